//! The linear method on the draws of the two steps.

use super::experiment::Run;
use super::noise::{Errors, SEEDS, Sigma};
use crate::ma2008::Raw;
use poinsot_dynamics::Tree;
use poinsot_identify::{
    Estimate, Noise, Observations, Problem, Samples, Segment, SensorRecord, SensorValue, TENSOR,
    Translation, linear,
};
use poinsot_model::{MomentumKnowledge, SensorKind};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// Trials of runs with more than ten samples.
const FEW: u64 = 30;
/// Accuracy limit at which everything counts as identified, because only errors are compared.
const ANY_ACCURACY: f64 = 1.0e6;
/// Sigma of the attitude, rad; practically exact.
const EXACT: f64 = 1.0e-7;

/// Errors of the linear method in many trials; trials without an answer are left out.
pub fn linear_trials(run: &Run, sigma: Sigma, known: bool) -> Vec<Errors> {
    let one = |seed| {
        let found = answer(run, &run.noisy(sigma, seed), sigma, known)?;
        Some(run.errors(Some(properties(&found)?)))
    };
    let seeds = if run.raws.len() > 10 { FEW } else { SEEDS };
    (0..seeds).filter_map(one).collect()
}

/// A run for the linear method, with the exact position of the base, which the two steps do not use.
fn segment(run: &Run, raws: &[Raw], noise: &Noise) -> Segment {
    let of = |kind, covariance, value: fn(&Raw) -> SensorValue| {
        SensorRecord::of_base(kind, covariance).at_every_time(raws.iter().map(value))
    };
    let joint_position: Vec<f64> = raws.iter().flat_map(|r| r.q.clone()).collect();
    let joint_rate: Vec<f64> = raws.iter().flat_map(|r| r.rates.clone()).collect();
    Segment {
        label: "study".to_owned(),
        samples: Samples {
            time_s: run.times.clone(),
            R_NB: raws.iter().map(|r| r.R_NB).collect(),
            w_NB_B: raws.iter().map(|r| r.w_NB_B).collect(),
            translation: Some(Translation {
                v_NBo_N: raws.iter().map(|r| r.v_NBo_N).collect(),
                p_NoBo_N: run.positions.iter().map(|p| p - run.positions[0]).collect(),
            }),
            joint_position: joint_position.clone(),
            joint_rate: joint_rate.clone(),
            wheel_speed: Vec::new(),
        },
        firings: Vec::new(),
        accelerations: None,
        observations: Observations {
            time_s: run.times.clone(),
            sensors: vec![
                of(SensorKind::Gyro, noise.gyro, |r| {
                    SensorValue::Vector(r.w_NB_B)
                }),
                of(SensorKind::Attitude, noise.attitude, |r| {
                    SensorValue::Attitude(r.R_NB)
                }),
                of(SensorKind::Velocity, noise.velocity, |r| {
                    SensorValue::Vector(r.v_NBo_N)
                }),
            ],
            joint_position,
            joint_rate,
            ..Observations::default()
        },
    }
}

/// Noise of the two velocities; all else is exact.
fn noise(sigma: Sigma) -> Noise {
    let square = |s: Vector3| Matrix3::from_diagonal(&s.component_mul(&s));
    Noise {
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
    }
}

/// The linear method for one draw.
fn answer(run: &Run, raws: &[Raw], sigma: Sigma, known: bool) -> Option<Estimate> {
    let mut model = run.model.clone();
    if known {
        model.momentum.linear = MomentumKnowledge::Known(run.known.p_C_N);
        model.momentum.angular = MomentumKnowledge::Known(run.known.h_C_N);
    }
    let tree = Tree::new(&model);
    let noise = noise(sigma);
    linear(&Problem {
        model: &model,
        tree: &tree,
        segments: &[segment(run, raws, &noise)],
        noise: &noise,
        relative_accuracy: ANY_ACCURACY,
    })
    .ok()
}

/// Mass properties of an answer, if complete.
fn properties(e: &Estimate) -> Option<MassProperties> {
    let b = e.bodies.first()?;
    let mut I = Matrix3::zeros();
    for (n, (i, j)) in b.inertia.iter().zip(TENSOR) {
        I[(i, j)] = n.value?;
        I[(j, i)] = n.value?;
    }
    Some(MassProperties {
        mass: b.mass.value?,
        p_BoBcm_B: Vector3::new(b.com[0].value?, b.com[1].value?, b.com[2].value?),
        I_BBcm_B: I,
    })
}
