//! Noise of wheels and joints beside good gyros: the table of `docs/validation/noisy_inputs.md`.

mod vehicle;

use crate::tables;
use nalgebra::{DMatrix, DVector};
use poinsot::{Question, identify_tables};
use poinsot_model::parse_model;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};
use vehicle::{Inputs, Vehicle};

/// Vehicles and inputs, a row each.
const ROWS: [(&str, Inputs); 5] = [
    ("wheels, q = 1", Inputs::Wheels { q: 1.0 }),
    ("wheels, q = 5", Inputs::Wheels { q: 5.0 }),
    ("wheels, q = 20", Inputs::Wheels { q: 20.0 }),
    ("encoders, 0.1 mrad", Inputs::Joints { noise_rad: 1.0e-4 }),
    ("encoders, 3 mrad", Inputs::Joints { noise_rad: 3.0e-3 }),
];
/// Numbers of an answer: the inertia of the base.
const NUMBERS: usize = 6;
/// Probability that a right estimator fails anywhere: NEES on both sides, and six means, in every row.
const FALSE_ALARM: f64 = 1.0e-3;

/// One answer.
struct Score {
    z: [f64; NUMBERS],
    nees: f64,
    trusted: bool,
}

fn score(inputs: Inputs, seed: u64) -> Score {
    let drawn = Vehicle::drawn(inputs, seed);
    let truth = drawn.truth();
    let (text, table) = drawn.record();
    let model = parse_model(&text, "drawn.toml").unwrap();
    let found = identify_tables(model, vec![table], &Question::default()).unwrap();
    let e = &found.estimate;
    let order = [0, 2, 5, 1, 3, 4];
    let own = order.map(|k| e.bodies[0].inertia[k]);
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

/// The bias of a fit along noisy inputs was a pure one: at q = 20 of 1.6 to 6.8 sigma, in answers that were trusted.
#[test]
fn stat_answers_with_noisy_inputs_are_calibrated() {
    tables::heading(&[
        "inputs", "seeds", "trusted", "mean z", "rms z", "NEES (6)", "coverage",
    ]);
    let n = tables::trials(6);
    let tests = ROWS.len() * (NUMBERS + 2);
    let tail = FALSE_ALARM / (2 * tests) as f64;
    for (row, inputs) in ROWS.into_iter().filter(|(row, _)| tables::wanted(row)) {
        let all: Vec<Score> = (0..n).into_par_iter().map(|s| score(inputs, s)).collect();
        let count = all.len() as f64;
        let mean = |k: usize| all.iter().map(|s| s.z[k]).sum::<f64>() / count;
        let means: [f64; NUMBERS] = std::array::from_fn(mean);
        let each = || all.iter().flat_map(|s| s.z);
        let numbers = count * NUMBERS as f64;
        let rms = (each().map(|z| z * z).sum::<f64>() / numbers).sqrt();
        let held = each().filter(|z| z.abs() < 1.959_964).count() as f64 / numbers;
        let nees = all.iter().map(|s| s.nees).sum::<f64>() / count;
        let trusted = all.iter().filter(|s| s.trusted).count();
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
}
