//! Are answers correct for a body at the limit of physical mass properties?
//!
//!     cargo run --release -p poinsot --example physical_edge -- [TRIALS [FIRST_SEED [plate|disc]]]
//!
//! A nearly flat plate and a flat disc rotate by three wheels; their thickness is far below the resolution of the
//! data. Each trial draws new noise and is solved twice: over all tensors and over physical ones. Beyond: the
//! unconstrained answer is unphysical. Held: the physical answer reports that it is at the physical limit, which must
//! be equivalent. Covered: fraction of the 95 % intervals of the six tensor elements that hold the truth, in the held
//! trials and in all, and that of the worst element.
#![allow(clippy::unwrap_used, non_snake_case)]

#[path = "../tests/all/vehicle/mod.rs"]
mod vehicle;

use poinsot::{Coordinates, Question, identify_tables};
use poinsot_identify::{Estimate, Status, TENSOR};
use poinsot_model::{EstimateSet, Model};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::Table;
use rayon::prelude::*;
use std::error::Error;
use vehicle::*;

/// Noise of gyro, attitude, velocity and position, SI.
const SIGMA: f64 = 3.0e-3;

/// Second moments along the principal axes, kg m2.
const SHAPES: [(&str, [f64; 3]); 2] = [
    ("plate", [6.9999, 5.9999, 1.0e-4]),
    ("disc", [6.0, 6.0, 0.0]),
];

struct Trial {
    settled: bool,
    rejected: bool,
    beyond: bool,
    held: bool,
    physical: bool,
    /// Whether the interval of each element holds the truth.
    covered: [bool; 6],
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let trials: u64 = words.next().map_or(Ok(100), |n| n.parse())?;
    let first: u64 = words.next().map_or(Ok(1000), |n| n.parse())?;
    println!("{trials} trials each");
    println!(
        "body   unknown  beyond  held  held amiss  unsettled  rejected  impossible  covered, held  worst  covered, all  worst"
    );
    let inertia = EstimateSet {
        mass: false,
        com: false,
        inertia: true,
    };
    let only = words.next();
    for (name, second) in SHAPES {
        if only.as_deref().is_some_and(|only| only != name) {
            continue;
        }
        for (word, estimate) in [("inertia", inertia), ("all", EstimateSet::ALL)] {
            let truth = vehicle(&tensor(second), estimate);
            row(name, &truth, word, first..first + trials);
        }
    }
    Ok(())
}

/// The tensor with these second moments, rotated relative to body axes.
fn tensor(second: [f64; 3]) -> Matrix3 {
    let axes = turned(Vector3::new(0.3, -0.5, 0.2));
    let second = Vector3::from(second);
    axes * Matrix3::from_diagonal(&second.map(|s| second.sum() - s)) * axes.transpose()
}

fn vehicle(I: &Matrix3, estimate: EstimateSet) -> Model {
    let mut model = with_wheels(tree(21, ""));
    model.bodies[0].nominal.I_BBcm_B = *I;
    model.bodies[0].estimate = estimate;
    model.sensors = sensors(SIGMA);
    model
}

fn row(name: &str, truth: &Model, word: &str, seeds: std::ops::Range<u64>) {
    let I = &truth.bodies[0].nominal.I_BBcm_B;
    let mut flight = moving(truth, 9);
    flight.rate_hz *= 2.0;
    flight.duration_s *= 0.5;
    let clean = fly(truth, &flight);
    // The nominal body is well inside the physical set.
    let mut model = truth.clone();
    model.bodies[0].nominal.I_BBcm_B += Matrix3::identity() * 0.5;
    let trials: Vec<Trial> = seeds
        .into_par_iter()
        .map(|seed| {
            let mut table = noisy(clean.clone(), seed, SIGMA);
            if word == "inertia" {
                table = rotation_only(table);
            }
            trial(&model, &table, I)
        })
        .collect();
    let count = |of: &dyn Fn(&Trial) -> bool| trials.iter().filter(|t| of(t)).count();
    let (held, held_worst) = coverage(trials.iter().filter(|t| t.held));
    let (all, all_worst) = coverage(trials.iter());
    println!(
        "{name:6} {word:7}  {:6}  {:4}  {:10}  {:9}  {:8}  {:10}  {held:11.1} %  {held_worst:4.0}  {all:10.1} %  {all_worst:4.0}",
        count(&|t| t.beyond),
        count(&|t| t.held),
        count(&|t| t.held != t.beyond),
        count(&|t| !t.settled),
        count(&|t| t.rejected),
        count(&|t| !t.physical),
    );
}

fn trial(model: &Model, table: &Table, I: &Matrix3) -> Trial {
    let ask = |coordinates| -> Estimate {
        let request = Question {
            coordinates,
            ..request("auto")
        };
        let answer = identify_tables(model.clone(), vec![table.clone()], &request);
        answer.unwrap().estimate
    };
    let (free, kept) = (ask(Coordinates::Linear), ask(Coordinates::Physical));
    let numbers = &kept.bodies[0].inertia;
    Trial {
        settled: kept.status != Status::IterationLimit && free.status != Status::IterationLimit,
        rejected: kept.status == Status::Rejected,
        // Far outside, the unconstrained answer is rejected and its numbers are withheld.
        beyond: free.bodies[0].physically_consistent == Some(false)
            || free
                .warnings
                .iter()
                .any(|w| w.contains("no distribution of positive mass")),
        held: kept
            .warnings
            .iter()
            .any(|w| w.contains("at the limit of physical")),
        physical: kept.bodies[0].physically_consistent == Some(true),
        covered: std::array::from_fn(|k| {
            let (value, sigma) = (numbers[k].value, numbers[k].sigma);
            value
                .zip(sigma)
                .is_some_and(|(v, s)| (v - I[TENSOR[k]]).abs() <= 1.96 * s)
        }),
    }
}

/// Percentage of the intervals that hold the truth: of all elements and of the worst.
fn coverage<'a>(trials: impl Iterator<Item = &'a Trial>) -> (f64, f64) {
    let mut sums = [0_usize; 6];
    let mut n = 0;
    for one in trials {
        n += 1;
        for (sum, covered) in sums.iter_mut().zip(one.covered) {
            *sum += usize::from(covered);
        }
    }
    let share = |sum: usize, of: usize| 100.0 * sum as f64 / of.max(1) as f64;
    let worst = sums.iter().copied().min().unwrap_or(0);
    (share(sums.iter().sum(), 6 * n), share(worst, n))
}
