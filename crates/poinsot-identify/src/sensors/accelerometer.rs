//! Accelerometer: specific force at a point, in the axes of its body. It depends on input accelerations, so its
//! derivatives are not those over pose, twist and joints.

use super::PredictedMeasurement;
use crate::motion::input_noise::InputNoise;
use crate::motion::{BodyPoint, Instant, Motion, State};
use crate::problem::segment::{SensorRecord, SensorValue};
use poinsot_spatial::Vector3;

pub(super) fn value(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
) -> Vector3 {
    let point: BodyPoint = (record.body, record.p_BoS_B);
    let forces = motion.specific_force(state, k, instant, &[point]);
    forces.first().map_or_else(Vector3::zeros, |f| f.value)
}

/// `None` where a thruster fires up to the end of the record.
pub(super) fn predict(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
    inputs: &InputNoise,
) -> Option<PredictedMeasurement> {
    if motion.thrust_after_unknown(k) {
        return None;
    }
    let point: BodyPoint = (record.body, record.p_BoS_B);
    let mut forces = motion.specific_force(state, k, instant, &[point]);
    let force = forces.pop()?;
    Some(PredictedMeasurement {
        value: SensorValue::Vector(force.value),
        rate: None,
        columns: force.columns,
        errors: inputs.force_slopes(motion, (state, k), instant, &point),
        gains: Vec::new(),
    })
}
