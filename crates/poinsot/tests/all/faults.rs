//! Whether the diagnosis notices planted faults and names them. The full table: `docs/validation/faults.md`.

use crate::planted;

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

/// How often it errs is counted by `cargo run --release -p poinsot --example faults -- --clean 1000`.
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
