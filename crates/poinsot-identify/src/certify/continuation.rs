//! Numerical continuation along the set of unknowns with equal prediction.
//!
//! The null space of the sensitivities is only the tangent of this set. So each direction is continued: a step along
//! the null space (with the curvature of the previous steps), then Gauss-Newton steps back onto equal prediction. A
//! linear set is recognised by its far ends. The samples are those that the answer predicts, at a few times of the
//! record, so their residual has no noise.

use crate::certify::naming;
use crate::fit::experiment::as_predicted::{readings_alone, take_predictions};
use crate::fit::experiment::{Experiment, Iterate, MovedVehicle};
use crate::fit::part_of_record::thinned;
use crate::fit::step::{Linearisation, moved, predicted_decrease};
use crate::problem::Problem;
use crate::problem::parameters::Parameters;
use crate::problem::segment::Segment;
use crate::solution::estimate::UnobservableCombination;
use crate::solution::solved::Solution;
use crate::solution::unobservable_set::{ContinuationPath, POINTS, REACH, UnobservableSet};
use poinsot_solve::{LeastSquares, Spectrum};
use rayon::prelude::*;

/// Samples of each sensor in a segment for the continuation: far more than the determined numbers.
const WALK_SAMPLES: usize = 32;
/// Largest change of all predictions along a path of equal prediction, in their noise.
const EQUAL: f64 = 1.0e-2;
/// Factor on the change that weakly excited directions cause.
const OWN: f64 = 1.02;
/// The same before the last step back onto the set.
const NEARLY_EQUAL: f64 = 3.0e-2;
/// Largest number of Gauss-Newton steps back onto equal prediction.
const CORRECTIONS: usize = 8;

/// The continuation paths from an answer along every unobservable direction.
pub(crate) fn unobservable_set(
    experiment: &Experiment,
    at: &Iterate,
    solution: &Solution,
) -> UnobservableSet {
    let spectrum = &solution.spectrum;
    if !solution.converged() || spectrum.rank == spectrum.natural.len() {
        return UnobservableSet::default();
    }
    if solution.data_alone().is_some() {
        return linear_set(experiment.problem, solution);
    }
    let directions = directions(experiment.problem, solution);
    if !experiment.parameters.has_known() {
        return values_along_path(experiment, at, &directions, spectrum.rank).unwrap_or_default();
    }
    // The vehicle with the fitted values of its known numbers.
    let of_known = || {
        let MovedVehicle { vehicle, base } = MovedVehicle::new(experiment, at)?;
        let problem = vehicle.problem(experiment.problem);
        let exact = experiment.of_vehicle(&problem, &vehicle.parameters);
        let (_, kept) = experiment.parameters.without_known();
        let mut set = values_along_path(&exact, &base, &directions, spectrum.rank)?;
        for walk in &mut set.walks {
            for x in walk
                .points
                .iter_mut()
                .chain(walk.ends.iter_mut().map(|e| &mut e.0))
            {
                let mut whole = at.x.clone();
                kept.iter().zip(&*x).for_each(|(k, v)| whole[*k] = *v);
                *x = whole;
            }
        }
        Some(set)
    };
    of_known().unwrap_or_default()
}

/// The set of a linear problem, or of a problem whose priors determine the unobservable directions.
pub(crate) fn linear_set(problem: &Problem, solution: &Solution) -> UnobservableSet {
    let directions = directions(problem, solution);
    let both = mixed(&directions);
    let all = directions.iter().chain(&both).cloned();
    UnobservableSet::straight(
        &solution.x,
        &all.collect::<Vec<_>>(),
        &solution.spectrum.natural,
    )
}

/// The named unobservable directions, in the unknowns' units; with priors, those that the priors do not determine
/// either.
fn directions(problem: &Problem, solution: &Solution) -> Vec<Vec<f64>> {
    let spectrum = &solution.spectrum;
    if solution.data_alone().is_some() {
        let open = spectrum.unobservable_directions();
        let one = |k: usize| {
            let natural = spectrum.natural.iter().enumerate();
            natural.map(|(i, unit)| open[(i, k)] * unit).collect()
        };
        return (0..open.ncols()).map(one).collect();
    }
    // Named directions agree with the null space within a tolerance; paths start in the null space.
    let natural = &spectrum.natural;
    let inside = |c: &UnobservableCombination| -> Vec<f64> {
        let step = step_of(&solution.parameters, c, natural.len());
        let z = along(spectrum, spectrum.rank, &spectrum.in_natural_units(&step));
        z.iter().zip(natural).map(|(z, u)| z * u).collect()
    };
    let named = naming::unobservable_directions(problem, solution);
    named.iter().map(inside).collect()
}

fn step_of(parameters: &Parameters, named: &UnobservableCombination, unknowns: usize) -> Vec<f64> {
    let mut step = vec![0.0; unknowns];
    for (unknown, s) in parameters.unknowns.iter().zip(&mut step) {
        let of_it = named
            .coefficients
            .iter()
            .find(|(name, _)| *name == unknown.name);
        *s = of_it.map_or(0.0, |c| c.1);
    }
    step
}

/// All directions together, in two ways: a quantity constant along each may change along these.
fn mixed(directions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let with = |sign: f64| {
        let mut sum = vec![0.0; directions.first().map_or(0, Vec::len)];
        for (k, d) in directions.iter().enumerate() {
            let factor = if k % 2 == 0 { 1.0 } else { sign };
            let length = d.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            sum.iter_mut()
                .zip(d)
                .for_each(|(s, d)| *s += factor * d / length.max(f64::MIN_POSITIVE));
        }
        sum
    };
    match directions.len() {
        0 | 1 => Vec::new(),
        _ => vec![with(1.0), with(-1.0)],
    }
}

fn values_along_path(
    experiment: &Experiment,
    at: &Iterate,
    directions: &[Vec<f64>],
    rank: usize,
) -> Option<UnobservableSet> {
    let segments = predicted(experiment, at)?;
    let problem = experiment.problem.with_segments(&segments);
    // Declared calibrations agree with the answer, as the samples do.
    let mut parameters = experiment.parameters.clone();
    let unknowns = parameters.unknowns.iter_mut().zip(&at.x);
    unknowns.for_each(|(u, x)| u.nominal = *x);
    let centred = experiment.with_parameters(&parameters);
    let few = readings_alone(&centred, &problem);
    let here = few.linearise(at)?.rows;
    let in_natural_units = |d: &Vec<f64>| here.spectrum.in_natural_units(d);
    let single: Vec<Vec<f64>> = directions.iter().map(in_natural_units).collect();
    let walker = Continuation {
        experiment: &few,
        at,
        here: &here,
        rank,
    };
    let walk = |d: &Vec<f64>| walker.both_ways(d);
    let mut walks: Vec<ContinuationPath> = single.par_iter().map(walk).collect();
    let all: Vec<ContinuationPath> = mixed(&single).par_iter().map(walk).collect();
    walks.extend(all);
    let curved = walks.iter().any(|w| !w.ends.is_empty());
    Some(UnobservableSet {
        walks,
        here: curved.then(|| here.spectrum.clone()),
    })
}

/// A few samples of every segment with predicted values, weighted for all samples.
fn predicted(experiment: &Experiment, at: &Iterate) -> Option<Vec<Segment>> {
    let few = |s: &Segment| {
        let mut few = thinned(s, WALK_SAMPLES).unwrap_or_else(|| s.clone());
        let pairs = few
            .observations
            .sensors
            .iter_mut()
            .zip(&s.observations.sensors);
        for (kept, all) in pairs {
            kept.scale_noise(kept.samples.len() as f64 / all.samples.len().max(1) as f64);
        }
        few
    };
    let mut segments: Vec<Segment> = experiment.problem.segments.iter().map(few).collect();
    take_predictions(experiment, at, &mut segments)?;
    Some(segments)
}

/// The end of a path: the unknowns and the spectrum there.
type End = (Vec<f64>, Spectrum);

/// Continuation from an answer.
struct Continuation<'a> {
    experiment: &'a Experiment<'a>,
    at: &'a Iterate,
    here: &'a Linearisation,
    rank: usize,
}

/// A point close to the set, the problem there, and the step onto the set in natural units.
struct ContinuationPoint {
    at: Iterate,
    local: Linearisation,
    back: Vec<f64>,
    /// Whether weakly excited directions of the answer also have equal prediction here.
    equal: bool,
}

/// One branch of a path.
#[derive(Default)]
struct Path {
    points: Vec<Vec<f64>>,
    /// Number of points with equal prediction in every direction identified there.
    tested: usize,
    /// The last of those.
    end: Option<End>,
}

impl Continuation<'_> {
    fn both_ways(&self, direction: &[f64]) -> ContinuationPath {
        let tangent = along(&self.here.spectrum, self.rank, direction);
        if let Some(walk) = self.straight(&tangent) {
            return walk;
        }
        let back: Vec<f64> = tangent.iter().map(|t| -t).collect();
        let (first, last) = (self.path(&back), self.path(&tangent));
        let middle = first.points.len();
        let tested = middle - first.tested..middle + 1 + last.tested;
        let mut points = first.points;
        points.reverse();
        points.push(self.at.x.clone());
        points.extend(last.points);
        let ends = [first.end, last.end].into_iter().flatten().collect();
        ContinuationPath {
            points,
            tested,
            ends,
        }
    }

    /// The path if both far ends of a straight step have equal prediction.
    fn straight(&self, tangent: &[f64]) -> Option<ContinuationPath> {
        let spectrum = &self.here.spectrum;
        let excited = (self.rank..tangent.len())
            .map(|k| (spectrum.singular[k] * spectrum.along(tangent, k)).powi(2));
        let own: f64 = excited.sum();
        let far = |reach: f64| {
            let step: Vec<f64> = tangent.iter().map(|t| reach * t).collect();
            let to = moved(self.experiment, self.at, self.here.parts(), &step);
            let there = self.experiment.evaluate(&to, false)?;
            let off: f64 = there.iter().map(|e| e.chi2).sum();
            (off < EQUAL * EQUAL + OWN * own * reach * reach).then_some(to)
        };
        let (end, start) = (far(REACH)?, far(-REACH)?);
        let x = &self.at.x;
        let middle = |i: usize| 0.5 * (end.x[i] - start.x[i]);
        Some(ContinuationPath::straight(x, middle))
    }

    /// Points of one branch.
    fn path(&self, direction: &[f64]) -> Path {
        let length = REACH / POINTS as f64;
        let mut path = Path::default();
        let mut stand: Option<ContinuationPoint> = None;
        let (mut tangent, mut before) = (direction.to_vec(), direction.to_vec());
        for _ in 0..POINTS {
            let bend = tangent.iter().zip(&before).map(|(t, b)| 0.5 * (t - b));
            let mut step: Vec<f64> = bend.zip(&tangent).map(|(b, t)| length * (t + b)).collect();
            let (from, local) = match &stand {
                Some(s) => {
                    step.iter_mut().zip(&s.back).for_each(|(z, b)| *z += b);
                    (&s.at, &s.local)
                }
                None => (self.at, self.here),
            };
            let to = moved(self.experiment, from, local.parts(), &step);
            let Some(next) = self.back_onto_the_set(to) else {
                break;
            };
            let reached = moved(self.experiment, &next.at, next.local.parts(), &next.back);
            if next.equal && path.tested == path.points.len() {
                path.tested += 1;
                path.end = Some((reached.x.clone(), next.local.spectrum.clone()));
            }
            path.points.push(reached.x);
            before = tangent;
            tangent = along(&next.local.spectrum, self.rank, &before);
            stand = Some(next);
        }
        path
    }

    /// How far the predictions are from equal, in their noise, as far as the identified directions can move them.
    fn off(&self, local: &Linearisation) -> f64 {
        let rhs = local.shared.rhs();
        let identified = (0..self.rank).map(|k| local.spectrum.left_along(&rhs, k).powi(2));
        predicted_decrease(self.experiment, local, identified.sum()).sqrt()
    }

    fn back_onto_the_set(&self, mut at: Iterate) -> Option<ContinuationPoint> {
        for _ in 0..CORRECTIONS {
            let here = self.experiment.linearise(&at)?;
            let (all, local) = (here.predicted_reduction.sqrt(), here.rows);
            let (off, back) = (self.off(&local), across(&local, self.rank));
            if off.is_nan() || largest(&back) > REACH {
                return None;
            }
            // The correction step is still taken: its remainder is of second order.
            if off < NEARLY_EQUAL {
                let equal = all < NEARLY_EQUAL;
                return Some(ContinuationPoint {
                    at,
                    local,
                    back,
                    equal,
                });
            }
            at = moved(self.experiment, &at, local.parts(), &back);
        }
        None
    }
}

/// The part of a direction in the null space, its largest component one.
fn along(spectrum: &Spectrum, rank: usize, direction: &[f64]) -> Vec<f64> {
    let out = spectrum.combined(rank..direction.len(), |k| spectrum.along(direction, k));
    let size = largest(&out);
    out.iter()
        .map(|z| z / size.max(f64::MIN_POSITIVE))
        .collect()
}

/// The Gauss-Newton step across the null space.
fn across(local: &Linearisation, rank: usize) -> Vec<f64> {
    let (spectrum, rhs) = (&local.spectrum, local.shared.rhs());
    let step = |k: usize| spectrum.left_along(&rhs, k) / spectrum.singular[k];
    spectrum.combined(0..rank, step)
}

fn largest(z: &[f64]) -> f64 {
    z.iter().fold(0.0, |a, b| f64::max(a, b.abs()))
}
