//! Ma, Dang and Pham 2008: both steps against closed forms, the paper, MuJoCo and statistics.
#![allow(clippy::needless_range_loop)]

mod equations;
mod estimates;
mod files;
mod increments;
mod trials;

use nalgebra::SVector;
use poinsot::case::read_case;
use poinsot::identify::{identify_tables, read_options};
use poinsot::simulate::simulate_case;
use poinsot::{IdentifyRequest, Question, identify};
use poinsot_dynamics::Tree;
use poinsot_identify::{Noise, Problem, Samples, Segment, Status, Translation};
use poinsot_model::{JointKind, Model, MomentumKnowledge, read_model};
use poinsot_papers::ma2008::bounds::{angular_error, bound, linear_error, sizes};
use poinsot_papers::ma2008::printed::{PrintedAxes, two_step_printed};
use poinsot_papers::ma2008::studies::experiment::{
    Experiment, Run, readings, scale_arm, unsymmetric,
};
use poinsot_papers::ma2008::{
    self, Known, Reading, TwoStep, Variant, Vehicle, angular_rows, linear_rows, two_step,
};
use poinsot_spatial::{MassProperties, Matrix3, UnitQuaternion, Vector3, elements};
use poinsot_telemetry::read;
use poinsot_testkit::momentum_sum::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::path::PathBuf;

/// The folder of shipped data.
fn shipped() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// The Table 1 system with its true numbers.
fn table1() -> Model {
    read_model(shipped().join("cases/ma2008_truth.toml")).unwrap()
}

/// The Table 1 system on one of the trajectories.
fn flown(trajectory: usize, spin_deg_s: [f64; 3]) -> Experiment {
    Experiment::new(&table1(), trajectory, spin_deg_s)
}

/// Largest error: mass relative, mass centre over 1 m, tensor relative to its norm.
fn error(answer: &TwoStep, truth: &MassProperties) -> f64 {
    let I = answer
        .I_S()
        .unwrap_or_else(|| Matrix3::from_element(f64::NAN));
    let m = (answer.mass() / truth.mass - 1.0).abs();
    let c = (answer.rho_S() - truth.p_BoBcm_B).norm();
    let i = (I - truth.I_BBcm_B).norm() / truth.I_BBcm_B.norm();
    if (m + c + i).is_nan() {
        f64::INFINITY
    } else {
        m.max(c).max(i)
    }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

fn vector(rng: &mut ChaCha8Rng) -> Vector3 {
    Vector3::from_fn(|_, _| normal(rng))
}

/// The samples with noise on both velocities, as a fraction of the largest component of each.
fn noisy(samples: &[Reading], share: f64, rng: &mut ChaCha8Rng) -> Vec<Reading> {
    let largest =
        |of: &dyn Fn(&Reading) -> Vector3| samples.iter().map(|s| of(s).amax()).fold(0.0, f64::max);
    let (v, w) = (largest(&|s| s.v_NBo_B), largest(&|s| s.w_NB_B));
    samples
        .iter()
        .map(|s| Reading {
            v_NBo_B: s.v_NBo_B + vector(rng) * (share * v),
            w_NB_B: s.w_NB_B + vector(rng) * (share * w),
            ..*s
        })
        .collect()
}

fn kit(model: &Model, raw: &ma2008::Raw, v_NBo_B: Vector3) -> (Vec<KitBody>, KitState) {
    let bodies = model.bodies.iter().map(|body| {
        let joint = body.joint.map(|j| &model.joints[j]);
        KitBody {
            parent: joint.map_or(0, |j| j.parent),
            joint: joint.map_or(KitJoint::Base, |j| match j.kind {
                JointKind::Revolute => KitJoint::Revolute,
                JointKind::Prismatic => KitJoint::Prismatic,
                JointKind::Fixed => KitJoint::Fixed,
            }),
            p_PoCo_P: joint.map_or(Vector3::zeros(), |j| j.p_PoCo_P),
            R_PC_zero: joint.map_or(Matrix3::identity(), |j| j.R_PC_zero),
            axis_C: joint.map_or(Vector3::z(), |j| j.axis_C),
            mass: body.nominal.mass,
            p_CoCcm_C: body.nominal.p_BoBcm_B,
            I_CCcm_C: body.nominal.I_BBcm_B,
        }
    });
    let state = KitState {
        R_NB: raw.R_NB.to_rotation_matrix().into_inner(),
        p_NBo_N: Vector3::new(0.3, 0.1, -0.2),
        v_NBo_B,
        w_NB_B: raw.w_NB_B,
        q: raw.q.clone(),
        qd: raw.rates.clone(),
        wheel_speeds: Vec::new(),
    };
    (bodies.collect(), state)
}
