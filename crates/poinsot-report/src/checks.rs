//! Evidence about the fit in words, for the terminal and the page.

use poinsot_figures::Tone;
use poinsot_files::{probability, significant};
use poinsot_formats::{ChannelFile, DiagnosticsFile, DriftFile, HeldOutFile, LagFile, SuspectFile};
use serde::Serialize;

/// p-value below which drift or lag is reported.
pub(crate) const SIGNIFICANT: f64 = 1.0e-4;

/// One check of the residuals, or a possible cause of a misfit.
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

impl Check {
    fn new(test: String, found: String, (tone, verdict): Verdict) -> Self {
        Self {
            test,
            found,
            verdict: verdict.to_owned(),
            tone,
        }
    }
}

/// Number of causes listed next to the checks; the result file has all.
const CAUSES: usize = 3;

/// Every check of the residuals.
pub(crate) fn checks(d: &DiagnosticsFile) -> Vec<Check> {
    let mut all = vec![chi_square(d)];
    all.extend(d.channels.iter().map(|(name, c)| residual(name, c)));
    all.extend(d.held_out.iter().map(held_out_row));
    let small = |p: Option<f64>| p.is_some_and(|p| p < SIGNIFICANT);
    let drifts = d.momentum_drift.iter();
    let worth_a_row = drifts.filter(|d| d.segment.is_none() || small(d.p));
    all.extend(worth_a_row.map(drift_row));
    all.extend(d.lags.iter().map(lag_row));
    all.extend(d.lines.iter().map(|l| {
        let share = 100.0 * l.share;
        let found = format!("{:.3} Hz, {share:.0} % of the power", l.frequency_hz);
        let test = format!("line in {}", l.segment);
        Check::new(test, found, (Tone::Bad, "not rigid"))
    }));
    all
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

fn chi_square(d: &DiagnosticsFile) -> Check {
    let found = format!("{:.0} for {} expected", d.chi2.unwrap_or(f64::NAN), d.dof);
    Check::new("chi-square".to_owned(), found, chi_square_verdict(d))
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

fn residual(name: &str, c: &ChannelFile) -> Check {
    let white = c
        .whiteness_p
        .map_or(String::new(), |p| format!(", white p = {}", probability(p)));
    let found = format!("{:.2} % outliers{white}", 100.0 * c.outlier_share);
    Check::new(
        format!("residual of the {name}"),
        found,
        residual_verdict(c),
    )
}

/// Verdict on the prediction of the last part of every record.
pub(crate) fn held_out_verdict(h: &HeldOutFile) -> Verdict {
    match h.p < SIGNIFICANT {
        true => (Tone::Bad, "no"),
        false => (Tone::Good, "yes"),
    }
}

fn held_out_row(h: &HeldOutFile) -> Check {
    let percent = 100.0 * h.share;
    let found = format!(
        "chi-square {:.0}, expected {}, p = {}",
        h.chi2,
        h.numbers,
        probability(h.p)
    );
    Check::new(
        format!("last {percent:.0} % of every record predicted by the rest"),
        found,
        held_out_verdict(h),
    )
}

fn drift_row(d: &DriftFile) -> Check {
    let name = match &d.segment {
        Some(segment) => format!("momentum drift in {segment}"),
        None => "momentum drift".to_owned(),
    };
    let torque = strongest(&d.torque_N_m, &d.torque_sigma_N_m, "N m");
    let force = match (&d.force_N, &d.force_sigma_N) {
        (Some(f), Some(s)) => strongest(f, s, "N"),
        _ => None,
    };
    let both: Vec<String> = [torque, force].into_iter().flatten().collect();
    let p = d.p.unwrap_or(f64::NAN);
    let found = format!("{}, p = {}", both.join("; "), probability(p));
    Check::new(name, found, seen(p, "drifts"))
}

/// The component with the most sigmas, in N.
fn strongest(value: &[Option<f64>; 3], sigma: &[Option<f64>; 3], unit: &str) -> Option<String> {
    let seen = ["x", "y", "z"].into_iter().zip(value.iter().zip(sigma));
    let (axis, v, s) = seen
        .filter_map(|(axis, (v, s))| Some((axis, (*v)?, (*s)?)))
        .max_by(|a, b| (a.1 / a.2).abs().total_cmp(&(b.1 / b.2).abs()))?;
    let (v, s) = (significant(v, 2), significant(s, 2));
    Some(format!("{axis} {v} ± {s} {unit}"))
}

fn lag_row(l: &LagFile) -> Check {
    let p = l.p.unwrap_or(f64::NAN);
    let (lag, sigma) = (
        significant(1.0e3 * l.lag_s, 2),
        significant(1.0e3 * l.sigma_s, 2),
    );
    Check::new(
        format!("lag of {} behind {}", l.between[0], l.between[1]),
        format!("{lag} ± {sigma} ms, p = {}", probability(p)),
        seen(p, "late"),
    )
}

/// Verdict for a p-value.
fn seen(p: f64, word: &'static str) -> Verdict {
    match p < SIGNIFICANT {
        true => (Tone::Bad, word),
        false => (Tone::Good, "none seen"),
    }
}
