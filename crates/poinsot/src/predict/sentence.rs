//! A prediction in one sentence.

use super::Prediction;
use crate::estimate_file::{component, inertia_entries};
use crate::trials::numbers_of;
use poinsot_files::significant;
use poinsot_identify::{BodyEstimate, Number, Source};

/// Significant figures of a predicted sigma.
const FIGURES: i32 = 2;

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

/// The vehicle as one body, if it has several and any number will be determined.
fn whole(prediction: &Prediction) -> Option<&(BodyEstimate, Vec<f64>)> {
    let whole = prediction.bound.system.as_ref();
    whole.filter(|(b, _)| prediction.bound.bodies.len() > 1 && tells(b))
}

/// Whether any single number of a body will be determined.
fn tells(body: &BodyEstimate) -> bool {
    numbers_of(body).any(|(_, n)| sigma(n).is_some())
}

/// A duration without unnecessary decimals.
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
            // A product of inertia may be zero, so it is compared with the largest moment.
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

/// A length in a unit that keeps the number short.
fn length(m: f64) -> String {
    let (factor, unit) = match m {
        m if m >= 1.0 => (1.0, "m"),
        m if m >= 1.0e-3 => (1.0e3, "mm"),
        _ => (1.0e6, "um"),
    };
    format!("{} {unit}", significant(m * factor, FIGURES))
}
