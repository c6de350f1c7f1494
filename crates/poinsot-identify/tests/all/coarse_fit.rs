//! A fit with large nominal errors and no linear start: a coarse fit to few samples, then a fit to all.

use crate::two_bodies;

use poinsot_dynamics::Tree;
use poinsot_identify::{
    Estimate, Noise, Observations, Problem, Samples, Segment, SensorRecord, SensorValue, Status,
    maximum_likelihood,
};
use poinsot_model::{EstimateSet, Model, SensorKind, parse_model};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use two_bodies::{VEHICLE, tumble};

const ROWS: usize = 2000;

/// Pseudo-random noise of unit variance.
fn scatter(k: usize) -> f64 {
    let uniform = ((12.9898 * (k as f64 + 1.0)).sin() * 43758.5453).fract();
    uniform * 3.0_f64.sqrt()
}

/// Rate and attitude of a tumbling bus, each with noise of 1e-5.
fn record(model: &Model) -> Segment {
    let times: Vec<f64> = (0..ROWS).map(|k| 0.02 * k as f64).collect();
    let mut samples = Samples {
        time_s: times.clone(),
        ..Samples::default()
    };
    let error = |k: usize| Vector3::from_fn(|i, _| 1.0e-5 * scatter(3 * k + i));
    tumble(model, 0, &times, |s| {
        let k = samples.R_NB.len();
        let turn = UnitQuaternion::from_scaled_axis(error(k + ROWS));
        samples.R_NB.push(s.R_NB * turn);
        samples.w_NB_B.push(s.w_NB_B + error(k));
        samples.joint_position.extend(&s.q);
        samples.joint_rate.extend(&s.rates);
    });
    let vectors = |kind, values: &[Vector3]| {
        SensorRecord::of_base(kind, Matrix3::identity() * 1.0e-10)
            .at_every_time(values.iter().map(|x| SensorValue::Vector(*x)))
    };
    let attitudes = samples.R_NB.iter().map(|R| SensorValue::Attitude(*R));
    let attitude = SensorRecord::of_base(SensorKind::Attitude, Matrix3::identity() * 1.0e-10);
    let observations = Observations {
        time_s: times,
        sensors: vec![
            vectors(SensorKind::Gyro, &samples.w_NB_B),
            attitude.at_every_time(attitudes),
        ],
        joint_position: samples.joint_position.clone(),
        joint_rate: samples.joint_rate.clone(),
        ..Observations::default()
    };
    Segment {
        label: "record".to_owned(),
        samples,
        observations,
        ..Segment::default()
    }
}

fn solved(model: &Model, tree: &Tree, segment: &Segment) -> Estimate {
    let one = Matrix3::identity() * 1.0e-10;
    let noise = Noise {
        gyro_sensor: None,
        gyro: one,
        attitude: one,
        velocity: one,
        position: one,
        joint_position: vec![0.0],
        joint_rate: vec![0.0],
        wheel_speed: Vec::new(),
        seen_gyro: 1.0,
        seen_velocity: 1.0,
        seen_joint_rate: 0.0,
    };
    maximum_likelihood(&Problem {
        model,
        tree,
        segments: std::slice::from_ref(segment),
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    })
    .unwrap()
}

#[test]
fn prop_a_far_start_ends_where_a_near_one_does() {
    let mut near = parse_model(VEHICLE, "vehicle.toml").unwrap();
    near.bodies[0].estimate = EstimateSet::default();
    let tree = Tree::new(&near);
    let segment = record(&near);
    let expected = solved(&near, &tree, &segment);
    assert_eq!(expected.status, Status::Converged);
    let mut far = near.clone();
    far.bodies[1].nominal.mass *= 4.0;
    far.bodies[1].nominal.I_BBcm_B *= 3.0;
    far.bodies[1].nominal.p_BoBcm_B *= -1.0;
    let found = solved(&far, &tree, &segment);
    assert_eq!(found.status, Status::Converged);
    // Iterations on all samples; the approach was made on few samples.
    assert!(found.iterations <= 3, "{} iterations", found.iterations);
    let (ours, theirs) = (&found.bodies[1], &expected.bodies[1]);
    let numbers = |body: &poinsot_identify::BodyEstimate| {
        let all = std::iter::once(&body.mass)
            .chain(&body.com)
            .chain(&body.inertia);
        all.map(|n| (n.value.unwrap(), n.sigma.unwrap()))
            .collect::<Vec<_>>()
    };
    let pairs = numbers(ours).into_iter().zip(numbers(theirs));
    for (at, ((x, _), (expected, sigma))) in pairs.enumerate() {
        assert!(
            (x - expected).abs() < 1.0e-3 * sigma,
            "{at}: {x} {expected} {sigma}"
        );
    }
}
