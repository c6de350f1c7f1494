//! Other minima of chi-square, where the one that was found does not stand.
//!
//! Over a record of many periods chi-square has a minimum for every whole turn by which a predicted nutation may be off, and one where
//! a bias of the gyro takes the place of the spin. A search ends in the one that is next to its start. Where that one contradicts what
//! is declared, or leaves an oscillation, two more starts are tried: the record followed from a short beginning, and a vehicle that
//! spins at the mean rate and nutates at the frequency that the residual shows. The smallest chi-square is the answer.

use crate::diagnosis::octaves::chance;
use crate::diagnosis::oscillation::wave;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::{Fitted, ITERATIONS, fit_along, fit_near, fit_starts};
use crate::likelihood::InitialState;
use crate::problem::segment::Samples;
use nalgebra::{DMatrix, UnitQuaternion};
use poinsot_spatial::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Chance below which a residual may hide an oscillation, and a difference from what is declared another minimum: what no test
/// rejects can be many sigmas of the answer.
pub(super) const SUSPICIOUS: f64 = 0.02;
/// Least decrease of chi-square by an oscillation: a scan over some thousand frequencies finds up to 40 by chance.
pub(super) const EVIDENCE: f64 = 60.0;
/// Decrease of chi-square by which another minimum is one: a tenth of a sigma.
const LOWER: f64 = 0.01;
/// Most starts at a frequency, each from the end of the one before.
const STARTS: usize = 3;
/// Most iterations from one: the spin, a bias of the gyro and a product of inertia make a curved valley.
const LONG: usize = 2 * ITERATIONS;
/// Iterations of pose, momentum and biases at a start.
const REFITS: usize = 8;
/// Most steps to a frequency, how near they lead, and the difference by which slopes are taken, natural units.
const STEPS: usize = 30;
const NEAR: f64 = 1.0e-6;
const DIFFERENCE: f64 = 1.0e-6;

/// The smallest minimum from all starts; the one that was found where it stands.
pub(super) fn least(experiment: &Experiment, found: Fitted, linear: Option<&Iterate>) -> Fitted {
    if experiment.settings.undiagnosed {
        return found;
    }
    let best = of_nutations(experiment, found);
    let of_residual = chance(&best.evaluated, &experiment.settings);
    let by_chance = of_residual.min(experiment.declared_chance(&best.at));
    let stands = best.converged && by_chance > SUSPICIOUS;
    // What is far from an explanation was followed already.
    if stands || !best.explains {
        return best;
    }
    match lower(experiment, &best, fit_along(experiment, linear)) {
        Some(other) => of_nutations(experiment, other),
        None => best,
    }
}

/// The smallest minimum from the frequencies that the residual of each shows.
fn of_nutations(experiment: &Experiment, mut best: Fitted) -> Fitted {
    for _ in 0..STARTS {
        let seen = nutation(experiment, &best);
        let start = seen.and_then(|seen| seen.start(experiment, &best));
        let fitted = start.and_then(|at| fit_near(experiment, at, LONG));
        match lower(experiment, &best, fitted) {
            Some(other) => best = other,
            None => break,
        }
    }
    best
}

/// Another minimum, where it is lower; one in a valley that is all but flat has to be lower by what only another motion explains.
fn lower(experiment: &Experiment, best: &Fitted, other: Option<Fitted>) -> Option<Fitted> {
    let cost = experiment.cost_of(best);
    other.filter(|o| {
        let least = match (best.converged, o.converged) {
            (true, false) => EVIDENCE,
            (false, true) => f64::NEG_INFINITY,
            _ => LOWER,
        };
        o.is_found() && cost - experiment.cost_of(o) > least
    })
}

/// A frequency in the residual of the longest record at which the vehicle may nutate.
struct Nutation {
    segment: usize,
    frequency_Hz: f64,
}

fn nutation(experiment: &Experiment, found: &Fitted) -> Option<Nutation> {
    let segments = experiment.problem.segments;
    let length = |k: &usize| segments[*k].observations.time_s.len();
    let segment = (0..segments.len()).max_by_key(length)?;
    let spin = Spin::new(experiment, segment)?;
    let own = experiment
        .problem
        .with_segments(&segments[segment..=segment]);
    let evaluated = &found.evaluated[segment..=segment];
    let most = spin.fastest(&found.at.x)? / TAU;
    let seen = wave(&experiment.with_problem(&own), evaluated, most)?;
    (seen.chance < SUSPICIOUS).then_some(Nutation {
        segment,
        frequency_Hz: seen.frequency_Hz,
    })
}

impl Nutation {
    /// The start of a vehicle that does, near to the nominal one.
    fn start(self, experiment: &Experiment, found: &Fitted) -> Option<Iterate> {
        let spin = Spin::new(experiment, self.segment)?;
        let wanted = (TAU * self.frequency_Hz).powi(2);
        let natural = &found.spectrum.natural;
        let mut x = experiment.parameters.nominal_vector();
        for _ in 0..STEPS {
            let now = spin.deviation(&x, wanted)?;
            if now.amax() < NEAR {
                let steady = |k| Some(Spin::new(experiment, k)?.start(&x));
                let starts = (0..experiment.problem.segments.len()).map(steady);
                let initial_states = starts.collect::<Option<_>>()?;
                // With the vehicle held: it moves where it does not nutate yet, and leaves the frequency.
                return fit_starts(experiment, Iterate { x, initial_states }, REFITS).ok();
            }
            let slope = |k: usize| {
                let end = |side: f64| {
                    let mut x = x.clone();
                    x[k] += side * DIFFERENCE * natural[k];
                    spin.deviation(&x, wanted)
                };
                Some((end(1.0)? - end(-1.0)?) / (2.0 * DIFFERENCE))
            };
            let slopes: Vec<Vector3> = (0..natural.len()).map(slope).collect::<Option<_>>()?;
            let G = DMatrix::from_fn(3, slopes.len(), |i, j| slopes[j][i]);
            let step = G.transpose() * (&G * G.transpose()).cholesky()?.solve(&now);
            for ((x, z), unit) in x.iter_mut().zip(&step).zip(natural) {
                *x -= z * unit;
            }
        }
        None
    }
}

/// A vehicle at the start of a segment, turning at the mean of the measured rates.
struct Spin<'a> {
    experiment: &'a Experiment<'a>,
    samples: &'a Samples,
    w_NB_B: Vector3,
}

impl<'a> Spin<'a> {
    fn new(experiment: &'a Experiment<'a>, segment: usize) -> Option<Self> {
        let samples = &experiment.problem.segments.get(segment)?.samples;
        let rates = &samples.w_NB_B;
        let w_NB_B = rates.iter().sum::<Vector3>() / rates.len().max(1) as f64;
        Some(Self {
            experiment,
            samples,
            w_NB_B,
        })
    }

    fn start(&self, x: &[f64]) -> InitialState {
        self.experiment
            .initial_state_at(self.samples, self.w_NB_B, x)
    }

    /// Momentum about the mass centre at a rate.
    fn momentum(&self, x: &[f64], w: Vector3) -> Vector3 {
        let state = self.experiment.initial_state_at(self.samples, w, x);
        state.rigid.R_NB.inverse() * state.rigid.h_SScm_N
    }

    /// The same at the mean rate, and its slope: the inertia.
    fn turning(&self, x: &[f64]) -> (Vector3, Matrix3) {
        let h = self.momentum(x, self.w_NB_B);
        let column = |k: usize| self.momentum(x, self.w_NB_B + Vector3::ith(k, 1.0)) - h;
        (h, Matrix3::from_columns(&[column(0), column(1), column(2)]))
    }

    /// The largest angular frequency of a nutation: a body nutates at most as fast as it turns, its wheels turn it faster.
    fn fastest(&self, x: &[f64]) -> Option<f64> {
        let (h, I) = self.turning(x);
        let by_wheels = I.try_inverse()? * (h - I * self.w_NB_B);
        Some(self.w_NB_B.norm() + by_wheels.norm())
    }

    /// How far a vehicle is from spinning steadily (the torque about two axes, over that of the whole momentum), and the square of the
    /// angular frequency of its nutation from a wanted one, over that: the second invariant of Euler's equation
    /// `I w' + w x (I w + h) = 0`, linearised.
    fn deviation(&self, x: &[f64], wanted: f64) -> Option<Vector3> {
        let (w, (h, I)) = (self.w_NB_B, self.turning(x));
        let A = I.try_inverse()? * (h.cross_matrix() - w.cross_matrix() * I);
        let squared = 0.5 * (A.trace().powi(2) - (A * A).trace());
        let turned = UnitQuaternion::rotation_between(&w, &Vector3::z())?;
        let torque = turned * w.cross(&h) / (w.norm() * h.norm());
        Some(Vector3::new(torque.x, torque.y, squared / wanted - 1.0))
    }
}
