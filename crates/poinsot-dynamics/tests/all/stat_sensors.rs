//! Simulated sensors: observed statistics against declared ones.

use crate::setup;

use poinsot_dynamics::*;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::momentum_sum::{KitBody, KitJoint};

const SAMPLES: usize = 40_000;

fn sensor(kind: SensorKind) -> Sensor {
    Sensor {
        name: "sensor".into(),
        kind,
        body: 1,
        noise_covariance: None,
        quantisation: 0.0,
        bias: Nuisance::Known,
        scale: Nuisance::Known,
        misalignment: Nuisance::Known,
        nonorthogonality: Nuisance::Known,
        lag: Nuisance::Known,
        slow: Vec::new(),
        R_BS: Matrix3::identity(),
        p_BoS_B: Vector3::zeros(),
        reference_N: None,
        seen_from: 0,
        of: Vec::new(),
    }
}

/// One instant of a spinning base with a rotating link.
fn instant() -> (Tree, MotionSample) {
    let body = |joint, mass| KitBody {
        parent: 0,
        joint,
        p_PoCo_P: Vector3::new(0.5, -0.2, 0.3),
        R_PC_zero: UnitQuaternion::from_euler_angles(0.3, 0.2, -0.7)
            .to_rotation_matrix()
            .into_inner(),
        axis_C: Vector3::new(0.6, 0.0, 0.8),
        mass,
        p_CoCcm_C: Vector3::new(0.1, 0.2, -0.1),
        I_CCcm_C: Matrix3::from_diagonal(&Vector3::new(3.0, 4.0, 5.0)),
    };
    let bodies = [body(KitJoint::Base, 50.0), body(KitJoint::Revolute, 8.0)];
    let model = setup::model(&bodies, &[]);
    let mut plan = Plan::hold(&model);
    plan.joints = vec![
        JointMotion::quintic_rest(&[0.0, 4.0], &[0.2, 1.7])
            .unwrap()
            .into(),
    ];
    let start = Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.1, 0.0, -0.2),
            w_NB_B: Vector3::new(0.2, -0.1, 0.15),
        },
        ..Start::at_rest()
    };
    let vehicle = Flight::new(&model, &plan, Tolerance::default()).unwrap();
    let mut sample = None;
    vehicle
        .run(&start, &[0.0, 1.5], |s| sample = Some(s.clone()))
        .unwrap();
    (Tree::new(&model), sample.unwrap())
}

/// A covariance that is not diagonal.
fn covariance() -> Matrix3 {
    let root = Matrix3::new(3e-4, 1e-4, 0.0, 0.0, 2e-4, -5e-5, 0.0, 0.0, 1e-4);
    root * root.transpose()
}

fn vectors(sensor: &Sensor, bias: Option<&[f64]>) -> Vec<Vector3> {
    let (tree, sample) = instant();
    let mut instrument = Instrument::new(sensor, &tree, 7, 3, bias);
    let mut out = Vec::new();
    (0..SAMPLES)
        .map(|_| {
            instrument.read(&sample, &mut out);
            Vector3::from_column_slice(&out)
        })
        .collect()
}

fn mean_and_covariance(x: &[Vector3]) -> (Vector3, Matrix3) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<Vector3>() / n;
    let squares = |v: &Vector3| (v - mean) * (v - mean).transpose();
    (mean, x.iter().map(squares).sum::<Matrix3>() / (n - 1.0))
}

/// Every entry is within five standard errors (Gaussian: variance of a sample covariance).
fn same_covariance(found: &Matrix3, declared: &Matrix3) {
    for r in 0..3 {
        for c in 0..3 {
            let spread = declared[(r, r)] * declared[(c, c)] + declared[(r, c)].powi(2);
            let error = (spread / SAMPLES as f64).sqrt();
            let off = (found[(r, c)] - declared[(r, c)]).abs();
            assert!(off < 5.0 * error, "({r}, {c}): {off:e} against {error:e}");
        }
    }
}

#[test]
fn stat_vector_noise_has_the_declared_mean_and_covariance_in_the_sensor_axes() {
    let R_BS = UnitQuaternion::from_euler_angles(0.5, -0.9, 0.2)
        .to_rotation_matrix()
        .into_inner();
    let bias = [1e-3, -2e-3, 5e-4];
    for kind in [
        SensorKind::Gyro,
        SensorKind::Accelerometer,
        SensorKind::Velocity,
        SensorKind::Position,
    ] {
        let p_BoS_B = Vector3::new(0.3, 0.1, -0.2);
        let declared = Sensor {
            noise_covariance: Some(covariance()),
            R_BS,
            p_BoS_B,
            ..sensor(kind)
        };
        let (_, sample) = instant();
        let truth = vector_reading(kind, &sample, 1, &p_BoS_B);
        let errors: Vec<Vector3> = vectors(&declared, Some(&bias))
            .iter()
            .map(|x| x - truth)
            .collect();
        // Position and velocity errors are in inertial axes.
        let turn = match kind {
            SensorKind::Gyro | SensorKind::Accelerometer => R_BS,
            _ => Matrix3::identity(),
        };
        let own: Vec<Vector3> = errors.iter().map(|e| turn.transpose() * e).collect();
        let (mean, found) = mean_and_covariance(&own);
        same_covariance(&found, &covariance());
        for k in 0..3 {
            let error = (covariance()[(k, k)] / SAMPLES as f64).sqrt();
            assert!((mean[k] - bias[k]).abs() < 5.0 * error, "{kind:?} {k}");
        }
    }
}

#[test]
fn stat_attitude_noise_is_a_small_turn_in_body_axes() {
    let declared = Sensor {
        noise_covariance: Some(covariance()),
        ..sensor(SensorKind::Attitude)
    };
    let (tree, sample) = instant();
    let R = sample.kinematics.R[1];
    let truth = sample.R_NB * UnitQuaternion::from_matrix(&R);
    let mut instrument = Instrument::new(&declared, &tree, 7, 3, None);
    let mut out = Vec::new();
    let errors: Vec<Vector3> = (0..SAMPLES)
        .map(|_| {
            instrument.read(&sample, &mut out);
            let q = nalgebra::Quaternion::new(out[3], out[0], out[1], out[2]);
            assert!((q.norm() - 1.0).abs() < 1e-14);
            (truth.inverse() * UnitQuaternion::new_normalize(q)).scaled_axis()
        })
        .collect();
    let (mean, found) = mean_and_covariance(&errors);
    assert!(mean.norm() < 5.0 * (covariance().trace() / SAMPLES as f64).sqrt());
    same_covariance(&found, &covariance());
}

#[test]
fn stat_drawn_bias_has_the_declared_sigma_and_differs_by_stream() {
    let (tree, _) = instant();
    let declared = Sensor {
        bias: Nuisance::Prior(1e-3),
        ..sensor(SensorKind::Gyro)
    };
    let n = 2000;
    let biases: Vec<f64> = (0..n)
        .flat_map(|stream| {
            Instrument::new(&declared, &tree, 1, stream, None)
                .bias()
                .to_vec()
        })
        .collect();
    let square = biases.iter().map(|b| b * b).sum::<f64>() / biases.len() as f64;
    let error = (2.0 / biases.len() as f64).sqrt();
    assert!((square / 1e-6 - 1.0).abs() < 5.0 * error, "{square:e}");
    let again = Instrument::new(&declared, &tree, 1, 5, None);
    assert_eq!(again.bias(), &biases[15..18]);
    let other_seed = Instrument::new(&declared, &tree, 2, 5, None);
    assert_ne!(other_seed.bias(), again.bias());
}

#[test]
fn exact_quantisation_rounds_to_the_nearest_bit() {
    let (tree, sample) = instant();
    let declared = Sensor {
        quantisation: 0.01,
        of: vec![0],
        ..sensor(SensorKind::JointPosition)
    };
    let mut out = Vec::new();
    Instrument::new(&declared, &tree, 1, 1, None).read(&sample, &mut out);
    assert_eq!(out.len(), 1);
    assert!((out[0] - sample.q[0]).abs() <= 0.005 && out[0] != sample.q[0]);
    assert!((out[0] / 0.01 - (out[0] / 0.01).round()).abs() < 1e-9);
}

#[test]
fn exact_silent_sensors_read_the_truth() {
    let (tree, sample) = instant();
    let mut out = Vec::new();
    let mut read = |kind, of: &[usize]| {
        let declared = Sensor {
            of: of.to_vec(),
            ..sensor(kind)
        };
        Instrument::new(&declared, &tree, 1, 1, None).read(&sample, &mut out);
        out.clone()
    };
    let k = &sample.kinematics;
    let R_NL = sample.R_NB.to_rotation_matrix().into_inner() * k.R[1];
    let axis = Vector3::new(0.6, 0.0, 0.8);
    // The link's rate is the base's rate in link axes plus the joint rate.
    let R_BL: Matrix3 = k.R[1];
    let w = R_BL.transpose() * sample.w_NB_B + axis * sample.rates[0];
    assert!((Vector3::from_column_slice(&read(SensorKind::Gyro, &[])) - w).norm() < 1e-15);
    let p = sample.p_NoBo_N + sample.R_NB * Vector3::new(0.5, -0.2, 0.3);
    assert!((Vector3::from_column_slice(&read(SensorKind::Position, &[])) - p).norm() < 1e-15);
    assert_eq!(read(SensorKind::JointRate, &[0]), sample.rates);
    let q = read(SensorKind::Attitude, &[]);
    let q = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(q[3], q[0], q[1], q[2]));
    assert!((q.to_rotation_matrix().into_inner() - R_NL).norm() < 1e-14);
    // A velocity increment needs a previous sample.
    assert!(read(SensorKind::VelocityIncrement, &[]).is_empty());
}
