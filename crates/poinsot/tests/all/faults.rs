//! Whether the diagnosis detects planted faults and names them. Full table: `docs/validation/faults.md`.

use crate::{drawn, planted};

use planted::{Planted, experiment, row};

#[track_caller]
fn assert_named(planted: Planted, trials: u64) {
    let row = row(&experiment(planted).unwrap(), planted, trials);
    assert_eq!(
        row.named as u64,
        trials,
        "{}: {:?}",
        planted.words(),
        row.firsts
    );
}

/// The rate of false alarms is measured by `cargo run --release -p poinsot --example faults -- --clean 1000`.
#[test]
fn stat_nothing_is_said_where_nothing_is_wrong() {
    let row = row(&experiment(Planted::Nothing).unwrap(), Planted::Nothing, 40);
    assert_eq!(row.detected, 0, "{:?}", row.firsts);
}

#[test]
fn stat_gyro_scale_of_one_percent_is_named() {
    assert_named(Planted::GyroScale, 3);
}

#[test]
fn stat_flipped_sign_of_a_wheel_is_named() {
    assert_named(Planted::WheelSign, 1);
}

#[test]
fn stat_exchanged_wheels_are_named() {
    assert_named(Planted::WheelExchange, 2);
}

#[test]
fn stat_lag_of_20_ms_is_named_with_its_sensor() {
    assert_named(Planted::GyroLag, 3);
    assert_named(Planted::TrackerLag, 3);
}

#[test]
fn stat_gyro_in_degrees_is_refused_on_reading() {
    assert_named(Planted::GyroInDegrees, 3);
}

#[test]
fn stat_understated_noise_is_named() {
    assert_named(Planted::Noise, 3);
}

#[test]
fn stat_strong_thruster_is_named() {
    assert_named(Planted::Thruster, 3);
}

#[test]
fn stat_outliers_are_named() {
    assert_named(Planted::Outliers, 3);
}

#[test]
fn stat_pendulum_of_two_percent_is_named_as_not_rigid() {
    assert_named(Planted::Pendulum, 2);
}

/// A fault of random size on a vehicle, in a few trials: each of at least twice the noticeable size is named.
#[track_caller]
fn assert_drawn(words: &str, craft: drawn::Craft) {
    let all = drawn::faults();
    let fault = all.iter().find(|f| f.words == words && f.craft == craft);
    let tally = drawn::tally(fault.unwrap(), 3).unwrap();
    assert!(tally.large.1 > 0, "no trial of that size");
    assert_eq!(tally.large.0, tally.large.1, "{words}: {:?}", tally.firsts);
}

#[test]
fn stat_tilt_of_a_wheel_is_named() {
    assert_drawn("wheel tilt", drawn::Craft::Satellite);
}

#[test]
fn stat_misaligned_tracker_is_named() {
    assert_drawn("tracker misalignment", drawn::Craft::Arm);
}

#[test]
fn stat_joined_record_is_named() {
    assert_drawn("joined record", drawn::Craft::Satellite);
}

#[test]
fn stat_drift_of_a_bias_is_named() {
    assert_drawn("gyro bias drift", drawn::Craft::Satellite);
}

#[test]
fn stat_tide_is_named() {
    assert_drawn("tide", drawn::Craft::Satellite);
}

#[test]
fn stat_backlash_is_named() {
    assert_drawn("backlash", drawn::Craft::Arm);
}

#[test]
fn stat_wrong_numbers_of_an_arm_are_named() {
    assert_drawn("link mass", drawn::Craft::Arm);
    assert_drawn("joint origin", drawn::Craft::Arm);
}

#[test]
fn stat_gravity_gradient_is_named() {
    assert_drawn("gravity gradient", drawn::Craft::LowOrbit);
}

#[test]
fn stat_rounding_is_named() {
    assert_drawn("rounded gyro", drawn::Craft::Arm);
}

/// The full thousand: `cargo run --release -p poinsot --example faults -- --drawn 0 --clean 250`.
#[test]
fn stat_nothing_is_said_of_three_vehicles_without_a_fault() {
    for fault in drawn::clean() {
        let tally = drawn::tally(&fault, 4).unwrap();
        assert_eq!(tally.noticed, 0, "{}: {:?}", fault.words, tally.firsts);
    }
}
