//! The linear method on the draws of the two steps.

use super::experiment::{Run, Sigma};
use crate::ma2008::Raw;
use poinsot_dynamics::Tree;
use poinsot_identify::{
    Noise, Observations, Problem, Samples, Segment, SensorRecord, SensorValue, Translation, linear,
};
use poinsot_model::MomentumKnowledge;
use poinsot_model::SensorKind::{Attitude, Gyro, Velocity};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// Accuracy limit at which everything counts as identified, because only errors are compared.
const ANY_ACCURACY: f64 = 1.0e6;
/// Sigma of the attitude, rad; practically exact.
const EXACT: f64 = 1.0e-7;

/// The linear method for one draw of noise of the two velocities: all else is exact, with the position of the base, which
/// the two steps do not use. `None` without a complete answer.
pub fn answer(run: &Run, raws: &[Raw], sigma: Sigma, known: bool) -> Option<MassProperties> {
    let mut model = run.model.clone();
    if known {
        model.momentum.linear = MomentumKnowledge::Known(run.known.p_C_N);
        model.momentum.angular = MomentumKnowledge::Known(run.known.h_C_N);
    }
    let square = |s: Vector3| Matrix3::from_diagonal(&s.component_mul(&s));
    let noise = Noise {
        gyro_sensor: None,
        gyro: square(sigma.w),
        attitude: Matrix3::identity() * EXACT * EXACT,
        velocity: square(sigma.v),
        position: Matrix3::zeros(),
        joint_position: vec![0.0; 6],
        joint_rate: vec![0.0; 6],
        wheel_speed: Vec::new(),
        seen_gyro: 1.0,
        seen_velocity: 1.0,
        seen_joint_rate: 0.0,
    };
    let samples = Samples {
        time_s: run.times.clone(),
        R_NB: raws.iter().map(|r| r.R_NB).collect(),
        w_NB_B: raws.iter().map(|r| r.w_NB_B).collect(),
        translation: Some(Translation {
            v_NBo_N: raws.iter().map(|r| r.v_NBo_N).collect(),
            p_NoBo_N: run.positions.iter().map(|p| p - run.positions[0]).collect(),
        }),
        joint_position: raws.iter().flat_map(|r| r.q.clone()).collect(),
        joint_rate: raws.iter().flat_map(|r| r.rates.clone()).collect(),
        wheel_speed: Vec::new(),
    };
    let of = |kind, covariance, value: fn(&Raw) -> SensorValue| {
        SensorRecord::of_base(kind, covariance).at_every_time(raws.iter().map(value))
    };
    let observations = Observations {
        time_s: run.times.clone(),
        sensors: vec![
            of(Gyro, noise.gyro, |r| SensorValue::Vector(r.w_NB_B)),
            of(Attitude, noise.attitude, |r| SensorValue::Attitude(r.R_NB)),
            of(Velocity, noise.velocity, |r| SensorValue::Vector(r.v_NBo_N)),
        ],
        joint_position: samples.joint_position.clone(),
        joint_rate: samples.joint_rate.clone(),
        ..Observations::default()
    };
    let segment = Segment {
        label: "study".to_owned(),
        samples,
        observations,
        ..Segment::default()
    };
    let problem = Problem {
        model: &model,
        tree: &Tree::new(&model),
        segments: &[segment],
        noise: &noise,
        relative_accuracy: ANY_ACCURACY,
    };
    let found = linear(&problem).ok()?;
    let ten = found.bodies.first()?.numbers().map(|n| n.value);
    let complete = ten.iter().all(Option::is_some);
    complete.then(|| MassProperties::from_array(&ten.map(Option::unwrap_or_default)))
}
