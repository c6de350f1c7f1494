//! A designed manoeuvre: result, active limits, and motion.

use super::curves::{GROUP, against_duration, commands};
use super::{Shown, ratio_figure};
use crate::case::read_case;
use crate::predict::durations;
use crate::report::placed::{Vehicle, nominal};

use crate::report::vehicle::{Motion, flying};
use crate::simulate::simulate_exact_watched;
use poinsot_dynamics::Tree;
use poinsot_formats::{DesignFile, DesignVerificationFile, RelaxedFile};
use poinsot_model::read_model;
use poinsot_report::{
    Axis, Document, Figure, Light, Mark, Opening, Plot, Section, Series, Table, Tone, significant,
};
use poinsot_spatial::UnitQuaternion;
use std::path::Path;

/// Significant figures of a sigma.
const FIGURES: i32 = 2;
/// Round-off tolerance of a limit, relative.
const ROUNDED: f64 = 1.0e-4;

/// The design as a document.
pub fn design_document(design: &DesignFile) -> Document {
    let agrees = design.verification.as_ref().is_none_or(|v| v.agrees);
    let tone = match (design.verdict == "reached", agrees) {
        (true, true) => Tone::Good,
        _ => Tone::Fair,
    };
    let mut document = Document::new(design.in_words.clone()).toned(tone);
    document.push(wanted(design));
    if !design.limits.is_empty() {
        document.push(limits(design));
    }
    if !design.relaxed.is_empty() {
        document.push(points("effect of relaxing a limit", &design.relaxed));
    }
    if !design.front.is_empty() {
        document.push(points("with one limit tighter and looser", &design.front));
    }
    if let Some(found) = &design.against_duration {
        document.push(durations(found));
    }
    if let Some(v) = &design.verification {
        document.push(flights(v));
    }
    let settled = match design.search.settled {
        true => "the next step would gain less than 0.001 %",
        false => "stopped before convergence: more evaluations or minutes may find a better one",
    };
    let mut lines = vec![format!(
        "{} manoeuvres evaluated, {settled}",
        design.search.evaluations
    )];
    if let Some(robust) = design.robust_log_ratio {
        lines.push(format!(
            "worst tenth of the vehicles of the prior: largest sigma {} of the wanted one",
            significant(robust.exp(), 3)
        ));
        let others = [
            design.robust_log_ratio_others,
            design.nominal_log_ratio_others,
        ];
        if let [Some(own), Some(nominal)] = others {
            lines.push(format!(
                "worst tenth of a thousand others: {}; with the best manoeuvre for the nominal vehicle: {}",
                significant(own.exp(), 3),
                significant(nominal.exp(), 3)
            ));
        }
    }
    document.push(Section::list("search", lines));
    document
}

fn points(title: &str, all: &[RelaxedFile]) -> Section {
    let mut table = Table::new(&["limit", "times", "largest sigma over wanted"]);
    for r in all {
        let factor = significant(r.factor, 3);
        table.push(vec![r.what.clone(), factor, significant(r.worst_ratio, 3)]);
    }
    Section::table(title, table)
}

fn wanted(design: &DesignFile) -> Section {
    let compared = design.wants.iter().any(|r| r.reference_sigma.is_some());
    let mut header = vec!["", "1 sigma", "wanted", "ratio"];
    if compared {
        header.push("manoeuvre of the case");
    }
    header.push("unit");
    let mut table = Table::new(&header);
    for r in &design.wants {
        let sigma = r.sigma.map(|s| significant(s, FIGURES));
        let ratio = r.sigma.map(|s| significant(s / r.wanted_sigma, 3));
        let mut row = vec![
            r.name.clone(),
            sigma.unwrap_or_else(|| "not identifiable".to_owned()),
            significant(r.wanted_sigma, FIGURES),
            ratio.unwrap_or_default(),
        ];
        if compared {
            let reference = r.reference_sigma.map(|s| significant(s, FIGURES));
            row.push(reference.unwrap_or_default());
        }
        row.push(r.unit.clone());
        table.push(row);
    }
    Section::table("wanted", table)
}

fn limits(design: &DesignFile) -> Section {
    let mut table = Table::new(&["", "value", "limit", "room", "unit"]);
    for l in &design.limits {
        let room = match (l.margin < -ROUNDED, l.active) {
            (true, _) => "broken".to_owned(),
            (false, true) => "active".to_owned(),
            (false, false) => format!("{} %", significant(100.0 * l.margin, FIGURES)),
        };
        table.push(vec![
            l.what.clone(),
            significant(l.value, 4),
            significant(l.limit, 4),
            room,
            l.unit.clone(),
        ]);
    }
    Section::table("limits", table)
}

fn flights(v: &DesignVerificationFile) -> Section {
    let mut table = Table::new(&["", "error over predicted sigma (rms)", "99.9 % band"]);
    for n in &v.numbers {
        let [low, high] = n.band.map(|x| significant(x, 3));
        table.push(vec![
            n.name.clone(),
            significant(n.rms_ratio, 3),
            format!("{low} to {high}"),
        ]);
    }
    let title = format!(
        "{} trial flights: {} without an answer, {} with a broken limit",
        v.flights,
        v.failed.len(),
        v.limits_broken
    );
    let mut section = Section::table(&title, table);
    section.note = v.failed.first().cloned();
    section
}

pub(super) fn result(design: &DesignFile, folder: &Path) -> Shown {
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
        curves: ("Manoeuvre", figures(design, folder)),
        open: None,
        several: false,
        inputs: vec![("case", design.case.clone())],
        opening,
        document,
    }
}

/// The vehicle as it flies the written case; `None` if the case or its model cannot be read any more.
fn flown(folder: &Path) -> Option<Figure> {
    let case = read_case(&folder.join("case.toml")).ok()?;
    let model = read_model(&case.model).ok()?;
    let scenario = case.bind(&model).ok()?;
    let coordinates = Tree::new(&model).coordinates;
    let names = coordinates.iter().map(|k| model.joints[*k].name.clone());
    let mut motion = Motion {
        joints: names.map(|name| (name, Vec::new())).collect(),
        group: GROUP.to_owned(),
        ..Motion::default()
    };
    let mut first: Option<(UnitQuaternion, Vehicle)> = None;
    simulate_exact_watched(&case, &model, scenario, |sample| {
        let start = || (sample.R_NB, nominal(&model, &sample.kinematics));
        let R_BN = first.get_or_insert_with(start).0.inverse();
        let turn = (R_BN * sample.R_NB).coords;
        let place = R_BN * (sample.p_NoBo_N - sample.p_NoScm_N);
        motion.time_s.push(sample.time);
        motion.base.push((turn.into(), place.into()));
        for ((_, values), q) in motion.joints.iter_mut().zip(&sample.q) {
            values.push(*q);
        }
    })
    .ok()?;
    Some(flying(&first?.1, motion))
}

/// The vehicle, the commands, the sigmas for shorter records, and the front.
fn figures(design: &DesignFile, folder: &Path) -> Vec<Figure> {
    let mut all: Vec<Figure> = flown(folder).into_iter().collect();
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
    let (tone, word, found) = match broken {
        Some(l) => (Tone::Bad, "no", l.what.clone()),
        None => {
            let all = design.limits.len();
            (
                Tone::Good,
                "yes",
                format!("{active} of {all} limits are active"),
            )
        }
    };
    Light {
        question: "Within the limits?",
        place: "numbers",
        tone,
        word: word.to_owned(),
        found,
    }
}

fn confirmed(design: &DesignFile) -> Light {
    let (tone, word, found) = match &design.verification {
        None => (
            Tone::Plain,
            "not flown",
            "--verify simulates trial flights".to_owned(),
        ),
        Some(v) => {
            let (tone, word) = match v.agrees {
                true => (Tone::Good, "yes"),
                false => (Tone::Bad, "no"),
            };
            (tone, word, format!("{} trial flights", v.flights))
        }
    };
    Light {
        question: "Confirmed by trial flights?",
        place: "numbers",
        tone,
        word: word.to_owned(),
        found,
    }
}
