//! Evidence about the fit in words, for the terminal and the page.

use poinsot_figures::Tone;
use poinsot_files::{probability, significant};
use poinsot_formats::{ChannelFile, DiagnosticsFile, EvidenceFile, HeldOutFile, SuspectFile};
use serde::Serialize;

/// p-value below which drift or lag is reported.
pub(crate) const SIGNIFICANT: f64 = 1.0e-4;

/// One test of an answer, or a possible cause of a misfit.
#[derive(Serialize)]
pub(crate) struct Check {
    /// Name of the test.
    pub test: String,
    /// Result.
    pub found: String,
    /// Meaning.
    pub verdict: String,
    /// Colour of the verdict.
    pub tone: Tone,
}

/// Colour and word.
pub(crate) type Verdict = (Tone, &'static str);

/// Number of causes listed next to the checks; the result file has all.
const CAUSES: usize = 3;

/// A test of an answer, as its evidence has it.
pub(crate) fn check(row: &EvidenceFile) -> Check {
    let statistic = row.statistic.as_ref().zip(row.value);
    let statistic = statistic.map(|(name, value)| format!("{name} {}", significant(value, 3)));
    let p = row.p.map(|p| format!("p = {}", probability(p)));
    let found: Vec<String> = [statistic, p].into_iter().flatten().collect();
    let (tone, verdict) = match row.effect.as_str() {
        "none" => (Tone::Good, "passed".to_owned()),
        "widens_sigmas" => (Tone::Fair, widened(row)),
        "makes_partial" => (Tone::Fair, "partial".to_owned()),
        "rejects_model" => (Tone::Bad, "rejected".to_owned()),
        "withholds_numbers" => (Tone::Bad, "withheld".to_owned()),
        _ => (Tone::Bad, "not reliable".to_owned()),
    };
    Check {
        test: row.test.clone(),
        found: found.join(", "),
        verdict,
        tone,
    }
}

fn widened(row: &EvidenceFile) -> String {
    let factor = row.sigma_factor.unwrap_or(f64::INFINITY);
    format!("sigmas times {factor:.2}")
}

/// The causes with the best evidence.
pub(crate) fn causes(d: &DiagnosticsFile) -> Vec<Check> {
    let one = |s: &SuspectFile| {
        let fall = s.decrease_of_chi2.unwrap_or(f64::NAN);
        Check {
            test: s.name.clone(),
            found: format!("would reduce chi-square by {fall:.0}"),
            verdict: s.fault.replace('_', " "),
            tone: Tone::Bad,
        }
    };
    d.suspects.iter().take(CAUSES).map(one).collect()
}

/// Verdict on the residual size relative to the declared noise.
pub(crate) fn chi_square_verdict(d: &DiagnosticsFile) -> Verdict {
    match d.excess_sigmas {
        Some(x) if x > 6.0 => (Tone::Bad, "larger than declared"),
        Some(x) if x < -6.0 => (Tone::Fair, "smaller than declared"),
        _ => (Tone::Good, "as declared"),
    }
}

/// Verdict on the time series of a sensor's residual.
pub(crate) fn residual_verdict(c: &ChannelFile) -> Verdict {
    match (c.outlier_share > 1.0e-3 && c.outliers > 1, c.whiteness_p) {
        (true, _) => (Tone::Bad, "outliers"),
        (false, Some(p)) if p < SIGNIFICANT => (Tone::Bad, "correlated in time"),
        (false, Some(_)) => (Tone::Good, "white"),
        (false, None) => (Tone::Fair, ""),
    }
}

/// Verdict on the prediction of the last part of every record.
pub(crate) fn held_out_verdict(h: &HeldOutFile) -> Verdict {
    match h.p < SIGNIFICANT {
        true => (Tone::Bad, "no"),
        false => (Tone::Good, "yes"),
    }
}
