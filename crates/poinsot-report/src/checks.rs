//! Evidence about the fit in words, for the terminal and the page.

use poinsot_figures::Tone;
use poinsot_formats::{ChannelFile, DiagnosticsFile, EstimateFile, HeldOutFile, SuspectFile};

/// p-value below which drift or lag is reported.
pub(crate) const SIGNIFICANT: f64 = 1.0e-4;

/// Colour and word.
pub(crate) type Verdict = (Tone, &'static str);

/// Number of causes listed next to the checks; the result file has all.
const CAUSES: usize = 3;

/// The causes of a misfit with the best evidence.
pub(crate) fn causes(e: &EstimateFile) -> Vec<&SuspectFile> {
    let all = e.diagnostics.iter();
    all.flat_map(|d| d.suspects.iter().take(CAUSES)).collect()
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
