//! One trial: random numbers, samples, and all methods.

use super::experiment::Apply;
use super::methods::MethodChoice;
use super::plan::{Plan, Shard, between, of};
use super::sampling::{Deviates, points};
use crate::error::Error;
use crate::trials::{Study, Trial, estimated_numbers, judged_body};
use poinsot_formats::{DrawFile, OfFile};
use poinsot_papers::Kernel;
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

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
    shared: Option<Shared>,
    /// Points of the sampling, one per trial.
    points: Vec<Vec<f64>>,
    /// Numbers with columns, whether determined or not.
    asked: Vec<String>,
    /// Those of the first body, which a kernel estimates.
    first: Vec<String>,
}

/// An experiment that all trials repeat.
struct Shared {
    study: Study,
    bound: Bound,
    /// Kernels of all methods, or none.
    kernels: Vec<Box<dyn Kernel>>,
    /// True numbers without the biases that trials draw.
    truth: HashMap<String, f64>,
    /// Those with columns, in trials by kernels.
    columns: TrueNumbers,
}

/// Sigmas of the Cramer-Rao bound by name; empty if it does not exist.
pub(super) type Bound = Vec<(String, f64)>;

/// True numbers with columns, by name.
pub(super) type TrueNumbers = Arc<[(String, f64)]>;

/// One trial by every method.
#[derive(Default)]
pub(super) struct Done {
    /// Random or sampled numbers, by address.
    pub drawn: Vec<(String, f64)>,
    /// True numbers, by name.
    pub truth: TrueNumbers,
    /// The bound of this trial, if it has its own true values.
    pub bound: Option<Bound>,
    /// One entry per method.
    pub trials: Vec<Trial>,
    /// CPU time of each method including its part of the simulation, s; by a kernel, the mean of a block of trials.
    pub seconds: Vec<f64>,
}

impl Prepared {
    /// Prepares the data shared by the trials of a shard.
    ///
    /// # Errors
    /// The experiment cannot be simulated.
    pub fn new(plan: &Plan, shard: &Shard) -> Result<Self, Error> {
        let points = match plan.sampling {
            Some(s) => points(
                s,
                plan.sampled.len(),
                seed(plan),
                shard.trials.start / s.points,
            ),
            None => Vec::new(),
        };
        let experiment = plan.experiment(shard.cell);
        let (asked, first) = (experiment.asked(), experiment.first());
        let shared = match plan.draws() {
            true => None,
            false => {
                let study = experiment.study(plan.files_at(experiment, shard.cell)?)?;
                let kernels = plan.methods.iter().filter(|m| m.kernel);
                let kernels = kernels.map(|m| study.kernel(&m.question));
                let truth = study.true_numbers(&[]);
                Some(Shared {
                    bound: bound_of(&study),
                    kernels: kernels.collect::<Result<_, _>>()?,
                    columns: with_columns(asked.iter().chain(&first), &truth),
                    truth,
                    study,
                })
            }
        };
        Ok(Self {
            shared,
            points,
            asked,
            first,
        })
    }

    /// The bound common to all trials.
    pub fn bound(&self) -> Bound {
        self.shared
            .as_ref()
            .map_or_else(Vec::new, |s| s.bound.clone())
    }

    /// Runs trials. Failures are part of the result.
    pub fn run(&self, plan: &Plan, shard: &Shard, numbers: Range<u64>) -> Vec<Done> {
        match &self.shared {
            Some(shared) if !shared.kernels.is_empty() => self.solved(shared, numbers),
            _ => numbers.map(|n| self.run_one(plan, shard, n)).collect(),
        }
    }

    fn run_one(&self, plan: &Plan, shard: &Shard, number: u64) -> Done {
        let start = processor_time();
        let drawn = RefCell::new(Vec::new());
        let own;
        let (study, bound) = match &self.shared {
            Some(shared) => (Ok(&shared.study), None),
            None => {
                own = self.own_study(plan, shard, number, &drawn);
                let bound = own.as_ref().ok().map(bound_of);
                (own.as_ref(), bound)
            }
        };
        let mut done = Done {
            drawn: drawn.take(),
            bound,
            ..Done::default()
        };
        let (study, tables, truth) = match study {
            Ok(study) => {
                let (tables, biases) = study.draw(number);
                (study, tables, study.true_numbers(&biases))
            }
            Err(error) => {
                let outcome = Err(error.to_string());
                done.trials = vec![Trial { number, outcome }; plan.methods.len()];
                done.seconds = vec![0.0; plan.methods.len()];
                return done;
            }
        };
        let share = since(start) / plan.methods.len() as f64;
        for choice in &plan.methods {
            let start = processor_time();
            let outcome = guarded(study, &tables, &truth, choice);
            done.trials.push(Trial { number, outcome });
            done.seconds.push(since(start) + share);
        }
        let answers = done.trials.iter().flat_map(|t| &t.outcome);
        let determined = answers.flat_map(|a| a.numbers.iter().map(|n| &n.name));
        done.truth = with_columns(self.asked.iter().chain(determined), &truth);
        done
    }

    /// Trials by kernels alone: no telemetry is drawn.
    fn solved(&self, shared: &Shared, numbers: Range<u64>) -> Vec<Done> {
        let done = |_| Done {
            truth: Arc::clone(&shared.columns),
            ..Done::default()
        };
        let mut all: Vec<Done> = numbers.clone().map(done).collect();
        for kernel in &shared.kernels {
            let start = processor_time();
            let bodies = kernel.trials(shared.study.seed, numbers.clone());
            for ((done, body), number) in all.iter_mut().zip(&bodies).zip(numbers.clone()) {
                let outcome = Ok(judged_body(body, &self.first, &shared.truth));
                done.trials.push(Trial { number, outcome });
            }
            let share = since(start) / bodies.len().max(1) as f64;
            all.iter_mut().for_each(|done| done.seconds.push(share));
        }
        all
    }

    /// The experiment of a trial with its own true values.
    fn own_study(
        &self,
        plan: &Plan,
        shard: &Shard,
        number: u64,
        drawn: &RefCell<Vec<(String, f64)>>,
    ) -> Result<Study, Error> {
        let experiment = plan.experiment(shard.cell);
        let point = self.points.get((number - shard.trials.start) as usize);
        let changes = |apply: &mut Apply<'_>| {
            plan.fixed(shard.cell, apply)?;
            for (axis, share) in plan.sampled.iter().zip(point.into_iter().flatten()) {
                let value = between(axis.range[0], axis.range[1], *share, axis.log);
                drawn.borrow_mut().push((axis.number.clone(), value));
                apply(&axis.number, axis.of, &|_, _| value)?;
            }
            for (k, draw) in plan.file.draw.iter().enumerate() {
                let deviates = Deviates {
                    seed: seed(plan),
                    trial: number,
                    draw: k as u64,
                };
                let note = |name: String, value| {
                    let mut all = drawn.borrow_mut();
                    // Both files use the same deviates, each about its own numbers.
                    if all.iter().all(|(other, _)| *other != name) {
                        all.push((name, value));
                    }
                };
                apply(&draw.number, of(draw.of, OfFile::Truth), &|at, old| {
                    let value = drawn_value(draw, deviates, at, old);
                    note(format!("{}[{at}]", draw.number), value);
                    value
                })?;
            }
            Ok(())
        };
        experiment.study(experiment.files(&changes)?)
    }
}

/// The true numbers of these names, each once and in order.
fn with_columns<'a>(
    names: impl Iterator<Item = &'a String>,
    truth: &HashMap<String, f64>,
) -> TrueNumbers {
    let mut names: Vec<&String> = names.collect();
    names.sort_unstable();
    names.dedup();
    let value = |name: &String| Some((name.clone(), *truth.get(name)?));
    names.into_iter().filter_map(value).collect()
}

fn drawn_value(draw: &DrawFile, deviates: Deviates, at: usize, old: f64) -> f64 {
    match (draw.sigma, draw.relative_sigma, draw.from.zip(draw.to)) {
        (Some(sigma), _, _) => old + sigma * deviates.normal(at),
        (_, Some(share), _) => old * (1.0 + share * deviates.normal(at)),
        (_, _, Some((from, to))) => between(from, to, deviates.unit(at), false),
        _ => old,
    }
}

/// Seed of points and draws. Sensor noise uses the seed of the experiment if the plan has none.
fn seed(plan: &Plan) -> u64 {
    plan.file.seed.unwrap_or(0)
}

fn bound_of(study: &Study) -> Bound {
    let numbers = study.bound().map(|bound| estimated_numbers(&bound));
    let numbers = numbers.unwrap_or_default();
    numbers.into_iter().map(|(name, _, s)| (name, s)).collect()
}

/// Runs a method; a panic counts as a failed trial.
fn guarded(
    study: &Study,
    tables: &[poinsot_telemetry::Table],
    truth: &HashMap<String, f64>,
    choice: &MethodChoice,
) -> Result<crate::trials::Answer, String> {
    let run = || study.answer(tables, truth, &choice.question, choice.diagnose);
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

/// CPU time of this thread.
#[cfg(unix)]
fn processor_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(t.tv_sec.max(0) as u64, t.tv_nsec as u32)
}

/// Wall-clock time, if CPU time is not available.
#[cfg(not(unix))]
fn processor_time() -> Duration {
    use std::sync::OnceLock;
    use std::time::Instant;
    static ZERO: OnceLock<Instant> = OnceLock::new();
    ZERO.get_or_init(Instant::now).elapsed()
}

fn since(start: Duration) -> f64 {
    processor_time().saturating_sub(start).as_secs_f64()
}
