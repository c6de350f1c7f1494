//! Momentum and kinetic energy of a tree of bodies by definition.
//!
//! The path of every body to the base is followed separately, in inertial axes: pose, velocity, then the sums of `m v`
//! and `r x m v + I w`. The cost is quadratic in the number of bodies.
//!
//! A tree is a slice of [`KitBody`]; body 0 is the base, every other body comes after its parent. The child frame has
//! the pose `Trans(p_PoCo_P) R_PC_zero Rot(axis, q)` in its parent (prismatic:
//! `Trans(p_PoCo_P + R_PC_zero axis q) R_PC_zero`).
//!
//! A [`KitWheel`] is an axisymmetric rotor; mass and inertia of the locked rotor are part of its host body. It adds
//! `Js Omega a` with the speed `Omega` relative to the host.

use crate::{Matrix3, Matrix6, Vector3, Vector6, turn};
use serde::Deserialize;

/// Joint between a body and its parent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum KitJoint {
    /// The free base: no parent.
    Base,
    /// Rotation about the axis, rad.
    Revolute,
    /// Translation along the axis, m.
    Prismatic,
    /// Rigid, without an entry in `q`.
    Fixed,
}

/// A rigid body C and the joint to its parent P.
#[derive(Debug, Clone, PartialEq)]
pub struct KitBody {
    /// Index of the parent, smaller than the body's own; ignored for the base.
    pub parent: usize,
    /// The joint to the parent.
    pub joint: KitJoint,
    /// Origin of C in P at joint zero, m.
    pub p_PoCo_P: Vector3,
    /// Attitude of C in P at joint zero.
    pub R_PC_zero: Matrix3,
    /// Unit joint axis, in C.
    pub axis_C: Vector3,
    /// Mass, kg.
    pub mass: f64,
    /// Mass centre from the origin of C, in C, m.
    pub p_CoCcm_C: Vector3,
    /// Inertia tensor about the mass centre, in C, tensor elements, kg m2.
    pub I_CCcm_C: Matrix3,
}

/// A wheel on a body.
#[derive(Debug, Clone, PartialEq)]
pub struct KitWheel {
    /// Index of the host body.
    pub host: usize,
    /// Unit spin axis, in the host.
    pub axis_C: Vector3,
    /// Spin inertia Js, kg m2.
    pub spin_inertia: f64,
}

/// State for which the sums are computed.
#[derive(Debug, Clone, PartialEq)]
pub struct KitState {
    /// Attitude of the base.
    pub R_NB: Matrix3,
    /// Origin of the base, m.
    pub p_NBo_N: Vector3,
    /// Velocity of the base origin in N, in base axes, m/s.
    pub v_NBo_B: Vector3,
    /// Angular velocity of the base in N, in base axes, rad/s.
    pub w_NB_B: Vector3,
    /// Joint positions, one for every revolute or prismatic joint in the order of the bodies.
    pub q: Vec<f64>,
    /// Joint rates.
    pub qd: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s, one per wheel.
    pub wheel_speeds: Vec<f64>,
}

/// Pose and velocity of body C, all in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyMotion {
    /// Attitude of C.
    pub R_NC: Matrix3,
    /// Origin of C, m.
    pub p_NCo_N: Vector3,
    /// Velocity of the origin of C, m/s.
    pub v_NCo_N: Vector3,
    /// Angular velocity of C, rad/s.
    pub w_NC_N: Vector3,
    /// Mass centre of C, m.
    pub p_NCcm_N: Vector3,
    /// Velocity of the mass centre of C, m/s.
    pub v_NCcm_N: Vector3,
}

/// The sums over the system S, in N, and the magnitudes of their terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SystemMomentum {
    /// Total mass, kg.
    pub mass: f64,
    /// Mass centre of the system, m.
    pub p_NScm_N: Vector3,
    /// Linear momentum, kg m/s.
    pub l_S_N: Vector3,
    /// Angular momentum about the system's mass centre, kg m2/s.
    pub h_SScm_N: Vector3,
    /// Sum of `m |p| / mass`: round-off in `p_NScm_N` is relative to it.
    pub scale_p: f64,
    /// Sum of `m |v|`.
    pub scale_l: f64,
    /// Sum of `m |r| |v| + |I| |w| + Js |Omega|`, arms from the mass centre.
    pub scale_h: f64,
}

/// Index of the joint of body `index` in `q`, or `None` if it does not move.
fn coordinate(bodies: &[KitBody], index: usize) -> Option<usize> {
    let moves = |body: &KitBody| matches!(body.joint, KitJoint::Revolute | KitJoint::Prismatic);
    moves(&bodies[index]).then(|| bodies[..index].iter().filter(|b| moves(b)).count())
}

/// Pose and velocity of body `index`, from its path to the base.
///
/// # Panics
/// If an index, `q` or `qd` does not match the bodies.
pub fn body_motion(bodies: &[KitBody], state: &KitState, index: usize) -> BodyMotion {
    let body = &bodies[index];
    let (R_NC, p_NCo_N, v_NCo_N, w_NC_N);
    if body.joint == KitJoint::Base {
        R_NC = state.R_NB;
        p_NCo_N = state.p_NBo_N;
        v_NCo_N = state.R_NB * state.v_NBo_B;
        w_NC_N = state.R_NB * state.w_NB_B;
    } else {
        let parent = body_motion(bodies, state, body.parent);
        let (q, qd) = coordinate(bodies, index).map_or((0.0, 0.0), |k| (state.q[k], state.qd[k]));
        let (angle, slide) = match body.joint {
            KitJoint::Prismatic => (0.0, q),
            _ => (q, 0.0),
        };
        let R_NZ = parent.R_NC * body.R_PC_zero; // C at joint zero; the rotation leaves the axis unchanged
        let axis_N = R_NZ * body.axis_C;
        R_NC = R_NZ * turn(body.axis_C * angle);
        p_NCo_N = parent.p_NCo_N + parent.R_NC * body.p_PoCo_P + axis_N * slide;
        let carried = parent.v_NCo_N + parent.w_NC_N.cross(&(p_NCo_N - parent.p_NCo_N));
        if body.joint == KitJoint::Prismatic {
            v_NCo_N = carried + axis_N * qd;
            w_NC_N = parent.w_NC_N;
        } else {
            v_NCo_N = carried;
            w_NC_N = parent.w_NC_N + axis_N * qd;
        }
    }
    let arm_N = R_NC * body.p_CoCcm_C;
    BodyMotion {
        R_NC,
        p_NCo_N,
        v_NCo_N,
        w_NC_N,
        p_NCcm_N: p_NCo_N + arm_N,
        v_NCcm_N: v_NCo_N + w_NC_N.cross(&arm_N),
    }
}

/// Angular momentum of one body about its mass centre, in N: `R I R^T w`.
fn spin_N(body: &KitBody, motion: &BodyMotion) -> Vector3 {
    motion.R_NC * (body.I_CCcm_C * (motion.R_NC.transpose() * motion.w_NC_N))
}

/// Linear momentum of the system in N: the sum of `m v`, kg m/s.
pub fn linear_momentum(bodies: &[KitBody], state: &KitState) -> Vector3 {
    (0..bodies.len())
        .map(|i| bodies[i].mass * body_motion(bodies, state, i).v_NCcm_N)
        .sum()
}

/// Angular momentum of the system about the point at `p_NP_N` (at rest in N), in N:
/// the sum of `r x m v + R I R^T w` over the bodies and `Js Omega a` over the wheels, kg m2/s.
pub fn angular_momentum_about(
    bodies: &[KitBody],
    wheels: &[KitWheel],
    state: &KitState,
    p_NP_N: &Vector3,
) -> Vector3 {
    let bodies_part: Vector3 = (0..bodies.len())
        .map(|i| {
            let motion = body_motion(bodies, state, i);
            let arm = motion.p_NCcm_N - p_NP_N;
            arm.cross(&(bodies[i].mass * motion.v_NCcm_N)) + spin_N(&bodies[i], &motion)
        })
        .sum();
    let wheels_part: Vector3 = wheels
        .iter()
        .zip(&state.wheel_speeds)
        .map(|(wheel, speed)| {
            let R_NC = body_motion(bodies, state, wheel.host).R_NC;
            R_NC * wheel.axis_C * (wheel.spin_inertia * speed)
        })
        .sum();
    bodies_part + wheels_part
}

/// Mass, mass centre and both momenta of the system; `None` without mass.
pub fn system_momentum(
    bodies: &[KitBody],
    wheels: &[KitWheel],
    state: &KitState,
) -> Option<SystemMomentum> {
    let motions: Vec<BodyMotion> = (0..bodies.len())
        .map(|i| body_motion(bodies, state, i))
        .collect();
    let mass: f64 = bodies.iter().map(|b| b.mass).sum();
    if mass.is_nan() || mass <= 0.0 {
        return None;
    }
    let both = || bodies.iter().zip(&motions);
    let p_NScm_N = both().map(|(b, m)| b.mass * m.p_NCcm_N).sum::<Vector3>() / mass;
    let l_S_N = linear_momentum(bodies, state);
    // The system velocity cancels in the sum about the mass centre, but leaves round-off. Velocities are therefore
    // taken relative to the mass centre.
    let mut relative = state.clone();
    relative.v_NBo_B -= state.R_NB.transpose() * (l_S_N / mass);
    let h_SScm_N = angular_momentum_about(bodies, wheels, &relative, &p_NScm_N);
    let wheel_scale: f64 = wheels
        .iter()
        .zip(&state.wheel_speeds)
        .map(|(w, speed)| w.spin_inertia * speed.abs())
        .sum();
    Some(SystemMomentum {
        mass,
        p_NScm_N,
        l_S_N,
        h_SScm_N,
        scale_p: both().map(|(b, m)| b.mass * m.p_NCcm_N.norm()).sum::<f64>() / mass,
        scale_l: both().map(|(b, m)| b.mass * m.v_NCcm_N.norm()).sum(),
        scale_h: wheel_scale
            + both()
                .map(|(b, m)| {
                    let arm = m.p_NCcm_N - p_NScm_N;
                    b.mass * arm.norm() * m.v_NCcm_N.norm() + b.I_CCcm_C.norm() * m.w_NC_N.norm()
                })
                .sum::<f64>(),
    })
}

/// Momentum `[l; h]` about the base origin, in base axes, for comparison with the regressor.
pub fn momentum_about_base(bodies: &[KitBody], wheels: &[KitWheel], state: &KitState) -> Vector6 {
    let l_N = linear_momentum(bodies, state);
    let h_N = angular_momentum_about(bodies, wheels, state, &state.p_NBo_N);
    let R_BN = state.R_NB.transpose();
    let (l, h) = (R_BN * l_N, R_BN * h_N);
    Vector6::new(l.x, l.y, l.z, h.x, h.y, h.z)
}

/// The locked inertia `H` about the base origin in base axes, `[l; h] = H [v; w]` with joints and wheels
/// at rest: column by column, the momentum of a unit twist of the base.
pub fn locked_inertia(bodies: &[KitBody], state: &KitState) -> Matrix6 {
    let mut still = state.clone();
    still.qd.fill(0.0);
    still.wheel_speeds.clear();
    let column = |k: usize| {
        let mut unit = Vector6::zeros();
        unit[k] = 1.0;
        let mut state = still.clone();
        state.v_NBo_B = unit.fixed_rows::<3>(0).into_owned();
        state.w_NB_B = unit.fixed_rows::<3>(3).into_owned();
        momentum_about_base(bodies, &[], &state)
    };
    Matrix6::from_columns(&[0, 1, 2, 3, 4, 5].map(column))
}

/// Kinetic energy, J: the sum of `m v.v/2 + w.I w/2` over the bodies and, for wheels,
/// `Js Omega a.w + Js Omega^2/2` (the host holds the part of the locked rotor).
pub fn kinetic_energy(bodies: &[KitBody], wheels: &[KitWheel], state: &KitState) -> f64 {
    let bodies_part: f64 = (0..bodies.len())
        .map(|i| {
            let motion = body_motion(bodies, state, i);
            0.5 * bodies[i].mass * motion.v_NCcm_N.norm_squared()
                + 0.5 * motion.w_NC_N.dot(&spin_N(&bodies[i], &motion))
        })
        .sum();
    let wheels_part: f64 = wheels
        .iter()
        .zip(&state.wheel_speeds)
        .map(|(wheel, speed)| {
            let motion = body_motion(bodies, state, wheel.host);
            let along = (motion.R_NC * wheel.axis_C).dot(&motion.w_NC_N);
            wheel.spin_inertia * speed * (along + 0.5 * speed)
        })
        .sum();
    bodies_part + wheels_part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{apart, scalars_apart};

    fn base(mass: f64) -> KitBody {
        KitBody {
            parent: 0,
            joint: KitJoint::Base,
            p_PoCo_P: Vector3::zeros(),
            R_PC_zero: Matrix3::identity(),
            axis_C: Vector3::z(),
            mass,
            p_CoCcm_C: Vector3::new(0.1, -0.2, 0.3),
            I_CCcm_C: Matrix3::new(3.0, 0.2, -0.1, 0.2, 4.0, 0.3, -0.1, 0.3, 5.0),
        }
    }

    fn state() -> KitState {
        KitState {
            R_NB: turn(Vector3::new(0.4, -0.9, 1.3)),
            p_NBo_N: Vector3::new(1.0, -2.0, 0.5),
            v_NBo_B: Vector3::new(0.3, 0.2, -0.7),
            w_NB_B: Vector3::new(-0.5, 0.8, 0.1),
            q: vec![],
            qd: vec![],
            wheel_speeds: vec![],
        }
    }

    #[test]
    fn exact_wheel_is_a_spinning_axisymmetric_body() {
        // The rotor as a separate body on a revolute joint, off-centre and tilted ...
        let tilt = turn(Vector3::new(0.7, 0.2, -0.4));
        let axis_C = Vector3::z();
        let rotor = KitBody {
            joint: KitJoint::Revolute,
            p_PoCo_P: Vector3::new(0.4, 0.1, -0.3),
            R_PC_zero: tilt,
            axis_C,
            mass: 2.0,
            p_CoCcm_C: Vector3::new(0.0, 0.0, 0.05),
            I_CCcm_C: Matrix3::from_diagonal(&Vector3::new(0.03, 0.03, 0.05)),
            ..base(0.0)
        };
        let spinning = KitState {
            q: vec![0.9],
            qd: vec![31.0],
            ..state()
        };
        let two = [base(10.0), rotor.clone()];
        // ... and as a wheel on a fixed body that includes the locked rotor.
        let locked = KitBody {
            joint: KitJoint::Fixed,
            ..rotor
        };
        let one = [base(10.0), locked];
        let wheel = [KitWheel {
            host: 1,
            axis_C,
            spin_inertia: 0.05,
        }];
        let with_wheel = KitState {
            wheel_speeds: vec![31.0],
            ..state()
        };
        let a = system_momentum(&two, &[], &spinning).unwrap();
        let b = system_momentum(&one, &wheel, &with_wheel).unwrap();
        assert!(apart(&a.l_S_N, &b.l_S_N, a.scale_l) < 1e-15);
        assert!(apart(&a.h_SScm_N, &b.h_SScm_N, a.scale_h) < 1e-15);
        let about = momentum_about_base(&two, &[], &spinning);
        assert!(
            apart(
                &about,
                &momentum_about_base(&one, &wheel, &with_wheel),
                about.norm()
            ) < 1e-15
        );
        let (ta, tb) = (
            kinetic_energy(&two, &[], &spinning),
            kinetic_energy(&one, &wheel, &with_wheel),
        );
        assert!(scalars_apart(ta, tb, ta) < 1e-15);
    }

    #[test]
    fn exact_one_body_by_hand() {
        let bodies = [base(2.0)];
        let still = KitState {
            R_NB: Matrix3::identity(),
            p_NBo_N: Vector3::zeros(),
            v_NBo_B: Vector3::new(1.0, 0.0, 0.0),
            w_NB_B: Vector3::new(0.0, 0.0, 2.0),
            ..state()
        };
        // v_cm = (1, 0, 0) + 2 z x (0.1, -0.2, 0.3) = (1.4, 0.2, 0).
        let s = system_momentum(&bodies, &[], &still).unwrap();
        assert!((s.l_S_N - Vector3::new(2.8, 0.4, 0.0)).norm() < 1e-15);
        assert!((s.h_SScm_N - Vector3::new(-0.2, 0.6, 10.0)).norm() < 1e-15);
        let energy = kinetic_energy(&bodies, &[], &still);
        assert!((energy - (1.4 * 1.4 + 0.2 * 0.2 + 10.0)).abs() < 1e-14);
    }

    #[test]
    fn unit_no_mass_has_no_mass_centre() {
        assert!(system_momentum(&[base(0.0)], &[], &state()).is_none());
    }
}
