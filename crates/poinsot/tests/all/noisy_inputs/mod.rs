//! Noise of wheels and joints beside good gyros: the table of `docs/validation/noisy_inputs.md`.

mod vehicle;

use crate::tables;
use nalgebra::{DMatrix, DVector};
use poinsot::{Question, identify_tables};
use poinsot_model::parse_model;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};
use vehicle::{Inputs, Slow, Vehicle};

/// Vehicles and inputs, a row each.
const ROWS: [(&str, Inputs); 5] = [
    ("wheels, q = 1", Inputs::Wheels { q: 1.0 }),
    ("wheels, q = 5", Inputs::Wheels { q: 5.0 }),
    ("wheels, q = 20", Inputs::Wheels { q: 20.0 }),
    ("encoders, 0.1 mrad", Inputs::Joints { noise_rad: 1.0e-4 }),
    ("encoders, 3 mrad", Inputs::Joints { noise_rad: 3.0e-3 }),
];
/// Slow errors, a row each.
const SLOW: [(&str, Slow); 6] = [
    ("tracker, 1.2 s", of_tracker(1.2)),
    ("tracker, 4 s", of_tracker(4.0)),
    ("tracker, 12 s", of_tracker(12.0)),
    ("gyro, 4 s", of_gyro(4.0, 0.0)),
    ("gyro, 12 s", of_gyro(12.0, 0.0)),
    ("walk of the gyro, 3e-6 rad/s in 1 s", of_gyro(1.0, 3.0e-6)),
];
/// Numbers of an answer: the inertia of the base.
const NUMBERS: usize = 6;
/// Probability that a right estimator fails anywhere: NEES on both sides, and six means, in every row.
const FALSE_ALARM: f64 = 1.0e-3;

/// As large as the white noise of the tracker.
const fn of_tracker(correlation_s: f64) -> Slow {
    Slow {
        tracker: 5.0e-5,
        gyro: 0.0,
        correlation_s,
        walk: 0.0,
        declared: false,
    }
}

/// The same of the gyro, or a walk.
const fn of_gyro(correlation_s: f64, walk: f64) -> Slow {
    Slow {
        tracker: 0.0,
        gyro: if walk > 0.0 { 0.0 } else { 2.0e-5 },
        correlation_s,
        walk,
        declared: false,
    }
}

/// One answer.
struct Score {
    z: [f64; NUMBERS],
    nees: f64,
    trusted: bool,
}

fn score(inputs: Inputs, slow: Slow, seed: u64) -> Score {
    let mut drawn = Vehicle::drawn(inputs, seed);
    drawn.slow = slow;
    let truth = drawn.truth();
    let (text, table) = drawn.record();
    let model = parse_model(&text, "drawn.toml").unwrap();
    let found = identify_tables(model, vec![table], &Question::default()).unwrap();
    let e = &found.estimate;
    let order = [0, 2, 5, 1, 3, 4];
    let own = order.map(|k| e.bodies[0].inertia[k]);
    if own.iter().any(|n| n.sigma.is_none()) {
        return Score {
            z: [0.0; NUMBERS],
            nees: 0.0,
            trusted: false,
        };
    }
    let off: [f64; NUMBERS] = std::array::from_fn(|k| own[k].value.unwrap() - truth[k]);
    let at = ["xx", "yy", "zz", "xy", "xz", "yz"].map(|n| {
        let mut names = e.covariance_names.iter();
        let of = [format!("I_{n}"), format!("inertia_{n}")];
        names
            .position(|c| of.iter().any(|n| c.contains(n)))
            .unwrap()
    });
    let covariance = DMatrix::from_fn(NUMBERS, NUMBERS, |i, j| e.covariance[at[i]][at[j]]);
    let error = DVector::from_row_slice(&off);
    Score {
        z: std::array::from_fn(|k| off[k] / own[k].sigma.unwrap()),
        nees: error.dot(&covariance.cholesky().unwrap().solve(&error)),
        trusted: e.passes(),
    }
}

fn heading(first: &str) {
    tables::heading(&[
        first, "seeds", "trusted", "mean z", "rms z", "NEES (6)", "coverage",
    ]);
}

fn scores(trials: u64, inputs: Inputs, slow: Slow) -> Vec<Score> {
    let seeds = (0..tables::trials(trials)).into_par_iter();
    seeds.map(|seed| score(inputs, slow, seed)).collect()
}

/// A row of the table from its answers, held to the limits of a calibrated estimator.
fn calibrated(row: &str, tests: usize, all: &[Score]) {
    let tail = FALSE_ALARM / (2 * tests) as f64;
    let count = all.len() as f64;
    let mean = |k: usize| all.iter().map(|s| s.z[k]).sum::<f64>() / count;
    let means: [f64; NUMBERS] = std::array::from_fn(mean);
    let each = || all.iter().flat_map(|s| s.z);
    let numbers = count * NUMBERS as f64;
    let rms = (each().map(|z| z * z).sum::<f64>() / numbers).sqrt();
    let held = each().filter(|z| z.abs() < 1.959_964).count() as f64 / numbers;
    let nees = all.iter().map(|s| s.nees).sum::<f64>() / count;
    let (n, trusted) = (all.len(), all.iter().filter(|s| s.trusted).count());
    let largest = means.iter().fold(0.0, |a: f64, z| a.max(z.abs()));
    tables::row(&[
        row.to_owned(),
        n.to_string(),
        trusted.to_string(),
        format!("{largest:.2}"),
        format!("{rms:.2}"),
        format!("{nees:.2}"),
        format!("{:.1} %", 100.0 * held),
    ]);
    let most = Normal::standard().inverse_cdf(1.0 - tail) / count.sqrt();
    assert!(
        largest < most,
        "{row}: mean z {means:.2?}, at most {most:.2}"
    );
    let squares = ChiSquared::new(numbers).unwrap();
    let [least, most] = [tail, 1.0 - tail].map(|p| squares.inverse_cdf(p) / count);
    assert!(
        nees > least && nees < most,
        "{row}: NEES {nees:.2}, {least:.2} to {most:.2}"
    );
    // A check of an answer errs once in 50,000, one of a diagnosis once in 100.
    assert!(
        trusted as f64 >= 0.9 * count - 1.0,
        "{row}: {trusted} of {n}"
    );
}

/// The bias of a fit along noisy inputs was a pure one: at q = 20 of 1.6 to 6.8 sigma, in answers that were trusted.
#[test]
fn stat_answers_with_noisy_inputs_are_calibrated() {
    heading("inputs");
    for (row, inputs) in ROWS.into_iter().filter(|(row, _)| tables::wanted(row)) {
        calibrated(
            row,
            ROWS.len() * (NUMBERS + 2),
            &scores(6, inputs, Slow::default()),
        );
    }
}

/// Errors of sensors that last over samples, as large as their white noise: declared, the answers are calibrated; not declared, none
/// is trusted and wrong.
#[test]
fn stat_slow_errors_are_declared_or_noticed() {
    heading("slow errors");
    let rows = SLOW.into_iter().filter(|(row, _)| tables::wanted(row));
    for (row, slow) in rows.clone() {
        let declared = Slow {
            declared: true,
            ..slow
        };
        let all = scores(3, Inputs::Wheels { q: 5.0 }, declared);
        calibrated(row, SLOW.len() * (NUMBERS + 2), &all);
    }
    tables::heading(&["not declared", "seeds", "trusted", "largest z of these"]);
    for (row, slow) in rows {
        let all = scores(3, Inputs::Wheels { q: 1.0 }, slow);
        let trusted = || all.iter().filter(|s| s.trusted);
        let largest = trusted()
            .flat_map(|s| s.z)
            .fold(0.0, |a: f64, z| a.max(z.abs()));
        tables::row(&[
            row.to_owned(),
            all.len().to_string(),
            trusted().count().to_string(),
            format!("{largest:.1}"),
        ]);
        assert!(largest < 5.0, "{row}: {largest:.2} sigma, trusted");
    }
}
