//! Rows as a reader finds them: which are kept, and at what time.

use crate::ReadOptions;
use crate::clock::Clock;
use crate::columns::Columns;
use crate::instant::NO_YEAR;
use crate::number::{InvalidNumber, RawCell};
use crate::plan::Plan;
use crate::selection::{Selection, WhenFull};
use crate::size::Rows;
use poinsot_files::{Faults, Place};
use std::path::Path;

/// What was taken from a file so far.
pub(crate) struct Intake<'a> {
    path: &'a Path,
    plan: &'a Plan,
    clock: Clock,
    selection: Selection,
    /// The first time of no year that a record has, and the number of such rows.
    unset: Option<Faults>,
    unset_rows: usize,
    pub columns: Columns,
}

impl<'a> Intake<'a> {
    pub fn new(path: &'a Path, plan: &'a Plan, options: &ReadOptions) -> Self {
        Self {
            path,
            plan,
            clock: plan.clock.clone(),
            selection: Selection::new(options),
            unset: None,
            unset_rows: 0,
            columns: Columns::new(plan.channels.len(), plan.choices.len()),
        }
    }

    /// Returns an error if the rows clearly exceed the memory limit.
    pub fn check_ahead(&self, rows: Rows) -> Result<(), Faults> {
        self.selection.check_ahead(self.path, self.plan, rows)
    }

    /// Reads the times as timestamps since 1970 UTC.
    #[cfg(feature = "parquet")]
    pub fn instants(mut self) -> Self {
        self.clock = self.clock.instants();
        self
    }

    /// Whether the row filter and the times keep a row. Its time is stored then; `cell` gives a cell of a column.
    pub fn keeps<'c>(
        &mut self,
        row: u64,
        cell: impl Fn(usize) -> RawCell<'c>,
    ) -> Result<bool, Faults> {
        let plan = self.plan;
        for (k, (index, text)) in plan.filter.iter().enumerate() {
            let found = cell(*index).text();
            if k == 0 {
                self.columns.saw(0, &found);
            }
            if *found != *text.as_bytes() {
                return Ok(false);
            }
        }
        let mut chosen = Vec::new();
        for (k, choice) in plan.choices.iter().enumerate() {
            let fits = |(index, text): &(usize, String)| *cell(*index).text() == *text.as_bytes();
            if let Some((index, _)) = choice.last() {
                self.columns.saw(k + 1, &cell(*index).text());
            }
            chosen.push(choice.iter().all(fits));
        }
        if plan.chooses_all() && !chosen.contains(&true) {
            return Ok(false);
        }
        let time = cell(plan.time_index);
        let seconds = self.clock.seconds(time, plan.week_index.map(&cell));
        self.columns.origin = self.clock.origin;
        let place = || Place::cell(self.path, row, &plan.time_column);
        let fault = |why: InvalidNumber| why.fault(place(), &time.text(), true);
        let time_s = match seconds {
            Err(why) if why == NO_YEAR => {
                self.unset.get_or_insert_with(|| fault(why));
                self.unset_rows += 1;
                return Ok(false);
            }
            read => read.map_err(fault)?.or_nan(),
        };
        let origin = self.columns.origin;
        let every_row = !plan.chooses_all();
        let keeps = self
            .selection
            .keeps((time_s, origin), every_row, &mut chosen);
        if keeps {
            let lists = self.columns.chosen.iter_mut().zip(chosen);
            lists.for_each(|(list, chosen)| list.push(chosen));
            self.columns.time_s.push(time_s);
            self.columns.rows.push(row);
        }
        Ok(keeps)
    }

    /// The columns. Rows of a clock that was not set are an error, unless others are chosen by their times.
    pub fn finished(self) -> Result<Columns, Faults> {
        let chosen = self.selection.time_s.is_some() && !self.columns.time_s.is_empty();
        let Some(mut faults) = self.unset.filter(|_| !chosen) else {
            return Ok(self.columns);
        };
        let (unset, all) = (self.unset_rows, self.columns.rows_read);
        if let Some(first) = faults.list.first_mut().filter(|_| unset < all) {
            first.problem += &format!(", as in {unset} of {all} rows");
            first.advice +=
                ", or leave these rows out by --time-s 0,TO (s since the first other row)";
        }
        Err(faults)
    }

    /// Passes the kept rows to `full` when they reach the memory limit; see [`Selection::check`].
    pub fn make_room(&mut self, rows: Rows, full: Option<&mut WhenFull>) -> Result<(), Faults> {
        let Self { path, plan, .. } = *self;
        self.selection
            .check(path, plan, &mut self.columns, rows, full)
    }
}
