//! Output of a reader: the numbers of one file by column.

use crate::Origin;
use crate::number::Cell;

/// The requested columns of one file, in SI, in file order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    /// Origin of the times.
    pub origin: Option<Origin>,
    /// Time of each kept row, s; NaN for an empty cell.
    pub time_s: Vec<f64>,
    /// Values of each planned channel, one per kept row; NaN for no sample.
    pub values: Vec<Vec<f64>>,
    /// Line (CSV) or row (Parquet) of each kept row, 1-based.
    pub rows: Vec<u64>,
    /// Number of data rows read, kept or not.
    pub rows_read: usize,
    /// Number of NaN cells of each channel, and the row of the first.
    pub nan_cells: Vec<(u64, u64)>,
    /// The first distinct texts in the first filter column.
    pub filter_seen: Vec<String>,
    /// Whether the first row is the last one of the part before.
    pub follows: bool,
}

impl Columns {
    pub(crate) fn with_channels(n: usize) -> Self {
        Self {
            values: vec![Vec::new(); n],
            nan_cells: vec![(0, 0); n],
            ..Self::default()
        }
    }

    /// Offset from a time to the file's own count, s.
    pub(crate) fn own_zero_s(&self) -> f64 {
        self.origin.map_or(0.0, |o| o.own_zero_s())
    }

    /// Appends one cell to a channel; NaN text is counted.
    pub(crate) fn push(&mut self, channel: usize, row: u64, cell: Cell) {
        if cell == Cell::NotANumber
            && let Some((count, first)) = self.nan_cells.get_mut(channel)
        {
            if *count == 0 {
                *first = row;
            }
            *count += 1;
        }
        if let Some(values) = self.values.get_mut(channel) {
            values.push(cell.or_nan());
        }
    }

    /// Removes the last row read, of which some cells may have been added.
    pub(crate) fn drop_row(&mut self, row: u64) {
        self.rows_read -= 1;
        if self.rows.last() == Some(&row) {
            self.rows.pop();
        }
        let n = self.rows.len();
        self.time_s.truncate(n);
        for values in &mut self.values {
            values.truncate(n);
        }
    }

    /// Removes the first row.
    pub(crate) fn drop_first(&mut self) {
        let mut keep = vec![true; self.rows.len()];
        if let Some(first) = keep.first_mut() {
            *first = false;
        }
        self.retain(&keep);
    }

    /// Takes the rows so far; later rows continue the count. The last row stays as well, so that the next part begins with
    /// the row that its times must follow.
    pub(crate) fn split(&mut self) -> Self {
        let last = |v: &[f64]| v.last().copied().into_iter().collect();
        let next = Self {
            origin: self.origin,
            rows_read: self.rows_read,
            filter_seen: std::mem::take(&mut self.filter_seen),
            follows: true,
            time_s: last(&self.time_s),
            rows: self.rows.last().copied().into_iter().collect(),
            values: self.values.iter().map(|v| last(v)).collect(),
            nan_cells: vec![(0, 0); self.values.len()],
        };
        std::mem::replace(self, next)
    }

    /// Keeps the rows marked in `keep`.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        fn filter<T: Copy>(v: &mut Vec<T>, keep: &[bool]) {
            let mut keep = keep.iter();
            v.retain(|_| keep.next().copied().unwrap_or(true));
        }
        filter(&mut self.time_s, keep);
        filter(&mut self.rows, keep);
        for values in &mut self.values {
            filter(values, keep);
        }
    }

    /// Texts in the first filter column, for messages.
    pub(crate) fn seen(&self) -> String {
        let seen = self.filter_seen.iter().map(|s| format!("'{s}'"));
        seen.collect::<Vec<_>>().join(", ")
    }

    /// Records a text of a filter column, for the error when no row matches.
    pub(crate) fn saw(&mut self, text: &str) {
        if self.filter_seen.len() < 5 && !self.filter_seen.iter().any(|s| s == text) {
            self.filter_seen.push(text.to_owned());
        }
    }
}
