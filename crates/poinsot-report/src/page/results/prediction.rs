//! Page of a prediction.

use super::curves::against_duration;
use super::{Shown, answer, light, ratio_figure};
use crate::prediction::{accuracy, peaks, predicted_sigma};
use crate::verdict::Standing;
use poinsot_figures::{Axis, Figure, Mark, Opening, Plot, Series};
use poinsot_formats::PredictionFile;

pub(super) fn result(p: &PredictionFile) -> Shown {
    let mut document = accuracy(p);
    if !p.peaks.is_empty() {
        document.push(peaks(p));
    }
    let (_, determined) = Standing {
        status: &p.status,
        covariance_trustworthy: true,
        doubted: false,
    }
    .display();
    let met = p.wants.iter().filter(|w| w.met).count();
    let word = match (p.wants.len(), met) {
        (0, _) => determined,
        (all, met) if all == met => "Reached",
        _ => "Not reached",
    };
    let found = &p.identifiability;
    let all = found.rank == found.parameters;
    let (tone, yes) = answer(all);
    let of = format!("{} of {} combinations", found.rank, found.parameters);
    let mut identifiable = light("Everything identifiable?", tone, yes, of);
    if !all {
        identifiable.place = "open";
    }
    let mut lights = vec![identifiable];
    if !p.wants.is_empty() {
        let (tone, yes) = answer(met == p.wants.len());
        let of = format!("{met} of {} wanted numbers", p.wants.len());
        lights.push(light("Accurate enough?", tone, yes, of));
    }
    let action = found
        .not_identifiable
        .first()
        .map(|o| format!("{}.", o.remedy));
    let wants = p.wants.iter().map(|w| {
        let ratio = w.sigma.map_or(f64::NAN, |s| s / w.wanted_sigma);
        (w.name.as_str(), vec![ratio])
    });
    let beside = ratio_figure(&["this manoeuvre"], wants).or_else(|| shares(p));
    Shown {
        title: format!("Accuracy expected of {}", p.case),
        poinsot: p.poinsot.clone(),
        opening: Opening {
            tone: document.tone,
            word: word.to_owned(),
            sentence: document.verdict.clone(),
            action,
            lights,
            ..Opening::default()
        },
        beside,
        document,
        curves: (
            "Duration",
            p.against_duration
                .iter()
                .filter_map(against_duration)
                .collect(),
        ),
        open: Some(found.clone()),
        several: p.bodies.len() > 1,
        inputs: vec![("case", p.case.clone()), ("vehicle", p.model.clone())],
    }
}

/// Predicted sigmas relative to the largest number of their kind.
fn shares(p: &PredictionFile) -> Option<Figure> {
    let mut series = Vec::new();
    for (k, (name, body)) in p.bodies.iter().enumerate() {
        let numbers = body.numbers();
        let size = |unit: &str| {
            let alike = numbers.iter().filter(|n| n.1 == unit);
            alike.map(|n| n.2.nominal.abs()).fold(0.0, f64::max)
        };
        let points = (1..).map(f64::from).zip(&numbers);
        let points = points.filter_map(|(x, (_, unit, n))| {
            let share = 100.0 * predicted_sigma(n)? / size(unit);
            Some((x, share)).filter(|p| p.1.is_finite())
        });
        let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
        if !x.is_empty() {
            series.push(Series::new(name, Mark::Points, k, &x, &y));
        }
    }
    let first = p.bodies.values().next()?;
    let names = first.numbers().into_iter().map(|n| n.0).collect();
    (!series.is_empty()).then(|| {
        Figure::plot(
            "expected",
            Plot {
                title: "one sigma over the largest number of its kind".to_owned(),
                x: Axis::new("number", ""),
                y: Axis::new("share", "%"),
                names,
                log: true,
                series,
                half: true,
                ..Plot::default()
            },
        )
    })
}
