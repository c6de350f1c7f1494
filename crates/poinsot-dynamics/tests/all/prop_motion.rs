//! Properties of every simulated motion, checked by momentum by definition and by finite differences.

use crate::setup;

use poinsot_dynamics::*;
use poinsot_model::{Environment, Model, Nuisance, Thruster};
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_testkit::momentum_sum::*;
use poinsot_testkit::trees::load_trees;

/// A recorded tree with harmonic motion of every joint. It has one wheel with a speed profile, one driven by a torque,
/// and one thruster on the last body.
struct Busy {
    bodies: Vec<KitBody>,
    wheels: Vec<KitWheel>,
    model: Model,
    plan: Plan,
    start: Start,
}

fn busy(index: usize, firings: Vec<Firing>) -> Busy {
    let case = load_trees().unwrap().swap_remove(index);
    let last = case.bodies.len() - 1;
    let wheel = |host, axis: [f64; 3], spin_inertia| KitWheel {
        host,
        axis_C: Vector3::from(axis).normalize(),
        spin_inertia,
    };
    let wheels = vec![
        wheel(0, [1.0, 2.0, -0.5], 0.01),
        wheel(last, [0.0, 0.6, 0.8], 0.02),
    ];
    let mut model = setup::model(&case.bodies, &wheels);
    model.thrusters.push(Thruster {
        name: "thr".into(),
        body: last,
        p_BoT_B: Vector3::new(0.3, -0.4, 0.2),
        direction_B: Vector3::new(0.0, -0.6, 0.8),
        never_fires: false,
        scale: Nuisance::Known,
        propellant: None,
    });
    let joints = (0..case.state.q.len())
        .map(|k| {
            JointMotion::Fourier(Fourier {
                offset: case.state.q[k],
                base_frequency_hz: 0.02 + 0.003 * k as f64,
                sine: vec![0.2, -0.1],
                cosine: vec![0.1],
            })
            .into()
        })
        .collect();
    let speed = PiecewisePolynomial::linear(&[0.0, 8.0, 30.0], &[20.0, 90.0, -40.0]).unwrap();
    let torque = PiecewisePolynomial::steps(&[2.0, 11.0, 25.0], &[0.03, -0.02, 0.0])
        .unwrap()
        .starting_from(0.0);
    let plan = Plan {
        joints,
        wheels: vec![
            WheelMotion::Speed(speed),
            WheelMotion::Torque {
                initial_speed: 15.0,
                torque,
            },
        ],
        firings,
        ..Plan::default()
    };
    let start = Start {
        R_NB: UnitQuaternion::from_euler_angles(0.2, 0.4, -1.0),
        p_NoBo_N: Vector3::new(0.5, -0.3, 0.2),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.02, -0.01, 0.005),
            w_NB_B: Vector3::new(0.05, -0.08, 0.03),
        },
    };
    Busy {
        bodies: case.bodies,
        wheels,
        model,
        plan,
        start,
    }
}

/// Recorded trees with at least six bodies and a heavy base, suitable for the wheels.
fn choices() -> Vec<usize> {
    load_trees()
        .unwrap()
        .iter()
        .enumerate()
        .filter(|(_, case)| case.bodies.len() >= 6 && case.bodies[0].mass > 50.0)
        .filter(|(_, case)| case.bodies.last().unwrap().I_CCcm_C.trace() > 1.0)
        .map(|(i, _)| i)
        .collect()
}

#[test]
fn prop_momentum_conserved_and_mass_centre_straight_over_1e5_steps() {
    let Busy {
        bodies,
        wheels,
        model,
        plan,
        start,
    } = busy(choices()[0], Vec::new());
    let times: Vec<f64> = (0..=100_000).map(|k| k as f64 / 1000.0).collect();
    let mut first = None;
    let mut worst = [0.0_f64; 3];
    Flight::new(&model, &plan, Tolerance::default())
        .unwrap()
        .run(&start, &times, |s| {
            let now = system_momentum(&bodies, &wheels, &setup::state(s)).unwrap();
            let begin: &SystemMomentum = first.get_or_insert(now);
            let l = (now.l_S_N - begin.l_S_N).norm() / begin.scale_l.max(now.scale_l);
            let h = (now.h_SScm_N - begin.h_SScm_N).norm() / begin.scale_h.max(now.scale_h);
            let path = begin.p_NScm_N + begin.l_S_N / begin.mass * s.time;
            let off = (now.p_NScm_N - path).norm();
            for (worst, x) in worst.iter_mut().zip([l, h, off]) {
                *worst = if x.is_nan() { x } else { worst.max(x) };
            }
        })
        .unwrap();
    println!("bodies {}; l, h relative, path m: {worst:?}", bodies.len());
    assert!(worst[0] < 1e-12, "{worst:?}");
    assert!(worst[1] < 1e-12, "{worst:?}");
    assert!(worst[2] < 1e-9, "{worst:?}");
}

/// Five points of the fourth-order central difference around `t`.
fn around(t: f64, step: f64) -> [f64; 5] {
    [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| t + k * step)
}

fn slope(y: &[Vector3], step: f64) -> Vector3 {
    (y[0] - y[1] * 8.0 + y[3] * 8.0 - y[4]) / (12.0 * step)
}

#[test]
fn prop_accelerations_are_the_slopes_of_velocities() {
    let step = 1e-3;
    for index in choices().into_iter().step_by(40) {
        let fire = Firing {
            thruster: 0,
            on: 1.0,
            off: 20.0,
            force: 3.0,
        };
        let b = busy(index, vec![fire]);
        let point = Vector3::new(0.2, -0.5, 0.4);
        let last = b.bodies.len() - 1;
        let mut times = vec![0.0];
        times.extend(around(9.5, step));
        let (mut v_N, mut w_N, mut rotor) = (Vec::new(), Vec::new(), Vec::new());
        let (mut a, mut alpha, mut torque) = (Vector3::zeros(), Vector3::zeros(), [0.0; 2]);
        Flight::new(&b.model, &b.plan, Tolerance::default())
            .unwrap()
            .run(&b.start, &times, |s| {
                if s.time == 0.0 {
                    return;
                }
                let m = body_motion(&b.bodies, &setup::state(s), last);
                v_N.push(m.v_NCo_N + m.w_NC_N.cross(&(m.R_NC * point)));
                w_N.push(m.w_NC_N);
                rotor.push(axial_momenta(&b, s));
                if s.time == times[3] {
                    a = m.R_NC * s.body.at_point(&s.kinematics, last, &point);
                    alpha = s.R_NB * s.body.alpha[last];
                    torque = [s.wheel_torque[0], s.wheel_torque[1]];
                }
            })
            .unwrap();
        let size = a.norm() + alpha.norm();
        assert!((slope(&v_N, step) - a).norm() < 1e-9 * size, "{index}");
        assert!((slope(&w_N, step) - alpha).norm() < 1e-9 * size, "{index}");
        // h_w' is the motor torque, both for a driven wheel and for prescribed speed.
        let motor = slope(&rotor, step);
        assert!((motor.x - torque[0]).abs() < 1e-9, "{index}");
        assert!((motor.y - torque[1]).abs() < 1e-9, "{index}");
        assert!((torque[1] - 0.03).abs() < 1e-15);
    }
}

/// `Js (Omega + a.w_host)` of both wheels, with host rates by definition.
fn axial_momenta(b: &Busy, s: &MotionSample) -> Vector3 {
    let state = setup::state(s);
    let h = |i: usize| {
        let wheel = &b.wheels[i];
        let m = body_motion(&b.bodies, &state, wheel.host);
        wheel.spin_inertia * (s.wheel_speed[i] + (m.R_NC * wheel.axis_C).dot(&m.w_NC_N))
    };
    Vector3::new(h(0), h(1), 0.0)
}

#[test]
fn prop_momentum_changes_by_the_thrust_on_a_moving_link() {
    let step = 1e-3;
    for index in choices().into_iter().step_by(40) {
        let fire = |on, off, force| Firing {
            thruster: 0,
            on,
            off,
            force,
        };
        let b = busy(index, vec![fire(1.0, 20.0, 3.0), fire(5.0, 9.0, 1.5)]);
        let thruster = &b.model.thrusters[0];
        for (centre, level) in [(0.5, 0.0), (3.0, 3.0), (7.0, 4.5), (15.0, 3.0), (22.0, 0.0)] {
            let mut times = vec![0.0];
            times.extend(around(centre, step));
            let (mut l, mut h, mut force, mut torque) =
                (Vec::new(), Vec::new(), Vector3::zeros(), Vector3::zeros());
            Flight::new(&b.model, &b.plan, Tolerance::default())
                .unwrap()
                .run(&b.start, &times, |s| {
                    if s.time == 0.0 {
                        return;
                    }
                    let state = setup::state(s);
                    let sum = system_momentum(&b.bodies, &b.wheels, &state).unwrap();
                    l.push(sum.l_S_N);
                    h.push(sum.h_SScm_N);
                    if s.time == times[3] {
                        let m = body_motion(&b.bodies, &state, thruster.body);
                        force = m.R_NC * thruster.direction_B * level;
                        let point = m.p_NCo_N + m.R_NC * thruster.p_BoT_B;
                        torque = (point - sum.p_NScm_N).cross(&force);
                        assert_eq!(s.thrust[0], level);
                    }
                })
                .unwrap();
            assert!((slope(&l, step) - force).norm() < 1e-8, "{index} {centre}");
            assert!((slope(&h, step) - torque).norm() < 1e-8, "{index} {centre}");
        }
    }
}

#[test]
fn exact_start_from_momentum_is_the_start_from_twist() {
    let mut b = busy(choices()[1], Vec::new());
    let end = |b: &Busy| {
        let mut out = None;
        Flight::new(&b.model, &b.plan, Tolerance::default())
            .unwrap()
            .run(&b.start, &[0.0, 5.0], |s| {
                out = Some((s.l_S_N, s.h_SScm_N, s.clone()))
            })
            .unwrap();
        out.unwrap()
    };
    let (l, h, by_twist) = end(&b);
    b.start.velocity = StartVelocity::Momentum {
        l_S_N: l,
        h_SScm_N: h,
    };
    let (_, _, by_momentum) = end(&b);
    assert!((by_twist.w_NB_B - by_momentum.w_NB_B).norm() < 1e-12);
    assert!((by_twist.p_NoBo_N - by_momentum.p_NoBo_N).norm() < 1e-12);
    assert!((by_twist.wheel_speed[1] - by_momentum.wheel_speed[1]).abs() < 1e-10);
}

#[test]
fn unit_questions_that_cannot_be_asked_are_errors() {
    let mut b = busy(choices()[0], Vec::new());
    let start = b.start;
    let run = |b: &Busy, times: &[f64]| {
        Flight::new(&b.model, &b.plan, Tolerance::default())?.run(&start, times, |_| {})
    };
    assert_eq!(run(&b, &[0.0, -1.0]), Err(MotionError::Times(1)));
    assert_eq!(run(&b, &[f64::NAN]), Err(MotionError::Times(0)));
    b.model.environment.gravity_gradient = true;
    b.model.environment.point_mass_gm = Some(3.986004418e14);
    // The orbit is missing.
    assert!(matches!(run(&b, &[0.0]), Err(MotionError::Gravity(_))));
    b.model.environment = Environment::default();
    b.plan.joints.pop();
    assert!(matches!(run(&b, &[0.0]), Err(MotionError::Plan { .. })));
    let mut b = busy(choices()[0], Vec::new());
    b.model
        .bodies
        .iter_mut()
        .for_each(|body| body.nominal.mass = 0.0);
    assert_eq!(run(&b, &[0.0]), Err(MotionError::NoMass));
    // A point mass has no inertia about itself.
    let mut b = busy(choices()[0], Vec::new());
    for (i, body) in b.model.bodies.iter_mut().enumerate() {
        body.nominal = poinsot_spatial::MassProperties {
            mass: if i == 0 { 1.0 } else { 0.0 },
            ..poinsot_spatial::MassProperties::ZERO
        };
    }
    let halted = run(&b, &[0.0]);
    assert!(matches!(
        halted,
        Err(MotionError::Halt(Halt::Singular { .. }))
    ));
}
