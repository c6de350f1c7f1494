//! Trials per second of both steps on one core.

use super::experiment::{Experiment, readings};
use super::noise::OPTIONS;
use crate::ma2008::Trials;
use crate::study::{Context, Findings, StudyError, Table, figures};
use std::time::Instant;

/// Groups of eight trials per measurement, and number of measurements; the fastest is reported.
const GROUPS: u64 = 2_000;
const ROUNDS: u64 = 100;
/// Noise of all velocities, m/s and rad/s.
const SIGMA: f64 = 1.0e-4;

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let e = Experiment::of(context, 1, [0.0, 0.0, 5.0])?;
    let run = e.run()?;
    let samples = readings(&e.model, &run.raws);
    let mut table = Table::new(
        "speed",
        "Trials of ten samples, both steps, on one core of this machine",
        " | million trials a second | mean mass, kg",
    );
    for known in OPTIONS {
        let trials = Trials::new(&samples, known.then_some(run.known), [SIGMA; 3], [SIGMA; 3]);
        let (mut best, mut sum) = (f64::INFINITY, 0.0);
        for round in 0..ROUNDS {
            let start = Instant::now();
            trials.run(1, round * GROUPS..(round + 1) * GROUPS, |r| {
                sum += r[0].iter().sum::<f64>() / 8.0;
            });
            best = best.min(start.elapsed().as_secs_f64());
        }
        let name = if known { "option 1" } else { "option 2" };
        let rate = 8.0e-6 * GROUPS as f64 / best;
        table.row(
            name,
            [figures(rate, 2), figures(sum / (ROUNDS * GROUPS) as f64, 4)],
        );
    }
    Ok(Findings::of(table))
}
