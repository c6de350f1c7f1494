//! Reasons to reject the rigid model, the strongest first.

use crate::solution::estimate::BodyEstimate;
use crate::solution::evidence::{Effect, Remark};
use crate::solution::solved::{OfLikelihood, Solution};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Smallest share of the signal that an accepted model explains in that case.
const LEAST_EXPLAINED: f64 = 0.5;

/// A reason to reject the rigid model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rejection {
    /// The answer is not physical.
    Impossible,
    /// Accumulated noise under thrust is visible in chi-square: sigmas that assume independent noise are wrong, and so
    /// are the numbers.
    NoiseAddsUp,
    /// The residual has a spectral line.
    NotRigid,
    /// Residuals far beyond the noise are correlated in time: a wrong sign or unit, a dead wheel, a torque that the
    /// model lacks. Only maximum likelihood compares single samples. If a prior contradicts the data, the prior is
    /// wrong, not the vehicle.
    Contradicted,
    /// The model misses most of the signal.
    Unexplained,
}

impl Rejection {
    /// The first reason that holds. `coloured`: residuals are too large and correlated in time.
    pub fn of(solution: &Solution, coloured: bool, bodies: &[BodyEstimate]) -> Option<Self> {
        let chi2 = solution.chi2_per_dof();
        let limits = &solution.settings;
        let share = solution.explained;
        let unexplained = share.is_some_and(|share| share < LEAST_EXPLAINED);
        let bad_fit = chi2 > limits.misfit;
        let rejected = chi2 > limits.rejection;
        let impossible = (bodies.iter())
            .any(|b| bad_fit && unphysical(b, 0.0) || unphysical(b, limits.contradiction_sigmas))
            || pressed(solution, bad_fit);
        let own = solution.likelihood.as_ref();
        // Where the search failed, a mistake that a fit of its own confirmed contradicts the model, or a part of the record.
        let mut suspects = own.into_iter().flat_map(|own| &own.diagnostics.suspects);
        if !solution.is_found() && suspects.next().is_none() {
            let contradicted = own.is_some_and(|own| own.contradicted);
            return contradicted.then_some(Self::Contradicted);
        }
        let coloured = coloured && own.is_none_or(|own| own.conflict.is_none());
        let not_rigid = own.is_some_and(OfLikelihood::not_rigid);
        let reasons = [
            (Self::Impossible, impossible),
            (Self::NoiseAddsUp, bad_fit && solution.noise_accumulates),
            (Self::NotRigid, bad_fit && not_rigid),
            (Self::Contradicted, rejected && coloured),
            (Self::Unexplained, rejected && unexplained),
        ];
        reasons.into_iter().find(|r| r.1).map(|r| r.0)
    }

    /// The row of the evidence, also where there is no reason.
    pub fn row(reason: Option<Self>, solution: &Solution) -> Remark {
        let words = match reason {
            Some(_) => "the data are inconsistent with the rigid model",
            None => "the data are consistent with the rigid model",
        };
        let effect = Effect::RejectsModel.if_failed(reason.is_some());
        let (statistic, value) = match (reason, solution.explained) {
            (Some(Self::Unexplained), Some(share)) => ("share of the momentum explained", share),
            _ => ("chi-square per degree of freedom", solution.chi2_per_dof()),
        };
        Remark::test("rigid model", effect, words).statistic(statistic, value)
    }

    /// Its message.
    pub fn message(self, solution: &Solution) -> String {
        let chi2 = solution.chi2_per_dof();
        let times = chi2.sqrt();
        let check = "check units, signs, wheel axes, external torques";
        match self {
            Self::Impossible => format!(
                "rigid model rejected: the estimate is not physical by more than its uncertainty; residuals are {times:.1} times the declared noise (chi-square per degree of freedom {chi2:.1}); {check}"
            ),
            Self::NoiseAddsUp => format!(
                "linear method: under thrust, position and attitude noise accumulates over samples (chi-square per degree of freedom {chi2:.1}); its sigmas ignore that, so numbers are withheld; use --method auto"
            ),
            Self::NotRigid => format!(
                "rigid model rejected: chi-square per degree of freedom {chi2:.1} with a line in the residual"
            ),
            Self::Contradicted => format!(
                "rigid model rejected: residuals are {times:.1} times the declared noise (chi-square per degree of freedom {chi2:.1}), correlated in time; {check}"
            ),
            Self::Unexplained => format!(
                "rigid model rejected: it explains {:.0} % of the measured momentum change; the rest is {times:.0} sigma; {check}",
                100.0 * solution.explained.unwrap_or(0.0)
            ),
        }
    }
}

/// Whether a body is not physical by more than so many sigmas.
fn unphysical(body: &BodyEstimate, sigmas: f64) -> bool {
    if !body.asked || body.physically_consistent != Some(false) {
        return false;
    }
    let Some(principal) = &body.principal else {
        return false;
    };
    let [a, b, c] = principal.moments_kg_m2;
    let violation = (c - a - b).max(-a);
    // Of numbers that the data leave open there is none.
    let known = body.inertia.iter().filter_map(|n| n.sigma);
    let sigma = known.reduce(f64::max);
    sigma.is_some_and(|sigma| violation > sigmas * sigma)
}

/// Whether a physical limit is active beyond what noise explains, or active at all if the fit is bad.
fn pressed(solution: &Solution, bad_fit: bool) -> bool {
    let own = solution.likelihood.as_ref();
    let held = own.and_then(|own| own.held.as_ref());
    held.is_some_and(|h| {
        let beyond = ChiSquared::new(h.conditions as f64);
        bad_fit || beyond.is_ok_and(|b| b.sf(h.cost) < solution.settings.contradiction_p())
    })
}
