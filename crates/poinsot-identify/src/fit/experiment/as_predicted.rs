//! Samples replaced by their predictions at an iterate.

use super::{Experiment, Iterate};
use crate::problem::Problem;
use crate::problem::loss::Loss;
use crate::problem::segment::{Segment, SensorValue};
use crate::problem::settings::Coordinates;
use crate::sensors::across;
use poinsot_spatial::UnitQuaternion;

/// Iterations until samples equal predictions: the turn of an attitude is exact after the first.
const ROUNDS: usize = 2;

pub(crate) fn readings_alone<'b>(
    experiment: &'b Experiment<'b>,
    problem: &'b Problem<'b>,
) -> Experiment<'b> {
    let mut few = experiment.with_problem(problem);
    few.settings.loss = Loss::Gaussian;
    few.settings.coordinates = Coordinates::Linear;
    few
}

/// Gives the samples of all segments the values that a point predicts: what is left of them are differences of predictions
/// alone, whitened as at this point.
pub(crate) fn take_predictions(
    experiment: &Experiment,
    at: &Iterate,
    segments: &mut [Segment],
) -> Option<()> {
    // Readings as predicted are those of the inputs in hand.
    let inputs = segments.iter_mut().map(|s| &mut s.observations);
    inputs.for_each(|o| o.expected_errors.clear());
    for _ in 0..ROUNDS {
        let problem = experiment.problem.with_segments(segments);
        let mut own = readings_alone(experiment, &problem);
        own.keep_rows = true;
        let evaluated = own.evaluate(at, false)?;
        drop(own);
        for (segment, one) in segments.iter_mut().zip(&evaluated) {
            for (sensor, record) in segment.observations.sensors.iter_mut().enumerate() {
                for row in one.kept.of(Some(sensor)) {
                    let place = record.samples.binary_search_by_key(&row.at, |s| s.to);
                    let sample = record.samples.get_mut(place.ok()?)?;
                    sample.value = match sample.value {
                        SensorValue::Vector(v) => SensorValue::Vector(v - row.raw),
                        SensorValue::Attitude(R) => {
                            SensorValue::Attitude(R * UnitQuaternion::from_scaled_axis(-row.raw))
                        }
                        SensorValue::Direction {
                            seen_B,
                            reference_N,
                            normal_B,
                        } => SensorValue::Direction {
                            seen_B: seen_B - across(&normal_B).transpose() * row.raw,
                            reference_N,
                            normal_B,
                        },
                    };
                }
            }
        }
    }
    Some(())
}
