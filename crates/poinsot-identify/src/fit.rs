//! The momentum-state fit: Levenberg-Marquardt on the triangle of the shared unknowns.
//!
//! Pose, momentum and biases are eliminated by the order of the columns, so each step is decided in the
//! mass properties alone; the rest follows by back-substitution. Directions that the data leave open do
//! not move. A damped step holds biases, lags and what else is wrong with the instruments back as it does the mass
//! properties: only pose and momentum follow whole.

use crate::coarse::approach;
use crate::coordinates::{Coordinates, PhysicalBodies};
use crate::information::{Experiment, Point};
use crate::likelihood::Evaluated;
use crate::problem::ProblemError;
use crate::solved::{Shared, Solved, head};
use nalgebra::UnitQuaternion;
use poinsot_solve::{End, LeastSquares, Linearised, Minimum, Spectrum, Step, levenberg_marquardt};
use poinsot_spatial::Vector3;

/// Most iterations.
pub(crate) const ITERATIONS: usize = 60;
/// Settled when the next step would lower chi-square by less than this: steps of a ten-thousandth of a sigma.
const SETTLED: f64 = 1.0e-8;
/// Share of chi-square by which two evaluations may differ.
const ROUND_OFF: f64 = 1.0e-12;
/// By how much the cost may rise over a step that is taken, where the unknowns move the covariance of the readings by way of
/// the noise of the inputs: Gauss and Newton's step does not look at that, and ends where chi-square alone is least at
/// the covariance found, a fraction of a sigma from the least cost.
const COVARIANCE: f64 = 0.1;
/// Fall of chi-square beyond the edge that is more than the barrier's own: a five-hundredth of a sigma.
const FELT: f64 = 4.0e-6;
/// Share of chi-square that may be left where no step lowers it: round-off, not a failure.
const NEGLIGIBLE: f64 = 1.0e-4;
/// Share of a chi-square that is far too large, below which what a step promises is not worth many iterations.
const CREEPING: f64 = 1.0e-3;

/// Fits from the better of the linear solution and the nominal numbers, in at most `limit` iterations.
///
/// The bodies are free at first: close to the edge, far from the answer, the equations of motion bend more than
/// beyond it. What then lies beyond is brought back by the step that costs least and fitted on within the edge.
pub(crate) fn fit(
    experiment: &Experiment,
    linear: Option<&Solved>,
    limit: usize,
) -> Result<Fitted, ProblemError> {
    let bodies = physical_bodies(experiment, experiment.parameters.mass_unknowns);
    if let Some(bodies) = bodies.as_ref().filter(|_| limit >= ITERATIONS) {
        let mut free = experiment.with_parameters(experiment.parameters);
        free.coordinates = Coordinates::Linear;
        let found = fit_within(&free, linear, Some(bodies), limit)?;
        if found.settled {
            let Some(bodies) = bodies.clone().seen_apart(&found.spectrum) else {
                return Ok(found);
            };
            if bodies.contain(&found.at.x) {
                return Ok(found);
            }
            let back = brought_back(experiment, &found, &bodies, limit);
            if let Some(found) = back.filter(|f| f.settled) {
                return Ok(found);
            }
        } else if found.crept && bodies.contain(&found.at.x) {
            // The edge is not what keeps it from settling.
            return Ok(found);
        }
    }
    fit_within(experiment, linear, bodies.as_ref(), limit)
}

/// Fits on from the step that leads back to physical bodies at the least cost.
fn brought_back(
    experiment: &Experiment,
    beyond: &Fitted,
    bodies: &PhysicalBodies,
    limit: usize,
) -> Option<Fitted> {
    let rhs = beyond.shared.rhs();
    let (step, _) = bodies.step(&beyond.spectrum, &rhs, 0.0, &beyond.at.x);
    let (shared, natural) = (&beyond.shared, &beyond.spectrum.natural);
    let at = moved(
        experiment,
        &beyond.at,
        (&beyond.evaluated, shared, natural),
        &step,
    );
    fit_from(experiment, at, limit)
}

/// Fits in the coordinates of the experiment, from starts at which the bodies are physical.
fn fit_within(
    experiment: &Experiment,
    linear: Option<&Solved>,
    bodies: Option<&PhysicalBodies>,
    limit: usize,
) -> Result<Fitted, ProblemError> {
    let mut best: Option<Fitted> = None;
    for start in starting_points(experiment, linear, bodies) {
        let at = start.point;
        let Some(here) = start.here.or_else(|| experiment.linearise(&at)) else {
            continue;
        };
        let found = fitted(experiment, levenberg_marquardt(experiment, at, here, limit))?;
        let settled = found.settled;
        best = best.filter(|b| b.settled || !settled).or(Some(found));
        // A start far off can leave the iteration among directions that come and go: try the other.
        if settled || limit < ITERATIONS {
            break;
        }
    }
    best.ok_or(ProblemError::NoMotion)
}

/// Fits from a point, in at most `limit` iterations; `None` where the vehicle cannot move there.
pub(crate) fn fit_from(experiment: &Experiment, at: Point, limit: usize) -> Option<Fitted> {
    let here = experiment.linearise(&at)?;
    fit_on(experiment, at, here, limit)
}

/// The same where the problem at the point is known.
pub(crate) fn fit_on(
    experiment: &Experiment,
    at: Point,
    here: Linearised<Local>,
    limit: usize,
) -> Option<Fitted> {
    fitted(experiment, levenberg_marquardt(experiment, at, here, limit)).ok()
}

/// Chi-square per row below which a start is taken without a look at another.
const CLOSE: f64 = 10.0;

/// A point to start from, with the problem there where it is known already.
struct Start {
    point: Point,
    cost: f64,
    here: Option<Linearised<Local>>,
}

impl Start {
    fn known(point: Point, here: Linearised<Local>) -> Self {
        Self {
            point,
            cost: here.cost,
            here: Some(here),
        }
    }

    fn is_close(&self) -> bool {
        self.here.as_ref().is_some_and(is_close)
    }
}

/// Whether chi-square at a point is not far from what noise makes.
pub(crate) fn is_close(here: &Linearised<Local>) -> bool {
    let rows: usize = here.rows.evaluated.iter().map(|e| e.rows).sum();
    here.cost < CLOSE * rows as f64
}

/// The linear solution and the nominal numbers, the better one first; before them where a few readings lead from
/// the better one, if that is close.
fn starting_points(
    experiment: &Experiment,
    linear: Option<&Solved>,
    bodies: Option<&PhysicalBodies>,
) -> Vec<Start> {
    let mut found: Vec<Start> = Vec::new();
    let point = linear.map(|solved| {
        let mut point = experiment.point(solved);
        if let Some(bodies) = bodies {
            bodies.start(&mut point.x);
        }
        point
    });
    if let Some(point) = point
        && let Some(here) = experiment.linearise(&point)
    {
        found.push(Start::known(point, here));
    }
    let mut close = found.iter().any(Start::is_close);
    let point = experiment.nominal_point();
    if !close {
        let worse = |cost: f64| experiment.cost(&point).is_none_or(|own| own > cost);
        let from = match found.first() {
            Some(linear) if worse(linear.cost) => &linear.point,
            _ => &point,
        };
        let start = approached(experiment, from, bodies);
        close = start.is_some();
        found.extend(start);
    }
    let cost = if close {
        Some(f64::INFINITY)
    } else {
        experiment.cost(&point)
    };
    found.extend(cost.map(|cost| Start {
        point,
        cost,
        here: None,
    }));
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    found
}

/// Where a few readings lead from a point; `None` where that is not close either.
fn approached(
    experiment: &Experiment,
    from: &Point,
    bodies: Option<&PhysicalBodies>,
) -> Option<Start> {
    let mut point = approach(experiment, from)?;
    if let Some(bodies) = bodies.filter(|b| !b.contain(&point.x)) {
        bodies.start(&mut point.x);
    }
    let here = experiment.linearise(&point)?;
    Some(Start::known(point, here)).filter(Start::is_close)
}

/// Pose, momentum and biases that fit best at the nominal mass properties, which are held.
pub(crate) fn fit_starts(experiment: &Experiment, limit: usize) -> Result<Point, ProblemError> {
    let mut at = experiment.nominal_point();
    let evaluate = |at: &Point| experiment.evaluate(at, true);
    let mut here = linearised(
        experiment,
        &at,
        evaluate(&at).ok_or(ProblemError::NoMotion)?,
    )?;
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

/// The bodies that are to stay physical.
fn physical_bodies(experiment: &Experiment, mass_unknowns: usize) -> Option<PhysicalBodies> {
    match experiment.coordinates {
        Coordinates::Linear => None,
        Coordinates::Physical => PhysicalBodies::new(experiment.parameters, mass_unknowns),
    }
}

/// Bodies that the data press against the edge of what positive mass can have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Held {
    /// Their names.
    pub bodies: Vec<String>,
    /// How much chi-square would fall beyond the edge, to first order.
    pub cost: f64,
    /// How many conditions hold them: the degrees of freedom of `cost`.
    pub conditions: usize,
}

/// Where the iteration ended.
#[derive(Clone)]
pub(crate) struct Fitted {
    pub at: Point,
    pub evaluated: Vec<Evaluated>,
    pub shared: Shared,
    pub spectrum: Spectrum,
    /// Spectrum without the priors of mass properties, where any are declared.
    pub data_alone: Option<Spectrum>,
    pub iterations: usize,
    pub settled: bool,
    /// Not settled, and given up: the convergence was slow and chi-square far too large.
    pub crept: bool,
    pub held: Option<Held>,
}

/// All segments at a point, the triangle of the shared unknowns, and its spectrum.
pub(crate) struct Local {
    pub evaluated: Vec<Evaluated>,
    pub shared: Shared,
    pub spectrum: Spectrum,
    /// The bodies that the steps keep physical.
    bodies: Option<PhysicalBodies>,
}

impl Local {
    /// How far the full step leads in the mass properties, sigmas.
    pub fn mass_shift(&self) -> f64 {
        self.spectrum.decrease(&self.shared.rhs(), 0.0).sqrt()
    }

    /// Whether a step in natural units leads out of the physical bodies.
    fn leaves(&self, x: &[f64], step: &[f64]) -> bool {
        let bodies = self.bodies.as_ref();
        bodies.is_some_and(|b| !b.contain(&after(x, step, &self.spectrum)))
    }

    /// What a step of the mass properties takes with it.
    pub fn parts(&self) -> (&[Evaluated], &Shared, &[f64]) {
        (&self.evaluated, &self.shared, &self.spectrum.natural)
    }
}

impl LeastSquares for Experiment<'_> {
    type Point = Point;
    type Rows = Local;

    fn cost(&self, at: &Point) -> Option<f64> {
        let evaluated = self.evaluate(at, false)?;
        self.chi2(at, &evaluated)
    }

    fn linearise(&self, at: &Point) -> Option<Linearised<Local>> {
        let evaluated = self.evaluate(at, true)?;
        linearised(self, at, evaluated).ok()
    }

    fn settled(&self, at: &Point, here: &Linearised<Local>) -> bool {
        let local = &here.rows;
        let plain = local.spectrum.damped(&local.shared.rhs(), 0.0);
        // The barrier knows a step along the edge no better than this.
        let limit = match local.leaves(&at.x, &plain) {
            true => FELT,
            false => SETTLED,
        };
        here.promised < limit
    }

    fn worth_it(&self, here: &Linearised<Local>, forecast: f64) -> bool {
        let hopeless = !is_close(here) && here.promised < CREEPING * here.cost;
        !hopeless || forecast < SETTLED
    }

    fn step(&self, at: &Point, here: &Linearised<Local>, damping: f64) -> Step<Point> {
        let local = &here.rows;
        if let Some(step) = self.step_of_all(at, local, damping) {
            return step;
        }
        let (step, lowered) = self.mass_step(&at.x, local, damping);
        Step {
            to: moved(self, at, local.parts(), &step),
            promised: promised_decrease(self, local, lowered),
            bend: 0.0,
        }
    }
}

impl Experiment<'_> {
    fn covariance_moves(&self) -> f64 {
        let noise = self.problem.noise;
        let inputs = [&noise.joint_position, &noise.joint_rate, &noise.wheel_speed];
        let noisy = inputs.into_iter().flatten().any(|v| *v > 0.0);
        match noisy || self.problem.model.environment.random_torque.is_some() {
            true => COVARIANCE,
            false => 0.0,
        }
    }

    /// A step that damps nuisances too: they are eliminated from the damped problem, not from the plain one. `None`
    /// where there is nothing to damp.
    ///
    /// The unit of a nuisance is what shows as much in the readings as the largest mass property does in its own
    /// (Marquardt 1963 scales by the columns as well).
    fn step_of_all(&self, at: &Point, local: &Local, damping: f64) -> Option<Step<Point>> {
        let shared = &local.shared;
        if damping <= 0.0 || !damping.is_finite() || shared.nuisances == 0 {
            return None;
        }
        let longest = self.longest_column(&local.evaluated);
        let lengths = shared.nuisance_lengths();
        let most = lengths.iter().fold(longest, |a, b| a.max(*b));
        let reference = if longest > 0.0 { longest } else { most };
        let unit = |length: &f64| reference / length.max(f64::EPSILON * most);
        let units: Vec<f64> = lengths.iter().map(unit).collect();
        if units.iter().any(|u| !u.is_finite() || *u <= 0.0) {
            return None;
        }
        let held = shared.damped(&units, damping);
        let nothing = vec![0.0; shared.mass * shared.mass];
        let spectrum = Spectrum::within(&held.block(), &nothing, &local.spectrum).ok()?;
        let (step, _) = mass_step(&at.x, local, (&spectrum, &held.rhs()), damping);
        let natural = &spectrum.natural;
        let mass: Vec<f64> = step.iter().zip(natural).map(|(z, unit)| z * unit).collect();
        let lowered = shared.lowered(&held.nuisances_for(&mass), &mass);
        Some(Step {
            to: moved(self, at, (&local.evaluated, &held, natural), &step),
            promised: heads_decrease(self, local) + lowered,
            bend: 0.0,
        })
    }

    /// Step of the mass unknowns, natural units, and how much the linear model says that it lowers chi-square.
    fn mass_step(&self, x: &[f64], local: &Local, damping: f64) -> (Vec<f64>, f64) {
        let of = (&local.spectrum, local.shared.rhs());
        mass_step(x, local, (of.0, &of.1), damping)
    }
}

/// Step of the mass unknowns, natural units, that a triangle and its right-hand side ask for, and how much they say that
/// it lowers chi-square.
fn mass_step(
    x: &[f64],
    local: &Local,
    (spectrum, rhs): (&Spectrum, &[f64]),
    damping: f64,
) -> (Vec<f64>, f64) {
    let step = spectrum.damped(rhs, damping);
    match &local.bodies {
        Some(bodies) if local.leaves(x, &step) => bodies.step(spectrum, rhs, damping, x),
        _ => (step, spectrum.decrease(rhs, damping)),
    }
}

/// The mass unknowns after a step in natural units.
fn after(x: &[f64], step: &[f64], spectrum: &Spectrum) -> Vec<f64> {
    let moved = x.iter().zip(step).zip(&spectrum.natural);
    moved.map(|((x, z), unit)| x + z * unit).collect()
}

fn linearised(
    experiment: &Experiment,
    at: &Point,
    evaluated: Vec<Evaluated>,
) -> Result<Linearised<Local>, ProblemError> {
    let stacked = experiment.stack(at, &evaluated, true);
    let shared = Shared::new(experiment.parameters, &stacked);
    let (spectrum, _) = experiment.spectra(&stacked, &shared, &evaluated)?;
    let cost = experiment
        .chi2(at, &evaluated)
        .ok_or(ProblemError::NoMotion)?;
    let bodies = physical_bodies(experiment, spectrum.natural.len())
        .and_then(|bodies| bodies.seen_apart(&spectrum));
    let local = Local {
        evaluated,
        shared,
        spectrum,
        bodies,
    };
    Ok(Linearised {
        cost,
        round_off: ROUND_OFF * (1.0 + cost),
        slack: ROUND_OFF * (1.0 + cost) + experiment.covariance_moves(),
        promised: {
            let (_, lowered) = experiment.mass_step(&at.x, &local, 0.0);
            promised_decrease(experiment, &local, lowered)
        },
        weakest: local.spectrum.weakest(),
        rows: local,
    })
}

fn fitted(experiment: &Experiment, minimum: Minimum<Point, Local>) -> Result<Fitted, ProblemError> {
    let Minimum {
        at,
        here,
        iterations,
        end,
    } = minimum;
    let local = here.rows;
    let data_alone = if experiment.has_design_prior() {
        let stacked = experiment.stack(&at, &local.evaluated, false);
        let own = Shared::new(experiment.parameters, &stacked);
        Some(experiment.spectra(&stacked, &own, &local.evaluated)?.0)
    } else {
        None
    };
    Ok(Fitted {
        held: held(experiment, &at, &local),
        at,
        evaluated: local.evaluated,
        shared: local.shared,
        spectrum: local.spectrum,
        data_alone,
        iterations,
        settled: match end {
            End::Settled => true,
            End::NoLowerCost | End::RoundOff => here.promised < NEGLIGIBLE * here.cost.max(1.0),
            End::IterationLimit | End::Creeping => false,
        },
        crept: end == End::Creeping,
    })
}

/// Where the plain step from the answer would leave the physical bodies, and chi-square feels it.
fn held(experiment: &Experiment, at: &Point, local: &Local) -> Option<Held> {
    let bodies = local.bodies.as_ref()?;
    let (spectrum, rhs) = (&local.spectrum, local.shared.rhs());
    if bodies.contain(&after(&at.x, &spectrum.damped(&rhs, 0.0), spectrum)) {
        return None;
    }
    let within = bodies.step(spectrum, &rhs, 0.0, &at.x).1;
    let cost = spectrum.decrease(&rhs, 0.0) - within;
    let (indices, conditions) = bodies.at_the_edge(&at.x);
    let names = &experiment.parameters.body_names;
    (cost > FELT && !indices.is_empty()).then(|| Held {
        bodies: indices.iter().map(|k| names[*k].clone()).collect(),
        cost,
        conditions,
    })
}

/// Chi-square of the readings alone.
pub(crate) fn chi2(evaluated: &[Evaluated]) -> f64 {
    evaluated.iter().map(|e| e.chi2).sum()
}

/// How much the linear model says a step lowers chi-square of which the mass properties' part is given.
pub(crate) fn promised_decrease(experiment: &Experiment, local: &Local, lowered: f64) -> f64 {
    let shared = &local.shared;
    let n = shared.nuisances + shared.mass;
    let biases: f64 = (0..shared.nuisances)
        .map(|i| shared.r[(i, n)].powi(2))
        .sum();
    heads_decrease(experiment, local) + biases + lowered
}

/// The part of it that pose and momentum bring, which follow whole.
fn heads_decrease(experiment: &Experiment, local: &Local) -> f64 {
    local
        .evaluated
        .iter()
        .zip(&experiment.unknown)
        .filter_map(|(e, unknown)| e.triangle.as_ref().map(|t| (t, unknown.count())))
        .map(|(t, h)| {
            let last = t.r.ncols() - 1;
            (0..h).map(|i| t.r[(i, last)].powi(2)).sum::<f64>()
        })
        .sum()
}

/// The point after a step of the mass properties: biases and heads follow.
pub(crate) fn moved(
    experiment: &Experiment,
    at: &Point,
    (evaluated, shared, natural): (&[Evaluated], &Shared, &[f64]),
    step: &[f64],
) -> Point {
    let mut dx: Vec<f64> = step.iter().zip(natural).map(|(z, unit)| z * unit).collect();
    dx.extend(shared.nuisances_for(&dx));
    let heads = at
        .heads
        .iter()
        .zip(evaluated)
        .zip(&experiment.unknown)
        .map(|((old, one), unknown)| {
            let Some(triangle) = &one.triangle else {
                return *old;
            };
            let d = head(&triangle.r, unknown.count(), &dx).mean;
            let mut parts = d.chunks_exact(3).map(Vector3::from_row_slice);
            let mut take =
                |present: bool| present.then(|| parts.next()).flatten().unwrap_or_default();
            let mut new = *old;
            new.R_NB = old.R_NB * UnitQuaternion::from_scaled_axis(take(unknown.attitude));
            new.p_NoBo_N += take(unknown.position);
            new.P += take(unknown.linear);
            new.h_SScm_N += take(unknown.angular);
            new
        })
        .collect();
    Point {
        x: at.x.iter().zip(&dx).map(|(a, b)| a + b).collect(),
        heads,
    }
}
