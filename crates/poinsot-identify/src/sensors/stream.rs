//! Samples of one sensor along the grid, each with its prediction.

use super::{IdealSeries, PredictedMeasurement, SpareVectors, predict};
use crate::motion::input_noise::InputNoise;
use crate::motion::{Instant, Motion, State};
use crate::problem::segment::{Observations, SensorRecord, SensorSample, SensorValue};
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;

/// One sensor in the course of a segment.
pub(crate) struct SampleStream {
    /// Index of the sensor in the segment.
    sensor: usize,
    /// Index of the next sample.
    next: usize,
    /// Grid time and velocity where the increment in hand began.
    began: Option<(usize, PredictedMeasurement)>,
    /// Place of an increment among those of the segment.
    increment: usize,
}

/// What a prediction needs beside the motion.
pub(crate) struct Predictor<'a> {
    pub observations: &'a Observations,
    /// Slopes of the measurements whose rate no state determines.
    pub ideal: &'a IdealSeries,
    pub inputs: &'a InputNoise,
    pub spare: &'a mut SpareVectors,
}

/// A sample with its prediction.
pub(crate) struct DueSample {
    pub sample: SensorSample,
    pub predicted: PredictedMeasurement,
    /// Rate of change of the ideal measurement.
    pub rate: Vector3,
}

impl SampleStream {
    /// One for each sensor of a segment.
    pub fn all(records: &[SensorRecord]) -> impl Iterator<Item = Self> + '_ {
        let mut increments = 0;
        records.iter().enumerate().map(move |(sensor, record)| {
            let increment = increments;
            increments += usize::from(record.kind == SensorKind::VelocityIncrement);
            Self {
                sensor,
                next: 0,
                began: None,
                increment,
            }
        })
    }

    /// Whether the sensor has a sample, or an increment that begins, at grid time k.
    pub fn is_due(&self, record: &SensorRecord, k: usize) -> bool {
        let mut next = record.samples.iter().skip(self.next).take(2);
        next.any(|s| s.to == k || s.from == k)
    }

    /// The sample at grid time k, where the motion has just given its velocity; `None` without a sample or a
    /// prediction. Asked at every grid time in turn, with [`Self::end`] after the sample is compared.
    pub fn at(
        &mut self,
        around: Predictor,
        motion: &mut Motion,
        (state, k): (&State, usize),
        instant: &Instant,
    ) -> Option<DueSample> {
        let (observations, spare) = (around.observations, around.spare);
        let record = &observations.sensors[self.sensor];
        if !self.is_due(record, k) {
            return None;
        }
        let here = record.samples.get(self.next).filter(|s| s.to == k).copied();
        self.next += usize::from(here.is_some());
        let now = predict(record, motion, (state, k), instant, around.inputs, spare)?;
        let slope = |k| around.ideal.rate(self.sensor, &observations.time_s, k);
        if record.kind != SensorKind::VelocityIncrement {
            return here.map(|sample| DueSample {
                sample,
                rate: now.rate.unwrap_or_else(|| slope(k)),
                predicted: now,
            });
        }
        let began = self.began.replace((k, now));
        let (from, before) = began?;
        let now = &self.began.as_ref()?.1;
        let sample = here.filter(|sample| sample.from == from);
        let due = sample.map(|sample| {
            let (mut columns, mut errors) = (spare.take(), spare.take());
            let pairs = now.columns.iter().zip(&before.columns);
            columns.extend(pairs.map(|(b, a)| b - a));
            errors.extend_from_slice(&now.errors);
            around.inputs.less_kept(self.increment, 1.0, &mut errors);
            DueSample {
                sample,
                predicted: PredictedMeasurement {
                    value: SensorValue::Vector(now.vector() - before.vector()),
                    rate: None,
                    columns,
                    errors,
                },
                rate: slope(k) - slope(from),
            }
        });
        spare.give_back(before.columns);
        due
    }

    /// Keeps the errors of the inputs where an increment begins at grid time k.
    pub fn end(&mut self, k: usize, inputs: &mut InputNoise, spare: &mut SpareVectors) {
        if let Some((_, now)) = self.began.as_mut().filter(|began| began.0 == k) {
            let errors = std::mem::take(&mut now.errors);
            inputs.keep(self.increment, &errors);
            spare.give_back(errors);
        }
    }
}
