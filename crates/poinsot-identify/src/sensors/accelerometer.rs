//! Accelerometer: specific force at a point, in the axes of its body. It depends on input accelerations, so its
//! derivatives are not those over pose, twist and joints.

use super::{PredictedMeasurement, SpareVectors};
use crate::motion::input_noise::InputNoise;
use crate::motion::{BodyPoint, Instant, Motion, State};
use crate::problem::segment::{SensorRecord, SensorValue};

/// `None` where a thruster fires up to the end of the record.
pub(super) fn predict(
    record: &SensorRecord,
    motion: &Motion,
    (state, k): (&State, usize),
    instant: &Instant,
    inputs: &InputNoise,
    spare: &mut SpareVectors,
) -> Option<PredictedMeasurement> {
    if motion.thrust_after_unknown(k) {
        return None;
    }
    let point: BodyPoint = (record.body, record.p_BoS_B);
    let (mut columns, mut errors) = (spare.take(), spare.take());
    let force = motion.specific_force((state, k), instant, &point, &mut columns);
    inputs.force_slopes(motion, (state, k), instant, &point, &mut errors);
    Some(PredictedMeasurement {
        value: SensorValue::Vector(force),
        rate: None,
        columns,
        errors,
    })
}
