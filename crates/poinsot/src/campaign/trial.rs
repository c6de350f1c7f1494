//! One trial: random numbers, samples, and all methods.

use super::deviates::Deviates;
use super::experiment::Apply;
use super::methods::MethodChoice;
use super::plan::{Plan, Shard};
use crate::error::Error;
use crate::threads::{processor_time, since};
use crate::trials::{Bound, Row, RowNumber, Study};
use poinsot_formats::{DrawFile, OfFile};
use poinsot_identify::{Estimate, Status};
use poinsot_papers::Kernel;
use poinsot_telemetry::Table;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Trials by kernels that a thread takes at once: half a millisecond, long beside the wait for the queue.
const TOGETHER: u64 = 256;

/// Number of trials that a thread takes at once.
pub(super) fn at_once(plan: &Plan) -> u64 {
    match plan.methods.iter().all(|m| m.kernel) {
        true => TOGETHER,
        false => 1,
    }
}

/// Data shared by all trials of a shard.
pub(super) struct Prepared {
    /// The experiment, if all trials have the same true values.
    shared: Option<Repeated>,
    /// Kernels of all methods, or none.
    kernels: Vec<Kernel>,
}

/// An experiment with its bound.
struct Repeated {
    study: Study,
    bound: Bound,
}

impl Repeated {
    fn of(study: Study) -> Self {
        let bound = study.bound_sigmas();
        Self { study, bound }
    }
}

impl Prepared {
    /// Prepares the data shared by the trials of a shard.
    ///
    /// # Errors
    /// The experiment cannot be simulated.
    pub fn new(plan: &Plan, shard: &Shard) -> Result<Self, Error> {
        let mut prepared = Self {
            shared: None,
            kernels: Vec::new(),
        };
        if !plan.draws() {
            let study = plan.study(shard.cell)?;
            let kernels = plan.methods.iter().filter(|m| m.kernel);
            let kernels = kernels.map(|m| study.kernel(&m.question));
            prepared.kernels = kernels.collect::<Result<_, _>>()?;
            prepared.shared = Some(Repeated::of(study));
        }
        Ok(prepared)
    }

    /// Runs trials: rows by trial, then by method. Failures are part of the result.
    pub fn run(&self, plan: &Plan, shard: &Shard, numbers: Range<u64>) -> Vec<Row> {
        match &self.shared {
            Some(shared) if !self.kernels.is_empty() => self.solved(shared, numbers),
            _ => numbers.flat_map(|n| self.run_one(plan, shard, n)).collect(),
        }
    }

    fn run_one(&self, plan: &Plan, shard: &Shard, number: u64) -> Vec<Row> {
        let start = processor_time();
        let mut drawn = Vec::new();
        let own;
        let repeated = match &self.shared {
            Some(shared) => Ok(shared),
            None => {
                own = Self::own_study(plan, shard, number, &mut drawn);
                own.as_ref()
            }
        };
        let Repeated { study, bound } = match repeated {
            Ok(repeated) => repeated,
            Err(error) => {
                let failed = Row::failed(number, error.to_string(), &[]);
                return vec![Row { drawn, ..failed }; plan.methods.len()];
            }
        };
        let (tables, biases) = study.draw(number);
        let expected = study.expected(&biases, bound);
        let share = since(start) / plan.methods.len() as f64;
        let by = |choice| {
            let start = processor_time();
            let found = guarded(study, &tables, choice);
            Row {
                drawn: drawn.clone(),
                seconds: since(start) + share,
                ..Row::judged(number, found, &expected)
            }
        };
        plan.methods.iter().map(by).collect()
    }

    /// Trials by kernels alone: no telemetry is drawn.
    fn solved(&self, shared: &Repeated, numbers: Range<u64>) -> Vec<Row> {
        let expected = shared.study.expected(&[], &shared.bound);
        let mut by_kernel = Vec::new();
        for kernel in &self.kernels {
            let start = processor_time();
            let bodies = kernel(shared.study.seed, numbers.clone());
            let seconds = since(start) / bodies.len().max(1) as f64;
            // A kernel estimates the first body.
            let rows = bodies.iter().zip(numbers.clone()).map(|(body, trial)| Row {
                trial,
                status: Some(Status::Converged),
                iterations: 1,
                seconds,
                numbers: body
                    .to_array()
                    .into_iter()
                    .zip(&expected)
                    .map(|(x, number)| RowNumber {
                        estimate: Some(x),
                        ..number.clone()
                    })
                    .collect(),
                ..Row::default()
            });
            by_kernel.push(rows.collect::<Vec<_>>().into_iter());
        }
        let next = |_| {
            by_kernel
                .iter_mut()
                .filter_map(Iterator::next)
                .collect::<Vec<_>>()
        };
        numbers.clone().flat_map(next).collect()
    }

    /// The experiment of a trial with its own true values.
    fn own_study(
        plan: &Plan,
        shard: &Shard,
        number: u64,
        drawn: &mut Vec<(String, f64)>,
    ) -> Result<Repeated, Error> {
        let experiment = plan.experiment(shard.cell);
        let mut changes = |apply: &mut Apply<'_>| {
            plan.fixed(shard.cell, apply)?;
            for (k, draw) in plan.file.draw.iter().enumerate() {
                let deviates = Deviates {
                    // Sensor noise uses the seed of the experiment if the plan has none.
                    seed: plan.file.seed.unwrap_or(0),
                    trial: number,
                    draw: k as u64,
                };
                let of = draw.of.unwrap_or(OfFile::Truth);
                apply(&draw.number, of, &mut |at, old| {
                    let name = format!("{}[{at}]", draw.number);
                    let value = drawn_value(draw, deviates, at, old);
                    // Both files use the same deviates, each about its own numbers.
                    if drawn.iter().all(|(other, _)| *other != name) {
                        drawn.push((name, value));
                    }
                    value
                })?;
            }
            Ok(())
        };
        let study = experiment.study(experiment.files(&mut changes)?)?;
        Ok(Repeated::of(study))
    }
}

fn drawn_value(draw: &DrawFile, deviates: Deviates, at: usize, old: f64) -> f64 {
    match (draw.sigma, draw.relative_sigma, draw.from.zip(draw.to)) {
        (Some(sigma), _, _) => old + sigma * deviates.normal(at),
        (_, Some(share), _) => old * (1.0 + share * deviates.normal(at)),
        (_, _, Some((from, to))) => from + deviates.unit(at) * (to - from),
        _ => old,
    }
}

/// Runs a method; a panic counts as a failed trial.
fn guarded(study: &Study, tables: &[Table], choice: &MethodChoice) -> Result<Estimate, String> {
    let run = || study.estimate(tables, &choice.question, choice.diagnose);
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(outcome) => outcome.map_err(|error| error.to_string()),
        Err(payload) => {
            let text = payload.downcast_ref::<&str>().copied();
            let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
            Err(format!("{CRASHED} {}", text.unwrap_or("no message")))
        }
    }
}

/// Prefix of the reason of a crashed trial.
pub(super) const CRASHED: &str = "crashed:";
