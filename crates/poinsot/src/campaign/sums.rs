//! Sums over the rows of a cell: those of a shard are written, and added in the order of the shards.

use super::plan::Plan;
use crate::trials::{Row, Sums};
use poinsot_formats::{CellFile, MethodResultFile, finite};
use serde::{Deserialize, Serialize};

/// Sums over trials of one cell.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CellSums {
    /// One entry per method.
    pub methods: Vec<Sums>,
    /// CPU time of each method, s; not reproducible.
    pub seconds: Vec<f64>,
}

impl CellSums {
    /// Sums of rows, which have one entry per method for each trial.
    pub(super) fn of(plan: &Plan, rows: &[Row]) -> Self {
        let methods = plan.methods.iter().map(|m| Sums {
            setup: m.label.clone(),
            ..Sums::default()
        });
        let mut sums = Self {
            methods: methods.collect(),
            seconds: vec![0.0; plan.methods.len()],
        };
        for trial in rows.chunks(plan.methods.len()) {
            for (k, row) in trial.iter().enumerate() {
                sums.methods[k].add(row);
                sums.seconds[k] += row.seconds;
            }
        }
        sums
    }

    /// Adds the sums of a shard.
    pub(super) fn merge(&mut self, shard: &Self) {
        for (ours, theirs) in self.methods.iter_mut().zip(&shard.methods) {
            ours.merge(theirs);
        }
        for (ours, theirs) in self.seconds.iter_mut().zip(&shard.seconds) {
            *ours += theirs;
        }
    }

    /// The statistics of every method.
    pub(super) fn file(&self, plan: &Plan, cell: u64, outside: f64) -> CellFile {
        let point = plan.point(cell).into_iter();
        let methods = self.methods.iter().zip(&self.seconds);
        CellFile {
            experiment: plan.experiment(cell).name.clone(),
            at: point.map(|(n, x)| (n.to_owned(), x)).collect(),
            methods: methods
                .map(|(sums, seconds)| MethodResultFile {
                    seconds_per_trial: finite(seconds / sums.trials as f64),
                    ..sums.result(outside)
                })
                .collect(),
        }
    }
}
