//! A constant force and torque in the body over a part of a record: a firing that is missing from the telemetry.
//!
//! An impulse at one time is a combination of the initial-state columns; a pulse is a sum of impulses. With the sums up
//! to every time at hand, each row of a pulse is one product. Durations are tried by halves, then both ends of the best
//! are moved.

use super::score::{Best, Products, ProjectedRows, Score, explained, momentum_jump, of_record};
use super::suspects::Scored;
use super::table::SegmentRows;
use super::types::FaultKind;
use crate::fit::experiment::Experiment;
use nalgebra::{DMatrix, DVector};
use poinsot_spatial::Vector3;

/// Shares of a segment that are tried as durations.
const DURATIONS: [f64; 5] = [0.25, 0.125, 0.0625, 0.03125, 0.015625];
/// Cosine between a force and a thruster's direction from which it is that thruster.
const ALONG: f64 = 0.99;

/// Cumulated impulses up to each time, for the score of any interval.
struct Pulses<'a> {
    rows: &'a SegmentRows<'a>,
    clear: &'a ProjectedRows,
    /// Sum of the impulses up to each transition.
    sums: Vec<DMatrix<f64>>,
    /// Transition of each measurement.
    places: Vec<usize>,
}

/// The best pulse in a segment.
pub(super) fn pulse(
    experiment: &Experiment,
    rows: &SegmentRows,
    clear: &ProjectedRows,
    segment: usize,
) -> Option<Scored> {
    let record = of_record(&experiment.problem.segments[segment].label);
    let t = &experiment.problem.segments[segment].observations.time_s;
    let pulses = Pulses::new(experiment, rows, clear, (segment, t))?;
    let last = rows.transitions.len() - 1;
    let mut best: Best<(usize, usize)> = Best::default();
    for share in DURATIONS {
        let length = ((last as f64 * share) as usize).max(1);
        for from in (0..last.saturating_sub(length)).step_by(length.div_ceil(2)) {
            let to = from + length;
            best.take(pulses.score(from, to), (from, to));
        }
    }
    let (_, (from, to)) = best.found.as_ref()?;
    let mut step = (to - from).div_ceil(2);
    while step > 0 {
        let (score, (from, to)) = best.found.as_ref()?;
        let (before, from, to) = (score.decrease, *from, *to);
        let ends = [
            (from.saturating_sub(step), to),
            (from + step, to),
            (from, to.saturating_sub(step)),
            (from, (to + step).min(last)),
        ];
        for (from, to) in ends.into_iter().filter(|(a, b)| a < b) {
            best.take(pulses.score(from, to), (from, to));
        }
        if best.found.as_ref()?.0.decrease <= before {
            step /= 2;
        }
    }
    let at = |k: usize| t[rows.transitions[k].at];
    best.suspect(FaultKind::Firing, |score, (from, to)| {
        let who = match thruster(experiment, score, segment) {
            Some(name) => {
                format!("a firing of {name} that is missing from the telemetry or did not happen")
            }
            None => {
                "a force or torque that is missing from the telemetry or did not act".to_owned()
            }
        };
        format!("{who}, {:.1} to {:.1} s{record},", at(*from), at(*to))
    })
}

/// The thruster along which the force of a pulse acts.
fn thruster<'a>(experiment: &'a Experiment, score: &Score, segment: usize) -> Option<&'a str> {
    if !experiment.unknown[segment].linear {
        return None;
    }
    let force = Vector3::from_row_slice(score.values.as_slice().get(..3)?);
    let cosine = |k: usize| {
        let t = &experiment.thrusters[k];
        (force.dot(&t.direction_B) / (force.norm() * t.direction_B.norm())).abs()
    };
    let mut along = (0..experiment.thrusters.len()).filter(|k| cosine(*k) > ALONG);
    let first = along.next()?;
    // Two thrusters along one line are not distinguishable by their force.
    along
        .next()
        .is_none()
        .then(|| experiment.thrusters[first].name.as_str())
}

impl<'a> Pulses<'a> {
    fn new(
        experiment: &Experiment,
        rows: &'a SegmentRows<'a>,
        clear: &'a ProjectedRows,
        (segment, t): (usize, &[f64]),
    ) -> Option<Self> {
        let mut sums: Vec<DMatrix<f64>> = Vec::with_capacity(rows.transitions.len());
        let mut before = None;
        for transition in &rows.transitions {
            let one = momentum_jump(&transition.start, experiment, segment)?;
            // Forces and torques along the axes of the body.
            let R = transition.R_NB.to_rotation_matrix();
            let turned = DMatrix::from_fn(one.nrows(), one.ncols(), |i, j| {
                (0..3)
                    .map(|k| one[(i, j / 3 * 3 + k)] * R[(k, j % 3)])
                    .sum()
            });
            let step = before.map_or(0.0, |b: usize| t[transition.at] - t[b]);
            before = Some(transition.at);
            sums.push(match sums.last() {
                Some(sum) => sum + &turned * step,
                None => DMatrix::zeros(one.nrows(), one.ncols()),
            });
        }
        let mut place = 0;
        let places = rows.measured.iter().map(|own| {
            while rows
                .transitions
                .get(place + 1)
                .is_some_and(|t| t.at <= own.at)
            {
                place += 1;
            }
            place
        });
        let places: Vec<usize> = places.collect();
        (sums.len() > 1).then_some(Self {
            rows,
            clear,
            sums,
            places,
        })
    }

    /// Score of a pulse between two transitions.
    fn score(&self, from: usize, to: usize) -> Score {
        let (h, m) = self.sums[0].shape();
        let mut sums = Products::new(m, self.clear);
        let whole = &self.sums[to] - &self.sums[from];
        let begin = self.places.partition_point(|place| *place <= from);
        for measurement in begin..self.places.len() {
            let place = self.places[measurement];
            let part = (place < to).then(|| &self.sums[place] - &self.sums[from]);
            let part = part.as_ref().unwrap_or(&whole);
            for (i, row) in (3 * measurement..).zip(&self.rows.measured[measurement].rows) {
                let own_columns = DVector::from_column_slice(&row[..h]);
                sums.add(&part.tr_mul(&own_columns), self.clear, i);
            }
        }
        explained(&sums.left(), &sums.square, &sums.toward)
    }
}
