//! The limit of significance, and the causes of a misfit that are listed.

use poinsot_figures::Tone;
use poinsot_formats::{EstimateFile, SuspectFile};

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
