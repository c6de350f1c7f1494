//! Three questions about the evidence, each with a link. None is answered for a rejected model.

use super::Answer;
use crate::checks::SIGNIFICANT;
use poinsot_figures::{Light, Tone};
use poinsot_files::{counted, probability};
use poinsot_formats::{ChannelFile, DiagnosticsFile};

/// Names of findings about the size of the noise, which belong to the first question.
pub const OF_NOISE: [&str; 2] = ["noise_overstated", "noise_understated"];
/// Name of the finding that the vehicle is not rigid.
pub const NOT_RIGID: &str = "not_rigid";

/// Sigmas of chi-square beyond which a residual is larger or smaller than declared.
const EXCESS: f64 = 6.0;

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
    let chi2 = d.chi2.unwrap_or(f64::NAN);
    let found = format!("chi-square {chi2:.0} for {} expected", d.dof);
    let mut channels = d.channels.iter();
    let worst = channels.find_map(|(name, c)| Some(format!("{name}: {}", not_noise(c)?)));
    match (d.excess_sigmas, worst) {
        (Some(excess), _) if excess > EXCESS => (Tone::Bad, "no, larger", found),
        (_, Some(worst)) => (Tone::Bad, "no", worst),
        (Some(excess), _) if excess < -EXCESS => (Tone::Fair, "smaller", found),
        _ => (Tone::Good, "yes", found),
    }
}

/// What the residual of a sensor shows that is no white noise.
fn not_noise(c: &ChannelFile) -> Option<&'static str> {
    match c.whiteness_p {
        _ if c.outlier_share > 1.0e-3 && c.outliers > 1 => Some("outliers"),
        Some(p) if p < SIGNIFICANT => Some("correlated in time"),
        _ => None,
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
    let (tone, word) = match held.p < SIGNIFICANT {
        true => (Tone::Bad, "no"),
        false => (Tone::Good, "yes"),
    };
    let (share, p) = (100.0 * held.share, probability(held.p));
    let found = format!("last {share:.0} % of every record, p = {p}");
    (tone, word, found)
}
