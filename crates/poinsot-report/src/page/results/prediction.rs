//! Page of a prediction.

use super::curves::against_duration;
use super::{Shown, asked, points, ratio_figure};
use crate::prediction::{document, predicted_sigma};
use crate::verdict::Standing;
use poinsot_figures::{Axis, Figure, Light, Opening, Plot};
use poinsot_files::counted;
use poinsot_formats::PredictionFile;

pub(super) fn result(p: &PredictionFile) -> Shown {
    let document = document(p, true);
    let standing = Standing {
        status: &p.status,
        covariance_trustworthy: true,
        doubted: false,
    };
    let (all, met) = (p.wants.len(), p.wants.iter().filter(|w| w.met).count());
    let word = match (all, met == all) {
        (0, _) => standing.display().1,
        (_, true) => "Reached",
        (_, false) => "Not reached",
    };
    let open = &p.identifiability.not_identifiable;
    let action = open.first().map(|o| format!("{}.", o.remedy));
    let wants = p.wants.iter().map(|w| {
        let ratio = w.sigma.map_or(f64::NAN, |s| s / w.wanted_sigma);
        (w.name.as_str(), vec![ratio])
    });
    let shorter = p.against_duration.iter().filter_map(against_duration);
    Shown {
        title: format!("Accuracy expected of {}", p.case),
        poinsot: p.poinsot.clone(),
        opening: Opening {
            tone: document.tone,
            word: word.to_owned(),
            sentence: document.verdict.clone(),
            action,
            lights: lights(p, met),
            ..Opening::default()
        },
        beside: ratio_figure(&["this manoeuvre"], wants).or_else(|| shares(p)),
        document,
        curves: ("Duration", shorter.collect()),
        open: Some(p.identifiability.clone()),
        several: p.bodies.len() > 1,
        inputs: vec![("case", p.case.clone()), ("vehicle", p.model.clone())],
    }
}

fn lights(p: &PredictionFile, met: usize) -> Vec<Light> {
    let found = &p.identifiability;
    let all = found.rank == found.parameters;
    let combinations = counted(found.parameters, "combination");
    let of = format!("{} of {combinations}", found.rank);
    let mut lights = vec![asked("Everything identifiable?", all, of)];
    if !all {
        lights[0].place = "open";
    }
    if !p.wants.is_empty() {
        let of = format!("{met} of {}", counted(p.wants.len(), "wanted number"));
        lights.push(asked("Accurate enough?", met == p.wants.len(), of));
    }
    lights
}

/// Predicted sigmas relative to the largest number of their kind.
fn shares(p: &PredictionFile) -> Option<Figure> {
    let bodies = p.bodies.iter().enumerate();
    let series = bodies.filter_map(|(k, (name, body))| {
        let numbers = body.numbers();
        let size = |unit: &str| {
            let alike = numbers.iter().filter(|n| n.1 == unit);
            alike.map(|n| n.2.nominal.abs()).fold(0.0, f64::max)
        };
        let share = |(_, unit, n): &(String, &str, _)| {
            predicted_sigma(n).map_or(f64::NAN, |s| 100.0 * s / size(unit))
        };
        points(name, k, numbers.iter().map(share))
    });
    let plot = Plot {
        title: "one sigma over the largest number of its kind".to_owned(),
        x: Axis::new("number", ""),
        y: Axis::new("share", "%"),
        series: series.collect(),
        names: p
            .bodies
            .values()
            .next()?
            .numbers()
            .into_iter()
            .map(|n| n.0)
            .collect(),
        log: true,
        half: true,
        ..Plot::default()
    };
    (!plot.series.is_empty()).then(|| Figure::plot("expected", plot))
}
