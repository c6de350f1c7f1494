//! Motion in a gravity gradient against closed forms.

use crate::setup;

use nalgebra::{Rotation3, UnitQuaternion};
use poinsot_dynamics::*;
use poinsot_model::{Model, Orbit};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_testkit::momentum_sum::*;

const GM: f64 = 3.986004418e14;

/// `K` of modulus k by the arithmetic-geometric mean of 1 and `sqrt(1 - k^2)`, which is the argument (Gauss).
fn complete_elliptic(complement: f64) -> f64 {
    let (mut a, mut b) = (1.0, complement);
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::FRAC_PI_2 / a
}

/// One body on a circular orbit in the xy plane of N.
fn satellite(moments: Vector3) -> (Model, f64) {
    let mut model = setup::model(
        &[KitBody {
            parent: 0,
            joint: KitJoint::Base,
            p_PoCo_P: Vector3::zeros(),
            R_PC_zero: Matrix3::identity(),
            axis_C: Vector3::z(),
            mass: 50.0,
            p_CoCcm_C: Vector3::new(0.1, -0.2, 0.05),
            I_CCcm_C: Matrix3::from_diagonal(&moments),
        }],
        &[],
    );
    let a = 7.0e6;
    model.environment.point_mass_gm = Some(GM);
    model.environment.gravity_gradient = true;
    model.environment.orbit = Some(Orbit {
        semi_major_axis: a,
        eccentricity: 0.0,
        inclination: 0.0,
        raan: 0.0,
        argument_of_periapsis: 0.0,
        true_anomaly: 0.0,
        epoch: None,
    });
    (model, (GM / a.powi(3)).sqrt())
}

/// Pitch libration about the local vertical is a pendulum: with k = (I_y - I_x)/I_z (x radial, y along track),
/// `theta'' = -(3/2) n^2 k sin 2 theta`. From rest at theta0 its quarter period is `K(sin theta0) / (n sqrt(3 k))`
/// (Hughes 1986, sec. 9.1).
#[test]
fn exact_libration_takes_the_period_of_a_pendulum() {
    let (model, n) = satellite(Vector3::new(2.0, 6.0, 5.0));
    let k: f64 = (6.0 - 2.0) / 5.0;
    for theta0 in [1.0e-3, 0.3, 1.2_f64] {
        let quarter = complete_elliptic(theta0.cos()) / (n * (3.0 * k).sqrt());
        let plan = Plan::hold(&model);
        let vehicle = Flight::new(&model, &plan, Tolerance::default()).unwrap();
        let start = Start {
            R_NB: UnitQuaternion::from_scaled_axis(Vector3::z() * theta0),
            p_NoBo_N: Vector3::zeros(),
            velocity: StartVelocity::Twist {
                v_NBo_N: Vector3::zeros(),
                w_NB_B: Vector3::z() * n,
            },
        };
        let mut angles = Vec::new();
        let times: Vec<f64> = (0..5).map(|i| quarter * f64::from(i)).collect();
        vehicle
            .run(&start, &times, |s| {
                let local = Rotation3::from_axis_angle(&Vector3::z_axis(), n * s.time);
                let relative = local.inverse() * s.R_NB.to_rotation_matrix();
                angles.push(relative[(1, 0)].atan2(relative[(0, 0)]));
            })
            .unwrap();
        for (angle, expected) in angles.iter().zip([1.0, 0.0, -1.0, 0.0, 1.0]) {
            let error = angle - expected * theta0;
            // The integrator's tolerance is 1e-12 rad.
            assert!(
                error.abs() < 1.0e-9 * theta0 + 1.0e-11,
                "{theta0}: {error:e}"
            );
        }
    }
}

/// On a circular orbit `w.I w / 2 - n h_z + (3/2) n^2 u.I u` is constant for any tumbling (Hughes 1986, sec. 9.2: the
/// Hamiltonian in orbiting axes).
#[test]
fn exact_tumbling_keeps_the_hamiltonian_of_orbiting_axes() {
    let moments = Vector3::new(2.0, 6.0, 5.0);
    let (model, n) = satellite(moments);
    let plan = Plan::hold(&model);
    let vehicle = Flight::new(&model, &plan, Tolerance::default()).unwrap();
    let start = Start {
        R_NB: UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.8, 0.3)),
        p_NoBo_N: Vector3::zeros(),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.01, 0.0, 0.02),
            w_NB_B: Vector3::new(0.7, -1.1, 0.4) * n,
        },
    };
    let I = Matrix3::from_diagonal(&moments);
    let mut values = Vec::new();
    let mut momenta = Vec::new();
    let times: Vec<f64> = (0..60).map(|i| 200.0 * f64::from(i)).collect();
    vehicle
        .run(&start, &times, |s| {
            let w = s.w_NB_B;
            let u = s.R_NB.inverse() * s.p_orbit_N.normalize();
            values.push(0.5 * w.dot(&(I * w)) - n * s.h_SScm_N.z + 1.5 * n * n * u.dot(&(I * u)));
            momenta.push(s.h_SScm_N);
            // The angular acceleration in the accelerometer's equations agrees with the torque.
            let T = gravity_gradient_torque(GM, &(s.R_NB.inverse() * s.p_orbit_N), &I);
            let alpha = s.body.alpha[0];
            assert!((I * alpha + w.cross(&(I * w)) - T).norm() < 1.0e-12 * T.norm().max(1.0e-6));
        })
        .unwrap();
    let scale = 6.0 * n * n;
    for v in &values {
        assert!(
            (v - values[0]).abs() < 1.0e-9 * scale,
            "{:e}",
            (v - values[0]) / scale
        );
    }
    // The momentum itself changes much.
    let moved = (momenta[59] - momenta[0]).norm() / momenta[0].norm();
    assert!(moved > 0.1, "{moved}");
}

/// A mass on a slider along the orbit normal oscillates through the orbital plane once per orbit, for any two masses:
/// `s'' = -n^2 s` (Hill, Clohessy and Wiltshire 1960). In the field both are in equilibrium, so nothing rotates.
#[test]
fn exact_a_free_slider_along_the_orbit_normal_swings_once_an_orbit() {
    let body = |parent, joint, mass| KitBody {
        parent,
        joint,
        p_PoCo_P: Vector3::zeros(),
        R_PC_zero: Matrix3::identity(),
        axis_C: Vector3::z(),
        mass,
        p_CoCcm_C: Vector3::zeros(),
        I_CCcm_C: Matrix3::from_diagonal(&Vector3::new(3.0, 3.0, 5.0)),
    };
    let bodies = [
        body(0, KitJoint::Base, 50.0),
        body(0, KitJoint::Prismatic, 7.0),
    ];
    let (around, n) = satellite(Vector3::new(2.0, 6.0, 5.0));
    let mut model = setup::model(&bodies, &[]);
    model.environment = around.environment;
    let plan = Plan {
        joints: vec![JointDrive::Force {
            motor: ForceProfile::none(),
            spring: SpringDamper::default(),
            initial_position: 1.5,
            initial_rate: 0.0,
        }],
        ..Plan::default()
    };
    let start = Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::zeros(),
            w_NB_B: Vector3::z() * n,
        },
        ..Start::at_rest()
    };
    let times: Vec<f64> = (0..7).map(|k| f64::from(k) * 1000.0).collect();
    let vehicle = Flight::new(&model, &plan, Tolerance::default()).unwrap();
    vehicle
        .run(&start, &times, |s| {
            let expected = 1.5 * (n * s.time).cos();
            assert!((s.q[0] - expected).abs() < 1.0e-9, "{}", s.q[0]);
        })
        .unwrap();
}

/// Wrenches on the single bodies have the same effect as the torque on the whole vehicle, and load prescribed joints.
#[test]
fn exact_driven_and_prescribed_motion_agree_in_the_field() {
    let inertia = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let bodies = [
        KitBody {
            parent: 0,
            joint: KitJoint::Base,
            p_PoCo_P: Vector3::zeros(),
            R_PC_zero: Matrix3::identity(),
            axis_C: Vector3::z(),
            mass: 50.0,
            p_CoCcm_C: Vector3::new(0.1, -0.2, 0.05),
            I_CCcm_C: inertia(2.0, 6.0, 5.0),
        },
        KitBody {
            parent: 0,
            joint: KitJoint::Revolute,
            p_PoCo_P: Vector3::new(0.4, 0.1, 0.3),
            R_PC_zero: Matrix3::identity(),
            axis_C: Vector3::y(),
            mass: 9.0,
            p_CoCcm_C: Vector3::new(0.9, 0.1, -0.2),
            I_CCcm_C: inertia(0.3, 1.1, 1.2),
        },
    ];
    let (around, n) = satellite(Vector3::new(2.0, 6.0, 5.0));
    let mut model = setup::model(&bodies, &[]);
    model.environment = around.environment;
    // Beyond the last time: at its end the acceleration jumps.
    let led = JointMotion::cubic_clamped(&[0.0, 900.0, 2100.0], &[0.2, 1.4, -0.5]).unwrap();
    let prescribed = Plan {
        joints: vec![led.into()],
        ..Plan::hold(&model)
    };
    let start = Start {
        R_NB: UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.8, 0.3)),
        p_NoBo_N: Vector3::zeros(),
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::zeros(),
            w_NB_B: Vector3::new(0.7, -1.1, 0.4) * n,
        },
    };
    let times: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 2.0).collect();
    let mut expected = Vec::new();
    Flight::new(&model, &prescribed, Tolerance::default())
        .unwrap()
        .run(&start, &times, |s| expected.push(s.clone()))
        .unwrap();
    // The force that the prescribed joint needs, as its motor's.
    let force: Vec<f64> = expected.iter().map(|s| s.motor_force[0]).collect();
    let motor = PiecewisePolynomial::linear(&times, &force).unwrap();
    let driven = Plan {
        joints: vec![JointDrive::Force {
            motor: ForceProfile::Nodes(motor),
            spring: SpringDamper::default(),
            initial_position: expected[0].q[0],
            initial_rate: expected[0].rates[0],
        }],
        ..Plan::default()
    };
    let mut wanted = expected.iter();
    Flight::new(&model, &driven, Tolerance::default())
        .unwrap()
        .run(&start, &times, |s| {
            let e = wanted.next().unwrap();
            assert!((s.q[0] - e.q[0]).abs() < 1.0e-5, "{} {}", s.q[0], e.q[0]);
            assert!(s.R_NB.angle_to(&e.R_NB) < 1.0e-5);
            let momentum = (s.h_SScm_N - e.h_SScm_N).norm();
            assert!(momentum < 1.0e-5 * e.h_SScm_N.norm(), "{momentum:e}");
            assert_eq!(s.p_orbit_N, e.p_orbit_N);
        })
        .unwrap();
    let (first, last) = (&expected[0].h_SScm_N, &expected[1000].h_SScm_N);
    assert!((last - first).norm() > 0.05 * first.norm());
}
