//! Test whether a fit to the beginning of each record predicts its end (predictive failure test, Chow 1960).
//!
//! With `K` the least sum of squares of the kept rows and `F` that of all rows, `F - K` is the square of the prediction
//! error of the held-out rows in its own covariance, noise and uncertainty of the fit together: chi-square distributed
//! with one degree of freedom for each of them. To first order about the answer, without a second fit.

use super::table::{SegmentRows, Table};
use super::types::HeldOut;
use crate::fit::Fitted;
use crate::fit::experiment::Experiment;
use crate::likelihood::Evaluated;
use crate::problem::segment::{Samples, Segment};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Share of the grid times at the end of every record that are held out: enough for a test, few enough to leave the fit its
/// manoeuvre.
const SHARE: f64 = 0.2;

/// The test; `None` where no sample is left on one of the sides. `fitted_numbers` were fitted in all. A table that holds the rows
/// has those of the beginnings.
pub(super) fn held_out(
    experiment: &Experiment,
    fitted: &Fitted,
    table: Option<&Table>,
    fitted_numbers: usize,
) -> Option<HeldOut> {
    let kept = match table.filter(|t| !t.segments.is_empty()) {
        Some(table) => beginnings(table, experiment.problem.segments),
        None => evaluated_beginnings(experiment, fitted)?,
    };
    let rows = |all: &[Evaluated]| all.iter().map(|e| e.rows).sum::<usize>();
    let numbers = rows(&fitted.evaluated).checked_sub(rows(&kept))?;
    let dof = rows(&kept).checked_sub(fitted_numbers)?;
    let least = least_square(experiment, fitted, &kept)?;
    let chi2 = (least_square(experiment, fitted, &fitted.evaluated)? - least).max(0.0);
    // Another test covers a residual larger than declared.
    let mean_square = (least / dof.max(1) as f64).max(1.0);
    let chance = ChiSquared::new(numbers as f64).ok()?;
    Some(HeldOut {
        share: SHARE,
        numbers,
        chi2,
        p: chance.sf(chi2 / mean_square),
    })
}

/// First grid time that is held out.
fn end(segment: &Segment) -> usize {
    ((1.0 - SHARE) * segment.observations.time_s.len() as f64) as usize
}

/// The rows of a table before what is held out. Later samples change no row before them.
fn beginnings(table: &Table, segments: &[Segment]) -> Vec<Evaluated> {
    let of = |(own, segment): (&SegmentRows, &Segment)| own.beginning(table.base, end(segment));
    table.segments.iter().zip(segments).map(of).collect()
}

/// The beginnings of all records, evaluated by themselves; the inputs stay.
fn evaluated_beginnings(experiment: &Experiment, fitted: &Fitted) -> Option<Vec<Evaluated>> {
    let problem = experiment.problem;
    let segments: Vec<Segment> = problem.segments.iter().map(beginning).collect();
    let kept = problem.with_segments(&segments);
    let kept = experiment.of_vehicle(&kept, experiment.parameters);
    kept.evaluate(&fitted.at, true)
}

/// A segment with the sensors' samples of its beginning alone. Of a long record nothing is copied that is not used.
fn beginning(segment: &Segment) -> Segment {
    let mut observations = segment.observations.clone();
    observations.smooth_wheel_speed = Vec::new();
    let end = end(segment);
    for sensor in &mut observations.sensors {
        let kept = sensor.samples.partition_point(|sample| sample.to < end);
        sensor.samples.truncate(kept);
    }
    Segment {
        label: segment.label.clone(),
        // Of these an evaluation takes the attitude at the start.
        samples: Samples {
            R_NB: segment.samples.R_NB.first().copied().into_iter().collect(),
            ..Samples::default()
        },
        observations,
        firings: segment.firings.clone(),
        accelerations: None,
    }
}

/// Least sum of squares of rows and priors over all unknowns: the residual of the triangle.
fn least_square(experiment: &Experiment, fitted: &Fitted, rows: &[Evaluated]) -> Option<f64> {
    let r = experiment.stack(&fitted.at, rows, true).r;
    let last = r.ncols().checked_sub(1)?;
    (r.nrows() > last).then(|| r[(last, last)].powi(2))
}
