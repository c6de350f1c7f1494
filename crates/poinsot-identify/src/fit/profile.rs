//! The likelihood along the directions that the data determine weakly.
//!
//! The curvature at the answer gives a 95 % interval that is right where the likelihood is a parabola over it. Along a weak
//! direction it often is not: a mass is one over the acceleration that is measured, and noise of a wheel looks like the response
//! of a small inertia. There the other unknowns are fitted again at both ends of the interval (the profile likelihood; Venzon
//! and Moolgavkar 1988), and the ends are moved to where the cost has risen as much as it does at the end of a normal's
//! interval. The longer side gives sigma.
//!
//! Whether a number is given must not depend on where in its interval the estimate happens to lie: an estimate that is too
//! small by chance would have a small sigma, and pass. So a direction is judged by the largest sigma that any value in the
//! interval would have: at the answer or at either end.

use crate::fit::Fitted;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::step::{Linearisation, moved};
use crate::problem::question::INTERVAL;
use poinsot_solve::{DirectionSigma, LeastSquares, Linearised, Spectrum, dot};

/// Half-width of an interval, natural units, up to which predictions are linear in a direction.
const LINEAR: f64 = 0.1;
/// Relative difference from a parabola that changes an interval.
const DIFFERENT: f64 = 0.1;
/// Most moves of an end of an interval, and largest factor of one.
const MOVES: usize = 4;
const FURTHEST: f64 = 3.0;
/// Most Gauss-Newton steps of the other unknowns, and the fall of the cost that ends them.
const REFITS: usize = 3;
const SETTLED: f64 = 1.0e-2;
/// Share of a direction that its local linearisation does not identify: then nothing is known along it.
const OPEN: f64 = 1.0e-2;
/// Sigma of what has no end, natural units.
const UNBOUNDED: f64 = 1.0e3;

/// The spectrum with the sigmas of the profile along each direction where the likelihood is no parabola, and how many these are.
pub(crate) fn profiled(
    experiment: &Experiment,
    fitted: &Fitted,
    spectrum: Spectrum,
) -> (Spectrum, usize) {
    let misfit = fitted.chi2() / fitted.rows().max(1) as f64;
    let profile = Profile {
        experiment,
        fitted,
        cost: experiment.cost_of(fitted),
        root: INTERVAL * misfit.sqrt().max(1.0),
    };
    // What is linear, or withheld in any case, needs no profile.
    let weak = (0..spectrum.rank).filter(|k| {
        let half = profile.root / spectrum.singular[*k];
        half > LINEAR && !profile.is_wide(half)
    });
    let curved: Vec<DirectionSigma> = weak.filter_map(|k| profile.along(k, &spectrum)).collect();
    let count = curved.len();
    let spectrum = spectrum.with_sigmas(&curved);
    (spectrum.judged(experiment.problem.largest_sigma()), count)
}

struct Profile<'a> {
    experiment: &'a Experiment<'a>,
    fitted: &'a Fitted,
    /// Cost of the fit.
    cost: f64,
    /// Root of the rise of the cost at the ends of an interval.
    root: f64,
}

/// One end of an interval: how far it is from the answer, and sigma there, natural units.
struct Side {
    half: f64,
    sigma: f64,
}

/// A direction in natural units.
type Direction = Vec<f64>;

/// Values of all unknowns, and the problem there.
type Point = (Iterate, Linearised<Linearisation>);

impl Profile<'_> {
    /// The sigmas along a direction; `None` where the likelihood is a parabola up to both ends of its interval.
    fn along(&self, k: usize, spectrum: &Spectrum) -> Option<DirectionSigma> {
        let n = spectrum.natural.len();
        let direction: Direction = (0..n).map(|i| spectrum.directions[(i, k)]).collect();
        let sigma = 1.0 / spectrum.singular[k];
        let senses = [1.0, -1.0].map(|sign| -> Direction {
            let towards = direction.iter().map(|d| sign * d);
            towards.collect()
        });
        let is_parabola = |towards: &Direction| {
            let rise = self.rise(&self.step(towards, self.root * sigma));
            rise.is_some_and(|r| (r / self.root - 1.0).abs() < DIFFERENT)
        };
        if senses.iter().all(is_parabola) {
            return None;
        }
        let (mut half, mut judged) = (0.0_f64, sigma);
        for towards in &senses {
            let side = self.side(towards, self.root * sigma);
            // A side without a motion is excluded by the vehicle, not by the data.
            let Some(side) = side else { continue };
            half = half.max(side.half);
            judged = judged.max(side.sigma).max(half / self.root);
            if self.is_wide(self.root * judged) {
                break;
            }
        }
        if half == 0.0 {
            return None;
        }
        let stated = half / self.root;
        Some(DirectionSigma {
            direction: k,
            stated: match self.is_wide(self.root * judged) {
                true => judged,
                false => stated,
            },
            judged,
        })
    }

    /// Whether an interval of this half-width is wider than what is given.
    fn is_wide(&self, half: f64) -> bool {
        half >= self.experiment.problem.relative_accuracy
    }

    /// The end of an interval, from where a parabola would have it; `None` where the vehicle cannot move there.
    fn side(&self, towards: &Direction, mut half: f64) -> Option<Side> {
        let point = |half| {
            let at = self.step(towards, half);
            Some((self.linearised(&at)?, at))
        };
        let (mut here, mut at) = point(half)?;
        for _ in 0..MOVES {
            let sigma = sigma_along(&here.rows, towards);
            if self.is_wide(half) || self.is_wide(self.root * sigma) {
                return Some(Side { half, sigma });
            }
            here = self.refitted((at, here), towards);
            let factor = self.root / self.root_of(here.cost);
            if (factor - 1.0).abs() < 0.5 * DIFFERENT {
                break;
            }
            half *= factor.clamp(FURTHEST.recip(), FURTHEST);
            (here, at) = point(half)?;
        }
        Some(Side {
            half,
            sigma: sigma_along(&here.rows, towards),
        })
    }

    /// The answer moved along a direction; what is eliminated follows.
    fn step(&self, towards: &Direction, half: f64) -> Iterate {
        let step: Vec<f64> = towards.iter().map(|d| half * d).collect();
        moved(self.experiment, &self.fitted.at, self.fitted.parts(), &step)
    }

    /// Root of the rise of the cost at a point.
    fn rise(&self, at: &Iterate) -> Option<f64> {
        let cost = self.experiment.cost(at).filter(|cost| cost.is_finite())?;
        Some(self.root_of(cost))
    }

    fn root_of(&self, cost: f64) -> f64 {
        (cost - self.cost).max(0.0).sqrt()
    }

    /// The best fit of the others from a point, where one direction is held.
    fn refitted(&self, (mut at, mut here): Point, held: &Direction) -> Linearised<Linearisation> {
        for _ in 0..REFITS {
            let step = across(&here.rows, held);
            at = moved(self.experiment, &at, here.rows.parts(), &step);
            let there = self.linearised(&at);
            let Some(there) = there.filter(|there| there.cost < here.cost) else {
                break;
            };
            let fell = here.cost - there.cost;
            here = there;
            if fell < SETTLED {
                break;
            }
        }
        here
    }

    fn linearised(&self, at: &Iterate) -> Option<Linearised<Linearisation>> {
        let here = self.experiment.linearise(at);
        here.filter(|here| here.cost.is_finite())
    }
}

/// The Gauss-Newton step of the others where one direction is held.
fn across(here: &Linearisation, held: &Direction) -> Vec<f64> {
    let free = here.spectrum.solve(&here.shared.rhs());
    // The covariance of the identified directions times the vector that is held.
    let spectrum = &here.spectrum;
    let variance = |k: usize| spectrum.along(held, k) / spectrum.singular[k].powi(2);
    let image = spectrum.combined(0..spectrum.rank, variance);
    let wrong = dot(held, &free) / dot(held, &image);
    match wrong.is_finite() {
        true => free
            .iter()
            .zip(&image)
            .map(|(z, w)| z - wrong * w)
            .collect(),
        false => free,
    }
}

/// Sigma along a direction with all others free.
fn sigma_along(here: &Linearisation, direction: &Direction) -> f64 {
    let spectrum = &here.spectrum;
    match 1.0 - spectrum.identified_share(direction) > OPEN * OPEN {
        true => UNBOUNDED,
        false => spectrum.variance(direction).sqrt(),
    }
}
