//! Selection of rows, and the limit on their number.

use crate::columns::Columns;
use crate::options::{MEMORY_MIB, ReadOptions};
use crate::plan::Plan;
use crate::size::{Limit, Rows};
use crate::{Origin, TelemetryError};
use std::path::Path;

impl ReadOptions {
    /// Row selection for the readers.
    pub(crate) fn selection(&self) -> Selection {
        Selection {
            time_s: self.time_s,
            limit: self.limit(),
            seen: 0,
        }
    }

    /// Limit on the samples kept.
    pub(crate) fn limit(&self) -> Limit {
        Limit {
            bytes: match self.memory_mib {
                0 => MEMORY_MIB << 20,
                mib => mib.saturating_mul(1 << 20),
            },
            every: self.every.max(1),
        }
    }
}

/// Rows to keep, and their limit.
pub(crate) struct Selection {
    time_s: Option<[f64; 2]>,
    limit: Limit,
    seen: usize,
}

impl Selection {
    /// Whether to keep the row at this time of the table. A row without time is kept; it gives an error later.
    pub(crate) fn keeps(&mut self, time_s: f64, origin: Option<Origin>) -> bool {
        if let Some([from, to]) = self.time_s {
            let own = time_s + origin.map_or(0.0, |o| o.own_zero_s());
            if own < from || own > to {
                return false;
            }
        }
        self.seen += 1;
        (self.seen - 1).is_multiple_of(self.limit.every)
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
    ) -> Result<(), TelemetryError> {
        if columns.rows.len() <= self.limit.samples(plan.channels.len()) {
            return Ok(());
        }
        match full {
            Some(take) => take(plan, columns.split()),
            None => {
                let rest = rows.most().saturating_sub(columns.rows_read as u64);
                let chosen = self.seen as u64 + rest;
                Err(self.limit.refusal(path, plan, chosen))
            }
        }
    }
}

/// Consumer of the rows read so far.
pub(crate) type WhenFull<'a> = dyn FnMut(&Plan, Columns) -> Result<(), TelemetryError> + 'a;
