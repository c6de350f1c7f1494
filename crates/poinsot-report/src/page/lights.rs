//! Three questions about the evidence, each with a link. None is answered for a rejected model.

use super::Answer;
use crate::checks::{SIGNIFICANT, chi_square_verdict, held_out_verdict, residual_verdict};
use poinsot_figures::{Light, Tone};
use poinsot_files::{counted, probability};
use poinsot_formats::DiagnosticsFile;

/// Names of findings about the size of the noise, which belong to the first question.
pub const OF_NOISE: [&str; 2] = ["noise_overstated", "noise_understated"];
/// Name of the finding that the vehicle is not rigid.
pub const NOT_RIGID: &str = "not_rigid";

/// Tone, word, and finding.
type Found = (Tone, &'static str, String);

pub(super) fn lights(answer: &Answer) -> Vec<Light> {
    let tested = answer.estimate.diagnostics.as_ref();
    let rejected = answer.estimate.is_withheld();
    let of = |judge: fn(&DiagnosticsFile) -> Found| match (rejected, tested) {
        (true, _) => (Tone::Plain, "not asked", "the model is rejected".to_owned()),
        (false, None) => (Tone::Plain, "not tested", "by this method".to_owned()),
        (false, Some(d)) => judge(d),
    };
    let questions = [
        ("Noise as declared?", of(noise)),
        ("Rigid?", of(rigid)),
        ("Predicts held-out samples?", of(held_out)),
    ];
    let light = |(question, (tone, word, found))| light(question, "tests", tone, word, found);
    questions.map(light).to_vec()
}

/// A question with its answer and the anchor of its evidence.
pub(super) fn light(
    question: &'static str,
    place: &'static str,
    tone: Tone,
    word: &str,
    found: String,
) -> Light {
    Light {
        question,
        place,
        tone,
        word: word.to_owned(),
        found,
    }
}

fn noise(d: &DiagnosticsFile) -> Found {
    let (tone, _) = chi_square_verdict(d);
    let chi2 = d.chi2.unwrap_or(f64::NAN);
    let found = format!("chi-square {chi2:.0} for {} expected", d.dof);
    let worst = d
        .channels
        .iter()
        .map(|(name, c)| (name, residual_verdict(c)))
        .find(|(_, (tone, _))| *tone == Tone::Bad);
    match (tone, worst) {
        (Tone::Bad, _) => (Tone::Bad, "no, larger", found),
        (_, Some((name, (_, what)))) => (Tone::Bad, "no", format!("{name}: {what}")),
        (Tone::Fair, _) => (Tone::Fair, "smaller", found),
        _ => (Tone::Good, "yes", found),
    }
}

fn rigid(d: &DiagnosticsFile) -> Found {
    let drifts = d.momentum_drift.iter();
    let drift = drifts
        .filter(|d| d.p.is_some_and(|p| p < SIGNIFICANT))
        .count();
    if let Some(line) = d.lines.first() {
        let found = format!("a line at {:.3} Hz in the residual", line.frequency_hz);
        return (Tone::Bad, "no", found);
    }
    if drift > 0 {
        let tests = counted(d.momentum_drift.len(), "test");
        return (
            Tone::Bad,
            "no",
            format!("momentum drifts in {drift} of {tests}"),
        );
    }
    let mut findings = d.findings.iter();
    match findings.find(|f| !OF_NOISE.contains(&f.fault.as_str())) {
        Some(f) if f.fault == NOT_RIGID => (Tone::Bad, "no", f.text.clone()),
        Some(f) => (Tone::Fair, "unclear", f.text.clone()),
        None => (
            Tone::Good,
            "yes",
            "no spectral line, no momentum drift".to_owned(),
        ),
    }
}

fn held_out(d: &DiagnosticsFile) -> Found {
    let Some(held) = &d.held_out else {
        return (Tone::Plain, "not tested", "too few samples".to_owned());
    };
    let (tone, word) = held_out_verdict(held);
    let (share, p) = (100.0 * held.share, probability(held.p));
    let found = format!("last {share:.0} % of every record, p = {p}");
    (tone, word, found)
}
