//! The backward pass: what all samples, earlier and later ones, tell of the inputs' errors.
//!
//! Modified Bryson-Frazier recursion (Bierman 1977, chapter 10): the adjoint `l` goes back over every step, `l = F^T l`, and
//! every sample, `l = l - H^T L^-T (v + G l)` with the white innovation v and the gain G; the smoothed error is `m - P l`.
//! No covariance is inverted, and exact inputs need no exception. Of a long record a part is gone back over as soon as as many
//! grid times follow it: what is later does not reach it.

use super::sparse::SparseRows;
use poinsot_spatial::{Matrix3, Vector3};

/// Grid times of a part.
const PART: usize = 4096;

/// What the filter did, in order.
enum Event {
    /// The errors went on by these rows.
    Carried(SparseRows),
    Taken {
        slopes: Vec<Vector3>,
        gains: Vec<Vector3>,
        inverse_root: Matrix3,
        white: Vector3,
    },
    /// The end of a grid time: mean and row of the covariance of each error that is smoothed.
    Known(Vec<KnownError>),
}

/// Mean of an error, and its row of the covariance.
pub(super) struct KnownError {
    pub mean: f64,
    pub covariance: Vec<f64>,
}

/// The filter's record along a segment.
#[derive(Default)]
pub(super) struct Trace {
    events: Vec<Event>,
    /// Rows of the parts that are smoothed.
    done: Vec<Vec<f64>>,
    /// Grid times among the events, and where the events of the second part begin.
    times: usize,
    second: usize,
}

impl Trace {
    pub(super) fn carried(&mut self, rows: SparseRows) {
        self.events.push(Event::Carried(rows));
    }

    /// A sample, after the filter took it: `row` is what is left of the residual.
    pub(super) fn taken(
        &mut self,
        (slopes, gains): (&[Vector3], &[Vector3]),
        inverse_root: &Matrix3,
        row: Option<&Vector3>,
    ) {
        self.events.push(Event::Taken {
            slopes: slopes.to_vec(),
            gains: gains.to_vec(),
            inverse_root: *inverse_root,
            white: row.copied().unwrap_or_default(),
        });
    }

    /// Ends a grid time with the errors that are smoothed, of so many that the filter has.
    pub(super) fn known(&mut self, size: usize, errors: Vec<KnownError>) {
        self.events.push(Event::Known(errors));
        self.times += 1;
        match self.times {
            PART => self.second = self.events.len(),
            n if n == 2 * PART => {
                let rows = self.backward(size);
                self.done.extend(rows.into_iter().take(PART));
                self.events.drain(..self.second);
                (self.times, self.second) = (PART, self.events.len());
            }
            _ => {}
        }
    }

    /// The smoothed errors at every grid time, one row each in the order of the places.
    pub(super) fn smoothed(&self, size: usize) -> Vec<f64> {
        let rest = self.backward(size).concat();
        self.done.iter().flatten().copied().chain(rest).collect()
    }

    /// The same of the events in hand.
    fn backward(&self, size: usize) -> Vec<Vec<f64>> {
        let mut adjoint = vec![0.0; size];
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for event in self.events.iter().rev() {
            match event {
                Event::Carried(by) => {
                    let mut before = vec![0.0; size];
                    for (row, l) in by.iter().zip(&adjoint) {
                        row.iter().for_each(|(j, f)| before[*j] += f * l);
                    }
                    adjoint = before;
                }
                Event::Taken {
                    slopes,
                    gains,
                    inverse_root,
                    white,
                } => {
                    let pairs = gains.iter().zip(&adjoint);
                    let sum = pairs.fold(*white, |sum, (gain, l)| sum + gain * *l);
                    let back = inverse_root.transpose() * sum;
                    let pairs = adjoint.iter_mut().zip(slopes);
                    pairs.for_each(|(l, slope)| *l -= slope.dot(&back));
                }
                Event::Known(errors) => {
                    let smooth = |error: &KnownError| {
                        let pairs = error.covariance.iter().zip(&adjoint);
                        error.mean - pairs.map(|(p, l)| p * l).sum::<f64>()
                    };
                    rows.push(errors.iter().map(smooth).collect());
                }
            }
        }
        rows.reverse();
        rows
    }
}
