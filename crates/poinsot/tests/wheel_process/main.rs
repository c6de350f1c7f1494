//! Wheels whose torque changes between tachometer samples: whether the stated uncertainty is the true one.
#![allow(clippy::unwrap_used, non_snake_case)]

mod satellite;

use nalgebra::{DMatrix, DVector};
use poinsot::{Identified, Question, identify_tables};
use rayon::prelude::*;
use satellite::{Case, PLAIN, TRUTH};

/// Normalised errors of one seed, their square in the stated covariance, and whether the answer is doubted.
struct Score {
    z: [f64; 6],
    nees: f64,
    doubted: bool,
    assumptions: String,
}

fn score(case: &Case, seed: u64) -> Score {
    let model = satellite::model(case);
    let found: Identified = identify_tables(
        model,
        vec![satellite::table(case, seed)],
        &Question::default(),
    )
    .unwrap();
    let e = &found.estimate;
    let inertia = &e.bodies[0].inertia;
    let off: [f64; 6] = std::array::from_fn(|k| inertia[k].value.unwrap() - TRUTH[k]);
    let names = ["xx", "xy", "yy", "xz", "yz", "zz"];
    let at = names.map(|n| {
        let ends = format!("I_{n}");
        let found = e
            .covariance_names
            .iter()
            .position(|c| c.contains(&ends) || c.contains(&format!("inertia_{n}")));
        found.unwrap_or_else(|| panic!("{:?}", e.covariance_names))
    });
    let covariance = DMatrix::from_fn(6, 6, |i, j| e.covariance[at[i]][at[j]]);
    let off_vector = DVector::from_row_slice(&off);
    let nees = off_vector.dot(&covariance.cholesky().unwrap().solve(&off_vector));
    Score {
        z: std::array::from_fn(|k| off[k] / inertia[k].sigma.unwrap()),
        nees,
        doubted: e.exit_code() != 0,
        assumptions: format!("{:?} {:?} {:?}", e.assumptions, e.doubts, e.warnings),
    }
}

fn trial(name: &str, case: &Case, seeds: std::ops::Range<u64>) -> Vec<Score> {
    let scores: Vec<Score> = seeds
        .clone()
        .into_par_iter()
        .map(|s| score(case, s))
        .collect();
    let n = scores.len() as f64;
    let nees = scores.iter().map(|s| s.nees).sum::<f64>() / n;
    let largest = scores.iter().map(|s| s.nees).fold(0.0, f64::max);
    let mean: Vec<String> = (0..6)
        .map(|k| format!("{:+.2}", scores.iter().map(|s| s.z[k]).sum::<f64>() / n))
        .collect();
    let doubted = scores.iter().filter(|s| s.doubted).count();
    println!(
        "{name}: NEES {nees:.2} of 6, largest {largest:.1}, mean z {mean:?}, doubted {doubted} of {n}"
    );
    if std::env::var("SHOW").is_ok() {
        for (s, seed) in scores.iter().zip(seeds) {
            println!("  {seed}: {:.1} {}", s.nees, s.assumptions);
        }
    }
    scores
}

fn cases() -> Vec<(&'static str, Case)> {
    let tachometer = |hz: f64| Case {
        tachometer_hz: hz,
        ..PLAIN
    };
    let slews = Case {
        slews: true,
        duration_s: 240.0,
        ..PLAIN
    };
    vec![
        ("tones, 4 Hz", tachometer(4.0)),
        ("tones, 2 Hz", PLAIN),
        ("tones, 1 Hz", tachometer(1.0)),
        (
            "slews, 4 Hz",
            Case {
                tachometer_hz: 4.0,
                ..slews
            },
        ),
        ("slews, 2 Hz", slews),
        (
            "slews, 1 Hz",
            Case {
                tachometer_hz: 1.0,
                ..slews
            },
        ),
        (
            "rounded to 1 rpm, 4 Hz",
            Case {
                rounding: std::f64::consts::PI / 30.0,
                tachometer_hz: 4.0,
                ..PLAIN
            },
        ),
        (
            "rounded to 1 rpm, slews, 4 Hz",
            Case {
                rounding: std::f64::consts::PI / 30.0,
                tachometer_hz: 4.0,
                ..slews
            },
        ),
        (
            "gap of 20 s, 4 Hz",
            Case {
                gap: Some((80.0, 100.0)),
                tachometer_hz: 4.0,
                ..PLAIN
            },
        ),
    ]
}

#[test]
fn stat_wheels_between_samples() {
    let seeds: u64 = std::env::var("SEEDS")
        .ok()
        .and_then(|s| s.parse().ok())
        .unwrap_or(4);
    let only = std::env::var("ONLY").unwrap_or_default();
    for (name, case) in cases().iter().filter(|c| c.0.contains(&only)) {
        trial(name, case, 0..seeds);
    }
}
