//! One trial: random numbers, samples, and all methods.

use super::address::edit;
use super::deviates::Deviates;
use super::methods::MethodChoice;
use super::plan::{Plan, Shard};
use crate::error::Error;
use crate::guard::panic_text;
use crate::threads::{processor_time, since};
use crate::trials::{Bound, Row, Study};
use poinsot_formats::{DrawFile, OfFile};
use poinsot_identify::Estimate;
use poinsot_telemetry::Table;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Data shared by all trials of a shard: the experiment, if all trials have the same true values.
pub(super) struct Prepared(Option<Repeated>);

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
        let same = plan.file.draw.is_empty();
        let study = same.then(|| plan.study(shard.cell)).transpose()?;
        Ok(Self(study.map(Repeated::of)))
    }

    /// Runs all trials of a shard, one after the other: rows by trial, then by method.
    pub fn run_all(&self, plan: &Plan, shard: &Shard) -> Vec<Row> {
        let trials = shard.trials.clone();
        trials.flat_map(|n| self.run(plan, shard, n)).collect()
    }

    /// Runs a trial: a row for each method. Failures are part of the result.
    pub fn run(&self, plan: &Plan, shard: &Shard, number: u64) -> Vec<Row> {
        let start = processor_time();
        let mut drawn = Vec::new();
        let own;
        let repeated = match &self.0 {
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

    /// The experiment of a trial with its own true values.
    fn own_study(
        plan: &Plan,
        shard: &Shard,
        number: u64,
        drawn: &mut Vec<(String, f64)>,
    ) -> Result<Repeated, Error> {
        let experiment = plan.experiment(shard.cell);
        let files = experiment.files(|documents| {
            plan.fixed(shard.cell, documents)?;
            for (k, draw) in plan.file.draw.iter().enumerate() {
                let deviates = Deviates {
                    // Sensor noise uses the seed of the experiment if the plan has none.
                    seed: plan.file.seed.unwrap_or(0),
                    trial: number,
                    draw: k as u64,
                };
                let of = draw.of.unwrap_or(OfFile::Truth);
                edit(documents, &draw.number, of, &mut |at, old| {
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
        });
        Ok(Repeated::of(experiment.study(files?)?))
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
        Err(payload) => Err(format!("{CRASHED} {}", panic_text(&*payload))),
    }
}

/// Prefix of the reason of a crashed trial.
pub(super) const CRASHED: &str = "crashed:";
