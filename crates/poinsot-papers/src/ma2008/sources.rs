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
    let axes = |covariance: &Matrix3| -> Vec<Vector3> {
        let e = SymmetricEigen::new(*covariance);
        (0..3)
            .filter(|&k| e.eigenvalues[k] > 0.0)
            .map(|k| e.eigenvectors.column(k) * e.eigenvalues[k].sqrt())
            .collect()
    };
    let scalars = |list: &[f64]| -> Vec<(usize, f64)> {
        list.iter()
            .enumerate()
            .filter(|(_, v)| **v > 0.0)
            .map(|(k, v)| (k, v.sqrt()))
            .collect()
    };
    let mut out = Vec::new();
    let rate = noise.seen_gyro;
    out.extend(
        axes(&noise.gyro)
            .into_iter()
            .map(|s| (Source::Rate(s), rate)),
    );
    let v = noise.seen_velocity;
    out.extend(
        axes(&noise.velocity)
            .into_iter()
            .filter(|_| velocity)
            .map(|s| (Source::Velocity(s), v)),
    );
    out.extend(
        axes(&noise.attitude)
            .into_iter()
            .map(|s| (Source::Attitude(s), v)),
    );
    out.extend(
        axes(&step.unwrap_or_default())
            .into_iter()
            .map(|s| (Source::VelocityStep(s), 1.0)),
    );
    let joint = noise.seen_joint_rate;
    for (k, s) in scalars(&noise.joint_position) {
        out.push((Source::JointPosition(k, s), joint));
    }
    for (k, s) in scalars(&noise.joint_rate) {
        out.push((Source::JointRate(k, s), joint));
    }
    for (k, s) in scalars(&noise.wheel_speed) {
        out.push((Source::WheelSpeed(k, s), joint));
    }
    out
}
