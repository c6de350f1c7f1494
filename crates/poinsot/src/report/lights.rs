//! Three questions about the evidence, each with a link to it. None is answered for a rejected model.

use super::Answer;
use crate::diagnostics_file::{SIGNIFICANT, chi_square_verdict, residual_verdict};
use minijinja::{Value, context};
use poinsot_formats::DiagnosticsFile;
use poinsot_report::Tone;

/// Tone, word, and what was found.
type Light = (&'static str, &'static str, String);

pub(super) fn lights(answer: &Answer) -> Vec<Value> {
    let tested = answer.estimate.diagnostics.as_ref();
    let rejected = answer.estimate.is_withheld();
    let of = |judge: fn(&DiagnosticsFile) -> Light| match (rejected, tested) {
        (true, _) => ("off", "not asked", "the model is rejected".to_owned()),
        (false, None) => ("off", "not tested", "by this method".to_owned()),
        (false, Some(d)) => judge(d),
    };
    let held_out = match rejected {
        true => "the model is rejected",
        false => "poinsot validate tests it on another record",
    };
    [
        ("Noise as declared?", "tests", of(noise)),
        ("Rigid?", "tests", of(rigid)),
        (
            "Predicts what was held out?",
            "held_out",
            ("off", "not tested", held_out.to_owned()),
        ),
    ]
    .into_iter()
    .map(|(question, place, (tone, word, found))| context! { question, place, tone, word, found })
    .collect()
}

fn noise(d: &DiagnosticsFile) -> Light {
    let (tone, _) = chi_square_verdict(d);
    let chi2 = d.chi2.unwrap_or(f64::NAN);
    let found = format!("chi-square {chi2:.0} for {} expected", d.dof);
    let worst = d
        .channels
        .iter()
        .map(|(name, c)| (name, residual_verdict(c)))
        .find(|(_, (tone, _))| *tone == Tone::Bad);
    match (tone, worst) {
        (Tone::Bad, _) => ("bad", "no, larger", found),
        (_, Some((name, (_, what)))) => ("bad", "no", format!("{name}: {what}")),
        (Tone::Fair, _) => ("fair", "smaller", found),
        _ => ("good", "yes", found),
    }
}

fn rigid(d: &DiagnosticsFile) -> Light {
    let drifts = d.momentum_drift.iter();
    let drift = drifts
        .filter(|d| d.p.is_some_and(|p| p < SIGNIFICANT))
        .count();
    if let Some(line) = d.lines.first() {
        let found = format!("a line at {:.3} Hz in the residual", line.frequency_hz);
        return ("bad", "no", found);
    }
    if drift > 0 {
        let found = format!(
            "momentum drifts in {drift} of {} tests",
            d.momentum_drift.len()
        );
        return ("bad", "no", found);
    }
    match d.findings.first() {
        Some(f) => ("bad", "no", f.text.clone()),
        None => (
            "good",
            "yes",
            "no spectral line, no momentum drift".to_owned(),
        ),
    }
}
