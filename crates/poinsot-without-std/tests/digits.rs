//! The kernels give the same numbers with `std` and with `libm`: run by `scripts/test policy` for the second.
#![allow(non_snake_case)]

use nalgebra::{Rotation3, UnitQuaternion};
use poinsot_dynamics::propagation::{
    LockedVehicle, PoseMomentum, PoseMomentumRate, Rates, StepPoint, runge_kutta_step,
};
use poinsot_dynamics::{
    Accelerations, ForwardDynamics, InverseDynamics, JointInput, Kinematics, Link, MassMatrix,
    Motion, Orbit, Rotor, Tree, composite, momentum, momentum_regressor, orbit_state,
    wheel_momentum,
};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3, Vector6};
use std::path::Path;

/// A base with a wheel, and an arm of two revolute joints about oblique axes and one prismatic joint.
fn satellite() -> (Tree, Vec<InertialParameters>) {
    let turned = |angle: f64| Rotation3::from_axis_angle(&Vector3::x_axis(), angle).into_inner();
    let oblique = Vector3::new(0.6, 0.0, 0.8);
    let link = |parent, motion, x, angle, axis| {
        Link::new(
            parent,
            motion,
            Vector3::new(x, 0.1, -0.2),
            turned(angle),
            axis,
        )
    };
    let tree = Tree {
        links: [
            Link::base(),
            link(0, Motion::Revolute(0), 0.5, 0.3, Vector3::z()),
            link(1, Motion::Revolute(1), 0.7, -1.1, oblique),
            link(2, Motion::Prismatic(2), 0.4, 0.8, Vector3::y()),
        ]
        .into(),
        rotors: [Rotor {
            body: 0,
            axis_B: oblique,
        }]
        .into(),
        coordinates: [0, 1, 2].into(),
    };
    let body = |mass: f64| {
        let I_BBcm_B = Matrix3::new(0.3, 0.02, 0.01, 0.02, 0.4, -0.03, 0.01, -0.03, 0.35) * mass;
        let p_BoBcm_B = Vector3::new(0.2, -0.05, 0.1);
        MassProperties {
            mass,
            p_BoBcm_B,
            I_BBcm_B,
        }
        .parameters()
    };
    (tree, [400.0, 25.0, 15.0, 8.0].map(body).into())
}

/// What the kernels give, one number after the other, at so many states.
fn values(states: u32) -> Vec<f64> {
    let (tree, parameters) = satellite();
    let mut kinematics = Kinematics::new(&tree);
    let mut forward = ForwardDynamics::new(&tree);
    let mut inverse = InverseDynamics::new(&tree);
    let mut accelerations = Accelerations::new(&tree);
    let mut matrix = MassMatrix::new(&tree);
    let mut regressor = [[0.0; 6]; 40];
    let mut out = Vec::new();
    for state in 0..states {
        let s = f64::from(state);
        let q = [0.3 * s, 1.0 - 0.7 * s, 0.02 * s];
        let rates = [0.2 - 0.01 * s, 0.05 * s, -0.03];
        let v = Vector3::new(0.01 * s, -0.02, 0.03);
        let w = Vector3::new(0.05, 0.1 - 0.01 * s, -0.02);
        kinematics.place(&tree, &q);
        kinematics.set_velocities(&tree, &v, &w, &rates);
        out.extend(momentum(&parameters, &kinematics).iter());
        out.extend(wheel_momentum(&tree, &kinematics, &[0.04], &[300.0 - s]).iter());
        momentum_regressor(&kinematics, &mut regressor);
        out.extend(regressor.iter().flatten());
        let whole = composite(&parameters, &kinematics);
        out.extend(whole.I_SScm_B().iter());
        matrix.set(&tree, &parameters, &kinematics);
        let of_rates = matrix.H_bm.iter().zip(rates).map(|(h, rate)| h * rate);
        out.extend(of_rates.sum::<Vector6>().iter());
        let mut found = [0.0; 3];
        forward.set_bodies(&tree, &parameters, &kinematics);
        let torques = [0.5, -0.2, 1.0].map(JointInput::Force);
        if forward
            .solve(&tree, &kinematics, &rates, &torques, &mut found)
            .is_ok()
        {
            out.extend(found);
        }
        accelerations.set_without_base(&tree, &kinematics, &rates, &found);
        accelerations.add_base(&kinematics, &v, &w);
        let wrench = inverse.solve(
            &tree,
            &parameters,
            &kinematics,
            &accelerations,
            &[],
            &mut found,
        );
        out.extend(found);
        out.extend(wrench.force.iter().chain(wrench.torque.iter()));
        let orbit = Orbit {
            semi_major_axis: 7.0e6,
            eccentricity: 0.01 + 0.02 * s,
            inclination: 0.9,
            raan: 0.3,
            argument_of_periapsis: 1.2,
            true_anomaly: 0.1 * s,
            epoch: None,
        };
        let (position, velocity) = orbit_state(3.986_004_418e14, &orbit, 100.0 * s);
        out.extend(position.iter().chain(velocity.iter()));
    }
    for state in 0..states {
        // A vehicle that has mass and inertia always has a step.
        let end = step(&tree, &parameters, f64::from(state));
        out.extend(
            end.iter()
                .flat_map(|f| f.R_NB.coords.iter().chain(&f.p_NoBo_N)),
        );
        out.extend(end.iter().flat_map(|f| f.P.iter().chain(&f.h_SScm_N)));
    }
    out
}

/// The vehicle at the three times of a step, under a force and a torque about its mass centre.
struct Pushed([LockedVehicle; 3]);

impl Rates for Pushed {
    fn rate(&mut self, at: StepPoint, state: &PoseMomentum) -> Option<PoseMomentumRate> {
        let twist = self.0[at as usize].base_motion(state).twist;
        let force = Vector3::new(0.5, -1.0, 2.0);
        let torque = Vector3::new(-0.3, 0.2, 0.1);
        Some(PoseMomentumRate::new(state, &twist, (&force, &torque)))
    }
}

/// The step of pose and momentum from a state on.
fn step(tree: &Tree, bodies: &[InertialParameters], s: f64) -> Option<PoseMomentum> {
    let dt = 0.1;
    let start = PoseMomentum {
        R_NB: UnitQuaternion::from_euler_angles(0.2 * s, -0.1 * s, 0.3),
        p_NoBo_N: Vector3::new(s, 2.0, -s),
        P: Vector3::new(4.0, -3.0, s),
        h_SScm_N: Vector3::new(20.0, -10.0 * s, 15.0),
    };
    let mut kinematics = Kinematics::new(tree);
    let mut locked = |t: f64| {
        let q = [0.3 * s + 0.2 * t, 1.0 - 0.7 * s + 0.05 * t, 0.02 * s];
        kinematics.place(tree, &q);
        let rates = [0.2, 0.05, -0.01 * s];
        kinematics.set_velocities(tree, &Vector3::zeros(), &Vector3::zeros(), &rates);
        let whole = composite(bodies, &kinematics);
        let mut joints = momentum(bodies, &kinematics);
        let wheels = wheel_momentum(tree, &kinematics, &[0.04], &[300.0 - 20.0 * t]);
        (0..3).for_each(|k| joints[3 + k] += wheels[k]);
        LockedVehicle::new(&whole, &whole, &joints)
    };
    let mut pushed = Pushed([locked(0.0)?, locked(0.5 * dt)?, locked(dt)?]);
    let rate = pushed.rate(StepPoint::Begin, &start)?;
    runge_kutta_step(&start, &rate, dt, &mut pushed)
}

const STATES: u32 = 8;

/// Equal to 1e-12 of the largest number of a state, with the numbers that the standard library's functions gave.
/// `POINSOT_BLESS=1` writes them.
#[test]
fn xval_kernels_without_the_standard_library_give_the_same_numbers() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/digits_with_std.txt");
    let found = values(STATES);
    if cfg!(feature = "std") && std::env::var_os("POINSOT_BLESS").is_some() {
        let lines: Vec<String> = found.iter().map(|x| format!("{x:e}\n")).collect();
        std::fs::write(&file, lines.concat()).unwrap();
    }
    let text = std::fs::read_to_string(&file).unwrap();
    let recorded: Vec<f64> = text.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(found.len(), recorded.len());
    let off = found
        .iter()
        .zip(&recorded)
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0));
    let worst = off.fold(0.0, f64::max);
    println!(
        "{} numbers, largest relative difference {worst:.1e}",
        found.len()
    );
    assert!(worst < 1.0e-12, "{worst:e}");
}
