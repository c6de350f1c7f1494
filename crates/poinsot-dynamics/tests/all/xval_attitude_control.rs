//! Attitude control by wheels against Basilisk, closed forms and conservation.

use crate::setup;

use poinsot_dynamics::*;
use poinsot_model::{Model, Thruster};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::compare::attitude_apart;
use poinsot_testkit::momentum_sum::{KitBody, KitJoint, KitWheel};
use setup::*;

const WN: f64 = 0.043;
const ZETA: f64 = 0.707;

/// Gains of Table 1: proportional to the inertia.
fn table_1(I: &Matrix3) -> AttitudeControl {
    AttitudeControl {
        proportional: I * (2.0 * WN * WN),
        derivative: I * (2.0 * ZETA * WN),
        targets: Vec::new(),
        period: None,
        drive: WheelDrive::Acceleration,
    }
}

fn matrix(value: &serde_json::Value) -> Matrix3 {
    Matrix3::from_row_slice(&numbers(value))
}

/// All wheels under a law.
fn controlled(law: &AttitudeControl, speeds: &[f64], limits: WheelLimits) -> Plan {
    let wheel = |speed: &f64| WheelMotion::Controlled {
        initial_speed: *speed,
        limits,
    };
    Plan {
        wheels: speeds.iter().map(wheel).collect(),
        control: Some(law.clone()),
        ..Plan::default()
    }
}

fn free(law: &AttitudeControl, speeds: &[f64]) -> Plan {
    controlled(law, speeds, WheelLimits::default())
}

/// The controller of the recorded run in our closed loop; every row is compared.
fn basilisk(run: &str) -> [f64; 4] {
    let recorded = Run::load(&format!("stsat3/{run}"));
    let source = &recorded.source["controller"];
    let targets = source["targets"].as_array().map(|list| {
        let target = |t: &serde_json::Value| {
            let q = numbers(&t["q_xyzw"]);
            Target {
                time: t["t_s"].as_f64().unwrap(),
                R_NB: UnitQuaternion::new_normalize(nalgebra::Quaternion::new(
                    q[3], q[0], q[1], q[2],
                )),
            }
        };
        list.iter().map(target).collect()
    });
    let control = AttitudeControl {
        proportional: matrix(&source["Kp"]),
        derivative: matrix(&source["Kd"]),
        targets: targets.unwrap_or_default(),
        period: Some(0.1),
        drive: WheelDrive::Torque,
    };
    let q = ["q_w", "q_x", "q_y", "q_z"].map(|c| recorded.column(c)[0]);
    let start = Start {
        R_NB: UnitQuaternion::new_normalize(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3])),
        p_NoBo_N: Vector3::zeros(),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::zeros(),
            w_NB_B: recorded.vector("omega", 0),
        },
    };
    let column = |k: usize, unit: &str| recorded.column(&format!("wheel{}_{unit}", k + 1));
    let speeds: Vec<f64> = (0..3).map(|k| column(k, "rad_s")[0]).collect();
    let times = recorded.column("time_s");
    let (mut worst, mut row) = ([0.0_f64; 4], 0);
    let plan = free(&control, &speeds);
    Flight::new(&recorded.model, &plan, Tolerance::default())
        .unwrap()
        .run(&start, times, |s| {
            let q = ["q_x", "q_y", "q_z", "q_w"].map(|c| recorded.column(c)[row]);
            let theirs = poinsot_testkit::trees::rotation_from_xyzw(q);
            let ours = s.R_NB.to_rotation_matrix().into_inner();
            worst[0] = worst[0].max(attitude_apart(&ours, &theirs));
            worst[1] = worst[1].max((s.w_NB_B - recorded.vector("omega", row)).norm());
            for k in 0..3 {
                worst[2] = worst[2].max((s.wheel_speed[k] - column(k, "rad_s")[row]).abs());
                // The last recorded torque belongs to a period that was not simulated.
                if row + 1 < times.len() {
                    worst[3] = worst[3].max((s.wheel_torque[k] - column(k, "Nm")[row]).abs());
                }
            }
            row += 1;
        })
        .unwrap();
    assert_eq!(row, times.len());
    println!("stsat3 {run}: attitude rad, omega rad/s, wheel rad/s, torque N m {worst:?}");
    worst
}

#[test]
fn xval_basilisk_closed_loop() {
    for run in ["paper", "bias", "multiaxis"] {
        let worst = basilisk(run);
        assert!(worst.iter().all(|x| *x < 1e-8), "{run}: {worst:?}");
    }
}

fn stsat3() -> Model {
    Run::load("stsat3/paper").model
}

fn ten_degrees() -> Start {
    let ten = 10.0_f64.to_radians();
    Start {
        R_NB: UnitQuaternion::from_euler_angles(ten, ten, ten),
        ..Start::at_rest()
    }
}

fn seconds(end: u32) -> Vec<f64> {
    (0..=end).map(f64::from).collect()
}

/// Largest ratio of off-axis rates in the first slew.
fn leak(control: &AttitudeControl) -> f64 {
    let model = stsat3();
    let n = ten_degrees().R_NB.axis().unwrap();
    let (mut off, mut along) = (0.0_f64, 0.0_f64);
    Flight::new(&model, &free(control, &[0.0; 3]), Tolerance::default())
        .unwrap()
        .run(&ten_degrees(), seconds(300), |s| {
            let a = s.w_NB_B.dot(&n);
            off = off.max((s.w_NB_B - n.into_inner() * a).norm());
            along = along.max(a.abs());
        })
        .unwrap();
    off / along
}

/// With `u` of (1a) the paper's control law gives an eigen-axis slew with the pendulum equation
/// `theta'' = -2 wn^2 sin(theta / 2) - 2 zeta wn theta'`.
#[test]
fn exact_paper_loop_is_a_pendulum_about_one_axis() {
    let model = stsat3();
    let control = table_1(&model.bodies[0].nominal.I_BBcm_B);
    assert!(leak(&control) < 1e-9, "{}", leak(&control));
    let (axis, angle) = ten_degrees().R_NB.axis_angle().unwrap();
    struct Pendulum;
    impl Flow for Pendulum {
        fn derivative(&mut self, _: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
            dy[0] = y[1];
            dy[1] = -2.0 * WN * WN * (0.5 * y[0]).sin() - 2.0 * ZETA * WN * y[1];
            Ok(())
        }
        fn project(&self, _: &mut [f64]) {}
    }
    let mut pendulum = DormandPrince8::new(vec![1.0, 0.01], Tolerance::default());
    let (mut y, mut t, mut worst) = ([angle, 0.0], 0.0, 0.0_f64);
    Flight::new(&model, &free(&control, &[0.0; 3]), Tolerance::default())
        .unwrap()
        .run(&ten_degrees(), seconds(300), |s| {
            while t < s.time {
                t = pendulum.step(&mut Pendulum, t, s.time, &mut y).unwrap();
            }
            let theirs = UnitQuaternion::from_axis_angle(&axis, y[0]);
            worst = worst.max((theirs.inverse() * s.R_NB).angle());
            worst = worst.max((s.w_NB_B - axis.into_inner() * y[1]).norm());
        })
        .unwrap();
    assert!(worst < 1e-9, "{worst:e}");
}

/// Why the recorded run deviates from the axis by 2e-6: its motor torque differs from the `u` of (1a) by `Js w'`.
/// Constant torque over 0.1 s keeps the axis.
#[test]
fn prop_motor_torque_leaves_the_axis() {
    let model = stsat3();
    let exact = table_1(&model.bodies[0].nominal.I_BBcm_B);
    let with = |period, drive| {
        leak(&AttitudeControl {
            period,
            drive,
            ..exact.clone()
        })
    };
    let held = with(Some(0.1), WheelDrive::Acceleration);
    let motor = with(None, WheelDrive::Torque);
    let both = with(Some(0.1), WheelDrive::Torque);
    println!("held {held:e}, motor torque {motor:e}, both {both:e}");
    assert!(held < 1e-12, "{held:e}");
    assert!(motor > 1e-6 && motor < 3e-6, "{motor:e}");
    assert!((both - motor).abs() < 0.01 * motor, "{both:e}");
}

fn pyramid() -> Model {
    let s = 1.0 / 3.0_f64.sqrt();
    let bus = KitBody {
        parent: 0,
        joint: KitJoint::Base,
        p_PoCo_P: Vector3::zeros(),
        R_PC_zero: Matrix3::identity(),
        axis_C: Vector3::x(),
        mass: 150.0,
        p_CoCcm_C: Vector3::new(0.1, -0.05, 0.2),
        I_CCcm_C: Matrix3::new(13.9, 0.1, 0.2, 0.1, 17.0, 0.6, 0.2, 0.6, 19.9),
    };
    let axes = [[s, s, s], [-s, s, s], [-s, -s, s], [s, -s, s]];
    let wheels: Vec<KitWheel> = axes
        .iter()
        .map(|a| KitWheel {
            host: 0,
            axis_C: Vector3::from(*a),
            spin_inertia: 4e-4,
        })
        .collect();
    model(&[bus], &wheels)
}

#[test]
fn prop_limited_pyramid_with_friction_conserves_momentum_and_arrives() {
    let model = pyramid();
    let I = model.bodies[0].nominal.I_BBcm_B;
    let limits = WheelLimits {
        torque: 2e-3,
        speed: 150.0,
        viscous: 1e-7,
        coulomb: 2e-5,
    };
    for period in [Some(0.1), None] {
        let control = AttitudeControl {
            period,
            drive: WheelDrive::Torque,
            ..table_1(&I)
        };
        let mut largest = [0.0_f64; 3];
        let mut last = 0.0;
        let speeds = [20.0, -30.0, 10.0, 5.0];
        let plan = controlled(&control, &speeds, limits);
        let used = Flight::new(&model, &plan, Tolerance::default())
            .unwrap()
            .run(&ten_degrees(), seconds(600), |s| {
                let h = s.wheel_speed.iter().zip(&model.wheels);
                let h: Vector3 = h
                    .map(|(speed, w)| w.axis_B * (w.spin_inertia * speed))
                    .sum();
                let H = s.R_NB * (I * s.w_NB_B + h);
                largest[0] = largest[0].max((H - s.h_SScm_N).norm());
                for (speed, torque) in s.wheel_speed.iter().zip(&s.wheel_torque) {
                    largest[1] = largest[1].max(speed.abs());
                    largest[2] = largest[2].max(torque.abs());
                }
                last = s.R_NB.angle();
            })
            .unwrap();
        println!("{period:?}: {largest:?}, {last} rad at the end, {used:?}");
        assert!(largest[0] < 1e-12, "{largest:?}");
        assert!(
            largest[1] < 150.01 && largest[2] <= 2e-3 * (1.0 + 1e-9),
            "{largest:?}"
        );
        assert!(used.iter().any(|u| u.limited));
        assert!(last < 0.02, "{last}");
    }
}

/// A controller with zero command gives the same motion under thrust and gravity gradient as a plan without motor
/// torque.
#[test]
fn exact_thrust_and_gravity_act_under_a_controller() {
    let mut model = stsat3();
    model.thrusters = vec![Thruster {
        name: "thr1".to_owned(),
        body: 0,
        p_BoT_B: Vector3::new(0.4, 0.3, -0.2),
        direction_B: Vector3::new(0.0, 0.6, 0.8),
        never_fires: false,
        scale: Nuisance::Known,
        propellant: None,
    }];
    model.environment.point_mass_gm = Some(3.986004418e14);
    model.environment.gravity_gradient = true;
    model.environment.orbit = Some(Orbit {
        semi_major_axis: 7.0e6,
        eccentricity: 0.01,
        inclination: 1.1,
        raan: 0.2,
        argument_of_periapsis: 0.4,
        true_anomaly: -0.3,
        epoch: None,
    });
    let firings = [(10.0, 25.0, 0.5), (40.5, 41.25, 2.0)].map(|(on, off, force)| Firing {
        thruster: 0,
        on,
        off,
        force,
    });
    let control = AttitudeControl {
        proportional: Matrix3::zeros(),
        derivative: Matrix3::zeros(),
        targets: Vec::new(),
        period: None,
        drive: WheelDrive::Torque,
    };
    let start = Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.1, -0.2, 0.05),
            w_NB_B: Vector3::new(0.02, -0.01, 0.03),
        },
        ..ten_degrees()
    };
    let (speeds, times) = ([20.0, -30.0, 10.0], seconds(60));
    let plan = Plan {
        wheels: speeds
            .map(|initial_speed| WheelMotion::Torque {
                initial_speed,
                torque: PiecewisePolynomial::constant(0.0),
            })
            .to_vec(),
        firings: firings.to_vec(),
        ..Plan::default()
    };
    let mut wanted = Vec::new();
    Flight::new(&model, &plan, Tolerance::default())
        .unwrap()
        .run(&start, &times, |s| wanted.push(s.clone()))
        .unwrap();
    let mut found = wanted.iter();
    let plan = Plan {
        firings: firings.to_vec(),
        ..free(&control, &speeds)
    };
    Flight::new(&model, &plan, Tolerance::default())
        .unwrap()
        .run(&start, &times, |s| {
            let w = found.next().unwrap();
            assert!(s.R_NB.angle_to(&w.R_NB) < 1e-10);
            for (ours, theirs) in [
                (s.w_NB_B, w.w_NB_B),
                (s.p_NoBo_N, w.p_NoBo_N),
                (s.v_NBo_N, w.v_NBo_N),
                (s.h_SScm_N, w.h_SScm_N),
                (s.body.alpha[0], w.body.alpha[0]),
                (s.body.a[0], w.body.a[0]),
            ] {
                assert!(
                    (ours - theirs).norm() < 1e-9,
                    "{} s: {ours} {theirs}",
                    s.time
                );
            }
            assert_eq!(s.thrust, w.thrust);
            assert_eq!(s.p_orbit_N, w.p_orbit_N);
            for (ours, theirs) in s.wheel_speed.iter().zip(&w.wheel_speed) {
                assert!((ours - theirs).abs() < 1e-8);
            }
        })
        .unwrap();
    // Both act: otherwise the momentum would not change.
    let (first, last) = (&wanted[0], &wanted[60]);
    assert!((first.h_SScm_N - last.h_SScm_N).norm() > 1.0);
}

#[test]
fn unit_two_wheels_cannot_point() {
    let mut model = stsat3();
    model.wheels.pop();
    let control = table_1(&model.bodies[0].nominal.I_BBcm_B);
    let plan = free(&control, &[0.0; 2]);
    let error = Flight::new(&model, &plan, Tolerance::default()).unwrap_err();
    assert_eq!(error, MotionError::Allocation { wheels: 2, rank: 2 });
    assert!(
        error.to_string().contains("span 2 of 3 directions"),
        "{error}"
    );
}

#[test]
fn unit_senseless_numbers_are_refused() {
    let model = stsat3();
    let good = table_1(&model.bodies[0].nominal.I_BBcm_B);
    let refused = |law: &AttitudeControl, limits: WheelLimits| {
        let plan = controlled(law, &[0.0; 3], limits);
        Flight::new(&model, &plan, Tolerance::default()).is_err()
    };
    let none = WheelLimits::default();
    assert!(!refused(&good, none));
    let mut bad = good.clone();
    bad.period = Some(0.0);
    assert!(refused(&bad, none));
    bad = good.clone();
    bad.derivative[(1, 1)] = f64::NAN;
    assert!(refused(&bad, none));
    bad = good.clone();
    let R_NB = UnitQuaternion::identity();
    bad.targets = vec![Target { time: 1.0, R_NB }; 2];
    assert!(refused(&bad, none));
    let limits = WheelLimits {
        speed: -1.0,
        ..WheelLimits::default()
    };
    assert!(refused(&good, limits));
    let mut plan = free(&good, &[0.0; 3]);
    let flight = Flight::new(&model, &plan, Tolerance::default()).unwrap();
    let backwards = flight.run(&ten_degrees(), &[1.0, 0.0], |_| ());
    assert_eq!(backwards, Err(MotionError::Times(1)));
    plan.wheels.pop();
    let short = Flight::new(&model, &plan, Tolerance::default()).unwrap_err();
    assert!(matches!(short, MotionError::Plan { found: 2, .. }));
    let lawless = Plan {
        control: None,
        ..free(&good, &[0.0; 3])
    };
    let lawless = Flight::new(&model, &lawless, Tolerance::default()).unwrap_err();
    assert!(matches!(lawless, MotionError::Control(_)));
}
