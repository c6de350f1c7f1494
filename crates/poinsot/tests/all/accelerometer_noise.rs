//! Effect of joint and wheel noise on an accelerometer and on velocity increments.
//!
//! `POINSOT_TRIALS` sets the number of trials.

use crate::points;
use crate::vehicle;

use crate::shared::{faults, rows, statistics};
use poinsot::trials::Study;
use poinsot_formats::MethodResultFile;
use poinsot_model::{Model, Sensor, SensorKind};
use poinsot_report::statistics_document;
use poinsot_spatial::Vector3;
use points::{add_point, with_point};
use vehicle::*;

/// Two noisy joints, three rounded tachometers, and a sensor on the last link whose sigma is about equal to their
/// effect.
struct Case {
    kind: SensorKind,
    sigma: f64,
    /// Whether joint rates are measured, not differentiated.
    rates: bool,
}

fn reader(kind: SensorKind, of: Vec<usize>, sigma: f64) -> Sensor {
    Sensor {
        of,
        ..sensor(kind, sigma)
    }
}

fn sensors_of(case: &Case, point: (usize, Vector3)) -> Vec<Sensor> {
    let mut all = vec![
        sensor(SensorKind::Gyro, 1.0e-4),
        sensor(SensorKind::Attitude, 1.0e-4),
        reader(SensorKind::JointPosition, vec![0, 1], 2.0e-6),
    ];
    if case.rates {
        all.push(reader(SensorKind::JointRate, vec![0, 1], 1.0e-4));
    }
    let mut tachometers = reader(SensorKind::WheelSpeed, vec![0, 1, 2], 0.0);
    tachometers.noise_covariance = None;
    tachometers.quantisation = 0.2;
    all.push(tachometers);
    let mut own = sensor(case.kind, case.sigma);
    (own.body, own.p_BoS_B) = point;
    all.push(own);
    all
}

fn study(case: &Case) -> Study {
    let point = (2, Vector3::new(0.1, 0.2, -0.3));
    let at = (case.kind, point.0, point.1);
    let mut truth: Model = with_point(with_thrusters(with_wheels(known_arm(5))), at, case.sigma);
    let flight = Flight {
        rate_hz: 40.0,
        duration_s: 10.0,
        ..moving(&truth, 8)
    };
    let mut table = rotation_only(fly(&truth, &flight));
    add_point(&mut table, &truth, &flight, at);
    if !case.rates {
        table
            .channels
            .retain(|c| !(c.name.starts_with("joint") && c.name.ends_with("_rad_s")));
    }
    truth.sensors = sensors_of(case, point);
    let mut study = Study::of_tables(vec![table], &truth, off_nominal(&truth, 0.03));
    study.diagnose = false;
    study
}

fn trials() -> u64 {
    let given = std::env::var("POINSOT_TRIALS").ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(12)
}

fn judged(case: &Case, change: impl Fn(&mut Study)) -> MethodResultFile {
    let mut study = study(case);
    change(&mut study);
    let result = statistics(&rows(&study, 0..trials()));
    println!("{}", statistics_document("", &result));
    result
}

#[track_caller]
fn assert_consistent(case: &Case) {
    let result = judged(case, |_| {});
    assert!(result.nees.is_some());
    let faults = faults(&result);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn stat_accelerometer_with_noisy_joint_rates_and_rounded_tachometers_is_consistent() {
    assert_consistent(&Case {
        kind: SensorKind::Accelerometer,
        sigma: 1.0e-3,
        rates: true,
    });
}

#[test]
fn stat_accelerometer_with_differentiated_joint_angles_is_consistent() {
    assert_consistent(&Case {
        kind: SensorKind::Accelerometer,
        sigma: 1.0e-3,
        rates: false,
    });
}

#[test]
fn stat_velocity_increments_with_noisy_joint_rates_and_rounded_tachometers_are_consistent() {
    assert_consistent(&Case {
        kind: SensorKind::VelocityIncrement,
        sigma: 1.0e-4,
        rates: true,
    });
}

/// The reverse: undeclared noise is visible in chi-square. That of positions and of rates: an acceleration follows from both.
#[test]
fn stat_an_accelerometer_shows_joint_noise_that_nobody_declared() {
    let case = Case {
        kind: SensorKind::Accelerometer,
        sigma: 1.0e-3,
        rates: true,
    };
    let result = judged(&case, |study| {
        for sensor in &mut study.sensors {
            if matches!(
                sensor.kind,
                SensorKind::JointPosition | SensorKind::JointRate
            ) {
                sensor.noise_covariance = sensor.noise_covariance.map(|c| 9.0 * c);
            }
        }
    });
    let chi2 = result.chi2_per_dof.unwrap();
    assert!(chi2 > 1.1, "{chi2}");
}
