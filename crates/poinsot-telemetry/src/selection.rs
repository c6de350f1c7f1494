//! Selection of rows, and the limit on their number.

use crate::clock::COUNTED_S;
use crate::columns::Columns;
use crate::plan::Plan;
use crate::size::Rows;
use crate::{Origin, ReadOptions};
use poinsot_files::{Faults, Place};
use std::path::Path;

/// Rows to keep, and their limit.
pub(crate) struct Selection {
    pub time_s: Option<[f64; 2]>,
    /// Every n-th selected row is kept.
    every: usize,
    /// Memory for samples, bytes.
    bytes: usize,
    seen: usize,
    /// The same of each choice of rows.
    of_choice: Vec<usize>,
}

impl Selection {
    pub(crate) fn new(options: &ReadOptions) -> Self {
        Self {
            time_s: options.time_s,
            every: options.every.max(1),
            bytes: options.memory_limit_mib().saturating_mul(1 << 20),
            seen: 0,
            of_choice: Vec::new(),
        }
    }

    /// Whether to keep the row at this time of the table. A row without time is kept; it gives an error later. Where not every row
    /// counts, each choice of rows counts its own.
    pub(crate) fn keeps(
        &mut self,
        (time_s, origin): (f64, Option<Origin>),
        every_row: bool,
        chosen: &mut [bool],
    ) -> bool {
        if let Some([from, to]) = self.time_s {
            let zero = origin.filter(|_| to >= COUNTED_S);
            let own = time_s + zero.map_or(0.0, |o| o.own_zero_s());
            if own < from || own > to {
                return false;
            }
        }
        self.seen += 1;
        if every_row {
            return (self.seen - 1).is_multiple_of(self.every);
        }
        self.of_choice.resize(chosen.len(), 0);
        for (count, chosen) in self.of_choice.iter_mut().zip(chosen.iter_mut()) {
            let own = *chosen;
            *chosen = own && count.is_multiple_of(self.every);
            *count += usize::from(own);
        }
        chosen.contains(&true)
    }

    /// Returns an error before reading if all rows are requested and clearly exceed the limit.
    ///
    /// # Errors
    /// E0221.
    pub(crate) fn check_ahead(&self, path: &Path, plan: &Plan, rows: Rows) -> Result<(), Faults> {
        let some = self.time_s.is_some() || !plan.filter.is_empty() || plan.chooses_all();
        let kept = rows.least() / self.every as f64;
        if some || kept <= self.samples(plan) as f64 {
            return Ok(());
        }
        Err(self.refusal(path, plan, rows.most()))
    }

    /// Passes the kept rows to `full` when they reach the memory limit; `rows` is the number in the whole file.
    ///
    /// # Errors
    /// Returns an error if no consumer is set or the consumer fails.
    pub(crate) fn check(
        &self,
        path: &Path,
        plan: &Plan,
        columns: &mut Columns,
        rows: Rows,
        full: Option<&mut WhenFull>,
    ) -> Result<(), Faults> {
        let own = columns.rows.len() - usize::from(columns.follows);
        if own <= self.samples(plan) {
            return Ok(());
        }
        match full {
            Some(take) => take(plan, columns.split()),
            None => {
                let rest = rows.most().saturating_sub(columns.rows_read as u64);
                let chosen = self.seen as u64 + rest;
                Err(self.refusal(path, plan, chosen))
            }
        }
    }

    /// Samples that fit: each row needs a time, a row number and one value per channel.
    fn samples(&self, plan: &Plan) -> usize {
        self.bytes / (8 * (plan.channels.len() + 2))
    }

    /// The error for this many selectable rows; names the row step that fits.
    fn refusal(&self, path: &Path, plan: &Plan, rows: u64) -> Faults {
        let fit = self.samples(plan);
        let every = rows.div_ceil(fit.max(1) as u64);
        let every = every.max(self.every as u64 + 1);
        let samples = rows.div_ceil(self.every as u64);
        let (channels, mib) = (plan.channels.len(), self.bytes >> 20);
        let problem = format!(
            "up to {samples} samples in {channels} channels are requested, but {fit} fit into {mib} MiB of memory"
        );
        let advice = format!("use --every {every}, --time-s FROM,TO, or a larger --memory-mib");
        Faults::one(TOO_LARGE, Place::file(path), problem, advice)
    }
}

/// Code of a file with more samples than the memory limit allows.
pub(crate) const TOO_LARGE: &str = "E0221";

/// Consumer of the rows read so far.
pub(crate) type WhenFull<'a> = dyn FnMut(&Plan, Columns) -> Result<(), Faults> + 'a;
