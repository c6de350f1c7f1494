//! The set of unknowns with equal prediction, and tests of quantities along it.

use crate::problem::quantity::Quantity;
use poinsot_solve::Spectrum;
use std::ops::Range;

/// Length of a path, natural units: the usual error of nominal numbers.
pub(crate) const REACH: f64 = 0.2;
/// Points of a path on each side of the answer.
pub(crate) const POINTS: usize = 10;
/// Largest factor of sigma along a path: a function of identifiable numbers has one sigma on the whole set, unlike a
/// combination with estimated coefficients.
const SPREAD: f64 = 1.5;

/// A path along an unobservable direction, in both senses.
#[derive(Clone)]
pub(crate) struct ContinuationPath {
    /// Values of all unknowns, evenly spaced; the answer is in the middle.
    pub points: Vec<Vec<f64>>,
    /// Points at which quantities are compared with their value at the answer.
    pub tested: Range<usize>,
    /// Spectra at the ends of these; none if the path is linear.
    pub ends: Vec<(Vec<f64>, Spectrum)>,
}

/// All paths from an answer.
#[derive(Clone, Default)]
pub(crate) struct UnobservableSet {
    /// One per unobservable direction in the order of their names, then two along all of them together.
    pub walks: Vec<ContinuationPath>,
    /// Spectrum at the answer, of the predicted samples; `None` if every path is linear.
    pub here: Option<Spectrum>,
}

impl UnobservableSet {
    /// Linear paths along directions in the unknowns' units: the set of a linear problem.
    pub fn straight(x: &[f64], directions: &[Vec<f64>], natural: &[f64]) -> Self {
        let walk = |step: &Vec<f64>| {
            let largest = step.iter().zip(natural).map(|(s, unit)| (s / unit).abs());
            let largest = largest.fold(0.0, f64::max);
            let ends = if largest > 0.0 { REACH / largest } else { 0.0 };
            ContinuationPath::straight(x, |i| step.get(i).map_or(0.0, |s| s * ends))
        };
        Self {
            walks: directions.iter().map(walk).collect(),
            here: None,
        }
    }

    /// The points at which quantities are compared: a few of a linear path, all of others.
    pub fn points(&self) -> impl Iterator<Item = &Vec<f64>> {
        let stride = |w: &ContinuationPath| if w.ends.is_empty() { POINTS / 2 } else { 1 };
        let walks = self.walks.iter();
        walks.flat_map(move |w| w.points[w.tested.clone()].iter().step_by(stride(w)))
    }

    /// Whether the sigma of a quantity is constant along all paths.
    pub fn keeps_sigma(&self, here: &Quantity, at: impl Fn(&[f64]) -> Quantity) -> bool {
        let Some(spectrum) = &self.here else {
            return true;
        };
        let mass = spectrum.natural.len();
        let of = |s: &Spectrum, q: &Quantity| s.sigma(&q.gradient[..mass.min(q.gradient.len())]);
        let Some(own) = of(spectrum, here) else {
            return false;
        };
        let mut ends = self.walks.iter().flat_map(|w| &w.ends);
        ends.all(|(x, s)| of(s, &at(x)).is_some_and(|there| there <= SPREAD * own))
    }

    /// Ranks at the answer and at both ends of the paths along all directions together.
    pub fn ranks(&self) -> Vec<usize> {
        let ends = self.walks.last().into_iter().flat_map(|w| &w.ends);
        let spectra = self.here.iter().chain(ends.map(|(_, s)| s));
        spectra.map(|s| s.rank).collect()
    }
}

impl ContinuationPath {
    /// Evenly spaced on a line; `end` is the step to its far end.
    pub fn straight(x: &[f64], end: impl Fn(usize) -> f64) -> Self {
        let count = POINTS as i32;
        let at = |k: i32| {
            let share = f64::from(k) / f64::from(count);
            let moved = x.iter().enumerate().map(|(i, x)| x + share * end(i));
            moved.collect()
        };
        Self {
            points: (-count..=count).map(at).collect(),
            tested: 0..2 * POINTS + 1,
            ends: Vec::new(),
        }
    }
}
