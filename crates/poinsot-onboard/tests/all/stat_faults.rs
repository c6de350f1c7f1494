//! Faults in the stream: the health word leaves *determined* before a number is wrong.

use crate::setups::{self, Setup};
use crate::stat_trials::{errors, is_chi_square, trials};
use crate::truth::{Noise, samples};
use nalgebra::{UnitQuaternion, Vector3};
use poinsot_onboard::{Health, Sample};

/// Samples of the record, the first with a fault, and the first without again.
const LENGTH: usize = 1200;
const BEGIN: usize = 350;
const END: usize = 450;
/// Largest error of a good number, sigma.
const WRONG: f64 = 6.0;

/// Delay of a tracker, s.
const DELAY: f64 = 0.02;

/// How a sample of the fault is changed; it sees the one before the fault.
type Change = fn(&mut Sample, &Sample);

fn turned(sample: &mut Sample, angle: f64) {
    if let Some([x, y, z, w]) = sample.attitude {
        let R = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.6, 0.0, 0.8) * angle);
        sample.attitude = Some((R * turn).coords.into());
    }
}

fn faults() -> Vec<(&'static str, Setup, Change)> {
    let frozen: Change = |sample, before| sample.gyro = before.gyro;
    let sign: Change = |sample, _| sample.wheel_speed[0] = -sample.wheel_speed[0];
    let off: Change = |sample, _| turned(sample, 1.0_f64.to_radians());
    let late: Change = |sample, _| {
        let turned = sample.gyro.map(Vector3::from).unwrap() * -DELAY;
        if let Some(R) = sample.attitude {
            let R =
                UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(R[3], R[0], R[1], R[2]));
            sample.attitude = Some((R * UnitQuaternion::from_scaled_axis(turned)).coords.into());
        }
    };
    let silent: Change = |sample, _| {
        sample.force_B = [1.0, 0.0, 0.0];
        sample.torque_B = [0.0, 0.15, 0.0];
    };
    let mut out = Vec::new();
    for setup in [
        setups::bus_with_wheels,
        setups::bus_with_thrusters,
        setups::tumbling,
        setups::arm_with_payload,
    ] {
        out.push(("gyro frozen", setup(), frozen));
        out.push(("tracker off by 1 degree", setup(), off));
    }
    for setup in [setups::bus_with_wheels, setups::tumbling] {
        out.push(("sign of a wheel", setup(), sign));
    }
    let stuck: Change = |sample, before| {
        (sample.joint_position[1], sample.joint_rate[1]) = (before.joint_position[1], 0.0);
    };
    let backwards: Change = |sample, _| {
        sample.joint_position[1] = -sample.joint_position[1];
        sample.joint_rate[1] = -sample.joint_rate[1];
    };
    for setup in [setups::tumbling, setups::arm_with_payload] {
        out.push(("tracker 20 ms late", setup(), late));
    }
    out.push(("encoder stuck", setups::arm_with_payload(), stuck));
    out.push(("sign of a joint", setups::arm_with_payload(), backwards));
    out.push(("wrong thrusters", setups::bus_with_thrusters(), silent));
    out
}

#[test]
fn stat_faults_are_noticed_before_a_number_is_wrong() {
    for (fault, mut setup, change) in faults() {
        setup.truth.samples = LENGTH;
        let motions = setup.truth.motions(&setup.configuration);
        let (mut unnoticed, mut noticed, mut recovered, mut delays) = (0, 0, 0, Vec::new());
        for seed in 0..trials() {
            let mut noise = Noise::new(1000 + seed);
            let mut stream = samples(
                &setup.truth,
                &setup.configuration,
                &motions,
                Some(&mut noise),
            );
            let before = stream[BEGIN - 1];
            stream[BEGIN..END]
                .iter_mut()
                .for_each(|s| change(s, &before));
            let mut filter = setup.filter(&mut noise);
            let (mut wrong, mut first) = (false, None);
            for (k, sample) in stream.iter().enumerate() {
                filter.push(sample).unwrap();
                let answer = filter.answer(sample.time_s);
                if answer.health == Health::Determined {
                    wrong |= errors(&setup, &answer).0.iter().any(|e| e.abs() > WRONG);
                } else if k >= BEGIN && first.is_none() {
                    first = Some(k - BEGIN);
                }
            }
            let end = filter.answer(stream[LENGTH - 1].time_s);
            let right = errors(&setup, &end).0.iter().all(|e| e.abs() < WRONG);
            unnoticed += u64::from(wrong);
            noticed += u64::from(first.is_some());
            recovered += u64::from(right && end.health == Health::Determined);
            delays.extend(first);
        }
        delays.sort_unstable();
        println!(
            "{fault}, {}: noticed in {noticed} of {}, after {:?} samples (median), wrong while determined in {unnoticed}, right again in {recovered}",
            setup.name,
            trials(),
            delays.get(delays.len() / 2),
        );
        assert!(100 * (trials() - unnoticed) >= 95 * trials());
        assert!(100 * noticed.min(recovered) >= 95 * trials());
    }
}

/// A gap of a minute and one in twenty measurements far off.
#[test]
fn stat_gaps_and_outliers_are_survived() {
    for mut setup in setups::all() {
        setup.truth.samples = LENGTH;
        let motions = setup.truth.motions(&setup.configuration);
        let (mut squared, mut good) = (0.0, 0);
        for seed in 0..trials() {
            let mut noise = Noise::new(2000 + seed);
            let mut stream = samples(
                &setup.truth,
                &setup.configuration,
                &motions,
                Some(&mut noise),
            );
            for sample in &mut stream {
                if noise.one().abs() > 1.96 {
                    turned(sample, 0.05);
                }
                if noise.one().abs() > 1.96 {
                    sample.gyro = sample.gyro.map(|w| w.map(|x| x + 0.02));
                }
            }
            stream.drain(300..600);
            let mut filter = setup.filter(&mut noise);
            for sample in &stream {
                // Two samples after the gap are refused.
                let _ = filter.push(sample);
            }
            let end = filter.answer(stream[stream.len() - 1].time_s);
            squared += errors(&setup, &end).1;
            good += u64::from(end.health == Health::Determined);
        }
        let numbers = setup.sigma.iter().filter(|s| **s > 0.0).count() as f64;
        let freedom = numbers * trials() as f64;
        println!(
            "{}: NEES per number {:.3} at the end, determined in {good} of {}",
            setup.name,
            squared / freedom,
            trials(),
        );
        assert!(is_chi_square(squared, freedom));
        assert!(100 * good >= 95 * trials());
    }
}
