//! Results are bitwise equal for any number of threads.

use crate::two_bodies;

use poinsot_dynamics::Tree;
use poinsot_identify::{
    Estimate, Noise, Number, Observations, Problem, Samples, Segment, SensorRecord, SensorValue,
    Translation, linear, maximum_likelihood,
};
use poinsot_model::{Model, SensorKind, parse_model};
use poinsot_spatial::{Matrix3, Vector3};
use two_bodies::{VEHICLE, tumble};

/// Pseudo-random numbers between -1 and 1.
fn scatter(k: usize) -> f64 {
    (12.9898 * (k as f64 + 1.0)).sin() * (78.233 * (k as f64 + 2.0)).cos()
}

/// A tumbling segment with errors of the size of the declared noise.
fn segment(model: &Model, at: usize, rows: usize) -> Segment {
    let times: Vec<f64> = (0..rows).map(|k| 0.02 * k as f64).collect();
    let mut samples = Samples {
        time_s: times.clone(),
        ..Samples::default()
    };
    let mut motion = Translation::default();
    tumble(model, at, &times, |s| {
        let k = 10 * (samples.R_NB.len() + rows * at);
        let error = |from: usize| Vector3::from_fn(|i, _| 1.0e-5 * scatter(k + from + i));
        samples.R_NB.push(s.R_NB);
        samples.w_NB_B.push(s.w_NB_B + error(0));
        motion.v_NBo_N.push(s.v_NBo_N + error(3));
        motion.p_NoBo_N.push(s.p_NoBo_N + error(6));
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
            vectors(SensorKind::Velocity, &motion.v_NBo_N),
            vectors(SensorKind::Position, &motion.p_NoBo_N),
        ],
        joint_position: samples.joint_position.clone(),
        joint_rate: samples.joint_rate.clone(),
        ..Observations::default()
    };
    samples.translation = Some(motion);
    Segment {
        label: format!("segment {at}"),
        samples,
        observations,
        ..Segment::default()
    }
}

fn bits(estimate: &Estimate) -> Vec<u64> {
    let mut all: Vec<f64> = Vec::new();
    let mut see = |n: &Number| all.extend([n.value, n.sigma].map(|x| x.unwrap_or(f64::NAN)));
    for body in &estimate.bodies {
        see(&body.mass);
        body.com.iter().for_each(&mut see);
        body.inertia.iter().for_each(&mut see);
        body.barycentric.iter().for_each(&mut see);
    }
    for momentum in &estimate.momentum {
        momentum.linear.iter().for_each(&mut see);
        momentum.angular.iter().for_each(&mut see);
    }
    all.extend(estimate.covariance.iter().flatten());
    all.extend(&estimate.identifiability.sigmas_natural);
    for combination in &estimate.identifiability.determined {
        all.extend([combination.value, combination.sigma]);
        all.extend(combination.coefficients.iter().map(|c| c.1));
    }
    for fit in &estimate.fit {
        all.push(fit.chi2_per_dof);
        all.extend(fit.channels.iter().map(|c| c.rms));
    }
    all.into_iter().map(f64::to_bits).collect()
}

#[test]
fn exact_the_same_bits_on_1_2_3_and_8_threads() {
    let model = parse_model(VEHICLE, "vehicle.toml").unwrap();
    let tree = Tree::new(&model);
    // The linear method works in chunks of 1024 samples, the fit segment by segment.
    let segments: Vec<Segment> = [2600, 1100, 300]
        .into_iter()
        .enumerate()
        .map(|(at, rows)| segment(&model, at, rows))
        .collect();
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
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    };
    for (name, method) in [
        ("linear", linear as fn(&Problem) -> _),
        ("maximum_likelihood", maximum_likelihood),
    ] {
        let answers = [1, 2, 3, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let estimate = pool.install(|| method(&problem)).unwrap();
            assert_eq!(estimate.identifiability.rank, 16, "{name}");
            bits(&estimate)
        });
        assert!(answers[0].len() > 100);
        for (threads, answer) in [1, 2, 3, 8].into_iter().zip(&answers) {
            assert_eq!(*answer, answers[0], "{name} on {threads} threads");
        }
    }
}
