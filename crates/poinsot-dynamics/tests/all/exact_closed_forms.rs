//! Driven motion against closed forms: the torque-free tops, a gyrostat, the two-body hinge; energy and momentum.

use crate::xu_arm;

use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::rigid_body::{AsymmetricTop, Spin};

const PRECISE: Integrator = Integrator::DormandPrince8(Tolerance {
    relative: 1e-13,
    max_steps: 1_000_000,
});

/// A body about its mass centre at `c`.
fn body(mass: f64, c: [f64; 3], moments: [f64; 3]) -> InertialParameters {
    MassProperties {
        mass,
        p_BoBcm_B: Vector3::from(c),
        I_BBcm_B: Matrix3::from_diagonal(&Vector3::from(moments)),
    }
    .parameters()
}

fn passive(spring: SpringDamper, initial_position: f64, initial_rate: f64) -> JointDrive {
    JointDrive::Force {
        motor: ForceProfile::none(),
        spring,
        initial_position,
        initial_rate,
    }
}

/// A base with a chain of hinged bodies.
fn chain(hinges: &[(Vector3, Vector3)]) -> Tree {
    let mut links = vec![Link::base()];
    for (k, (p, axis)) in hinges.iter().enumerate() {
        links.push(Link::new(
            k,
            Motion::Revolute(k),
            *p,
            Matrix3::identity(),
            *axis,
        ));
    }
    Tree {
        links,
        rotors: Vec::new(),
        coordinates: (0..hinges.len()).collect(),
    }
}

fn turning(w_NB_B: Vector3, v_NBo_N: Vector3) -> Start {
    Start {
        velocity: StartVelocity::Twist { v_NBo_N, w_NB_B },
        ..Start::at_rest()
    }
}

fn samples(flight: &Flight, start: &Start, times: &[f64]) -> Vec<MotionSample> {
    let mut all = Vec::new();
    flight.run(start, times, |s| all.push(s.clone())).unwrap();
    all
}

fn flight(tree: Tree, bodies: Vec<InertialParameters>, plan: &Plan) -> Flight<'_> {
    let vehicle = Vehicle::new(tree, bodies, Vec::new(), Vec::new());
    Flight::new(vehicle, plan, PRECISE).unwrap()
}

fn attitude_apart(a: &UnitQuaternion, R_NB: &Matrix3) -> f64 {
    (a.to_rotation_matrix().into_inner() - R_NB).amax()
}

#[test]
fn exact_torque_free_asymmetric_top() {
    let moments = [30.0, 45.0, 62.0];
    let plan = Plan {
        joints: Vec::new(),
        ..Plan::default()
    };
    // The mass centre is not the origin; the rotation does not depend on it.
    let bodies = vec![body(120.0, [0.3, -0.2, 0.5], moments)];
    let vehicle = flight(chain(&[]), bodies, &plan);
    for w in [
        Vector3::new(0.1, 0.7, -0.2),
        Vector3::new(0.5, 0.05, 0.1),
        Vector3::new(0.02, -0.1, 0.6),
    ] {
        let spin = Spin {
            R_NB: Matrix3::identity(),
            w_NB_B: w,
        };
        let I = Matrix3::from_diagonal(&Vector3::from(moments));
        let top = AsymmetricTop::new(&I, &spin).unwrap();
        let times: Vec<f64> = (0..=40).map(|k| 2.5 * f64::from(k)).collect();
        for sample in samples(&vehicle, &turning(w, Vector3::zeros()), &times) {
            let exact = top.at(sample.time);
            let found = attitude_apart(&sample.R_NB, &exact.R_NB);
            // 1.3e-11 for the first, which passes its middle axis, where errors grow.
            assert!(found < 5e-11, "{w}: {found:e}");
            assert!((sample.w_NB_B - exact.w_NB_B).amax() < 5e-11);
        }
    }
}

/// A symmetric top with a torque-driven wheel on its axis. The transverse rate rotates with
/// `((I_c - I_a) w_c + h_w) / I_a` in body axes, where `w_c` and `h_w` are linear in time.
#[test]
fn exact_symmetric_gyrostat_with_a_driven_wheel() {
    let (Ia, Ic, js, torque) = (40.0, 25.0, 0.3, 0.02);
    let mut tree = chain(&[]);
    tree.rotors.push(Rotor {
        body: 0,
        axis_B: Vector3::z(),
    });
    let (speed, w0) = (20.0, Vector3::new(0.03, 0.0, 0.05));
    let plan = Plan {
        joints: Vec::new(),
        wheels: vec![WheelMotion::Torque {
            initial_speed: speed,
            torque: PiecewisePolynomial::constant(torque),
        }],
        ..Plan::default()
    };
    let bodies = vec![body(120.0, [0.3, -0.2, 0.5], [Ia, Ia, Ic])];
    let vehicle = Vehicle::new(tree, bodies, vec![js], Vec::new());
    let vehicle = Flight::new(vehicle, &plan, PRECISE).unwrap();
    let times: Vec<f64> = (0..=60).map(f64::from).collect();
    for sample in samples(&vehicle, &turning(w0, Vector3::zeros()), &times) {
        let t = sample.time;
        let reduced = Ic - js;
        let h_w = js * (speed + w0.z) + torque * t;
        let w_c = w0.z - torque * t / reduced;
        // d(w_x + i w_y)/dt = i rate (w_x + i w_y), rate linear in time.
        let at = |t: f64| {
            let (h_w, w_c) = (
                js * (speed + w0.z) + torque * t,
                w0.z - torque * t / reduced,
            );
            ((reduced - Ia) * w_c + h_w) / Ia
        };
        let phase = t * 0.5 * (at(0.0) + at(t));
        let exact = Vector3::new(w0.x * phase.cos(), w0.x * phase.sin(), w_c);
        let found = (sample.w_NB_B - exact).amax();
        assert!(found < 1e-12, "{t}: {found:e}");
        let wheel = sample.wheel_speed[0] - (h_w / js - w_c);
        assert!(wheel.abs() < 1e-9, "{t}: {wheel:e}");
    }
}

/// Two bodies with a hinge through both mass centres, a spring between them, and zero momentum. The relative angle is
/// the damped oscillator of the reduced inertia; the base rotates by the other body's share of inertia.
#[test]
fn exact_two_body_hinge_with_spring_and_damper() {
    let (I0, I1) = (30.0, 4.0);
    let spring = SpringDamper {
        stiffness: 2.0,
        rest: 0.1,
        damping: 0.3,
    };
    let plan = Plan {
        joints: vec![passive(spring, 0.6, 0.0)],
        ..Plan::default()
    };
    let tree = chain(&[(Vector3::new(0.0, 0.0, 0.4), Vector3::z())]);
    let bodies = vec![
        body(50.0, [0.0; 3], [20.0, 25.0, I0]),
        body(8.0, [0.0, 0.0, 0.7], [5.0, 6.0, I1]),
    ];
    let vehicle = flight(tree, bodies, &plan);
    let reduced = I0 * I1 / (I0 + I1);
    let decay = 0.5 * spring.damping / reduced;
    let pace = (spring.stiffness / reduced - decay * decay).sqrt();
    let times: Vec<f64> = (0..=50).map(|k| 0.37 * f64::from(k)).collect();
    for sample in samples(&vehicle, &Start::at_rest(), &times) {
        let t = sample.time;
        let swing = (pace * t).cos() + decay / pace * (pace * t).sin();
        let exact = 0.1 + 0.5 * (-decay * t).exp() * swing;
        let q = sample.q[0];
        assert!((q - exact).abs() < 1e-12, "{t}: {:e}", q - exact);
        let turn = sample.R_NB.scaled_axis().z;
        let share = -(q - 0.6) * I1 / (I0 + I1);
        assert!((turn - share).abs() < 1e-12, "{t}: {:e}", turn - share);
        assert!(sample.p_NoBo_N.norm() < 1e-12);
    }
}

/// A hinge away from the mass centres, constant torque, plane motion from rest. The mass centre is at rest, the
/// angular momentum zero, and the work of the torque equals the kinetic energy.
#[test]
fn exact_work_of_a_hinge_torque_is_kinetic_energy() {
    let torque = 0.7;
    let plan = Plan {
        joints: vec![JointDrive::Force {
            motor: ForceProfile::Nodes(PiecewisePolynomial::constant(torque)),
            spring: SpringDamper::default(),
            initial_position: -0.4,
            initial_rate: 0.0,
        }],
        ..Plan::default()
    };
    let tree = chain(&[(Vector3::new(0.8, 0.1, 0.0), Vector3::z())]);
    let bodies = vec![
        body(50.0, [0.1, 0.0, 0.0], [20.0, 25.0, 30.0]),
        body(8.0, [0.5, 0.2, 0.0], [5.0, 6.0, 4.0]),
    ];
    let vehicle = flight(tree, bodies.clone(), &plan);
    let times: Vec<f64> = (0..=20).map(|k| 0.3 * f64::from(k)).collect();
    let all = samples(&vehicle, &Start::at_rest(), &times);
    for sample in &all {
        let work = torque * (sample.q[0] + 0.4);
        let energy = kinetic_energy(&bodies, &sample.kinematics);
        assert!(
            (work - energy).abs() < 1e-11 * (1.0 + work),
            "{work} {energy}"
        );
    }
    assert!(all[20].q[0] > 2.0);
}

/// A tumbling three-body chain with springs and without damper conserves energy, and momentum to round-off; with a
/// damper the energy decreases.
#[test]
fn prop_energy_and_momentum_of_a_springy_chain() {
    let bodies = vec![
        body(50.0, [0.1, 0.0, 0.2], [20.0, 25.0, 30.0]),
        body(8.0, [0.5, 0.2, 0.0], [0.5, 0.6, 0.7]),
        body(5.0, [0.1, -0.3, 0.4], [0.3, 0.4, 0.5]),
    ];
    let hinges = [
        (Vector3::new(0.8, 0.1, 0.0), Vector3::new(0.6, 0.0, 0.8)),
        (Vector3::new(0.9, 0.0, 0.3), Vector3::y()),
    ];
    let energy = |damping: f64, how: Integrator| -> (f64, f64, f64) {
        let spring = SpringDamper {
            stiffness: 3.0,
            rest: 0.2,
            damping,
        };
        let plan = Plan {
            joints: vec![passive(spring, 0.7, 0.1), passive(spring, -0.5, 0.3)],
            ..Plan::default()
        };
        let vehicle = Vehicle::new(chain(&hinges), bodies.clone(), Vec::new(), Vec::new());
        let vehicle = Flight::new(vehicle, &plan, how).unwrap();
        let start = turning(Vector3::new(0.2, -0.3, 0.4), Vector3::new(0.5, 0.1, -0.2));
        let all = samples(&vehicle, &start, &[0.0, 30.0]);
        let total = |s: &MotionSample| {
            let springs: f64 = s.q.iter().map(|q| spring.energy(*q)).sum();
            springs + kinetic_energy(&bodies, &s.kinematics)
        };
        let whole = |s: &MotionSample| {
            let m = momentum(&bodies, &s.kinematics);
            s.R_NB * Vector3::new(m[0], m[1], m[2])
        };
        let drift = (whole(&all[1]) - whole(&all[0])).norm();
        (total(&all[0]), total(&all[1]), drift)
    };
    let (before, after, drift) = energy(0.0, PRECISE);
    assert!((after - before).abs() < 1e-11 * before, "{before} {after}");
    assert!(drift < 1e-12, "{drift:e}");
    let (before, after, drift) = energy(0.0, Integrator::RungeKutta4(0.02));
    assert!((after - before).abs() < 1e-5 * before, "{before} {after}");
    assert!(drift < 1e-12, "{drift:e}");
    let (before, after, _) = energy(0.2, PRECISE);
    assert!(after < 0.95 * before, "{before} {after}");
}

/// Base parameters give the same motion as the original vehicle. The part of a body that a revolute joint does not
/// affect (mass, first moment along the axis, line inertia on it) is transferred to the parent.
#[test]
fn exact_base_parameters_move_alike() {
    let plan = Plan {
        joints: xu_arm::drives(),
        ..Plan::default()
    };
    let end = |parameters: Vec<InertialParameters>| {
        let tree = xu_arm::tree();
        let vehicle = flight(tree, parameters, &plan);
        let all = samples(&vehicle, &xu_arm::start(), &[0.0, 5.0]);
        all[1].clone()
    };
    let (tree, mut moved) = (xu_arm::tree(), xu_arm::parameters());
    for i in (1..moved.len()).rev() {
        let mass = moved[i].mass;
        let (R, p) = (tree.links[i].R_PC_zero, tree.links[i].p_PoCo_P);
        moved[i].mass = 0.0;
        // A point on the axis at the child's origin is fixed in the parent.
        assert!((R * tree.links[i].axis_C - tree.links[i].axis_P).norm() < 1e-15);
        let parent = &mut moved[tree.links[i].parent];
        parent.mass += mass;
        parent.mc_B += p * mass;
        parent.I_BBo_B += poinsot_spatial::parallel_axis(mass, &p);
    }
    let (a, b) = (end(xu_arm::parameters()), end(moved));
    let q = a.q.iter().zip(&b.q).map(|(a, b)| (a - b).abs());
    assert!(q.fold(0.0, f64::max) < 1e-11);
    assert!((a.p_NoBo_N - b.p_NoBo_N).norm() < 1e-11);
    assert!(a.R_NB.angle_to(&b.R_NB) < 1e-11);
}

#[test]
fn unit_what_cannot_move_is_refused() {
    let plan = Plan {
        joints: vec![passive(SpringDamper::default(), 0.0, 0.0)],
        ..Plan::default()
    };
    let tree = chain(&[(Vector3::x(), Vector3::z())]);
    let bodies = vec![
        body(50.0, [0.0; 3], [20.0, 25.0, 30.0]),
        InertialParameters::ZERO,
    ];
    let vehicle = flight(tree.clone(), bodies, &plan);
    let refused = vehicle.run(&Start::at_rest(), &[0.0, 1.0], |_| {});
    let halt = Halt::Joint {
        time: 0.0,
        coordinate: 0,
    };
    assert_eq!(refused, Err(MotionError::Halt(halt)));
    let empty = vec![InertialParameters::ZERO; 2];
    let new = |bodies| {
        let vehicle = Vehicle::new(tree.clone(), bodies, Vec::new(), Vec::new());
        Flight::new(vehicle, &plan, PRECISE)
    };
    let refused = new(empty);
    assert!(matches!(refused, Err(MotionError::NoMass)));
    let two = vec![InertialParameters::ZERO; 3];
    let refused = new(two);
    assert!(matches!(refused, Err(MotionError::Plan { .. })));
}
