//! Sums over the trials of a cell: those of a shard are written, and added in the order of the shards.

use super::pairs::PairSums;
use super::plan::Plan;
use super::trial::{Bound, Done};
use crate::trials::{Interval, NumberSums, Sums};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// Sums over trials of one cell.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CellSums {
    /// One entry per method.
    pub methods: Vec<Sums>,
    /// Every method compared with the first.
    pub pairs: Vec<PairSums>,
    /// CPU time of each method, s; not reproducible.
    pub seconds: Vec<f64>,
    /// Per method and number: scatter of coverage and of squared errors over the replicates of a sampling.
    #[serde(skip)]
    pub(super) replicates: Vec<IndexMap<String, Replicates>>,
}

impl CellSums {
    /// Empty sums with the bound that all trials share.
    pub(super) fn new(plan: &Plan, bound: &Bound) -> Self {
        let methods = plan.methods.iter();
        let methods = methods.map(|m| Sums::with_bound(&m.label, bound));
        Self {
            methods: methods.collect(),
            pairs: vec![PairSums::default(); plan.methods.len().saturating_sub(1)],
            seconds: vec![0.0; plan.methods.len()],
            replicates: Vec::new(),
        }
    }

    /// Adds a trial.
    pub(super) fn add(&mut self, done: &Done) {
        for (k, trial) in done.trials.iter().enumerate() {
            self.methods[k].add(trial);
            if let Some(bound) = &done.bound {
                self.methods[k].add_bound(bound);
            }
            self.seconds[k] += done.seconds[k];
        }
        let [first, others @ ..] = done.trials.as_slice() else {
            return;
        };
        for (pair, other) in self.pairs.iter_mut().zip(others) {
            if let (Ok(a), Ok(b)) = (&first.outcome, &other.outcome) {
                pair.add(first.number, a, b);
            }
        }
    }

    /// Adds the sums of a shard, which is a replicate if the plan is a sampling.
    ///
    /// # Errors
    /// The shards have other methods, or the same trial.
    pub(super) fn merge(&mut self, shard: &Self, replicated: bool) -> Result<(), String> {
        if self.methods.is_empty() {
            self.clone_from(shard);
            self.replicates = vec![IndexMap::new(); shard.methods.len()];
        } else {
            for (ours, theirs) in self.methods.iter_mut().zip(&shard.methods) {
                ours.merge(theirs)?;
            }
            for (ours, theirs) in self.pairs.iter_mut().zip(&shard.pairs) {
                ours.merge(theirs);
            }
            for (ours, theirs) in self.seconds.iter_mut().zip(&shard.seconds) {
                *ours += theirs;
            }
        }
        let replicates = self.replicates.iter_mut().zip(&shard.methods);
        for (all, sums) in replicates.filter(|_| replicated) {
            for n in sums.numbers.iter().filter(|n| n.trials > 0) {
                all.entry(n.name.clone()).or_default().add(n, sums.trials);
            }
        }
        Ok(())
    }
}

/// Statistics over replicates: count, sums and sums of squares of the coverage and of the mean square over the bound.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Replicates {
    count: u64,
    pub held: (f64, f64),
    pub held_all: (f64, f64),
    pub square: (f64, f64),
}

impl Replicates {
    fn add(&mut self, n: &NumberSums, trials: u64) {
        let plus = |s: &mut (f64, f64), x: f64| *s = (s.0 + x, s.1 + x * x);
        self.count += 1;
        let stated = (n.trials - n.unstated).max(1);
        plus(&mut self.held, n.held as f64 / stated as f64);
        plus(&mut self.held_all, n.held as f64 / trials as f64);
        let yardstick = match n.bounds {
            (0, _) => n.bound.map_or(n.variance, |b| b * b * n.trials as f64),
            (count, squares) => squares / count as f64 * n.trials as f64,
        };
        plus(&mut self.square, n.square / yardstick);
    }

    /// Mean of a statistic with Student's interval over the replicates.
    pub fn interval(&self, (sum, squares): (f64, f64), value: f64, outside: f64) -> Interval {
        let n = self.count as f64;
        let mean = sum / n;
        let scatter = ((squares / n - mean * mean).max(0.0) * n / (n - 1.0).max(1.0)).sqrt();
        let about = Interval::mean(mean, scatter, self.count, outside);
        Interval { value, ..about }
    }
}
