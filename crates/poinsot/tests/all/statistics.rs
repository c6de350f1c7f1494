//! Calibration of the stated uncertainty: small campaigns against 99.9 % bands.
//!
//! The full campaign is `poinsot campaign data/campaigns/NAME.toml --out DIR`.

use crate::setups;
use crate::shared::{faults, rows, statistics, undiagnosed};
use crate::tables;
use poinsot_report::{prediction_document, statistics_document};

use nalgebra::Matrix3;
use poinsot::bind::bind;
use poinsot::case::parse_case;
use poinsot::predict::{predict, prediction_file};
use poinsot::trials::{Band, Bound, Row, Study};
use poinsot_dynamics::Tree;
use poinsot_formats::MethodResultFile;
use poinsot_identify::{Estimate, Settings, Status, TENSOR, linear, maximum_likelihood_with};
use poinsot_model::{SensorKind, read_model};
use setups::study;
use std::path::{Path, PathBuf};

/// Trials of set-ups with short trials; the published campaign has 10,000.
const FAST: u64 = 150;

fn judge(study: &Study, trials: u64) -> MethodResultFile {
    let result = statistics(&rows(study, 0..tables::trials(trials)));
    println!("{}", statistics_document("", &result));
    result
}

#[track_caller]
fn assert_consistent(study: &Study, trials: u64) {
    let result = judge(study, trials);
    assert!(result.nees.is_some(), "no joint consistency was computed");
    let faults = faults(&result);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Replaces the rounding of a sensor by white noise of equal variance, and declares it coarser by this factor.
fn white(study: &mut Study, name: &str, factor: f64) {
    let of_study = study.sensors.iter_mut().chain(&mut study.model.sensors);
    for sensor in of_study.filter(|s| s.name == name) {
        let step = factor * sensor.quantisation;
        sensor.quantisation = 0.0;
        sensor.noise_covariance = Some(Matrix3::identity() * (step * step / 12.0));
    }
}

#[test]
fn stat_ma_trajectory_1_with_coarse_white_encoders_is_consistent_and_reaches_the_bound() {
    // Without input noise in the attitude, NEES is 1.84.
    let mut study = study("ma_traj1", 10);
    white(&mut study, "encoders", 16.0);
    assert_consistent(&study, 80);
}

#[test]
fn stat_ma_trajectory_1_with_rounded_encoders_is_consistent_and_reaches_the_bound() {
    assert_consistent(&study("ma_traj1", 4), 60);
}

/// A joint that drifts by half a rounding step, or by an eighth, in 75 s: its readings are those of one at rest, or change
/// once.
#[test]
fn stat_a_joint_that_drifts_by_less_than_a_step_is_consistent() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let path = shipped.join("cases/ma2008_traj1.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let end = "2.6179938779914944, 2.6179938779914944]";
    let rest = format!("position_rad = [0.0, 0.0, 0.0, 0.0, {end}");
    assert!(text.contains(&rest));
    let nominal = read_model(shipped.join("ma2008/model_noisy.toml")).unwrap();
    for drift in [1.2e-5, 3.0e-6] {
        let [a, b] = [5.0, 45.0].map(|t| drift * t / 75.0);
        let moved = format!("position_rad = [0.0, {a:e}, {b:e}, {drift:e}, {end}");
        let mut case = parse_case(&path, text.replace(&rest, &moved)).unwrap();
        case.rate_hz /= 4.0;
        let truth = read_model(&case.model).unwrap();
        let study = Study {
            diagnose: false,
            ..Study::of_case(&case, &truth, nominal.clone()).unwrap()
        };
        assert_consistent(&study, 60);
    }
}

#[test]
fn stat_ma_trajectory_2_is_consistent_and_reaches_the_bound() {
    assert_consistent(&study("ma_traj2", 5), 80);
}

// Every sample: the torque is constant between samples, so no other interpolation of the wheels is as accurate.
#[test]
fn stat_stsat3_with_rounded_tachometers_is_consistent_and_reaches_the_bound() {
    assert_consistent(&study("stsat3_multiaxis", 1), 30);
}

#[test]
fn stat_stsat3_with_coarse_white_tachometers_is_consistent_and_reaches_the_bound() {
    let mut study = study("stsat3_multiaxis", 1);
    white(&mut study, "tachometers", 10.0);
    assert_consistent(&study, 30);
}

#[test]
fn stat_xu_grasped_target_is_consistent_and_reaches_the_bound() {
    assert_consistent(&study("xu_target", 4), FAST);
}

#[test]
fn stat_tug_with_thrusters_is_consistent_and_reaches_the_bound() {
    assert_consistent(&study("tug_thrusters", 5), FAST);
}

/// Correctly declared samples: nothing is inconsistent with the model. Rate of false alarms:
/// `poinsot campaign data/campaigns/trust.toml`.
#[test]
fn stat_no_honest_trial_is_doubted() {
    for (name, stride) in [
        ("ma_traj1", 10),
        ("ma_traj2", 5),
        ("stsat3_multiaxis", 1),
        ("xu_target", 4),
        ("tug_thrusters", 5),
    ] {
        let study = study(name, stride);
        for trial in 0..tables::trials(6) {
            let (tables, _) = study.draw(trial);
            let tree = Tree::new(&study.model);
            let bound = bind(&study.model, &tree, &tables).unwrap();
            let problem = bound.problem(&study.model, &tree);
            let answer = maximum_likelihood_with(&problem, Settings::default()).unwrap();
            assert!(
                answer.doubts().is_empty(),
                "{name} {trial}: {:?}",
                answer.doubts()
            );
            assert!(answer.passes(), "{name} {trial}");
        }
    }
}

#[test]
fn stat_same_bits_on_any_number_of_threads() {
    let study = study("xu_target", 10);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| rows(&study, 0..8))
    };
    let one = on(1);
    assert_eq!(one, on(3));
    // A trial alone has no bound beside it.
    let found = |row: &Row| -> Vec<_> {
        let numbers = row.determined();
        numbers
            .map(|n| (n.name.clone(), n.estimate, n.sigma))
            .collect()
    };
    assert_eq!(found(&one[5]), found(&study.trial(5, &Bound::new())));
}

#[test]
fn stat_a_wrong_declaration_is_caught() {
    let mut study = study("tug_thrusters", 5);
    for sensor in &mut study.sensors {
        sensor.noise_covariance = sensor.noise_covariance.map(|c| c * 1.5);
    }
    let result = judge(&study, 60);
    assert!(!faults(&result).is_empty());
    assert!((result.chi2_per_dof.unwrap() - 1.5).abs() < 0.05);
}

/// Squared Mahalanobis error of mass properties and nuisances together: its mean equals their number if variances and
/// correlations are right.
#[test]
fn stat_covariance_of_mass_properties_and_nuisances_together_is_that_of_the_errors() {
    let study = study("tug_thrusters", 10);
    let model = &study.model;
    let tree = Tree::new(model);
    let gyro = model
        .sensors
        .iter()
        .position(|s| s.kind == SensorKind::Gyro)
        .unwrap();
    let truth = study.truth[0];
    let (trials, mut sum, mut mass_alone, mut count) = (tables::trials(120), 0.0, 0.0, 0);
    for trial in 0..trials {
        let (tables, biases) = study.draw(trial);
        let bound = bind(model, &tree, &tables).unwrap();
        let problem = bound.problem(model, &tree);
        let answer = undiagnosed(&problem);
        let body = &answer.bodies[0];
        let value = |n: &poinsot_identify::Number| n.value.unwrap();
        let mut errors = vec![value(&body.mass) - truth.mass];
        errors.extend((0..3).map(|k| value(&body.com[k]) - truth.p_BoBcm_B[k]));
        for (n, element) in body.inertia.iter().zip(TENSOR) {
            errors.push(value(n) - truth.I_BBcm_B[element]);
        }
        let gyro_bias =
            model.sensors[gyro].R_BS * nalgebra::Vector3::from_column_slice(&biases[gyro]);
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let name = format!("gyro.bias_{axis}");
            let found = answer.nuisance.iter().find(|n| n.name == name).unwrap();
            assert_eq!(answer.covariance_names[10 + k], name);
            let stated = answer.covariance[10 + k][10 + k].sqrt();
            assert!((stated / found.number.sigma.unwrap() - 1.0).abs() < 1.0e-9);
            errors.push(value(&found.number) - gyro_bias[k]);
        }
        count = errors.len();
        assert_eq!(answer.covariance_names.len(), count);
        let square = |n: usize| {
            let scale = |i: usize| answer.covariance[i][i].sqrt();
            let C = nalgebra::DMatrix::from_fn(n, n, |i, j| {
                answer.covariance[i][j] / (scale(i) * scale(j))
            });
            let e = nalgebra::DVector::from_fn(n, |i, _| errors[i] / scale(i));
            e.dot(&C.cholesky().unwrap().solve(&e))
        };
        sum += square(count);
        mass_alone += square(10);
    }
    let band = Band::of_mean_square(count as u64 * trials);
    let ratio = sum / (count * trials as usize) as f64;
    println!(
        "{ratio:.4} of {count} numbers, {:.4} of ten",
        mass_alone / (10 * trials) as f64
    );
    assert!(band.holds(ratio), "{ratio}");
}

fn linear_answer(study: &Study, trial: u64) -> Option<Estimate> {
    let (tables, _) = study.draw(trial);
    let tree = Tree::new(&study.model);
    let bound = bind(&study.model, &tree, &tables).ok()?;
    linear(&bound.problem(&study.model, &tree)).ok()
}

/// Noise of measured positions accumulates in `p x F dt`: the inertia has errors up to 80 sigmas of the rows alone.
/// Such numbers are withheld at any sample rate.
#[test]
fn stat_the_linear_method_under_thrust_withholds_what_it_cannot_judge() {
    for stride in [1, 5, 10] {
        let study = study("tug_thrusters", stride);
        for trial in 0..4 {
            let answer = linear_answer(&study, trial).unwrap();
            assert_eq!(answer.status, Status::Rejected, "stride {stride}");
            assert!(!answer.covariance_trustworthy());
            assert!(answer.bodies[0].mass.value.is_none());
            assert!(answer.warnings().iter().any(|w| w.contains("accumulates")));
        }
    }
}

/// Without noise nothing accumulates.
#[test]
fn exact_the_linear_method_under_thrust_answers_noise_free_records() {
    let mut study = study("tug_thrusters", 1);
    let exact = study.exact.clone();
    let tree = Tree::new(&study.model);
    let bound = bind(&study.model, &tree, &exact).unwrap();
    for nominal in &mut study.model.bodies {
        nominal.nominal.mass *= 1.01;
    }
    let answer = linear(&bound.problem(&study.model, &tree)).unwrap();
    assert_eq!(answer.status, Status::Converged, "{:?}", answer.warnings());
    assert!(answer.covariance_trustworthy());
    let error = answer.bodies[0].mass.value.unwrap() / study.truth[0].mass - 1.0;
    assert!(error.abs() < 1.0e-6, "{error:e}");
}

#[test]
fn stat_a_failed_trial_is_kept_and_named() {
    let mut study = study("tug_thrusters", 10);
    study.exact[0].channels.retain(|c| c.name != "omega_x");
    let trials = rows(&study, 0..3);
    let result = statistics(&trials);
    assert_eq!((result.failures.len(), result.failure_count()), (3, 3));
    assert!(result.failures[1].1.contains("E0301"));
}

fn example(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(path)
}

/// An independent implementation gave these bounds for the shipped run with exact wheels.
#[test]
fn xval_stsat3_bound_is_that_of_an_independent_computation() {
    let mut study = study("stsat3_multiaxis", 1);
    white(&mut study, "tachometers", 1.0e-6);
    let bound = study.bound().unwrap();
    let expected = [7.8e-5, 5.7e-5, 6.3e-5, 6.7e-5, 6.7e-5, 12.7e-5];
    for (number, sigma) in bound.bodies[0].inertia.iter().zip(expected) {
        assert!((number.sigma.unwrap() / sigma - 1.0).abs() < 0.01);
    }
}

#[test]
fn exact_prediction_of_a_case_is_the_sigma_that_its_identification_states() {
    let case = example("cases/tug_thrusters.toml");
    let prediction = predict(&case, 1.0).unwrap();
    let stated = study("tug_thrusters", 1).trial(7, &Bound::new());
    let mass = stated.number("bus.mass_kg").unwrap();
    let predicted = prediction.bound.bodies[0].mass.sigma.unwrap();
    assert!((mass.sigma.unwrap() / predicted - 1.0).abs() < 0.02);
    let text = prediction_document(&prediction_file(&prediction)).to_string();
    assert!(text.starts_with("2 min of this manoeuvre (tug, 10 of 10 combinations): bus mass to"));
}

#[test]
fn paper_prediction_for_thrusters_with_a_locked_arm_shows_the_whole_but_no_body() {
    let prediction = predict(&example("cases/xu2017_c1.toml"), 1.0).unwrap();
    assert!(!prediction.passes());
    let file = prediction_file(&prediction);
    assert_eq!(file.identifiability.rank, 10);
    assert!(file.bodies["B3"].mass_kg.sigma.is_none());
    let words = file.in_words;
    assert!(words.contains("no single number of base, B1, B2, B3, B4, B5, B6 is identifiable"));
    let (whole, _) = prediction.bound.system.unwrap();
    assert!(whole.mass.sigma.unwrap() < 0.05);
}
