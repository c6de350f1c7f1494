//! Residuals of one sensor along a segment, with its errors.

use super::{ChannelResidual, SegmentComparison, Setting};
use crate::motion::{Instant, Motion, State};
use crate::problem::parameters::UnknownKind;
use crate::problem::segment::{SensorRecord, SensorValue};
use crate::sensors::{DueSample, Predictor, SampleStream, across};
use nalgebra::Cholesky;
use poinsot_dynamics::{SensorError, SensorErrors};
use poinsot_model::printed_unit;
use poinsot_spatial::{Matrix3, Vector3};
use std::ops::Range;

/// State of one sensor during an evaluation.
pub(super) struct SensorCursor {
    pub errors: SensorErrors,
    /// Whether its lag is unknown.
    pub late: bool,
    pub stream: SampleStream,
    /// Root of the determinant of its own covariance; `None` for a sensor taken as exact.
    pub own_root_det: Option<f64>,
    /// Covariance of its white noise.
    white: Matrix3,
    pub channel: ChannelResidual,
    /// The errors that are unknown: column, error.
    unknown: Vec<(usize, SensorError)>,
}

impl SensorCursor {
    /// One for each sensor of a segment; `initial_columns` columns stand before those of the unknowns.
    pub fn all(
        records: &[SensorRecord],
        setting: &Setting,
        x: &[f64],
        initial_columns: usize,
    ) -> Vec<Self> {
        let parameters = setting.parameters;
        let streams = SampleStream::all(records);
        let one = |((sensor, record), stream): ((usize, &SensorRecord), SampleStream)| {
            let columns = parameters.unknowns.iter().enumerate();
            let unknown: Vec<(usize, SensorError)> = columns
                .filter_map(|(u, unknown)| match unknown.kind {
                    UnknownKind::Sensor { sensor, error } if Some(sensor) == record.sensor => {
                        Some((initial_columns + u, error))
                    }
                    _ => None,
                })
                .collect();
            Self {
                errors: parameters.sensor_errors(x, record.sensor),
                late: unknown.iter().any(|u| u.1 == SensorError::Lag),
                stream,
                own_root_det: Cholesky::new(record.covariance).map(|c| c.l().diagonal().product()),
                white: record.white(),
                channel: ChannelResidual {
                    sensor,
                    name: record.name.clone(),
                    unit: printed_unit(record.kind.unit(false)),
                    numbers: record.kind.numbers(),
                    ..ChannelResidual::default()
                },
                unknown,
            }
        };
        records.iter().enumerate().zip(streams).map(one).collect()
    }
}

/// Residual of a sample with its sensitivities.
struct Difference {
    residual: Vector3,
    /// Sensitivities.
    columns: Vec<Vector3>,
    /// Over the errors of the inputs.
    errors: Vec<Vector3>,
}

impl Difference {
    /// The same in other axes.
    fn turn(&mut self, R: &Matrix3) {
        let lists = [&mut self.columns, &mut self.errors];
        for x in lists.into_iter().flatten().chain([&mut self.residual]) {
            *x = R * *x;
        }
    }
}

impl SegmentComparison<'_> {
    /// Rows of one sensor at grid time k, where it is due.
    pub(super) fn add_sensor_rows(
        &mut self,
        i: usize,
        motion: &mut Motion,
        (state, k): (&State, usize),
        instant: &Instant,
    ) {
        let around = Predictor {
            observations: &self.segment.observations,
            ideal: &self.ideal,
            inputs: &self.inputs,
            spare: &mut self.spare,
        };
        let stream = &mut self.cursors[i].stream;
        if let Some(due) = stream.at(around, motion, (state, k), instant) {
            self.compare(i, due);
        }
        let stream = &mut self.cursors[i].stream;
        stream.end(k, &mut self.inputs, &mut self.spare);
    }

    /// Three rows: measured against predicted.
    fn compare(&mut self, i: usize, due: DueSample) {
        let slow = self.inputs.slow_errors(i);
        let mut new = difference(&self.cursors[i], due, slow);
        new.columns.push(new.residual);
        let sensor = self.cursors[i].white;
        // A reading without noise that can be whitened is left out.
        let _ = self.take(i, &new.errors, &sensor, &mut new.columns);
        for list in [new.columns, new.errors] {
            self.spare.give_back(list);
        }
    }
}

/// `slow` are the places of its slow errors among those of the filter, three to each.
fn difference(cursor: &SensorCursor, due: DueSample, slow: Range<usize>) -> Difference {
    let errors = &cursor.errors;
    let (predicted, rate) = (due.predicted, due.rate);
    let x = predicted.vector();
    let mut new = Difference {
        residual: predicted.residual(&due.sample.value, errors, &rate),
        columns: predicted.columns,
        errors: predicted.errors,
    };
    if errors.turn != Matrix3::zeros() {
        let lists = [&mut new.columns, &mut new.errors];
        for d in lists.into_iter().flatten() {
            *d = errors.change(d);
        }
    }
    if !new.columns.is_empty() {
        for (column, error) in &cursor.unknown {
            new.columns[*column] += errors.slope(*error, &x, &rate);
        }
    }
    for own in new.errors[slow].chunks_exact_mut(3) {
        for (axis, slope) in own.iter_mut().enumerate() {
            slope[axis] += 1.0;
        }
    }
    if let SensorValue::Direction { normal_B, .. } = &due.sample.value {
        new.turn(&across(normal_B));
    }
    new
}
