//! Whether the diagnosis detects planted faults and names them. Full table: `docs/validation/faults.md`.

mod list;
mod plants;
mod trials;

pub use trials::{Craft, off_nominal};

use crate::tables;
use trials::{Fault, Tally, noticeable, tally};

#[track_caller]
fn assert_named(words: &str, trials: u64) {
    let all = list::planted();
    let fault = all.iter().find(|f| f.words == words).unwrap();
    let tally = tally(fault, f64::NAN, trials);
    assert_eq!(tally.named, trials, "{words}: {:?}", tally.firsts);
}

/// Prints a row for each fault and judges it: without a fault nothing is noticed.
fn print(faults: &[Fault], count: u64, drawn: bool) {
    let mut amiss = Vec::new();
    for fault in faults.iter().filter(|f| tables::wanted(f.words)) {
        let size = if drawn { noticeable(fault) } else { f64::NAN };
        let row = tally(fault, size, count);
        tables::row(&row.cells(fault));
        let right = match fault.names {
            [] => row.noticed == 0,
            _ => row.trials - row.named <= (row.trials * (200 - fault.least)).div_ceil(200),
        };
        amiss.extend((!right).then(|| format!("{}, {}", fault.words, fault.craft.words())));
    }
    assert!(amiss.is_empty(), "{amiss:?}");
}

/// The first table of `docs/validation/faults.md`.
#[test]
#[ignore = "takes minutes"]
fn stat_table_of_planted_faults() {
    let count = tables::trials(100);
    tables::heading(&Tally::COLUMNS);
    print(&list::planted()[..1], 10 * count, false);
    print(&list::planted()[1..], count, false);
}

/// The second one.
#[test]
#[ignore = "takes most of an hour"]
fn stat_table_of_drawn_faults() {
    let count = tables::trials(200);
    tables::heading(&Tally::COLUMNS);
    print(&list::drawn(), count, true);
    print(&list::clean(), count + count / 4, false);
}

#[test]
fn stat_nothing_is_said_where_nothing_is_wrong() {
    let row = tally(&list::planted()[0], f64::NAN, 40);
    assert_eq!(row.noticed, 0, "{:?}", row.firsts);
}

#[test]
fn stat_gyro_scale_of_one_percent_is_named() {
    assert_named("gyro scale 1 %", 3);
}

#[test]
fn stat_flipped_sign_of_a_wheel_is_named() {
    assert_named("sign of one wheel flipped", 1);
}

#[test]
fn stat_exchanged_wheels_are_named() {
    assert_named("speeds of two wheels exchanged", 2);
}

#[test]
fn stat_lag_of_20_ms_is_named_with_its_sensor() {
    assert_named("gyro 20 ms late", 3);
    assert_named("star tracker 20 ms late", 3);
}

#[test]
fn stat_gyro_in_degrees_is_refused_on_reading() {
    assert_named("gyro in deg/s, declared rad/s", 3);
}

#[test]
fn stat_understated_noise_is_named() {
    assert_named("gyro noise understated by 3", 3);
}

#[test]
fn stat_strong_thruster_is_named() {
    assert_named("one thruster 10 % stronger", 3);
}

#[test]
fn stat_outliers_are_named() {
    assert_named("3 % of the gyro samples off by 20 sigma", 3);
}

#[test]
fn stat_pendulum_of_two_percent_is_named_as_not_rigid() {
    assert_named("pendulum of 2 % of the mass", 2);
}

/// A fault of random size on a vehicle, in a few trials: each of at least twice the noticeable size is named.
#[track_caller]
fn assert_drawn(words: &str, craft: Craft) {
    let all = list::drawn();
    let fault = all.iter().find(|f| f.words == words && f.craft == craft);
    let fault = fault.unwrap();
    let tally = tally(fault, noticeable(fault), 3);
    assert!(tally.large.1 > 0, "no trial of that size");
    assert_eq!(tally.large.0, tally.large.1, "{words}: {:?}", tally.firsts);
}

#[test]
fn stat_tilt_of_a_wheel_is_named() {
    assert_drawn("wheel tilt", Craft::Satellite);
}

#[test]
fn stat_misaligned_tracker_is_named() {
    assert_drawn("tracker misalignment", Craft::Arm);
}

#[test]
fn stat_joined_record_is_named() {
    assert_drawn("joined record", Craft::Satellite);
}

#[test]
fn stat_drift_of_a_bias_is_named() {
    assert_drawn("gyro bias drift", Craft::Satellite);
}

#[test]
fn stat_tide_is_named() {
    assert_drawn("tide", Craft::Satellite);
}

#[test]
fn stat_backlash_is_named() {
    assert_drawn("backlash", Craft::Arm);
}

#[test]
fn stat_wrong_numbers_of_an_arm_are_named() {
    assert_drawn("link mass", Craft::Arm);
    assert_drawn("joint origin", Craft::Arm);
}

#[test]
fn stat_gravity_gradient_is_named() {
    assert_drawn("gravity gradient", Craft::LowOrbit);
}

#[test]
fn stat_rounding_is_named() {
    assert_drawn("rounded gyro", Craft::Arm);
}

#[test]
fn stat_nothing_is_said_of_three_vehicles_without_a_fault() {
    for fault in list::clean() {
        let tally = tally(&fault, f64::NAN, 4);
        assert_eq!(tally.noticed, 0, "{}: {:?}", fault.words, tally.firsts);
    }
}
