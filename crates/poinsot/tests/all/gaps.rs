//! Wheel samples with gaps, or at other times than those of the base sensors.

use poinsot::identify::{identify, read_options};
use poinsot::{Identified, IdentifyRequest, Question, identify_tables};
use poinsot_model::{Model, read_model};
use poinsot_telemetry::{Channel, Table, read};
use std::path::{Path, PathBuf};

/// True tensor of the record, xx xy yy xz yz zz (`data/stsat3/multiaxis/truth.json`).
const TRUTH: [f64; 6] = [13.916, 0.085, 16.954, 0.133, 0.5896, 19.894];

fn example(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data/stsat3")
        .join(path)
}

fn record() -> (Model, Table) {
    let model = read_model(example("model.toml")).unwrap();
    let options = read_options(&model, &model.telemetry, false, false);
    let table = read(&[example("multiaxis/telemetry_noisy.csv")], &options).unwrap();
    (model, table)
}

fn keep(channel: &mut Channel, wanted: impl Fn(usize) -> bool) {
    let rows: Vec<usize> = (0..channel.values.len()).filter(|k| wanted(*k)).collect();
    channel.time_s = rows.iter().map(|k| channel.time_s[*k]).collect();
    channel.values = rows.iter().map(|k| channel.values[*k]).collect();
}

fn is_wheel(channel: &Channel) -> bool {
    channel.name.starts_with("wheel")
}

fn request() -> Question {
    Question::default()
}

fn answer(model: &Model, table: Table) -> Identified {
    identify_tables(model.clone(), vec![table], &request()).unwrap()
}

/// Largest error in stated sigmas.
fn worst(answer: &Identified) -> f64 {
    let body = &answer.estimate.bodies[0];
    let errors = body.inertia.iter().zip(TRUTH).map(|(n, truth)| {
        let z = (n.value.unwrap() - truth) / n.sigma.unwrap();
        println!("{:.6} {truth} {z:+.2}", n.value.unwrap());
        z.abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn regress_rows_that_are_missing_cut_the_record() {
    for (from, to) in [(1620, 1670), (1620, 1700), (1000, 1300)] {
        let (model, mut table) = record();
        let lost = |k: usize| (from..to).contains(&k);
        table
            .channels
            .iter_mut()
            .for_each(|c| keep(c, |k| !lost(k)));
        let answer = answer(&model, table);
        assert_eq!(answer.estimate.fit.len(), 2, "segments");
        assert!(worst(&answer) < 4.0, "rows {from} to {to}");
        assert!(answer.estimate.covariance_trustworthy());
        let told = answer.repairs().iter().any(|r| r.contains("2 segments"));
        assert!(told, "{:?}", answer.repairs());
    }
}

#[test]
fn regress_wheels_that_are_not_read_for_a_while_cut_the_record() {
    let (model, mut table) = record();
    let wheels = table.channels.iter_mut().filter(|c| is_wheel(c));
    wheels.for_each(|c| keep(c, |k| !(1000..1100).contains(&k)));
    let answer = answer(&model, table);
    assert_eq!(answer.estimate.fit.len(), 2, "segments");
    assert!(worst(&answer) < 4.0);
    assert!(answer.estimate.covariance_trustworthy());
}

/// The equation of motion propagates the state across a gap of gyro and star tracker; wheel samples continue.
#[test]
fn regress_a_pause_of_the_base_sensors_cuts_nothing() {
    let (model, mut table) = record();
    let base = table.channels.iter_mut().filter(|c| !is_wheel(c));
    base.for_each(|c| keep(c, |k| !(1600..1700).contains(&k)));
    let answer = answer(&model, table);
    assert_eq!(answer.estimate.fit.len(), 1, "segments");
    assert!(worst(&answer) < 4.0);
}

#[test]
fn regress_wheel_readings_between_those_of_the_gyro_count() {
    let (model, mut table) = record();
    let base = table.channels.iter_mut().filter(|c| !is_wheel(c));
    base.for_each(|c| keep(c, |k| k.is_multiple_of(5)));
    let answer = answer(&model, table);
    assert!(worst(&answer) < 4.0);
    assert!(answer.estimate.covariance_trustworthy());
}

/// Wheel motion between samples changes the answer by sigmas without a visible residual. Every second sample is doubted; with
/// every fifth one constant torque does not explain the residuals, and the torque as a process does.
#[test]
fn regress_wheels_read_too_seldom_are_doubted_or_right() {
    let (model, table) = record();
    for (stride, trusted) in [(1, true), (2, false), (5, true)] {
        let mut table = table.clone();
        let wheels = table.channels.iter_mut().filter(|c| is_wheel(c));
        wheels.for_each(|c| keep(c, |k| k.is_multiple_of(stride)));
        let answer = answer(&model, table);
        let estimate = &answer.estimate;
        let (worst, warnings) = (worst(&answer), &estimate.warnings());
        println!(
            "every {stride}: {worst:.1} {:?}",
            estimate.said(poinsot_identify::RemarkKind::Assumption)
        );
        let trusts = estimate.covariance_trustworthy();
        assert_eq!(trusts, trusted, "every {stride}: {warnings:?}");
        assert!(!trusts || worst < 4.0, "every {stride}: {worst}");
        let told = warnings
            .iter()
            .any(|w| w.contains("the estimate would change by"));
        assert_eq!(told, !trusted, "{warnings:?}");
    }
}

/// Rows skipped by --every are known to have existed.
#[test]
fn regress_thinned_rows_are_not_trusted() {
    let asked = |every: usize| {
        let mut request = IdentifyRequest::new(
            example("model.toml"),
            [example("multiaxis/telemetry_noisy.csv")],
        );
        request.reading.every = every;
        identify(&request).unwrap()
    };
    assert!(asked(1).estimate.covariance_trustworthy());
    let thinned = asked(2);
    assert!(worst(&thinned) > 4.0);
    assert!(!thinned.estimate.covariance_trustworthy());
    let told = |w: &&str| w.starts_with("--every 2 leaves out");
    assert!(thinned.estimate.warnings().iter().any(told));
}

/// The requested accuracy affects the verdict, not the fit.
#[test]
fn regress_a_strict_accuracy_leaves_the_fit_as_it_is() {
    let (model, table) = record();
    let asked = |relative_accuracy: f64| {
        let request = Question {
            relative_accuracy,
            ..request()
        };
        identify_tables(model.clone(), vec![table.clone()], &request).unwrap()
    };
    let (plain, strict) = (asked(1.0), asked(1.0e-6));
    let chi2 = |answer: &Identified| answer.estimate.fit[0].chi2_per_dof;
    // Different starts, equal ends.
    assert!((chi2(&plain) - chi2(&strict)).abs() < 1.0e-9);
    assert_eq!(plain.estimate.identifiability.rank, 6);
    assert!(strict.estimate.identifiability.rank < 6);
    let open = |answer: &Identified| {
        let numbers = &answer.estimate.bodies[0].inertia;
        numbers.iter().filter(|n| n.value.is_none()).count()
    };
    assert_eq!((open(&plain), open(&strict)), (0, 6));
    assert!(strict.estimate.covariance_trustworthy());
    // Between the sigmas of the numbers: each is printed or not by its own.
    let sigmas = |answer: &Identified| answer.estimate.bodies[0].inertia.map(|n| n.sigma);
    let all = sigmas(&plain).map(Option::unwrap);
    // Of the natural scale: in the middle between the third and the fourth of them.
    let mut sorted = all;
    sorted.sort_by(f64::total_cmp);
    let nominal = &model.bodies[0].nominal;
    let scale = nominal.mass * nominal.radius_of_gyration().powi(2);
    let between = asked(1.96 * (sorted[2] * sorted[3]).sqrt() / scale);
    let kept = sigmas(&between).iter().flatten().count();
    assert!((1..6).contains(&kept), "{:?}", sigmas(&between));
    for (strict, plain) in sigmas(&between).iter().zip(all) {
        // Different starts, equal ends but for the last step.
        assert!(strict.is_none_or(|s| (s / plain - 1.0).abs() < 1.0e-6));
    }
    let (found, open) = (
        between.estimate.identifiability,
        &between.estimate.bodies[0],
    );
    assert_eq!(found.rank + found.open.len(), 6);
    assert!(
        found
            .open
            .iter()
            .all(|o| o.text.ends_with("less accurately than asked"))
    );
    assert!(open.inertia.iter().any(|n| n.value.is_none()));
}
