//! A vehicle that burns propellant, against closed forms.

use crate::setup;

use poinsot_dynamics::*;
use poinsot_model::{Model, Nuisance, Propellant, Thruster};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::momentum_sum::{KitBody, KitJoint};

const MASS: f64 = 400.0;
const FORCE: f64 = 50.0;
const ON: f64 = 3.0;
const OFF: f64 = 40.0;
/// Exhaust velocity, m/s: much propellant for little thrust.
const EXHAUST: f64 = 25.0;

/// A body whose thruster pushes along `direction_B` at `p_BoT_B`, with its propellant at `p_BoF_B`.
fn rocket(p_BoT_B: Vector3, direction_B: Vector3, p_BoF_B: Vector3) -> Model {
    let mut model = setup::model(
        &[KitBody {
            parent: 0,
            joint: KitJoint::Base,
            p_PoCo_P: Vector3::zeros(),
            R_PC_zero: Matrix3::identity(),
            axis_C: Vector3::z(),
            mass: MASS,
            p_CoCcm_C: Vector3::new(0.1, -0.2, 0.35),
            I_CCcm_C: Matrix3::from_diagonal(&Vector3::new(90.0, 80.0, 110.0)),
        }],
        &[],
    );
    model.thrusters.push(Thruster {
        name: "main".into(),
        body: 0,
        p_BoT_B,
        direction_B,
        never_fires: false,
        scale: Nuisance::Known,
        propellant: Some(Propellant {
            specific_impulse: EXHAUST / 9.806_65,
            p_BoF_B,
        }),
    });
    model
}

fn burn(model: &Model) -> Plan {
    let mut plan = Plan::hold(model);
    plan.firings.push(Firing {
        thruster: 0,
        on: ON,
        off: OFF,
        force: FORCE,
    });
    plan
}

fn last(model: &Model, start: &Start) -> MotionSample {
    fly(model, &burn(model), start)
}

fn fly(model: &Model, plan: &Plan, start: &Start) -> MotionSample {
    let mut last = None;
    Flight::new(model, plan, Tolerance::default())
        .unwrap()
        .run(start, &[0.0, 20.0, 50.0], |s| last = Some(s.clone()))
        .unwrap();
    last.unwrap()
}

fn used() -> f64 {
    FORCE * (OFF - ON) / EXHAUST
}

#[test]
fn exact_burn_is_that_of_the_rocket_equation() {
    let c = Vector3::new(0.1, -0.2, 0.35);
    let x = Vector3::x();
    // The propellant lies on the line of the thrust: no torque.
    let model = rocket(c - x, x, c - x * 0.4);
    let end = last(&model, &Start::at_rest());
    // Tsiolkovsky 1903.
    let gained = EXHAUST * (MASS / (MASS - used())).ln();
    assert!((end.v_NBo_N - x * gained).norm() < 1.0e-9 * gained);
    assert!(end.w_NB_B.norm() < 1.0e-12);
    // The mass centre moves in the vehicle, and the vehicle with it.
    let moved = end.p_NoScm_N - end.p_NoBo_N;
    let expected = (c * MASS - (c - x * 0.4) * used()) / (MASS - used());
    assert!((moved - expected).norm() < 1.0e-9);
    assert!((end.l_S_N - end.v_NBo_N * (MASS - used())).norm() < 1.0e-7);
}

#[test]
fn exact_mass_that_leaves_a_spinning_body_changes_no_rate() {
    // It takes its own momentum along, and the thrust has no torque: it goes along the spin axis through the mass centre.
    let c = Vector3::new(0.1, -0.2, 0.35);
    let model = rocket(c, Vector3::z(), c + Vector3::z() * 0.7);
    let spin = Vector3::z() * 0.4;
    let start = Start {
        R_NB: UnitQuaternion::identity(),
        p_NoBo_N: Vector3::zeros(),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::zeros(),
            w_NB_B: spin,
        },
    };
    assert!((last(&model, &start).w_NB_B - spin).norm() < 1.0e-12);
}

#[test]
fn exact_a_tank_beside_the_thrust_turns_the_vehicle() {
    let c = Vector3::new(0.1, -0.2, 0.35);
    let arm = 0.5;
    let model = rocket(c, Vector3::z(), c + Vector3::x() * arm);
    let end = last(&model, &Start::at_rest());
    // About y: `I(t) w' = F arm mu / (m - mu)`, with `mu` used so far, `I(t) = I0 - mu arm^2 m / (m - mu)`; in small steps.
    let mut expected = 0.0;
    let steps = 100_000;
    let h = (OFF - ON) / f64::from(steps);
    for k in 0..steps {
        let mu = FORCE * h * (f64::from(k) + 0.5) / EXHAUST;
        let inertia = 80.0 - mu * arm * arm * MASS / (MASS - mu);
        expected -= h * FORCE * arm * mu / (MASS - mu) / inertia;
    }
    assert!((end.w_NB_B.y - expected).abs() < 1.0e-8 * expected.abs());
}

/// The upper stage slides off a base that nothing holds: the base stays, and the stage follows the rocket equation.
#[test]
fn exact_a_stage_on_a_free_joint_leaves_its_base() {
    let body = |parent, joint, mass| KitBody {
        parent,
        joint,
        p_PoCo_P: Vector3::x() * 0.5,
        R_PC_zero: Matrix3::identity(),
        axis_C: Vector3::x(),
        mass,
        p_CoCcm_C: Vector3::zeros(),
        I_CCcm_C: Matrix3::from_diagonal(&Vector3::new(9.0, 8.0, 11.0)),
    };
    let base = KitBody {
        p_PoCo_P: Vector3::zeros(),
        ..body(0, KitJoint::Base, 70.0)
    };
    let mut model = setup::model(&[base, body(0, KitJoint::Prismatic, MASS)], &[]);
    model.thrusters = rocket(Vector3::zeros(), Vector3::x(), Vector3::x() * -0.3).thrusters;
    model.thrusters[0].body = 1;
    let plan = Plan {
        joints: vec![JointDrive::Force {
            motor: ForceProfile::none(),
            spring: SpringDamper::default(),
            initial_position: 0.0,
            initial_rate: 0.0,
        }],
        ..burn(&model)
    };
    let end = fly(&model, &plan, &Start::at_rest());
    let gained = EXHAUST * (MASS / (MASS - used())).ln();
    assert!((end.rates[0] - gained).abs() < 1.0e-9 * gained);
    assert!(end.v_NBo_N.norm() < 1.0e-9 && end.w_NB_B.norm() < 1.0e-12);
}
