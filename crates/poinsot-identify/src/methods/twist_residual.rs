//! Measured base twist against the one that the answer's momentum gives, sample by sample.

use crate::problem::parameters::{Parameters, UnknownKind};
use crate::problem::segment::Segment;
use crate::solution::estimate::ChannelFit;
use poinsot_dynamics::{
    Kinematics, Tree, composite, momentum, shift_to_body, twist_from_momentum, wheel_momentum,
};
use poinsot_spatial::Vector3;

/// Root mean squares of one segment, from the momentum at its first sample about the inertial origin
/// without thrust in between; empty where thrusters fire (the whitened chi-square covers them).
pub(crate) fn twist(
    parameters: &Parameters,
    x: &[f64],
    tree: &Tree,
    spin_inertia: &[f64],
    (segment, gyro_sensor): (&Segment, Option<usize>),
    start: (Vector3, Vector3),
) -> Vec<ChannelFit> {
    if !segment.firings.is_empty() {
        return Vec::new();
    }
    let s = &segment.samples;
    let (dof, wheels) = (tree.dof(), tree.rotors.len());
    let bodies = parameters.bodies(x);
    let gyro = parameters.sensor_errors(x, gyro_sensor);
    let mut spin = spin_inertia.to_vec();
    for (unknown, value) in parameters.unknowns.iter().zip(x) {
        if let UnknownKind::SpinInertia(k) = unknown.kind {
            spin[k] = *value;
        }
    }
    let mut kinematics = Kinematics::new(tree);
    let (mut rate, mut velocity) = (0.0, 0.0);
    for k in 0..s.time_s.len() {
        kinematics.place(tree, &s.joint_position[k * dof..(k + 1) * dof]);
        let rates = &s.joint_rate[k * dof..(k + 1) * dof];
        let zero = Vector3::zeros();
        kinematics.set_velocities(tree, &zero, &zero, rates);
        let joints = momentum(&bodies, &kinematics);
        let speed = &s.wheel_speed[k * wheels..(k + 1) * wheels];
        let h_wheels = wheel_momentum(tree, &kinematics, &spin, speed);
        let whole = composite(&bodies, &kinematics);
        let p = s.translation.as_ref().map_or(zero, |t| t.p_NoBo_N[k]);
        let (l, mut h) = shift_to_body(&s.R_NB[k], &p, &start.0, &start.1);
        if s.translation.is_none() {
            // Only rotation is seen: momentum about the mass centre, moved to the base origin.
            h += whole.p_BoScm_B().cross(&l);
        }
        let Some(twist) = twist_from_momentum(
            &whole,
            &l,
            &h,
            &joints.fixed_rows::<3>(0).into(),
            &(joints.fixed_rows::<3>(3) + h_wheels),
        ) else {
            return Vec::new();
        };
        rate += (s.w_NB_B[k] - gyro.bias - twist.w).norm_squared();
        if let Some(t) = &s.translation {
            velocity += (s.R_NB[k].inverse() * t.v_NBo_N[k] - twist.v).norm_squared();
        }
    }
    let count = 3.0 * s.time_s.len().max(1) as f64;
    let channel = |name: &str, unit, square: f64| ChannelFit {
        name: name.to_owned(),
        unit,
        rms: (square / count).sqrt(),
        ..ChannelFit::default()
    };
    let mut channels = vec![channel("gyro", "rad/s", rate)];
    if s.translation.is_some() {
        channels.push(channel("velocity", "m/s", velocity));
    }
    channels
}
