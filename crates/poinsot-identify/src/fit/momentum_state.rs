//! The momentum-state fit: Levenberg-Marquardt on the triangle of the shared unknowns.
//!
//! Pose, momentum and biases are eliminated by the order of the columns, so each step is decided in the
//! mass properties alone; the rest follows by back-substitution. Directions that the data leave open do
//! not move. A damped step also damps what is eliminated.

use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::step::{
    BoundaryBodies, Linearisation, NEAR, held, linearised, moved, physical_bodies,
};
use crate::fit::triangle::SharedTriangle;
use crate::likelihood::{ChannelResidual, Evaluated};
use crate::problem::ProblemError;
use crate::problem::alternative::BetweenSamples;
use crate::problem::refusal::no_motion;
use poinsot_solve::{End, LeastSquares, Linearised, Minimum, Spectrum, levenberg_marquardt};

/// Share of a misfit that a full step may still promise where it is known well enough to contradict a model.
const SETTLED: f64 = 1.0e-2;
/// Fits from near a point, where the bodies are physical, in at most `limit` iterations.
pub(crate) fn fit_near(experiment: &Experiment, mut at: Iterate, limit: usize) -> Option<Fitted> {
    if let Some(bodies) = physical_bodies(experiment) {
        bodies.start(&mut at.x);
    }
    fit_from(experiment, at, limit)
}

/// Fits from a point, in at most `limit` iterations; `None` where the vehicle cannot move there.
pub(crate) fn fit_from(experiment: &Experiment, at: Iterate, limit: usize) -> Option<Fitted> {
    let here = experiment.linearise(&at)?;
    fit_on(experiment, at, here, limit)
}

/// The same where the problem at the point is known.
pub(crate) fn fit_on(
    experiment: &Experiment,
    at: Iterate,
    here: Linearised<Linearisation>,
    limit: usize,
) -> Option<Fitted> {
    let minimum = levenberg_marquardt(experiment, at, here, limit);
    let settled = is_settled(&minimum);
    let (at, here, end) = (minimum.at, minimum.here, minimum.end);
    let linearisation = here.rows;
    let alone = || {
        let stacked = experiment.stack(&at, &linearisation.evaluated, false);
        let own = SharedTriangle::new(experiment.parameters, &stacked);
        experiment.spectrum_within(&stacked, &own, &linearisation.evaluated)
    };
    let data_alone = experiment.has_design_prior().then(alone).transpose().ok()?;
    let chi2 = (linearisation.evaluated.iter()).map(|e| e.chi2).sum();
    let rows: usize = linearisation.evaluated.iter().map(|e| e.rows).sum();
    // What an integration error may change the answer by, in sigmas widened by the misfit; and what a step ignores.
    let left = experiment.settings.integration.answer_sigmas;
    let near = left.powi(2) * (here.cost / rows.max(1) as f64).max(1.0) + here.slack;
    // A step ignores that the covariance moves: where none lowers the cost of a law of the inputs, that is at its minimum.
    let lowest = end == End::NoLowerCost && experiment.wheels == BetweenSamples::RandomTorque;
    let limit = if lowest { near.max(NEAR) } else { near };
    Some(Fitted {
        explains: experiment.expects(chi2, &linearisation.evaluated),
        held: held(experiment, &at, &linearisation),
        at,
        evaluated: linearisation.evaluated,
        shared: linearisation.shared,
        spectrum: linearisation.spectrum,
        data_alone,
        iterations: minimum.iterations,
        costs: minimum.costs,
        // Steps end where evaluations differ by more than the steps lower the cost: near the minimum, not at it.
        converged: end == End::Converged || here.predicted_reduction < limit,
        settled,
        search: Search::Whole,
    })
}

/// Pose, momentum and biases that fit best at the mass properties of a point, which are held.
pub(crate) fn fit_starts(
    experiment: &Experiment,
    mut at: Iterate,
    limit: usize,
) -> Result<Iterate, ProblemError> {
    let evaluate = |at: &Iterate| experiment.evaluate(at, true);
    let mut here = linearised(experiment, &at, evaluate(&at).ok_or_else(no_motion)?)?;
    for _ in 0..limit {
        let held = vec![0.0; here.rows.spectrum.natural.len()];
        let next = moved(experiment, &at, here.rows.parts(), &held);
        let Some(evaluated) = evaluate(&next) else {
            break;
        };
        let there = linearised(experiment, &next, evaluated)?;
        if there.cost.is_nan() || there.cost >= here.cost {
            break;
        }
        (at, here) = (next, there);
    }
    Ok(at)
}

/// Where a search ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Search {
    /// At a minimum of the whole record.
    Whole,
    /// At a minimum of a beginning of the record that the model does not explain.
    Contradicted,
    /// Nowhere: beyond this share of the record no fit converges.
    Lost(f64),
}

/// Whether no step lowers the misfit, what the cost is more than its expectation, by more than a negligible share.
pub(super) fn is_settled(end: &Minimum<Iterate, Linearisation>) -> bool {
    let rows: usize = end.here.rows.evaluated.iter().map(|e| e.rows).sum();
    end.here.predicted_reduction < SETTLED * (end.here.cost - rows as f64).max(1.0)
}

/// Where the iteration ended.
#[derive(Clone)]
pub(crate) struct Fitted {
    pub at: Iterate,
    pub evaluated: Vec<Evaluated>,
    pub shared: SharedTriangle,
    pub spectrum: Spectrum,
    /// Spectrum without the priors of mass properties, where any are declared.
    pub data_alone: Option<Spectrum>,
    pub iterations: usize,
    /// Cost at the start and after every accepted step of the last fit.
    pub costs: Vec<f64>,
    pub converged: bool,
    /// No step lowers chi-square much: it can contradict the model.
    pub settled: bool,
    /// Chi-square of the readings is of the size of its expectation.
    pub explains: bool,
    /// How far along the record the minimum was followed.
    pub search: Search,
    pub held: Option<BoundaryBodies>,
}

impl Fitted {
    /// Chi-square of the readings alone.
    pub fn chi2(&self) -> f64 {
        self.evaluated.iter().map(|e| e.chi2).sum()
    }

    /// Whether it is a minimum by which the model can be judged: the numbers if it converged, else chi-square alone.
    pub fn is_found(&self) -> bool {
        let lost = matches!(self.search, Search::Lost(_));
        !lost && (self.converged || self.settled)
    }

    /// Mean square of the noise in the residuals by their successive differences (von Neumann 1941), which no slow misfit enters.
    pub fn scatter(&self) -> f64 {
        let channels = self.evaluated.iter().flat_map(|e| &e.channels);
        let of = |(square, count): (f64, usize), c: &ChannelResidual| {
            let steps = c.white.windows(2).map(|w| (w[1] - w[0]).norm_squared());
            let steps: f64 = steps.sum();
            (square + 0.5 * steps, count + c.numbers * c.white.len())
        };
        let (square, count) = channels.fold((0.0, 0), of);
        square / count.max(1) as f64
    }

    /// Parts that follow a step of the mass properties.
    pub fn parts(&self) -> (&[Evaluated], &SharedTriangle, &[f64]) {
        (&self.evaluated, &self.shared, &self.spectrum.natural)
    }

    /// How many numbers were compared.
    pub fn rows(&self) -> usize {
        self.evaluated.iter().map(|e| e.rows).sum()
    }
}

impl Experiment<'_> {
    /// Cost of a fit; infinite if a prior forbids its end.
    pub fn cost_of(&self, fitted: &Fitted) -> f64 {
        self.chi2(&fitted.at, &fitted.evaluated)
            .unwrap_or(f64::INFINITY)
    }
}
