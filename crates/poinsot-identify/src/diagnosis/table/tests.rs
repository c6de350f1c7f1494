use super::*;
use crate::diagnosis::candidates::candidates;
use crate::diagnosis::projected::Score;
use crate::fit::fit_from;
use crate::problem::Problem;
use crate::problem::segment::{InputChannel, Samples, Segment, SensorRecord, SensorValue};
use nalgebra::UnitQuaternion;
use poinsot_dynamics::Tree;
use poinsot_model::{SensorKind, parse_model};

const MODEL: &str = r#"
schema = "poinsot.model/1"
name = "box"
exact = true
[[body]]
name = "box"
mass_kg = 10.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 2.0, zz = 2.0 }
estimate = ["inertia"]
[[wheel]]
name = "wheel"
body = "box"
axis = [0.0, 0.6, 0.8]
spin_inertia_kg_m2 = 0.001
[[sensor]]
name = "first"
type = "gyro"
noise_rad_s = 1.0e-4
[[sensor]]
name = "second"
type = "gyro"
noise_rad_s = 3.0e-4
[[sensor]]
name = "third"
type = "gyro"
noise_rad_s = 2.0e-4
[momentum]
linear_N_s = [0.0, 0.0, 0.0]
angular_N_m_s = "estimate"
"#;

/// About what is known of a moment of inertia, kg m2.
const SIGMA: f64 = 1.0e-3;

fn gyro(sensor: usize, sigma: f64, rates: &[Vector3]) -> SensorRecord {
    let variance = Matrix3::identity() * (sigma * sigma);
    let values = rates.iter().enumerate().map(|(k, w)| {
        // Each has residuals of its own.
        let error = sigma * ((7 * k + 3 * sensor) as f64).sin();
        SensorValue::Vector(w.add_scalar(error))
    });
    let mut record = SensorRecord::of_base(SensorKind::Gyro, variance).at_every_time(values);
    record.sensor = Some(sensor);
    record.name = format!("gyro {sensor}");
    record
}

/// Three gyros along one turning motion, beside a wheel that changes its speed; the second has samples at the end alone.
fn segment(label: &str, phase: f64) -> Segment {
    let time_s: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
    let turn = |t: &f64| Vector3::new(0.3 * (t + phase).sin(), 0.2, 0.1 * t.cos());
    let rates: Vec<Vector3> = time_s.iter().map(turn).collect();
    let samples = Samples {
        time_s: time_s.clone(),
        R_NB: vec![UnitQuaternion::identity(); time_s.len()],
        w_NB_B: rates.clone(),
        ..Samples::default()
    };
    let mut second = gyro(1, 3.0e-4, &rates);
    second.samples.drain(..20);
    let observations = Observations {
        wheel_speed: time_s.iter().map(|t| 50.0 * t.sin()).collect(),
        wheels: vec![InputChannel {
            errors: InputErrors::Kept(vec![0.8; time_s.len()]),
            ..InputChannel::default()
        }],
        time_s,
        sensors: vec![gyro(0, 1.0e-4, &rates), second, gyro(2, 2.0e-4, &rates)],
        ..Observations::default()
    };
    Segment {
        label: label.to_owned(),
        samples,
        observations,
        ..Segment::default()
    }
}

fn noise(wheel_speed: f64) -> Noise {
    Noise {
        gyro_sensor: None,
        gyro: Matrix3::identity() * 1.0e-8,
        attitude: Matrix3::zeros(),
        velocity: Matrix3::zeros(),
        position: Matrix3::zeros(),
        joint_position: vec![],
        joint_rate: vec![],
        wheel_speed: vec![wheel_speed],
        seen_gyro: 1.0,
        seen_velocity: 0.0,
        seen_joint_rate: 0.0,
    }
}

/// Decrease and values, in sigmas; nothing of a number that does not show.
fn told(score: &Score) -> Vec<f64> {
    let sigma = |k: usize| score.covariance[(k, k)].sqrt();
    let values = score.values.iter().enumerate();
    let shown = values.map(|(k, x)| {
        if sigma(k).is_finite() {
            x / sigma(k)
        } else {
            0.0
        }
    });
    std::iter::once(score.decrease).chain(shown).collect()
}

/// Whether numbers agree to round-off of the largest, or of one where all are smaller.
#[track_caller]
fn assert_same(what: &str, one: &[f64], other: &[f64]) {
    assert_eq!(one.len(), other.len(), "{what}");
    let largest = one.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
    for (a, b) in one.iter().zip(other) {
        assert!((a - b).abs() < 1.0e-9 * largest, "{what}: {a} {b}");
    }
}

/// Every score, and every effect on the answer, is the same in many groups as in one, with noise of a wheel in all rows and
/// without.
#[test]
fn exact_groups_have_the_scores_of_one() {
    let model = parse_model(MODEL, "box.toml").unwrap();
    let tree = Tree::new(&model);
    let segments = [segment("one", 0.0), segment("two", 0.4)];
    for variance in [0.0, 1.0e-2] {
        let noise = noise(variance);
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: &segments,
            noise: &noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let parameters = problem.likelihood_parameters().unwrap();
        let experiment = Experiment::new(&problem, &parameters);
        let fitted = fit_from(&experiment, experiment.nominal_point(), 0).unwrap();
        let mut list = candidates(&experiment, &fitted).0;
        list.retain(Candidate::is_tried_in_parts);
        let table = |most| Table::new(&experiment, &fitted, &list, Some(most)).unwrap();
        let (whole, parts) = (table(usize::MAX), table(4));
        assert!(whole.groups.len() == 1 && parts.groups.len() > 4);
        let columns = parts.groups.iter().map(|g| g.numbers.len());
        assert_eq!(columns.sum::<usize>(), whole.numbers);
        let of = |table: &Table, only| table.projected(only);
        let (one, many) = (of(&whole, None), of(&parts, None));
        let (one_alone, many_alone) = (of(&whole, Some(1)), of(&parts, Some(1)));
        let mut together = Vec::new();
        let mut first = 0;
        for candidate in &list {
            let own: Vec<usize> = (first..first + candidate.unknowns.len()).collect();
            first += own.len();
            let scores = [&one, &many].map(|all| told(&all.score(&own, None)));
            assert_same(&candidate.name, &scores[0], &scores[1]);
            let sigma = |k: usize| one.score(&own[k..=k], None).covariance[(0, 0)].sqrt();
            let shifts = [&whole, &parts].map(|table| {
                let all = table.shifts(&own).unwrap();
                let all = all.into_iter().enumerate();
                // By one sigma of the number, in those of the answer.
                let moved = |(k, shift): (usize, Vec<f64>)| shift.into_iter().map(move |s| (k, s));
                let in_sigmas = |(k, s): (usize, f64)| s * sigma(k).min(1.0e6) / SIGMA;
                all.flat_map(moved).map(in_sigmas).collect::<Vec<f64>>()
            });
            assert_same(&candidate.name, &shifts[0], &shifts[1]);
            if candidate.is_scored_with_others() {
                together.extend(own);
            }
        }
        // The torque of a drift, and a lag of every gyro.
        assert!(together.len() >= 6, "{together:?}");
        let scores = [&one, &many].map(|all| told(&all.score(&together, Some(1.0))));
        assert!(scores[0][0] > 0.0);
        assert_same("together", &scores[0], &scores[1]);
        let scores = [&one_alone, &many_alone].map(|all| told(&all.score(&together, Some(1.0))));
        assert!(scores[0][0] > 0.0);
        assert_same("in one segment", &scores[0], &scores[1]);
    }
}
