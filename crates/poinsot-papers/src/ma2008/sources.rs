//! The declared noise as independent errors of one sample.

use super::arm::Raw;
use nalgebra::SymmetricEigen;
use poinsot_identify::Noise;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// One independent error of one sample, one sigma.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Angular velocity, in B, rad/s.
    Rate(Vector3),
    /// Velocity, in N, m/s.
    Velocity(Vector3),
    /// Change of velocity since the previous sample, in N, m/s; it remains in all later samples.
    VelocityStep(Vector3),
    /// Attitude: a small rotation in B, rad.
    Attitude(Vector3),
    /// Position of a joint, rad or m.
    JointPosition(usize, f64),
    /// Rate of a joint.
    JointRate(usize, f64),
    /// Speed of a wheel, rad/s.
    WheelSpeed(usize, f64),
}

impl Source {
    pub(super) fn moved(&self, raw: &Raw, sign: f64) -> Raw {
        let mut raw = raw.clone();
        let push = |list: &mut Vec<f64>, k: usize, s: f64| {
            if let Some(x) = list.get_mut(k) {
                *x += sign * s;
            }
        };
        match *self {
            Self::Rate(s) => raw.w_NB_B += s * sign,
            Self::Velocity(s) | Self::VelocityStep(s) => raw.v_NBo_N += s * sign,
            Self::Attitude(s) => raw.R_NB *= UnitQuaternion::from_scaled_axis(s * sign),
            Self::JointPosition(k, s) => push(&mut raw.q, k, s),
            Self::JointRate(k, s) => push(&mut raw.rates, k, s),
            Self::WheelSpeed(k, s) => push(&mut raw.wheel_speed, k, s),
        }
        raw
    }
}

/// Independent one-sigma errors of one sample, with the fraction of their variance present in the data.
///
/// `velocity`: whether the segment measures velocity. `step`: covariance of velocity increments, whose noise is
/// assumed to be fully present.
pub(super) fn sources(noise: &Noise, velocity: bool, step: Option<Matrix3>) -> Vec<(Source, f64)> {
    let mut out = Vec::new();
    let mut axes = |covariance: &Matrix3, seen: f64, source: fn(Vector3) -> Source| {
        let e = SymmetricEigen::new(*covariance);
        let own = (0..3).filter(|&k| e.eigenvalues[k] > 0.0);
        let axis = |k: usize| e.eigenvectors.column(k) * e.eigenvalues[k].sqrt();
        out.extend(own.map(|k| (source(axis(k)), seen)));
    };
    let v = noise.seen_velocity;
    axes(&noise.gyro, noise.seen_gyro, Source::Rate);
    if velocity {
        axes(&noise.velocity, v, Source::Velocity);
    }
    axes(&noise.attitude, v, Source::Attitude);
    axes(&step.unwrap_or_default(), 1.0, Source::VelocityStep);
    let mut scalars = |variances: &[f64], source: fn(usize, f64) -> Source| {
        let own = variances.iter().enumerate().filter(|(_, v)| **v > 0.0);
        out.extend(own.map(|(k, v)| (source(k, v.sqrt()), noise.seen_joint_rate)));
    };
    scalars(&noise.joint_position, Source::JointPosition);
    scalars(&noise.joint_rate, Source::JointRate);
    scalars(&noise.wheel_speed, Source::WheelSpeed);
    out
}
