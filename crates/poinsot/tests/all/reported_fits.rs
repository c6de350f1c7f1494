//! Honest records that were refused, or answered wrongly: those of `data/reports` with a `truth.json`, by a simulator that shares nothing
//! with this program. Each answer is compared with the vehicle that made the record.
#![allow(clippy::print_stdout)]

use crate::reported::{AGREES, Record};
use poinsot::{Identified, identify};
use poinsot_identify::Number;
use serde_json::Value;

/// The answer of a record, of whose model these texts are replaced.
fn answer(name: &'static str, replaced: &[(&str, &str)]) -> Identified {
    Record::new(name, replaced, "").answer()
}

/// Errors of the numbers that are given of the bodies asked for, sigmas.
fn errors(name: &str, found: &Identified) -> Vec<f64> {
    let text = std::fs::read_to_string(Record::file(name, "truth.json")).unwrap();
    let truth: Value = serde_json::from_str(&text).unwrap();
    let mut all = Vec::new();
    for body in found.estimate.bodies.iter().filter(|b| b.asked) {
        let own = &truth[body.name.as_str()];
        let mut add = |number: &Number, truth: &Value| {
            let sigma = number.sigma.filter(|sigma| *sigma > 0.0);
            if let (Some(value), Some(sigma)) = (number.value, sigma) {
                all.push((value - truth.as_f64().unwrap()) / sigma);
            }
        };
        add(&body.mass, &own["mass_kg"]);
        for (k, number) in body.com.iter().enumerate() {
            add(number, &own["com_m"][k]);
        }
        for (number, (i, j)) in body.inertia.iter().zip(poinsot_identify::TENSOR) {
            add(number, &own["inertia_kg_m2"][i][j]);
        }
    }
    let largest = all.iter().fold(0.0, |a: f64, z| a.max(z.abs()));
    println!(
        "{name}: {} numbers, the largest error {largest:.2} sigma",
        all.len()
    );
    all
}

fn agree(name: &str, found: &Identified) -> usize {
    let all = errors(name, found);
    assert!(all.iter().all(|z| z.abs() < AGREES), "{name}: {all:?}");
    all.len()
}

#[test]
fn xval_honest_records_are_answered() {
    let records = [
        ("fast_spinner", 6),
        ("gyros_of_moment", 6),
        ("dual_spin", 6),
        ("tracker_alone", 6),
        ("declared_slow_tracker", 6),
        ("tracker_gaps", 6),
        ("coarse_encoders", 10),
        ("noisy_tachometers", 6),
    ];
    for (name, numbers) in records {
        let found = answer(name, &[]);
        assert!(found.passes(), "{name}: {:?}", found.estimate.doubts());
        assert_eq!(agree(name, &found), numbers, "{name}");
    }
}

/// The first half of three orbits: all of them take 18 s.
#[test]
fn xval_a_tumble_in_a_gradient_beside_noisy_wheels_is_answered() {
    let record = Record::new("gradient_over_orbits", &[], "");
    let mut request = record.request();
    request.reading.time_s = Some([0.0, 9.0e3]);
    let found = identify(&request).unwrap();
    assert!(found.passes(), "{:?}", found.estimate.doubts());
    assert_eq!(agree("gradient_over_orbits", &found), 6);
}

/// The mass was printed as 188 +- 52 kg where it is 400.
#[test]
fn xval_a_mass_that_a_coarse_position_does_not_tell_is_withheld() {
    let found = answer("coarse_position", &[]);
    assert!(found.estimate.bodies[0].mass.value.is_none());
    assert_eq!(agree("coarse_position", &found), 9);
}

/// All thrusters 5 % strong: what that does is stated, and an answer that knows of it is right.
#[test]
fn xval_a_common_error_of_thrust_can_be_declared() {
    let found = answer("common_thrust", &[]);
    let said = |r: &poinsot_identify::Remark| r.words.contains("thrust_correlation");
    assert!(found.estimate.remarks.iter().any(said));
    let common = (
        "source = \"cad\"",
        "source = \"cad\"\nthrust_correlation = 0.9",
    );
    let found = answer("common_thrust", &[common]);
    assert!(found.passes(), "{:?}", found.estimate.doubts());
    assert_eq!(agree("common_thrust", &found), 10);
}

/// White noise and a slow error of one tracker, 5e-5 rad each.
#[test]
fn xval_a_slow_error_beside_white_noise_can_be_declared() {
    let both = (
        "noise_rad = 5e-05",
        "noise_rad = 5e-05\nslow_rad = 5e-05\ncorrelation_s = 100",
    );
    let found = answer("slow_tracker", &[both]);
    assert!(found.passes(), "{:?}", found.estimate.doubts());
    assert_eq!(agree("slow_tracker", &found), 6);
}

/// On-times that are rounded to 10 ms: no answer is trusted, and firings are named.
#[test]
fn xval_rounded_on_times_are_doubted() {
    let found = answer("rounded_on_times", &[]);
    assert!(!found.passes());
    let causes = &found.estimate.diagnostics.as_ref().unwrap().suspects;
    assert!(
        causes
            .iter()
            .take(2)
            .any(|s| s.name.contains("torque") || s.name.contains("impulse"))
    );
    agree("rounded_on_times", &found);
}
