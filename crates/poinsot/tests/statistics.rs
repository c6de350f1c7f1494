//! Whether the stated uncertainty is the true one: small campaigns against 99.9 % bands.
//!
//! The full campaign is `cargo run --release -p poinsot --example campaign`.
#![allow(non_snake_case, clippy::unwrap_used)]

#[path = "../examples/campaign/setups.rs"]
mod setups;

use poinsot::trials::{Statistics, Study, statistics, statistics_document};

fn study(name: &str, stride: usize) -> Study {
    setups::setup(name, stride).unwrap().unwrap().study
}

fn judge(name: &str, study: &Study, trials: u64) -> Statistics {
    let bound = study.bound().unwrap();
    let result = statistics(&study.run(0..trials), Some(&bound));
    println!("{}", statistics_document(name, &result));
    result
}

#[track_caller]
fn assert_consistent(name: &str, stride: usize, trials: u64) {
    let result = judge(name, &study(name, stride), trials);
    assert!(result.nees.is_some(), "no joint consistency was computed");
    let faults = result.faults();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn stat_ma_trajectory_2_is_consistent_and_reaches_the_bound() {
    assert_consistent("ma_traj2", 5, 200);
}

#[test]
fn stat_stsat3_with_rounded_tachometers_is_consistent_and_reaches_the_bound() {
    assert_consistent("stsat3_multiaxis", 2, 120);
}

#[test]
fn stat_xu_grasped_target_is_consistent_and_reaches_the_bound() {
    assert_consistent("xu_target", 2, 200);
}

#[test]
fn stat_tug_with_thrusters_is_consistent_and_reaches_the_bound() {
    assert_consistent("tug_thrusters", 2, 200);
}

#[test]
fn stat_same_bits_on_any_number_of_threads() {
    let study = study("xu_target", 10);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| study.run(0..8))
    };
    let one = on(1);
    assert_eq!(one, on(3));
    assert_eq!(one[5], study.trial(5));
}

#[test]
fn stat_a_wrong_declaration_is_caught() {
    let mut study = study("tug_thrusters", 4);
    for sensor in &mut study.sensors {
        sensor.noise_covariance = sensor.noise_covariance.map(|c| c * 1.5);
    }
    let result = judge("noise 1.22 times the declared", &study, 60);
    assert!(!result.faults().is_empty());
    assert!((result.chi2_per_dof - 1.5).abs() < 0.05);
}

#[test]
fn stat_a_failed_trial_is_kept_and_named() {
    let mut study = study("tug_thrusters", 10);
    study.exact[0].channels.retain(|c| c.name != "omega_x");
    let trials = study.run(0..3);
    let result = statistics(&trials, None);
    assert_eq!(result.failed.len(), 3);
    assert!(result.failed[1].1.contains("E0301"));
}
