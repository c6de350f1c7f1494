//! Predicted measurements: the models of `poinsot-dynamics` at the motion of the estimate.
//!
//! A kind gives the ideal measurement at an instant, and its derivatives over pose, base twist and joints
//! ([`SensorKind::measure`]: `h`, `H_x`, `H_u`). [`predict`] converts them to derivatives over every unknown and every
//! input error. Sensor errors (`H_theta`) are added by one model for all: [`SensorErrors`].

mod accelerometer;
mod direction;
mod ideal;
mod stream;

pub(crate) use direction::across;
pub(crate) use ideal::IdealSeries;
pub(crate) use stream::{DueSample, Predictor, SampleStream};

use crate::motion::input_noise::InputNoise;
use crate::motion::{BodyPoint, Column, Instant, Motion, PointKinematics, State, small_rotation};
use crate::problem::segment::{SensorRecord, SensorValue};
use nalgebra::SMatrix;
use poinsot_dynamics::{
    BasePose, Carried, Ideal, JointEffect, Measurement, OverJoint, Scene, SensorErrors,
};
use poinsot_model::SensorKind;
use poinsot_spatial::{Vector3, Vector6};

/// Ideal measurement at an instant, with its derivatives over joints, sorted by joint.
struct IdealMeasurement {
    measured: Measurement,
    joints: Vec<(usize, OverJoint)>,
}

impl IdealMeasurement {
    fn value(&self) -> SensorValue {
        match self.measured.value {
            Ideal::Vector(x) => SensorValue::Vector(x),
            Ideal::Rotation(R) => SensorValue::Attitude(R),
        }
    }

    /// Changes of the measurement with changes of state and base twist. Most kinds depend on one of the two alone.
    fn along<'a>(
        &self,
        changes: impl Iterator<Item = (&'a Column, &'a Vector6)>,
        mut out: Vec<Vector3>,
    ) -> Vec<Vector3> {
        let nothing = SMatrix::<f64, 3, 6>::zeros();
        let (pose, twist) = (&self.measured.pose, &self.measured.twist);
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
    joints: Vec<(usize, OverJoint)>,
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
    fn take_joints(&mut self) -> Vec<(usize, OverJoint)> {
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
/// measurement is no function of pose, twist and joints, and for a direction without reference.
fn measure(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
    mut joints: Vec<(usize, OverJoint)>,
) -> Option<IdealMeasurement> {
    if record.kind == SensorKind::Accelerometer {
        return None;
    }
    let place = motion.place(&instant.twist, (record.body, &record.p_BoS_B));
    let from = motion.place(&instant.twist, (record.seen_from, &Vector3::zeros()));
    let pose = BasePose {
        R_NB: state.R_NB,
        p_NoBo_N: state.p_NoBo_N,
    };
    let scene = Scene {
        pose: &pose,
        point: &place.point,
        from: &from.point,
        reference_N: record.reference_N(k),
        a_NP_B: None,
    };
    let measured = record.kind.measure(&scene);
    let over = |(joint, effect)| Some((joint, record.kind.over_joint(&scene, effect)?));
    joints.extend(alone(&place, &from).filter_map(|(k, j)| over((k, Carried::Point(j)))));
    if record.kind.is_relative() {
        joints.extend(alone(&from, &place).filter_map(|(k, j)| over((k, Carried::From(j)))));
        joints.sort_unstable_by_key(|joint| joint.0);
    }
    motion.leave(place);
    motion.leave(from);
    Some(IdealMeasurement {
        measured: measured?,
        joints,
    })
}

/// Joints that carry one body and not the other one.
fn alone<'a>(
    one: &'a PointKinematics,
    other: &'a PointKinematics,
) -> impl Iterator<Item = (usize, &'a JointEffect)> {
    let apart = |joint: usize| other.joints.binary_search_by_key(&joint, |j| j.0).is_err();
    let all = one.joints.iter().map(|(joint, effect)| (*joint, effect));
    all.filter(move |(joint, _)| apart(*joint))
}

/// Ideal measurement at grid time k, and its rate if the state determines it; `None` if it is unknown.
pub(crate) fn ideal_measurement(
    record: &SensorRecord,
    motion: &mut Motion,
    (state, k): (&State, usize),
    instant: &Instant,
) -> Option<(SensorValue, Option<Vector3>)> {
    if record.kind == SensorKind::Accelerometer {
        let point: BodyPoint = (record.body, record.p_BoS_B);
        let force = motion.specific_force((state, k), instant, &point, &mut Vec::new());
        return Some((SensorValue::Vector(force), None));
    }
    let seen = measure(record, motion, (state, k), instant, Vec::new())?;
    Some((seen.value(), seen.measured.rate))
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
    if record.kind == SensorKind::Accelerometer {
        return accelerometer::predict(record, motion, (state, k), instant, inputs, spare);
    }
    let seen = measure(record, motion, (state, k), instant, spare.take_joints())?;
    let mut columns = seen.along(motion.sensitivities(), spare.take());
    let mut errors = seen.along(inputs.columns.iter().zip(&inputs.twists), spare.take());
    if !seen.joints.is_empty() {
        let of = |joint: usize| {
            let found = seen.joints.binary_search_by_key(&joint, |s| s.0);
            Some(seen.joints.get(found.ok()?)?.1)
        };
        if !columns.is_empty() {
            for (column, joint, dq, drate) in motion.joint_changes() {
                if let Some(over) = of(joint) {
                    columns[column] += over.position * dq + over.rate * drate;
                }
            }
        }
        let swings = inputs.swings(motion).into_iter();
        for (at, joint, dq, drate) in inputs.at_once().chain(swings) {
            if let Some(over) = of(joint) {
                errors[at] += over.position * dq + over.rate * drate;
            }
        }
    }
    let predicted = PredictedMeasurement {
        value: seen.value(),
        rate: seen.measured.rate,
        columns,
        errors,
    };
    spare.joints = seen.joints;
    Some(predicted)
}
