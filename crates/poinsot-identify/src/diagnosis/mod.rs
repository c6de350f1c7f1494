//! When the fit is worse than the declared noise: what would explain it?
//!
//! Each candidate fault is a group of columns that the fit did not have. Its score is how much of the
//! residual those columns reach beyond the fitted unknowns: the decrease of chi-square that adding it would
//! bring, to first order. The best few are fitted in earnest. A spectral line in the gyro residual speaks of
//! flexing or slosh; white noise that is too large, of a wrong declaration; few bad readings, of outliers.

mod candidates;
mod channels;
mod drift;
mod findings;
mod gross;
mod line;
mod projected;
mod suspects;
mod types;

pub(crate) use channels::{OUTLIER, whiteness};
pub use types::{
    ChannelDiagnosis, Diagnostics, FaultKind, Finding, MomentumDrift, SensorLag, SpectralLine,
    Suspect,
};

use crate::fit::Fitted;
use crate::information::{Experiment, Point};
use crate::likelihood::Evaluated;
use candidates::{Candidate, candidates};
use poinsot_solve::{BlockQr, Triangle};
use projected::Projected;

/// Excess of chi-square, in its own standard deviations, below which nothing is to be explained.
pub(super) const EXCESS: f64 = 6.0;
/// Mean turn between readings, rad, from which one look at the motion takes so many steps that fits of single causes would
/// take minutes.
const COARSE: f64 = 0.3;
/// Most segments whose drift is looked at one by one.
const SEGMENTS: usize = 16;

/// Looks for what explains the misfit of a fit; `fitted_numbers` were fitted in all.
pub(crate) fn diagnose(
    experiment: &Experiment,
    fitted: &Fitted,
    fitted_numbers: usize,
) -> Diagnostics {
    let rows: usize = fitted.evaluated.iter().map(|e| e.rows).sum();
    let chi2: f64 = fitted.evaluated.iter().map(|e| e.chi2).sum();
    let dof = rows.saturating_sub(fitted_numbers);
    let excess = chi2 - dof as f64;
    let per_number = (chi2 / dof.max(1) as f64).max(1.0);
    let mut out = Diagnostics {
        chi2,
        dof,
        deviance: crate::deviance::deviance(experiment, fitted),
        excess_sigmas: excess / (2.0 * dof.max(1) as f64).sqrt(),
        channels: channels::channels(fitted),
        ..Diagnostics::default()
    };
    let misfit = out.excess_sigmas > EXCESS;
    let turn = turn_between_readings(experiment);
    let affordable = turn < COARSE;
    let candidates = candidates(experiment);
    if let Some(wide) = Widened::new(experiment, fitted, &candidates) {
        let projected = wide.projected(experiment, fitted, None);
        out.suspects = suspects::suspects(
            experiment,
            fitted,
            &candidates,
            &projected,
            (excess, per_number, misfit),
            affordable,
        );
        out.lags = drift::lags(experiment, &candidates, &projected, per_number);
        out.drift
            .extend(drift::drift(None, &candidates, &projected, per_number));
        let segments = experiment.problem.segments;
        if (2..=SEGMENTS).contains(&segments.len()) {
            for (at, segment) in segments.iter().enumerate() {
                let alone = wide.projected(experiment, fitted, Some(at));
                let label = Some(segment.label.clone());
                out.drift
                    .extend(drift::drift(label, &candidates, &alone, per_number));
            }
        }
    }
    // A suspect that leaves chi-square right needs no gross mistake beside it; trying them all is slow.
    let settled = |s: &Suspect| excess - s.decrease < dof as f64;
    if affordable
        && !out.suspects.first().is_some_and(settled)
        && let Some(mistake) = gross::gross(experiment, fitted, (excess, dof as f64))
    {
        out.suspects.insert(0, mistake);
    }
    if misfit {
        out.lines = line::spectral_lines(experiment, fitted);
    }
    out.findings = findings::findings(&out);
    if misfit && !affordable {
        out.findings.push(Finding {
            fault: FaultKind::Unexplained,
            text: format!(
                "the vehicle turns by {turn:.1} rad from one reading to the next, too far to try single causes: are the times in seconds?"
            ),
        });
    }
    out
}

/// Mean turn between grid times by the gyro, rad.
fn turn_between_readings(experiment: &Experiment) -> f64 {
    let (mut turn, mut intervals) = (0.0, 0);
    for segment in experiment.problem.segments {
        let o = &segment.observations;
        for (t, w) in o.time_s.windows(2).zip(&o.rate) {
            turn += w.map_or(0.0, |w| w.norm() * (t[1] - t[0]));
            intervals += 1;
        }
    }
    turn / intervals.max(1) as f64
}

/// The experiment at the answer with the columns of all candidates.
struct Widened {
    unknowns: Vec<crate::parameters::Unknown>,
    at: Point,
    evaluated: Vec<Evaluated>,
    stacked: Triangle,
    heads: Vec<usize>,
}

impl Widened {
    fn new(experiment: &Experiment, fitted: &Fitted, candidates: &[Candidate]) -> Option<Self> {
        let unknowns: Vec<_> = candidates.iter().flat_map(|c| c.unknowns.clone()).collect();
        let mut extended = experiment.parameters.clone();
        extended.unknowns.extend(unknowns.iter().cloned());
        let wide = experiment.with_parameters(&extended);
        let mut x = fitted.at.x.clone();
        x.extend(unknowns.iter().map(|u| u.nominal));
        let at = Point {
            x,
            heads: fitted.at.heads.clone(),
        };
        let evaluated = wide.evaluate(&at, true)?;
        let stacked = wide.stack(&at, &evaluated, true);
        Some(Self {
            unknowns,
            stacked,
            heads: experiment.unknown.iter().map(|u| u.count()).collect(),
            at,
            evaluated,
        })
    }

    /// Candidates clear of the fit; with a segment given they act in that segment alone.
    fn projected(
        &self,
        experiment: &Experiment,
        fitted: &Fitted,
        segment: Option<usize>,
    ) -> Projected {
        let base = experiment.parameters;
        let Some(only) = segment else {
            return Projected::new(&self.stacked, base, &self.unknowns, fitted);
        };
        let mut stacked = BlockQr::new(self.at.x.len() + 1);
        for (s, one) in self.evaluated.iter().enumerate() {
            if let Some(triangle) = &one.triangle {
                let h = self.heads[s];
                let candidate = base.len()..self.at.x.len();
                stacked.push(triangle.r.nrows().saturating_sub(h), |i, j| {
                    match candidate.contains(&j) && s != only {
                        true => 0.0,
                        false => triangle.r[(h + i, h + j)],
                    }
                });
            }
        }
        Projected::new(&stacked.finish(), base, &self.unknowns, fitted)
    }
}
