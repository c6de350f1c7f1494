//! Simulated motions against closed forms.

use crate::setup;

use poinsot_dynamics::*;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::compare::attitude_apart;
use poinsot_testkit::momentum_sum::{KitBody, KitJoint, KitWheel, kinetic_energy};
use poinsot_testkit::rigid_body::*;

fn bus() -> Matrix3 {
    Matrix3::new(30.0, 0.26, 0.37, 0.26, 28.0, -0.29, 0.37, -0.29, 32.0)
}

/// One body whose mass centre is not at its origin.
fn body(inertia: Matrix3) -> KitBody {
    KitBody {
        parent: 0,
        joint: KitJoint::Base,
        p_PoCo_P: Vector3::zeros(),
        R_PC_zero: Matrix3::identity(),
        axis_C: Vector3::z(),
        mass: 400.0,
        p_CoCcm_C: Vector3::new(0.1, -0.2, 0.35),
        I_CCcm_C: inertia,
    }
}

fn wheel(axis: Vector3, spin_inertia: f64) -> KitWheel {
    KitWheel {
        host: 0,
        axis_C: axis,
        spin_inertia,
    }
}

fn attitude() -> UnitQuaternion {
    UnitQuaternion::from_euler_angles(0.4, -0.2, 1.3)
}

fn turning(w: Vector3) -> Start {
    Start {
        R_NB: attitude(),
        p_NoBo_N: Vector3::new(0.3, -0.2, 0.1),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.02, -0.01, 0.005),
            w_NB_B: w,
        },
    }
}

fn first(w: Vector3) -> Spin {
    Spin {
        R_NB: attitude().to_rotation_matrix().into_inner(),
        w_NB_B: w,
    }
}

fn times(end: f64, rows: usize) -> Vec<f64> {
    (0..=rows).map(|k| end * k as f64 / rows as f64).collect()
}

fn rotation(sample: &MotionSample) -> Matrix3 {
    sample.R_NB.to_rotation_matrix().into_inner()
}

fn top_error(w: Vector3, relative: f64) -> f64 {
    let model = setup::model(&[body(bus())], &[]);
    let plan = Plan::hold(&model);
    let tolerance = Tolerance {
        relative,
        ..Tolerance::default()
    };
    let top = AsymmetricTop::new(&bus(), &first(w)).unwrap();
    let mut worst = 0.0_f64;
    Flight::new(&model, &plan, tolerance)
        .unwrap()
        .run(&turning(w), times(200.0, 40), |s| {
            let exact = top.at(s.time);
            worst = worst.max(attitude_apart(&rotation(s), &exact.R_NB));
            worst = worst.max((s.w_NB_B - exact.w_NB_B).norm());
        })
        .unwrap();
    worst
}

#[test]
fn exact_torque_free_spin_of_an_asymmetric_body() {
    for w in [[0.1, -0.05, 0.3], [0.02, 0.3, -0.05], [-0.3, 0.1, 0.03]] {
        let error = top_error(w.into(), 1e-12);
        println!("torque-free {w:?}: {error:e}");
        assert!(error < 1e-10, "{w:?}: {error:e}");
    }
}

#[test]
fn prop_error_follows_the_tolerance() {
    let w = Vector3::new(0.1, -0.05, 0.3);
    let mut last = f64::INFINITY;
    for relative in [1e-5, 1e-7, 1e-9, 1e-11] {
        let error = top_error(w, relative);
        println!("tolerance {relative:e}: {error:e}");
        assert!(error < 1e3 * relative, "{relative:e}: {error:e}");
        assert!(error < 0.1 * last, "{relative:e}: {error:e} after {last:e}");
        last = error;
    }
}

#[test]
fn exact_mass_centre_coasts_and_the_origin_circles_it() {
    let w = Vector3::new(0.1, -0.05, 0.3);
    let kit = body(bus());
    let model = setup::model(std::slice::from_ref(&kit), &[]);
    let plan = Plan::hold(&model);
    let start = turning(w);
    let (R, c) = (attitude(), kit.p_CoCcm_C);
    let StartVelocity::Twist { v_NBo_N, .. } = start.velocity else {
        unreachable!()
    };
    let p_cm = start.p_NoBo_N + R * c;
    let v_cm = v_NBo_N + R * w.cross(&c);
    let top = AsymmetricTop::new(&bus(), &first(w)).unwrap();
    Flight::new(&model, &plan, Tolerance::default())
        .unwrap()
        .run(&start, times(100.0, 20), |s| {
            let (p, v) = coasting_origin(&p_cm, &v_cm, &c, &top.at(s.time), s.time);
            assert!((s.p_NoBo_N - p).norm() < 1e-10);
            let v_B = s.R_NB.inverse() * s.v_NBo_N;
            assert!((v_B - v).norm() < 1e-10);
        })
        .unwrap();
}

#[test]
fn exact_axisymmetric_gyrostat() {
    let gyrostat = AxisymmetricGyrostat {
        axis_B: Vector3::new(2.0, -1.0, 2.0) / 3.0,
        transverse: 10.0,
        axial: 16.0,
        wheel_momentum: -4.1,
    };
    let js = 0.02;
    let wheels = [wheel(gyrostat.axis_B, js)];
    let model = setup::model(&[body(gyrostat.inertia())], &wheels);
    let speed = gyrostat.wheel_momentum / js;
    let w = Vector3::new(0.2, -0.1, 0.5);
    let zero = PiecewisePolynomial::constant(0.0);
    // The axial rate is constant, so a free rotor keeps its relative speed: both drives must agree.
    for drive in [
        WheelMotion::constant(speed),
        WheelMotion::Torque {
            initial_speed: speed,
            torque: zero,
        },
    ] {
        let mut plan = Plan::hold(&model);
        plan.wheels = vec![drive];
        let mut worst = 0.0_f64;
        Flight::new(&model, &plan, Tolerance::default())
            .unwrap()
            .run(&turning(w), times(150.0, 30), |s| {
                let exact = gyrostat.at(&first(w), s.time);
                worst = worst.max(attitude_apart(&rotation(s), &exact.R_NB));
                worst = worst.max((s.w_NB_B - exact.w_NB_B).norm());
                assert!((s.wheel_speed[0] - speed).abs() < 1e-9 * speed.abs());
                assert!(s.wheel_torque[0].abs() < 1e-12);
            })
            .unwrap();
        println!("gyrostat: {worst:e}");
        assert!(worst < 1e-10, "{worst:e}");
    }
}

#[test]
fn exact_zero_momentum_slew_by_wheel_speed_and_by_wheel_torque() {
    let (axis, js) = (Vector3::new(0.6, 0.0, 0.8), 0.02);
    let model = setup::model(&[body(bus())], &[wheel(axis, js)]);
    // Speed rises to 200 rad/s in 10 s and then stays constant: 1000 rad, then 200 rad/s.
    let ramp = PiecewisePolynomial::linear(&[0.0, 10.0], &[0.0, 200.0]).unwrap();
    // The equivalent torque: the body's rate along the axis is -a.I^-1 a Js Omega.
    let compliance = axis.dot(&(bus().try_inverse().unwrap() * axis));
    let torque = js * (1.0 - js * compliance) * 20.0;
    let push = PiecewisePolynomial::steps(&[0.0, 10.0], &[torque, 0.0]).unwrap();
    for drive in [
        WheelMotion::Speed(ramp),
        WheelMotion::Torque {
            initial_speed: 0.0,
            torque: push,
        },
    ] {
        let mut plan = Plan::hold(&model);
        plan.wheels = vec![drive];
        let start = Start {
            R_NB: attitude(),
            ..Start::at_rest()
        };
        let R0 = first(Vector3::zeros()).R_NB;
        Flight::new(&model, &plan, Tolerance::default())
            .unwrap()
            .run(&start, times(40.0, 80), |s| {
                let t = s.time;
                let (angle, speed, motor) = if t < 10.0 {
                    (10.0 * t * t, 20.0 * t, torque)
                } else {
                    (1000.0 + 200.0 * (t - 10.0), 200.0, 0.0)
                };
                let R = zero_momentum_slew(&bus(), &axis, js, &R0, angle).unwrap();
                let error = attitude_apart(&rotation(s), &R);
                assert!(error < 1e-10, "{t}: {error:e}");
                assert!((s.wheel_speed[0] - speed).abs() < 1e-9);
                assert!((s.wheel_torque[0] - motor).abs() < 1e-12);
            })
            .unwrap();
    }
}

#[test]
fn exact_free_rotors_keep_energy_and_axial_momentum() {
    let wheels = [
        wheel(Vector3::x(), 0.5),
        wheel(Vector3::new(0.0, 0.6, 0.8), 0.9),
    ];
    let bodies = [body(bus())];
    let model = setup::model(&bodies, &wheels);
    let zero = PiecewisePolynomial::constant(0.0);
    let mut plan = Plan::hold(&model);
    plan.wheels = [7.0, -3.0]
        .map(|initial_speed| WheelMotion::Torque {
            initial_speed,
            torque: zero.clone(),
        })
        .to_vec();
    let w = Vector3::new(0.3, 0.2, -0.4);
    let mut energies = Vec::new();
    let expected = |i: usize, speed| {
        let wheel = &wheels[i];
        rotor_axial_momentum(wheel.spin_inertia, &wheel.axis_C, speed, &w)
    };
    let kept = [expected(0, 7.0), expected(1, -3.0)];
    let mut change = 0.0_f64;
    Flight::new(&model, &plan, Tolerance::default())
        .unwrap()
        .run(&turning(w), times(60.0, 60), |s| {
            energies.push(kinetic_energy(&bodies, &wheels, &setup::state(s)));
            for (i, wheel) in wheels.iter().enumerate() {
                let (js, a) = (wheel.spin_inertia, &wheel.axis_C);
                let h = rotor_axial_momentum(js, a, s.wheel_speed[i], &s.w_NB_B);
                assert!((h - kept[i]).abs() < 1e-11);
            }
            change = change.max((s.wheel_speed[0] - 7.0).abs());
        })
        .unwrap();
    assert!(
        change > 0.1,
        "the rotors must change speed for this to judge anything"
    );
    let drift = energies.iter().map(|e| (e / energies[0] - 1.0).abs());
    let drift = drift.fold(0.0, f64::max);
    println!("energy: {drift:e}");
    assert!(drift < 1e-11, "{drift:e}");
}
