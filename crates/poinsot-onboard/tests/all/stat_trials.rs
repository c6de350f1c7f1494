//! Calibration over many trials.

use crate::setups::{self, OnBoard, Setup};
use crate::truth::{Noise, samples};
use nalgebra::{DMatrix, DVector};
use poinsot_onboard::{Answer, Health};

/// Trials of each set-up; `POINSOT_TRIALS` gives another number.
fn trials() -> u64 {
    let given = std::env::var("POINSOT_TRIALS").ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(20)
}

/// Error of the unknown parameters in sigma, and its squared size in their covariance.
pub fn errors(setup: &Setup, answer: &Answer) -> (Vec<f64>, f64) {
    let truth = setup.truth.parameters();
    let unknown: Vec<usize> = (0..10).filter(|k| setup.sigma[*k] > 0.0).collect();
    let n = unknown.len();
    let error = DVector::from_fn(n, |j, _| answer.numbers[unknown[j]].value - truth[unknown[j]]);
    let C = DMatrix::from_fn(n, n, |i, j| answer.covariance[i][j]);
    let squared = (error.transpose() * C.cholesky().unwrap().solve(&error))[0];
    let each = unknown.iter().zip(error.iter());
    (each.map(|(k, e)| e / answer.numbers[*k].sigma).collect(), squared)
}

fn run(setup: &Setup, seed: u64) -> (Vec<Answer>, Box<OnBoard>) {
    let mut noise = Noise::new(seed);
    let motions = setup.truth.motions(&setup.configuration);
    let stream = samples(&setup.truth, &setup.configuration, &motions, Some(&mut noise));
    let mut filter = setup.filter(&mut noise);
    let mut out = Vec::new();
    for sample in &stream {
        filter.push(sample).unwrap();
        out.push(filter.answer(sample.time_s));
    }
    (out, filter)
}

#[test]
fn stat_errors_are_those_of_the_covariance() {
    for setup in setups::all() {
        let (mut at_half, mut at_end, mut inconsistent, mut worst) = (0.0, 0.0, 0, 0.0_f64);
        let mut first = Vec::new();
        for seed in 0..trials() {
            let (answers, filter) = run(&setup, seed);
            let last = answers.len() - 1;
            let half = errors(&setup, &answers[last / 2]).1;
            let end = errors(&setup, &answers[last]).1;
            at_half += half;
            at_end += end;
            let bad = answers.iter().any(|a| a.health == Health::Inconsistent);
            inconsistent += usize::from(bad);
            for a in &answers {
                if a.health == Health::Determined {
                    worst = errors(&setup, a).0.iter().fold(worst, |w, e| w.max(e.abs()));
                }
            }
            first.extend(answers.iter().position(|a| a.health == Health::Determined));
            if std::env::var("VERBOSE").is_ok() {
                println!("{seed} half {half:.2} end {end:.2} {bad} {:?} {:?}", filter.counts(), answers[last].numbers.map(|n| n.sigma));
            }
        }
        let n = setup.sigma.iter().filter(|s| **s > 0.0).count() as f64 * trials() as f64;
        first.sort();
        println!(
            "{}: NEES half {:.3} end {:.3}, inconsistent {inconsistent}, worst {worst:.2}, determined {} median {:?}",
            setup.name, at_half / n, at_end / n, first.len(), first.get(first.len() / 2)
        );
    }
}
