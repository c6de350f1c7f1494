//! A designed manoeuvre: result, active limits, and motion.

use super::curves::{against_duration, commands};
use super::{Shown, asked, light, ratio_figure};
use crate::design::{ROUNDED, design_document};
use crate::page::vehicle::{Flown, flying};
use poinsot_figures::{Axis, Figure, Light, Mark, Opening, Plot, Series, Tone};
use poinsot_files::{counted, significant};
use poinsot_formats::{DesignFile, FrontPointFile};
use std::path::Path;

pub(super) fn result(
    design: &DesignFile,
    folder: &Path,
    flown: Option<Flown>,
) -> Result<Shown, String> {
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
    Ok(Shown {
        title: format!("Manoeuvre for {}", design.model),
        poinsot: design.poinsot.clone(),
        beside: ratio_figure(&["designed manoeuvre", "manoeuvre of the case"], rows),
        curves: ("Manoeuvre", figures(design, folder, flown.as_ref())?),
        inputs: vec![("case", design.case.clone())],
        opening,
        document,
        ..Shown::default()
    })
}

/// The vehicle, the commands, the sigmas for shorter records, and the front.
fn figures(
    design: &DesignFile,
    folder: &Path,
    flown: Option<&Flown>,
) -> Result<Vec<Figure>, String> {
    let mut all: Vec<Figure> = flown.into_iter().map(flying).collect();
    all.extend(commands(&folder.join("commands.csv"))?);
    all.extend(design.against_duration.iter().filter_map(against_duration));
    all.extend(front(&design.front));
    Ok(all)
}

/// The front: one line for every factor on the second limit.
fn front(points: &[FrontPointFile]) -> Option<Figure> {
    let mut names = points.first()?.factors.keys();
    let (first, second) = (names.next()?, names.next());
    let of_second = |p: &FrontPointFile| second.and_then(|name| p.factors.get(name)).copied();
    let mut levels: Vec<Option<f64>> = points.iter().map(of_second).collect();
    levels.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    levels.dedup();
    let line = |(k, level): (usize, &Option<f64>)| {
        let own = points.iter().filter(|p| of_second(p) == *level);
        let point = |p: &FrontPointFile| Some((*p.factors.get(first)?, p.worst_ratio));
        let (x, y): (Vec<f64>, Vec<f64>) = own.filter_map(point).unzip();
        let name = match (second, level) {
            (Some(name), Some(factor)) => format!("{name} x {}", significant(*factor, 3)),
            _ => "designed manoeuvre".to_owned(),
        };
        Series::new(&name, Mark::Line, k, &x, &y)
    };
    let plot = Plot {
        title: format!("largest sigma against the limit: {first}"),
        x: Axis::new("limit over that of the case", ""),
        y: Axis::new("sigma over wanted sigma", ""),
        series: levels.iter().enumerate().map(line).collect(),
        levels: vec![(1.0, "wanted".to_owned())],
        height: 210.0,
        ..Plot::default()
    };
    Some(Figure::plot("front", plot))
}

fn within_limits(design: &DesignFile) -> Light {
    let broken = design.limits.iter().find(|l| l.margin < -ROUNDED);
    let active = design.limits.iter().filter(|l| l.active).count();
    let limits = counted(design.limits.len(), "limit");
    let found = match broken {
        Some(l) => l.what.clone(),
        None => format!("active: {active} of {limits}"),
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
