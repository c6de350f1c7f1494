//! Calibration over many trials.

use crate::dense;
use crate::setups::{self, OnBoard, Setup};
use crate::truth::{Motion, Noise, samples};
use nalgebra::{DMatrix, DVector, Matrix3, Quaternion, UnitQuaternion};
use poinsot_onboard::{Answer, Health};

/// Trials of each set-up; `POINSOT_TRIALS` gives another number.
pub fn trials() -> u64 {
    let given = std::env::var("POINSOT_TRIALS").ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(8)
}

/// Error of the unknown parameters in sigma, and its squared size in their covariance.
pub fn errors(setup: &Setup, answer: &Answer) -> (Vec<f64>, f64) {
    let truth = setup.truth.parameters();
    let unknown: Vec<usize> = (0..10).filter(|k| setup.sigma[*k] > 0.0).collect();
    let n = unknown.len();
    let error = DVector::from_fn(n, |j, _| {
        answer.numbers[unknown[j]].value - truth[unknown[j]]
    });
    let C = DMatrix::from_fn(n, n, |i, j| answer.covariance[i][j]);
    let squared = (error.transpose() * C.cholesky().unwrap().solve(&error))[0];
    let each = unknown.iter().zip(error.iter());
    (
        each.map(|(k, e)| e / answer.numbers[*k].sigma).collect(),
        squared,
    )
}

pub fn run(setup: &Setup, seed: u64) -> (Vec<Answer>, Box<OnBoard>) {
    let mut noise = Noise::new(seed);
    let (flown, mounting) = setup.flown(&mut noise);
    let motions = setup.truth.motions(&flown);
    let mut stream = samples(&setup.truth, &flown, &motions, Some(&mut noise));
    let mut filter = setup.filter(&mut noise);
    let mut out = Vec::new();
    for sample in &mut stream {
        let [x, y, z, w] = sample.attitude.unwrap();
        let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * mounting;
        if mounting != UnitQuaternion::identity() {
            sample.attitude = Some(attitude.coords.into());
        }
        filter.push(sample).unwrap();
        out.push(filter.answer(sample.time_s));
    }
    (out, filter)
}

/// Whether a chi-square of so many degrees of freedom is within limits that one of twelve such tests exceeds by chance in a
/// thousandth of all cases (Wilson and Hilferty 1931).
pub fn is_chi_square(sum: f64, freedom: f64) -> bool {
    let spread = 2.0 / (9.0 * freedom);
    (((sum / freedom).cbrt() - 1.0 + spread) / spread.sqrt()).abs() < 3.76
}

/// What trials of a set-up show: errors in the covariance, and in the sigma of numbers that are called determined. At most this
/// share may be called inconsistent at some time.
fn calibrated(setup: &Setup, trials: u64, doubted: f64) {
    let (mut at_half, mut at_end, mut inconsistent, mut worst) = (0.0, 0.0, 0, 0.0_f64);
    let mut determined = Vec::new();
    for seed in 0..trials {
        let (answers, filter) = run(setup, seed);
        let last = answers.len() - 1;
        at_half += errors(setup, &answers[last / 2]).1;
        at_end += errors(setup, &answers[last]).1;
        inconsistent += u64::from(answers.iter().any(|a| a.health == Health::Inconsistent));
        let good = answers.iter().filter(|a| a.health == Health::Determined);
        for answer in good {
            let errors = errors(setup, answer).0;
            worst = errors.iter().fold(worst, |w, e| w.max(e.abs()));
        }
        let first = answers.iter().position(|a| a.health == Health::Determined);
        determined.extend(first.map(|k| k as f64 * setup.truth.dt));
        let counts = filter.counts();
        let few = counts.iter().all(|c| c.gated <= 3 + c.accepted / 5_000);
        assert!(few, "{seed} {counts:?}");
    }
    let numbers = setup.sigma.iter().filter(|s| **s > 0.0).count() as f64;
    let freedom = numbers * trials as f64;
    determined.sort_by(f64::total_cmp);
    println!(
        "{} at {:.0} Hz: {trials} trials, NEES per number {:.3} at half, {:.3} at the end; {inconsistent} inconsistent; largest error {worst:.2} sigma; determined after {:.1} s (median)",
        setup.name,
        1.0 / setup.truth.dt,
        at_half / freedom,
        at_end / freedom,
        determined[determined.len() / 2],
    );
    assert!(is_chi_square(at_half, freedom) && is_chi_square(at_end, freedom));
    assert!(inconsistent as f64 <= doubted * trials as f64);
    assert!(worst < 6.0);
    assert_eq!(determined.len() as u64, trials);
}

/// Masses that slide on springs, exact at any deflection: modes are of first order.
#[test]
fn stat_errors_with_modes_are_those_of_the_covariance() {
    for setup in setups::with_modes() {
        calibrated(&setup, trials().div_ceil(2), 0.01);
    }
}

#[test]
fn stat_errors_are_those_of_the_covariance() {
    for setup in setups::all() {
        calibrated(&setup, trials(), 0.01);
    }
}

/// What is hardly known is found as soon as it shows, at any rate.
#[test]
fn stat_numbers_that_are_hardly_known_are_found() {
    for faster in [1, 3] {
        for setup in setups::all() {
            calibrated(
                &setup.hardly_known().faster(faster),
                trials().div_ceil(2),
                0.02,
            );
        }
    }
}

/// What the wheels do between samples is found: straight lines, and curves.
#[test]
fn stat_speeds_that_curve_between_samples_are_followed() {
    let straight = setups::bus_with_wheels();
    for mut setup in [straight, setups::bus_with_smooth_wheels()] {
        setup.truth.samples = 3_000;
        calibrated(&setup.with_curve(), trials().div_ceil(2), 0.01);
    }
}

/// Spin inertias within 2 %, axes and mounting within 3 mrad: what is not exact counts in the covariance, and in the motion.
#[test]
fn stat_known_numbers_count_in_the_covariance() {
    for setup in [setups::bus_with_wheels(), setups::tumbling()] {
        calibrated(&setup.drawn(), trials(), 0.01);
    }
}

/// The bus with wheels while its inertia walks, with the momentum that it has; in `forget_s` as far as the prior.
fn walking(setup: &mut Setup, forget_s: f64, noise: &mut Noise) -> Vec<Motion> {
    let mut now = setup.truth.start;
    let mut out = vec![now];
    let share = (setup.truth.dt / forget_s).sqrt();
    for k in 1..setup.truth.samples {
        now = setup.truth.next(&setup.configuration, &now, k - 1);
        let before = setup.truth.I;
        let step: [f64; 6] = std::array::from_fn(|j| setup.sigma[4 + j] * share * noise.one());
        let [xx, xy, yy, xz, yz, zz] = step;
        setup.truth.I += Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        now.w = setup.truth.I.try_inverse().unwrap() * before * now.w;
        out.push(now);
    }
    out
}

/// Mean NEES per number of trials at the end, and how many are called inconsistent at some time.
fn walked(declared: bool, walks: bool) -> (f64, u64) {
    let forget_s = 30_000.0;
    let (mut sum, mut inconsistent) = (0.0, 0);
    for seed in 0..trials() {
        let mut setup = setups::bus_with_wheels();
        if declared {
            setup.configuration.forget_s = forget_s;
        }
        let mut noise = Noise::new(seed);
        let motions = match walks {
            true => walking(&mut setup, forget_s, &mut noise),
            false => setup.truth.motions(&setup.configuration),
        };
        let mut filter = setup.filter(&mut noise);
        let mut doubted = false;
        for sample in samples(
            &setup.truth,
            &setup.configuration,
            &motions,
            Some(&mut noise),
        ) {
            filter.push(&sample).unwrap();
            doubted |= filter.answer(sample.time_s).health == Health::Inconsistent;
        }
        sum += errors(&setup, &filter.answer(0.0)).1;
        inconsistent += u64::from(doubted);
    }
    let nees = sum / (6 * trials()) as f64;
    println!(
        "a walk, declared {declared}, there {walks}: NEES per number {nees:.2}, {inconsistent} inconsistent"
    );
    (nees, inconsistent)
}

/// A body that stays where a walk is declared is no fault either.
#[test]
fn stat_a_walk_of_the_inertia_is_followed_where_it_is_declared() {
    let freedom = 6.0 * trials() as f64;
    let (nees, inconsistent) = walked(true, true);
    assert!(is_chi_square(nees * freedom, freedom) && inconsistent == 0);
    let (nees, inconsistent) = walked(true, false);
    assert!(nees < 1.0 && inconsistent == 0);
    let (nees, inconsistent) = walked(false, true);
    assert!(nees > 2.0 && inconsistent > trials() / 2);
}

/// The window has the same number of samples at any rate: here it lasts 7.5 and 1.5 s, in which the parameters are not found.
#[test]
fn stat_errors_are_those_of_the_covariance_at_other_rates() {
    for faster in [4, 20] {
        for setup in setups::all() {
            calibrated(&setup.faster(faster), trials().div_ceil(4), 0.02);
        }
    }
}

/// Angular velocities by the tachometers are as noisy as those of the gyro, 4 and 10 times as noisy.
#[test]
fn stat_errors_are_those_of_the_covariance_with_noisy_tachometers() {
    let (bus, tumbling) = (setups::bus_with_wheels, setups::tumbling);
    for (noise, mut setup) in [(0.5, bus()), (0.5, tumbling()), (5.0, bus())] {
        for wheel in &mut setup.configuration.wheels {
            wheel.noise = noise;
        }
        println!("tachometers of {noise} rad/s:");
        calibrated(&setup.faster(20), trials().div_ceil(4), 0.02);
    }
}

#[test]
fn xval_sigma_is_that_of_one_least_squares_problem() {
    for setup in setups::all() {
        let motions = setup.truth.motions(&setup.configuration);
        // Two errors of each joint and sample are unknown: a shorter record, beyond the first window.
        let count = setup.truth.samples / if setup.truth.arm.is_some() { 4 } else { 2 };
        let bound = dense::bound(&setup, &motions, count);
        for seed in 0..3 {
            let (answers, _) = run(&setup, seed);
            let numbers = answers[count - 1].numbers;
            let sigma = numbers.iter().map(|n| n.sigma).filter(|s| *s > 0.0);
            let ratios: Vec<f64> = sigma.zip(&bound).map(|(a, b)| a / b).collect();
            println!("{}: sigma over the bound {ratios:.4?}", setup.name);
            assert!(ratios.iter().all(|r| (0.95..1.2).contains(r)));
        }
    }
}

/// Samples after which one least squares problem knows all numbers to half of the prior.
fn needed(setup: &Setup, motions: &[Motion]) -> usize {
    let prior: Vec<f64> = setup.sigma.iter().copied().filter(|s| *s > 0.0).collect();
    let knows = |count: usize| {
        let sigma = dense::bound(setup, motions, count);
        sigma
            .iter()
            .zip(&prior)
            .all(|(sigma, prior)| *sigma < 0.5 * prior)
    };
    let (mut less, mut enough) = (2, 4);
    while !knows(enough) {
        (less, enough) = (enough, 2 * enough);
    }
    while enough - less > 1 {
        let half = usize::midpoint(less, enough);
        if knows(half) {
            enough = half;
        } else {
            less = half;
        }
    }
    enough
}

#[test]
fn xval_numbers_come_soon_after_one_least_squares_problem_has_them() {
    let trials = trials();
    for setup in setups::all() {
        let motions = setup.truth.motions(&setup.configuration);
        let needed = needed(&setup, &motions);
        let mut first: Vec<usize> = (0..trials)
            .map(|seed| {
                let answers = run(&setup, seed).0;
                let told = answers.iter().position(|a| a.health == Health::Determined);
                told.unwrap() + 1
            })
            .collect();
        first.sort_unstable();
        let most = first[first.len() * 95 / 100 - 1];
        println!(
            "{}: determined after {} samples (median), {most} in 95 % of the trials; one problem needs {needed}",
            setup.name,
            first[first.len() / 2]
        );
        assert!(2 * most <= 3 * needed);
    }
}
