//! A prediction in words: one sentence first, then the numbers behind it.

use super::Prediction;
use crate::estimate_file::{component, inertia_entries};
use crate::estimate_text::open_sentences;
use crate::trials::numbers_of;
use poinsot_identify::{BodyEstimate, Number, Source};
use poinsot_report::{Document, Section, Table, Tone, significant};

/// Combinations listed in the terminal; the file has all.
const LISTED: usize = 12;
/// Figures of a predicted sigma.
const FIGURES: i32 = 2;

/// The prediction as a document.
pub fn prediction_document(prediction: &Prediction) -> Document {
    let bound = &prediction.bound;
    let tone = match prediction.passes() {
        true => Tone::Good,
        false => Tone::Fair,
    };
    let mut document = Document::new(sentence(prediction)).toned(tone);
    if !prediction.wants.is_empty() {
        let mut table = Table::new(&["", "1 sigma", "wanted", "verdict", "unit"]);
        for met in &prediction.wants {
            let sigma = met.sigma.map(|s| significant(s, FIGURES));
            table.push(vec![
                met.want.name.clone(),
                sigma.unwrap_or_else(|| "not identifiable".to_owned()),
                significant(met.want.sigma, FIGURES),
                if met.is_met() { "met" } else { "missed" }.to_owned(),
                met.want.unit.to_owned(),
            ]);
        }
        document.push(Section::table("wanted", table));
    }
    for body in bound.bodies.iter().filter(|b| b.asked && tells(b)) {
        document.push(body_section(body));
    }
    if let Some((whole, _)) = whole(prediction) {
        let mut section = body_section(whole);
        section.title =
            "whole vehicle at the first sample (base axes, from the base origin)".to_owned();
        document.push(section);
    }
    if !bound.nuisance.is_empty() {
        let mut table = Table::new(&["", "1 sigma", "unit"]);
        for item in &bound.nuisance {
            table.push(vec![
                item.name.clone(),
                sigma_text(&item.number),
                item.unit.to_owned(),
            ]);
        }
        document.push(Section::table("also found", table));
    }
    let found = &bound.identifiability;
    if !found.open.is_empty() {
        document.push(Section::list(
            "what this manoeuvre cannot tell",
            open_sentences(&found.open),
        ));
        let mut table = Table::new(&["combination", "1 sigma", "unit"]);
        for c in found.determined.iter().take(LISTED) {
            table.push(vec![
                c.text.clone(),
                significant(c.sigma, FIGURES),
                c.unit.to_owned(),
            ]);
        }
        let mut section = Section::table("what it tells instead", table);
        if found.determined.len() > LISTED {
            section.note = Some(format!(
                "and {} more combinations with --json",
                found.determined.len() - LISTED
            ));
        }
        document.push(section);
    }
    if !prediction.assumptions.is_empty() {
        document.push(Section::list("assumed", prediction.assumptions.clone()));
    }
    document
}

/// "2 min of this manoeuvre: bus mass to 0.1 %, mass centre to 4 mm, Ixx to 0.3 %, ...; Ixy not identifiable."
pub(super) fn sentence(prediction: &Prediction) -> String {
    let asked = || prediction.bound.bodies.iter().filter(|b| b.asked);
    let mut told: Vec<String> = asked().filter(|b| tells(b)).map(of_body).collect();
    let silent: Vec<&str> = asked()
        .filter(|b| !tells(b))
        .map(|b| b.name.as_str())
        .collect();
    if !silent.is_empty() {
        if let Some((whole, _)) = whole(prediction) {
            told.push(of_body(whole));
        }
        told.push(format!(
            "no single number of {} is identifiable",
            silent.join(", ")
        ));
    }
    let found = &prediction.bound.identifiability;
    format!(
        "{} of this manoeuvre ({}, {} of {} combinations): {}.",
        duration(prediction.duration_s),
        prediction.model.name,
        found.rank,
        found.parameters,
        told.join("; ")
    )
}

/// The vehicle as one body, where it has more than one and any of its numbers will be determined.
fn whole(prediction: &Prediction) -> Option<&(BodyEstimate, Vec<f64>)> {
    let whole = prediction.bound.system.as_ref();
    whole.filter(|(b, _)| prediction.bound.bodies.len() > 1 && tells(b))
}

/// Whether any single number of a body will be determined.
fn tells(body: &BodyEstimate) -> bool {
    numbers_of(body).any(|(_, n)| sigma(n).is_some())
}

/// A duration without needless decimals.
fn duration(s: f64) -> String {
    let (value, unit) = if s < 120.0 {
        (s, "s")
    } else {
        (s / 60.0, "min")
    };
    format!("{} {unit}", (100.0 * value).round() / 100.0)
}

fn of_body(body: &BodyEstimate) -> String {
    let mut told = Vec::new();
    let mut open = Vec::new();
    match body.mass.source {
        Source::Open => open.push("mass".to_owned()),
        Source::Known => {}
        _ => told.push(format!(
            "mass to {}",
            relative(&body.mass, body.mass.nominal)
        )),
    }
    let com: Vec<f64> = body.com.iter().filter_map(sigma).collect();
    let com_open: Vec<String> = (0..3)
        .filter(|&k| body.com[k].source == Source::Open)
        .map(|k| component("com", k))
        .collect();
    if !com.is_empty() {
        let worst = com.iter().fold(0.0_f64, |a, b| a.max(*b));
        told.push(format!("mass centre to {}", length(worst)));
    }
    match com_open.len() {
        3 => open.push("mass centre".to_owned()),
        _ => open.extend(com_open),
    }
    let largest = [0, 2, 5].map(|k| body.inertia[k].nominal.abs());
    let largest = largest.iter().fold(0.0_f64, |a, b| a.max(*b));
    for (k, name) in inertia_entries() {
        let n = &body.inertia[k];
        let moment = matches!(name, "xx" | "yy" | "zz");
        match n.source {
            Source::Open => open.push(format!("I{name}")),
            Source::Known => {}
            _ if moment => told.push(format!("I{name} to {}", relative(n, n.nominal))),
            // A product may be zero: judged against the largest moment.
            _ => told.push(format!(
                "I{name} to {} of the largest moment",
                relative(n, largest)
            )),
        }
    }
    let mut text = body.name.clone();
    text.push(' ');
    text.push_str(&told.join(", "));
    if !open.is_empty() {
        text.push_str(&format!(", {} not identifiable", open.join(", ")));
    }
    text
}

fn sigma(n: &Number) -> Option<f64> {
    n.sigma
        .filter(|_| !matches!(n.source, Source::Known | Source::Open))
}

fn relative(n: &Number, scale: f64) -> String {
    match sigma(n) {
        Some(s) if scale != 0.0 => format!("{} %", significant(100.0 * s / scale.abs(), FIGURES)),
        Some(s) => significant(s, FIGURES),
        None => "-".to_owned(),
    }
}

/// A length in the unit that keeps the number short.
fn length(m: f64) -> String {
    let (factor, unit) = match m {
        m if m >= 1.0 => (1.0, "m"),
        m if m >= 1.0e-3 => (1.0e3, "mm"),
        _ => (1.0e6, "um"),
    };
    format!("{} {unit}", significant(m * factor, FIGURES))
}

fn sigma_text(n: &Number) -> String {
    match n.source {
        Source::Known => "known".to_owned(),
        Source::Open => "not identifiable".to_owned(),
        _ => n
            .sigma
            .map_or_else(String::new, |s| significant(s, FIGURES)),
    }
}

fn body_section(body: &BodyEstimate) -> Section {
    let mut table = Table::new(&["", "truth", "1 sigma", "95 %", "relative", "unit"]);
    let mut row = |name: String, n: &Number, unit: &str| {
        let s = sigma(n);
        table.push(vec![
            name,
            significant(n.nominal, 6),
            sigma_text(n),
            s.map_or_else(String::new, |s| {
                format!("+- {}", significant(1.96 * s, FIGURES))
            }),
            s.filter(|_| n.nominal != 0.0)
                .map_or_else(String::new, |_| relative(n, n.nominal)),
            unit.to_owned(),
        ]);
    };
    row("mass".to_owned(), &body.mass, "kg");
    for k in 0..3 {
        row(component("com", k), &body.com[k], "m");
    }
    for (k, name) in inertia_entries() {
        row(format!("I_{name}"), &body.inertia[k], "kg m2");
    }
    Section::table(
        &format!(
            "{} (inertia about its mass centre, tensor elements)",
            body.name
        ),
        table,
    )
}
