//! Torque-driven motion: forward against inverse dynamics, momentum and energy, a recorded end state.

use crate::xu_arm;

use poinsot_dynamics::*;
use poinsot_spatial::Vector3;

/// Torques of the recorded run: amplitude N m, frequency rad/s, phase rad.
fn plan() -> Plan {
    Plan {
        joints: xu_arm::drives(),
        ..Plan::default()
    }
}

fn start() -> Start {
    Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.01, 0.02, -0.01),
            w_NB_B: Vector3::new(0.02, -0.03, 0.05),
        },
        ..Start::at_rest()
    }
}

fn end(plan: &Plan, integrator: impl Into<Integrator>, seconds: f64) -> MotionSample {
    let (tree, bodies) = (xu_arm::tree(), xu_arm::parameters());
    let vehicle = Vehicle::new(tree, bodies, Vec::new(), Vec::new());
    let flight = Flight::new(vehicle, plan, integrator).unwrap();
    let mut last = None;
    let sink = |s: &MotionSample| last = Some(s.clone());
    flight.run(&start(), &[0.0, seconds], sink).unwrap();
    last.unwrap()
}

#[test]
fn exact_forward_dynamics_inverts_inverse_dynamics() {
    let (tree, parameters) = (xu_arm::tree(), xu_arm::parameters());
    let mut kinematics = Kinematics::new(&tree);
    let mut forward = ForwardDynamics::new(&tree);
    let mut inverse = InverseDynamics::new(&tree);
    let mut accelerations = Accelerations::new(&tree);
    for state in xu_arm::states() {
        kinematics.place(&tree, &state.q);
        kinematics.set_velocities(&tree, &state.v, &state.w, &state.rates);
        let given = [0.7, -1.2, 0.3, 0.9, -0.4, 1.1];
        let (a, alpha) = (Vector3::new(0.1, -0.3, 0.2), Vector3::new(-0.2, 0.5, 0.1));
        accelerations.set_without_base(&tree, &kinematics, &state.rates, &given);
        accelerations.add_base(&kinematics, &a, &alpha);
        let mut forces = [0.0; 6];
        let base = inverse.solve(
            &tree,
            &parameters,
            &kinematics,
            &accelerations,
            &[],
            &mut forces,
        );
        forward.set_bodies(&tree, &parameters, &kinematics);
        forward.add_wrench(0, &base.force, &base.torque);
        let mut found = [0.0; 6];
        let inputs = forces.map(JointInput::Force);
        forward
            .solve(&tree, &kinematics, &state.rates, &inputs, &mut found)
            .unwrap();
        for (a, b) in found.iter().zip(&given) {
            assert!((a - b).abs() < 1e-12, "{found:?}");
        }
        for i in 0..7 {
            let (a, alpha) = forward.acceleration(i);
            assert!((a - accelerations.a[i]).amax() < 1e-12);
            assert!((alpha - accelerations.alpha[i]).amax() < 1e-12);
        }
    }
}

/// The recorded final state after 20 s by Pinocchio 4.1.0 (`aba`, classical Runge-Kutta in the quaternion, steps of
/// 0.1 ms): position of the base, attitude xyzw, joints; base twist in base axes, joint rates.
const PINOCCHIO_AT_20_S: [f64; 25] = [
    0.22190338592341882,
    0.4149225305361335,
    -0.21010856477080145,
    0.0803637291180353,
    -0.15382556398293376,
    0.46327399259170116,
    0.8690549894544763,
    0.1554690688678697,
    -0.06759006717342793,
    0.8182418608321186,
    -0.3721319876277254,
    -1.1424793121763874,
    1.8384663089323137,
    0.0192666942832812,
    0.0026530599521286413,
    -0.01761249776017289,
    0.003964430329455348,
    -0.00931628736857965,
    0.055265534216654366,
    -0.03892409875210547,
    -0.014495215072614994,
    0.09315224775948336,
    -0.04989098082722698,
    -0.06209555163024069,
    0.08469069802870594,
];

/// Largest difference from the recorded final state: joints and attitude, rad; position, m; rates per second.
fn apart(found: &MotionSample) -> f64 {
    let v = found.R_NB.inverse() * found.v_NBo_N;
    let w = &found.w_NB_B;
    let mine = found.p_NoBo_N.iter().chain(found.R_NB.coords.iter());
    let mine = mine.chain(&found.q).chain(v.iter()).chain(w.iter());
    let mine = mine.chain(&found.rates);
    let differences = mine.zip(&PINOCCHIO_AT_20_S).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

#[test]
fn xval_pinocchio_twenty_seconds_of_the_arm() {
    let plan = plan();
    let found = apart(&end(&plan, Integrator::RungeKutta4(0.001), 20.0));
    println!("1 ms: {found:e}");
    assert!(found < 6e-12, "{found:e}");
}

#[test]
fn exact_error_of_runge_kutta_falls_with_the_fourth_power_of_the_step() {
    let plan = plan();
    let errors =
        [0.02, 0.01, 0.005].map(|step| apart(&end(&plan, Integrator::RungeKutta4(step), 20.0)));
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 4.0).abs() < 0.2, "{errors:?}");
    }
}

#[test]
fn exact_step_control_follows_the_tolerance() {
    let plan = plan();
    for relative in [1e-6, 1e-9, 1e-12] {
        let tolerance = Tolerance {
            relative,
            ..Tolerance::default()
        };
        let found = apart(&end(&plan, tolerance, 20.0));
        println!("{relative:e}: {found:e}");
        assert!(found < 30.0 * relative, "{relative:e}: {found:e}");
    }
}
