//! Measurement models: one file a kind, one interface.
//!
//! A kind gives the ideal measurement at an instant, and its derivatives over pose, base twist and joints
//! ([`IdealMeasurement`]: `h`, `H_x`, `H_u`). [`predict`] converts them to derivatives over every unknown and every
//! input error. Sensor errors (`H_theta`) are added by one model for all: [`SensorErrors`].

mod accelerometer;
mod attitude;
mod direction;
mod gyro;
mod ideal;
mod position;
mod relative;
mod velocity;

pub(crate) use direction::across;
pub(crate) use ideal::IdealSeries;

use crate::motion::input_noise::InputNoise;
use crate::motion::{Column, Instant, Motion, PointKinematics, State, matrix, small_rotation};
use crate::problem::segment::{SensorRecord, SensorValue};
use nalgebra::SMatrix;
use poinsot_dynamics::SensorErrors;
use poinsot_model::SensorKind;
use poinsot_spatial::{Matrix3, Vector3, Vector6};

/// Ideal measurement at an instant.
pub(crate) struct IdealMeasurement {
    pub value: SensorValue,
    /// Its rate of change, if the state determines it.
    pub rate: Option<Vector3>,
    pub slopes: MeasurementJacobian,
}

/// Slopes of a reading; of an attitude, of the small turn in the axes of the sensor's body.
#[derive(Default)]
pub(crate) struct MeasurementJacobian {
    /// Over `[dphi_B, dp_N]` of the base.
    pub pose: SMatrix<f64, 3, 6>,
    /// Over `[dv_NBo_B, dw_NB_B]`.
    pub twist: SMatrix<f64, 3, 6>,
    /// Over joints, all else held; sorted by joint.
    pub joints: Vec<JointSlope>,
}

/// Joint, slope over its position, slope over its rate.
type JointSlope = (usize, Vector3, Vector3);

impl MeasurementJacobian {
    fn new(pose: [&Matrix3; 2], twist: [&Matrix3; 2]) -> Self {
        let side_by_side = |[a, b]: [&Matrix3; 2]| {
            let mut both = SMatrix::<f64, 3, 6>::zeros();
            both.fixed_view_mut::<3, 3>(0, 0).copy_from(a);
            both.fixed_view_mut::<3, 3>(0, 3).copy_from(b);
            both
        };
        Self {
            pose: side_by_side(pose),
            twist: side_by_side(twist),
            joints: Vec::new(),
        }
    }

    /// Changes of the reading with changes of state and base twist. Most kinds depend on one of the two alone.
    fn along<'a>(
        &self,
        changes: impl Iterator<Item = (&'a Column, &'a Vector6)>,
        mut out: Vec<Vector3>,
    ) -> Vec<Vector3> {
        let nothing = SMatrix::<f64, 3, 6>::zeros();
        let (pose, twist) = (&self.pose, &self.twist);
        match (*pose == nothing, *twist == nothing) {
            (true, _) => out.extend(changes.map(|(_, V)| twist * V)),
            (_, true) => out.extend(changes.map(|(x, _)| pose * x.fixed_rows::<6>(0))),
            _ => out.extend(changes.map(|(x, V)| pose * x.fixed_rows::<6>(0) + twist * V)),
        }
        out
    }
}

/// Lists that were used and may be filled anew.
#[derive(Default)]
pub(crate) struct SpareVectors {
    lists: Vec<Vec<Vector3>>,
    joints: Vec<JointSlope>,
}

impl SpareVectors {
    /// An empty list.
    pub fn take(&mut self) -> Vec<Vector3> {
        self.lists.pop().unwrap_or_default()
    }

    pub fn give_back(&mut self, mut list: Vec<Vector3>) {
        list.clear();
        self.lists.push(list);
    }

    /// An empty list of slopes over joints; there is one.
    fn take_joints(&mut self) -> Vec<JointSlope> {
        let mut joints = std::mem::take(&mut self.joints);
        joints.clear();
        joints
    }
}

/// Ideal measurement at a grid time, with its derivatives.
pub(crate) struct PredictedMeasurement {
    pub value: SensorValue,
    /// Its rate of change, if the state determines it.
    pub rate: Option<Vector3>,
    /// Change with every sensitivity column.
    pub columns: Vec<Vector3>,
    /// Change with every error in the state of the inputs' filter.
    pub errors: Vec<Vector3>,
    /// Change with the rate of every joint, where the filter does not know the errors of rates.
    pub gains: Vec<Vector3>,
}

impl PredictedMeasurement {
    /// The value to which the error model applies: an attitude's errors are rotations from the true one.
    pub fn vector(&self) -> Vector3 {
        vector(&self.value)
    }

    /// Measured less predicted by a sensor with these errors.
    pub fn residual(
        &self,
        measured: &SensorValue,
        errors: &SensorErrors,
        rate: &Vector3,
    ) -> Vector3 {
        let x = self.vector();
        measurement_error(&self.value, measured) - (errors.reading(&x, rate) - x)
    }
}

/// The value to which the error model applies.
pub(crate) fn vector(value: &SensorValue) -> Vector3 {
    match value {
        SensorValue::Vector(x) => *x,
        SensorValue::Attitude(_) => Vector3::zeros(),
        SensorValue::Direction { seen_B, .. } => *seen_B,
    }
}

/// Measured less true; of attitudes the small turn from the true one, in its axes.
pub(crate) fn measurement_error(truth: &SensorValue, measured: &SensorValue) -> Vector3 {
    match (truth, measured) {
        (SensorValue::Vector(x), SensorValue::Vector(y)) => y - x,
        (SensorValue::Vector(x), SensorValue::Direction { seen_B, .. }) => seen_B - x,
        (SensorValue::Attitude(R), SensorValue::Attitude(S)) => small_rotation(R, S),
        // A record of mixed values has no meaning.
        _ => Vector3::from_element(f64::NAN),
    }
}

/// Ideal measurement of the pose or its rate; of an increment, the velocity. `None` for an accelerometer, whose
/// measurement is no function of pose, twist and joints.
fn measure(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
    joints: Vec<JointSlope>,
) -> Option<IdealMeasurement> {
    if record.kind == SensorKind::Accelerometer {
        return None;
    }
    let place = motion.place(&instant.twist, (record.body, &record.p_BoS_B));
    let R_NB = matrix(&state.R_NB);
    let seen = match record.kind {
        SensorKind::Gyro => Some(gyro::measure(&place, joints)),
        SensorKind::Attitude => Some(attitude::measure(&place, state, record.body, joints)),
        SensorKind::Direction => record
            .reference_N(k)
            .and_then(|d_N| direction::measure(&place, state, (record.body, &d_N), joints)),
        SensorKind::Position => Some(position::measure(&place, state, &R_NB, joints)),
        SensorKind::RelativeAttitude | SensorKind::RelativePosition => {
            let from = motion.place(&instant.twist, (record.seen_from, &Vector3::zeros()));
            let seen = match record.kind {
                SensorKind::RelativeAttitude => relative::attitude(&place, &from, joints),
                _ => relative::position(&place, &from, joints),
            };
            motion.leave(from);
            Some(seen)
        }
        SensorKind::Velocity | SensorKind::VelocityIncrement => {
            Some(velocity::measure(&place, &R_NB, joints))
        }
        _ => None,
    };
    motion.leave(place);
    seen
}

/// Ideal measurement at grid time k, and its rate if the state determines it.
pub(crate) fn ideal_measurement(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
) -> (SensorValue, Option<Vector3>) {
    match measure(record, motion, (state, k), instant, Vec::new()) {
        Some(seen) => (seen.value, seen.rate),
        None => {
            let force = accelerometer::value(record, motion, (state, k), instant);
            (SensorValue::Vector(force), None)
        }
    }
}

/// Ideal measurement at grid time k with its derivatives; `None` if it is unknown.
pub(crate) fn predict(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
    inputs: &InputNoise,
    spare: &mut SpareVectors,
) -> Option<PredictedMeasurement> {
    let Some(IdealMeasurement {
        value,
        rate,
        slopes,
    }) = measure(record, motion, (state, k), instant, spare.take_joints())
    else {
        return accelerometer::predict(record, motion, (state, k), instant, inputs, spare);
    };
    let mut columns = slopes.along(motion.sensitivities(), spare.take());
    let mut errors = slopes.along(inputs.columns.iter().zip(&inputs.twists), spare.take());
    let mut gains = spare.take();
    gains.extend(inputs.rate_gain.iter().map(|gain| slopes.twist * gain));
    if !slopes.joints.is_empty() {
        let of = |joint: usize| {
            let found = slopes.joints.binary_search_by_key(&joint, |s| s.0);
            slopes.joints.get(found.ok()?)
        };
        if !columns.is_empty() {
            for (column, joint, dq, drate) in motion.joint_changes() {
                if let Some((_, position, rate)) = of(joint) {
                    columns[column] += position * dq + rate * drate;
                }
            }
        }
        for (at, joint, dq, drate) in inputs.at_once(k) {
            if let Some((_, position, rate)) = of(joint) {
                errors[at] += position * dq + rate * drate;
            }
        }
        for (joint, _, rate) in &slopes.joints {
            if let Some(gain) = gains.get_mut(*joint) {
                *gain += rate;
            }
        }
    }
    spare.joints = slopes.joints;
    Some(PredictedMeasurement {
        value,
        rate,
        columns,
        errors,
        gains,
    })
}

/// `[a]x` applied from the right: `M [a]x`.
fn times_skew(M: &Matrix3, a: &Vector3) -> Matrix3 {
    M * poinsot_spatial::skew(a)
}

/// The joints' part of slopes, in an empty list.
fn joints(
    place: &PointKinematics,
    mut list: Vec<JointSlope>,
    of: impl Fn(&crate::motion::JointEffect) -> (Vector3, Vector3),
) -> Vec<JointSlope> {
    list.extend(place.joints.iter().map(|joint| {
        let (position, rate) = of(joint);
        (joint.joint, position, rate)
    }));
    list
}
