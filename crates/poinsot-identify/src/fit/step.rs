//! One step of a fit: the linearisation at an iterate, and a damped step on the triangle of the shared unknowns.
//!
//! A damped step damps all unknowns, pose and momentum least. Unobservable directions do not move.

use crate::fit::coordinates::PhysicalBodies;
use crate::fit::experiment::{Experiment, Iterate, known_columns_last};
use crate::fit::triangle::{self, SharedTriangle, conditional_estimate, damped, lowered};
use crate::likelihood::{Evaluated, InitialStateColumns};
use crate::problem::ProblemError;
use crate::problem::refusal::no_motion;
use crate::problem::settings::Coordinates;
use nalgebra::UnitQuaternion;
use poinsot_solve::{LeastSquares, Linearised, Pace, Spectrum, Step, Triangle};
use poinsot_spatial::Vector3;

/// Most iterations of a fit.
pub(crate) const ITERATIONS: usize = 60;
/// Converged when the next step would reduce chi-square by less than this: steps of a ten-thousandth of a sigma.
const CONVERGED_BELOW: f64 = 1.0e-8;
/// Reduction of chi-square that may be left where the derivatives of an earlier iterate serve: a step of a thousandth of a
/// sigma.
const LEFT: f64 = 1.0e-6;
/// Fall of chi-square by a full step, one sigma, below which columns of known numbers are made where they are used, since older
/// ones may lead away from the answer, a fit that only leads near it ends without a look where its last step led, and one along a
/// process of the inputs has converged where no step lowers the cost.
pub(crate) const NEAR: f64 = 1.0;
/// Share of chi-square by which two evaluations may differ.
const ROUND_OFF: f64 = 1.0e-12;
/// Allowed increase of the cost over a step if input noise makes the covariance depend on the unknowns. The
/// Gauss-Newton step ignores that dependence, and ends a fraction of a sigma from the smallest cost. It counts where the full step
/// promises less.
const COVARIANCE: f64 = 0.1;
/// Decrease of chi-square beyond the limit that exceeds the error of a step along the limit: a five-hundredth of a sigma.
const SIGNIFICANT_DECREASE: f64 = 4.0e-6;
/// Relative reduction of chi-square by an iteration, predicted or real, below which a fit with a far too large one stops.
const TOO_SLOW: f64 = 1.0e-3;
/// Damping of pose and momentum relative to that of the other unknowns. Far from the minimum they must follow a step undamped (with 0.01
/// the beginning of a fast spin is lost); with none at all a step does not shorten, and along a curved valley none lowers the cost.
const FOLLOWING: f64 = 1.0e-6;
/// Chi-square per row below which no other start is tried.
const CLOSE_BELOW: f64 = 10.0;

/// Bodies at an active limit of physical mass properties.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BoundaryBodies {
    /// Their names.
    pub bodies: Vec<String>,
    /// First-order decrease of chi-square beyond the limit.
    pub cost: f64,
    /// Number of active conditions: the degrees of freedom of `cost`.
    pub conditions: usize,
}

/// All segments at a point, the triangle of the shared unknowns, and its spectrum.
pub(crate) struct Linearisation {
    pub evaluated: Vec<Evaluated>,
    pub shared: SharedTriangle,
    pub spectrum: Spectrum,
    /// The bodies that the steps keep physical.
    bodies: Option<PhysicalBodies>,
}

impl Linearisation {
    /// How far the full step leads in the mass properties, sigmas.
    pub fn mass_shift(&self) -> f64 {
        self.spectrum.decrease(&self.shared.rhs(), 0.0).sqrt()
    }

    /// Whether a step in natural units leads out of the physical bodies.
    fn leaves(&self, x: &[f64], step: &[f64]) -> bool {
        let bodies = self.bodies.as_ref();
        bodies.is_some_and(|b| !b.contain(&after(x, step, &self.spectrum)))
    }

    /// Parts that follow a step of the mass properties.
    pub fn parts(&self) -> (&[Evaluated], &SharedTriangle, &[f64]) {
        (&self.evaluated, &self.shared, &self.spectrum.natural)
    }
}

impl LeastSquares for Experiment<'_> {
    type Iterate = Iterate;
    type Rows = Linearisation;

    fn cost(&self, at: &Iterate) -> Option<f64> {
        let evaluated = self.evaluate(at, false)?;
        self.chi2(at, &evaluated)
    }

    fn linearise(&self, at: &Iterate) -> Option<Linearised<Linearisation>> {
        linearised(self, at, self.evaluate(at, true)?).ok()
    }

    fn carried(
        &self,
        at: &Iterate,
        here: &Linearised<Linearisation>,
        step: &Step<Iterate>,
        left: f64,
    ) -> Option<Linearised<Linearisation>> {
        if self.only_near {
            let near = self.weight * left <= NEAR;
            return near.then(|| self.promised(at, here, step)).flatten();
        }
        if left > LEFT || self.keep_rows || !known_columns_last(self, at, &step.to) {
            return None;
        }
        let there = self.evaluate(&step.to, false)?;
        self.linearised_after(at, here, step, there)
    }

    fn converged(&self, at: &Iterate, here: &Linearised<Linearisation>) -> bool {
        let linearisation = &here.rows;
        let plain = linearisation
            .spectrum
            .damped(&linearisation.shared.rhs(), 0.0);
        // Round-off limits the accuracy of a step along the limit.
        let limit = match linearisation.leaves(&at.x, &plain) {
            true => SIGNIFICANT_DECREASE,
            false => CONVERGED_BELOW,
        };
        here.predicted_reduction < limit
    }

    fn damps(&self, here: &Linearised<Linearisation>) -> bool {
        !self.full_steps || self.is_close(here)
    }

    fn should_continue(&self, here: &Linearised<Linearisation>, pace: Pace) -> bool {
        let gain = f64::min(here.predicted_reduction, pace.fell);
        let too_slow = !self.is_close(here) && gain < TOO_SLOW * here.cost;
        !too_slow || pace.left < CONVERGED_BELOW
    }

    fn step(&self, at: &Iterate, here: &Linearised<Linearisation>, damping: f64) -> Step<Iterate> {
        let linearisation = &here.rows;
        if let Some(step) = self.step_of_all(at, linearisation, damping) {
            return step;
        }
        let (step, lowered) = self.mass_step(&at.x, linearisation, damping);
        Step {
            to: moved(self, at, linearisation.parts(), &step),
            predicted_reduction: predicted_decrease(self, linearisation, lowered),
            acceleration_ratio: 0.0,
        }
    }
}

impl Experiment<'_> {
    /// What the linear model at an iterate says of the end of a step, where nothing is evaluated.
    pub(crate) fn promised(
        &self,
        at: &Iterate,
        here: &Linearised<Linearisation>,
        step: &Step<Iterate>,
    ) -> Option<Linearised<Linearisation>> {
        let evaluated = here.rows.evaluated.clone();
        let there = self.linearised_after(at, here, step, evaluated)?;
        Some(Linearised {
            cost: here.cost - step.predicted_reduction,
            ..there
        })
    }

    /// The problem at the end of a step, with the derivatives of its start.
    fn linearised_after(
        &self,
        at: &Iterate,
        here: &Linearised<Linearisation>,
        step: &Step<Iterate>,
        mut there: Vec<Evaluated>,
    ) -> Option<Linearised<Linearisation>> {
        let dx: Vec<f64> = step.to.x.iter().zip(&at.x).map(|(a, b)| a - b).collect();
        let segments = there.iter_mut().zip(&here.rows.evaluated);
        for ((there, here), unknown) in segments.zip(&self.unknown) {
            let triangle = here.triangle.as_ref()?;
            there.triangle = Some(after_step(triangle, unknown.count(), &dx));
        }
        linearised(self, &step.to, there).ok()
    }

    /// Whether a cost is of the size of its expectation.
    pub fn expects(&self, cost: f64, evaluated: &[Evaluated]) -> bool {
        let rows: usize = evaluated.iter().map(|e| e.rows).sum();
        cost < CLOSE_BELOW * self.scatter * rows as f64
    }

    /// The same at an iterate.
    pub fn is_close(&self, here: &Linearised<Linearisation>) -> bool {
        self.expects(here.cost, &here.rows.evaluated)
    }

    /// The same without derivatives.
    pub fn meets(&self, at: &Iterate) -> bool {
        let evaluated = self.evaluate(at, false);
        evaluated.is_some_and(|e| self.chi2(at, &e).is_some_and(|cost| self.expects(cost, &e)))
    }

    /// Whether noise of measured inputs drives the vehicle.
    pub fn has_noisy_inputs(&self) -> bool {
        let noise = self.problem.noise;
        let inputs = [&noise.joint_position, &noise.joint_rate, &noise.wheel_speed];
        inputs.into_iter().flatten().any(|v| *v > 0.0)
    }

    fn covariance_moves(&self) -> f64 {
        let random = self.problem.model.environment.random_torque.is_some();
        match self.has_noisy_inputs() || random {
            true => COVARIANCE * self.scatter,
            false => 0.0,
        }
    }

    /// A step that damps all unknowns: the nuisances, and the pose and momentum of each segment, are eliminated from the damped problem.
    /// `None` where nothing is damped.
    ///
    /// The unit of what is eliminated is what shows as much in the readings as the largest mass property does in its own
    /// (Marquardt 1963 scales by the columns as well).
    fn step_of_all(
        &self,
        at: &Iterate,
        linearisation: &Linearisation,
        damping: f64,
    ) -> Option<Step<Iterate>> {
        let plain = &linearisation.shared;
        let longest = self.longest_column(&linearisation.evaluated);
        let lengths = triangle::lengths(&plain.r, plain.nuisances);
        let most = lengths.iter().fold(longest, |a, b| a.max(*b));
        let reference = if longest > 0.0 { longest } else { most };
        if damping <= 0.0 || !damping.is_finite() || reference <= 0.0 || !most.is_finite() {
            return None;
        }
        let units = |lengths: Vec<f64>| -> Vec<f64> {
            let most = lengths.iter().fold(most, |a, b| a.max(*b));
            let unit = |length: &f64| reference / length.max(f64::EPSILON * most);
            lengths.iter().map(unit).collect()
        };
        let start = |(one, unknown): (&Evaluated, &InitialStateColumns)| {
            let of = |t: &Triangle| {
                let units = units(triangle::lengths(&t.r, unknown.count()));
                Triangle {
                    r: damped(&t.r, &units, FOLLOWING * damping),
                    rows: t.rows,
                }
            };
            Evaluated {
                triangle: one.triangle.as_ref().map(of),
                ..Evaluated::default()
            }
        };
        let pairs = linearisation.evaluated.iter().zip(&self.unknown);
        let held: Vec<Evaluated> = pairs.map(start).collect();
        let mut shared = SharedTriangle::new(self.parameters, &self.stack(at, &held, true));
        shared.held.clone_from(&plain.held);
        shared.r = damped(&shared.r, &units(lengths), damping);
        let spectrum = Spectrum::within(&shared.block(), None, &linearisation.spectrum).ok()?;
        let (step, _) = mass_step(&at.x, linearisation, (&spectrum, &shared.rhs()), damping);
        let natural = &spectrum.natural;
        let mass: Vec<f64> = step.iter().zip(natural).map(|(z, unit)| z * unit).collect();
        let nuisances = shared.nuisances_for(&mass);
        let dx: Vec<f64> = mass.iter().chain(&nuisances).copied().collect();
        let of_start = |((t, h), (damped, _)): ((&Triangle, usize), (&Triangle, usize))| {
            let start = conditional_estimate(&damped.r, h, &dx).mean;
            lowered(&t.r, h, start.iter().chain(&dx))
        };
        let plain_ones = self.triangles(&linearisation.evaluated);
        let both = plain_ones.zip(self.triangles(&held));
        let of_starts: f64 = both.map(of_start).sum();
        let of_shared = nuisances.iter().chain(&mass);
        let of_shared = lowered(&plain.r, plain.nuisances + plain.mass, of_shared);
        Some(Step {
            to: moved(self, at, (&held, &shared, natural), &step),
            predicted_reduction: of_starts + of_shared,
            acceleration_ratio: 0.0,
        })
    }

    /// Step of the mass unknowns, natural units, and how much the linear model says that it lowers chi-square.
    fn mass_step(&self, x: &[f64], linearisation: &Linearisation, damping: f64) -> (Vec<f64>, f64) {
        let of = (&linearisation.spectrum, linearisation.shared.rhs());
        mass_step(x, linearisation, (of.0, &of.1), damping)
    }
}

/// Step of the mass unknowns, natural units, that a triangle and its right-hand side ask for, and how much they say that
/// it lowers chi-square.
fn mass_step(
    x: &[f64],
    linearisation: &Linearisation,
    (spectrum, rhs): (&Spectrum, &[f64]),
    damping: f64,
) -> (Vec<f64>, f64) {
    let step = spectrum.damped(rhs, damping);
    match &linearisation.bodies {
        Some(bodies) if linearisation.leaves(x, &step) => bodies.step(spectrum, rhs, damping, x),
        _ => (step, spectrum.decrease(rhs, damping)),
    }
}

/// The triangle of a segment after a step of the shared unknowns, which the start of the segment follows: the residual is
/// that of the linear model.
fn after_step(triangle: &Triangle, initial_columns: usize, dx: &[f64]) -> Triangle {
    let start = conditional_estimate(&triangle.r, initial_columns, dx).mean;
    let step: Vec<f64> = start.iter().chain(dx).copied().collect();
    let mut after = triangle.clone();
    for i in 0..step.len() {
        let change = (i..step.len()).map(|j| triangle.r[(i, j)] * step[j]);
        after.r[(i, step.len())] -= change.sum::<f64>();
    }
    after
}

/// The mass unknowns after a step in natural units.
fn after(x: &[f64], step: &[f64], spectrum: &Spectrum) -> Vec<f64> {
    let moved = x.iter().zip(step).zip(&spectrum.natural);
    moved.map(|((x, z), unit)| x + z * unit).collect()
}

pub(crate) fn linearised(
    experiment: &Experiment,
    at: &Iterate,
    evaluated: Vec<Evaluated>,
) -> Result<Linearised<Linearisation>, ProblemError> {
    let stacked = experiment.stack(at, &evaluated, true);
    let mut shared = SharedTriangle::new(experiment.parameters, &stacked);
    shared.hold(&experiment.largest_nuisances());
    let spectrum = experiment.spectrum_within(&stacked, &shared, &evaluated)?;
    let cost = experiment.chi2(at, &evaluated).ok_or_else(no_motion)?;
    let bodies = physical_bodies(experiment).and_then(|bodies| bodies.separable(&spectrum));
    let linearisation = Linearisation {
        evaluated,
        shared,
        spectrum,
        bodies,
    };
    Ok(Linearised {
        cost,
        round_off: ROUND_OFF * (1.0 + cost),
        slack: ROUND_OFF * (1.0 + cost) + experiment.covariance_moves(),
        predicted_reduction: {
            let (_, lowered) = experiment.mass_step(&at.x, &linearisation, 0.0);
            predicted_decrease(experiment, &linearisation, lowered)
        },
        smallest_singular_value: linearisation.spectrum.smallest_singular_value(),
        rows: linearisation,
    })
}

/// Whether the plain step from the answer leaves the physical bodies with a significant change of chi-square.
pub(crate) fn held(
    experiment: &Experiment,
    at: &Iterate,
    linearisation: &Linearisation,
) -> Option<BoundaryBodies> {
    let bodies = linearisation.bodies.as_ref()?;
    let (spectrum, rhs) = (&linearisation.spectrum, linearisation.shared.rhs());
    if bodies.contain(&after(&at.x, &spectrum.damped(&rhs, 0.0), spectrum)) {
        return None;
    }
    let within = bodies.step(spectrum, &rhs, 0.0, &at.x).1;
    let cost = spectrum.decrease(&rhs, 0.0) - within;
    let (indices, conditions) = bodies.at_the_edge(&at.x);
    let names = &experiment.parameters.body_names;
    (cost > SIGNIFICANT_DECREASE && !indices.is_empty()).then(|| BoundaryBodies {
        bodies: indices.iter().map(|k| names[*k].clone()).collect(),
        cost,
        conditions,
    })
}

/// How much the linear model says a step lowers chi-square of which the mass properties' part is given.
pub(crate) fn predicted_decrease(
    experiment: &Experiment,
    linearisation: &Linearisation,
    lowered: f64,
) -> f64 {
    let square = |(t, h): (&Triangle, usize)| -> f64 {
        let last = t.r.ncols() - 1;
        (0..h).map(|i| t.r[(i, last)].powi(2)).sum()
    };
    let segments = experiment.triangles(&linearisation.evaluated);
    let of_starts: f64 = segments.map(square).sum();
    of_starts + linearisation.shared.lowered_by_nuisances() + lowered
}

/// The iterate after a step of the mass properties: biases and initial states follow.
pub(crate) fn moved(
    experiment: &Experiment,
    at: &Iterate,
    (evaluated, shared, natural): (&[Evaluated], &SharedTriangle, &[f64]),
    step: &[f64],
) -> Iterate {
    let mut dx: Vec<f64> = step.iter().zip(natural).map(|(z, unit)| z * unit).collect();
    dx.extend(shared.nuisances_for(&dx));
    let initial_states = at
        .initial_states
        .iter()
        .zip(evaluated)
        .zip(&experiment.unknown)
        .map(|((old, one), unknown)| {
            let Some(triangle) = &one.triangle else {
                return *old;
            };
            let d = conditional_estimate(&triangle.r, unknown.count(), &dx).mean;
            let mut parts = d.chunks_exact(3).map(Vector3::from_row_slice);
            let mut take =
                |present: bool| present.then(|| parts.next()).flatten().unwrap_or_default();
            let mut new = *old;
            new.R_NB = old.R_NB * UnitQuaternion::from_scaled_axis(take(unknown.attitude));
            new.p_NoBo_N += take(unknown.position);
            new.P += take(unknown.linear);
            new.h_SScm_N += take(unknown.angular);
            let own = d.iter().skip(unknown.count() - 2 * unknown.internal);
            new.internal.iter_mut().zip(own).for_each(|(x, d)| *x += d);
            new
        })
        .collect();
    Iterate {
        x: at.x.iter().zip(&dx).map(|(a, b)| a + b).collect(),
        initial_states,
    }
}

/// The bodies that are to stay physical.
pub(crate) fn physical_bodies(experiment: &Experiment) -> Option<PhysicalBodies> {
    match experiment.settings.coordinates {
        Coordinates::Linear => None,
        Coordinates::Physical => PhysicalBodies::new(experiment.parameters),
    }
}
