//! A designed manoeuvre: result, active limits, and motion.

use super::curves::{against_duration, commands};
use super::{Shown, asked, light, ratio_figure};
use crate::design::{ROUNDED, design_document};
use crate::page::vehicle::{Flown, flying};
use poinsot_figures::{Axis, Figure, Light, Mark, Opening, Plot, Series, Tone};
use poinsot_files::significant;
use poinsot_formats::{DesignFile, RelaxedFile};
use std::path::Path;

pub(super) fn result(design: &DesignFile, folder: &Path, flown: Option<Flown>) -> Shown {
    let document = design_document(design);
    let reached = design.verdict == "reached";
    let best = design
        .relaxed
        .iter()
        .min_by(|a, b| a.worst_ratio.total_cmp(&b.worst_ratio));
    let opening = Opening {
        tone: document.tone,
        word: if reached { "Reached" } else { "Not reached" }.to_owned(),
        sentence: document.verdict.clone(),
        action: best.filter(|_| !reached).map(|r| {
            format!(
                "Relax {} by a factor of {}: the largest sigma is then {} of the wanted one.",
                r.what,
                significant(r.factor, 3),
                significant(r.worst_ratio, 3)
            )
        }),
        lights: vec![within_limits(design), confirmed(design)],
        ..Opening::default()
    };
    let rows = design.wants.iter().map(|w| {
        let ratio = |s: Option<f64>| s.map_or(f64::NAN, |s| s / w.wanted_sigma);
        (
            w.name.as_str(),
            vec![ratio(w.sigma), ratio(w.reference_sigma)],
        )
    });
    Shown {
        title: format!("Manoeuvre for {}", design.model),
        poinsot: design.poinsot.clone(),
        beside: ratio_figure(&["designed manoeuvre", "manoeuvre of the case"], rows),
        curves: ("Manoeuvre", figures(design, folder, flown.as_ref())),
        inputs: vec![("case", design.case.clone())],
        opening,
        document,
        ..Shown::default()
    }
}

/// The vehicle, the commands, the sigmas for shorter records, and the front.
fn figures(design: &DesignFile, folder: &Path, flown: Option<&Flown>) -> Vec<Figure> {
    let mut all: Vec<Figure> = flown.into_iter().map(flying).collect();
    all.extend(commands(&folder.join("commands.csv")));
    all.extend(design.against_duration.iter().filter_map(against_duration));
    if let Some(first) = design.front.first() {
        let point = |r: &RelaxedFile| (r.factor, r.worst_ratio);
        let (x, y): (Vec<f64>, Vec<f64>) = design.front.iter().map(point).unzip();
        let plot = Plot {
            title: format!("largest sigma against the limit: {}", first.what),
            x: Axis::new("limit over that of the case", ""),
            y: Axis::new("sigma over wanted sigma", ""),
            series: vec![Series::new("designed manoeuvre", Mark::Line, 0, &x, &y)],
            levels: vec![(1.0, "wanted".to_owned())],
            height: 210.0,
            ..Plot::default()
        };
        all.push(Figure::plot("front", plot));
    }
    all
}

fn within_limits(design: &DesignFile) -> Light {
    let broken = design.limits.iter().find(|l| l.margin < -ROUNDED);
    let active = design.limits.iter().filter(|l| l.active).count();
    let found = match broken {
        Some(l) => l.what.clone(),
        None => format!("{active} of {} limits are active", design.limits.len()),
    };
    asked("Within the limits?", broken.is_none(), found)
}

fn confirmed(design: &DesignFile) -> Light {
    let question = "Confirmed by trial flights?";
    match &design.verification {
        Some(v) => asked(question, v.agrees, format!("{} trial flights", v.flights)),
        None => {
            let found = "--verify simulates trial flights".to_owned();
            light(question, "numbers", Tone::Plain, "not flown", found)
        }
    }
}
