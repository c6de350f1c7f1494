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
    /// For each choice of rows and each kept row, whether it is one of them.
    pub chosen: Vec<Vec<bool>>,
    /// The first distinct texts in the first filter column, and in the last one of each choice.
    pub seen: Vec<Vec<String>>,
    /// Whether the first row is the last one of the part before.
    pub follows: bool,
}

impl Columns {
    pub(crate) fn new(channels: usize, choices: usize) -> Self {
        Self {
            values: vec![Vec::new(); channels],
            nan_cells: vec![(0, 0); channels],
            chosen: vec![Vec::new(); choices],
            seen: vec![Vec::new(); choices + 1],
            ..Self::default()
        }
    }

    /// Offset from a time to the file's own count, s.
    pub(crate) fn own_zero_s(&self) -> f64 {
        self.origin.map_or(0.0, |o| o.own_zero_s())
    }

    /// Whether the next sample of a channel is in a row that has it.
    pub(crate) fn reads(&self, channel: usize, choice: Option<usize>) -> bool {
        let next = self.values.get(channel).map_or(0, Vec::len);
        choice.is_none_or(|c| self.chosen.get(c).and_then(|rows| rows.get(next)) == Some(&true))
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
        let is_kept = self.rows.last() == Some(&row);
        self.pick(0..self.rows.len() - usize::from(is_kept));
    }

    /// Keeps these rows, in this order.
    pub(crate) fn pick(&mut self, rows: impl Iterator<Item = usize> + Clone) {
        fn picked<T: Copy>(v: &mut Vec<T>, rows: impl Iterator<Item = usize>) {
            *v = rows.filter_map(|k| v.get(k).copied()).collect();
        }
        picked(&mut self.time_s, rows.clone());
        picked(&mut self.rows, rows.clone());
        let values = self.values.iter_mut();
        values.for_each(|v| picked(v, rows.clone()));
        let chosen = self.chosen.iter_mut();
        chosen.for_each(|v| picked(v, rows.clone()));
    }

    /// Takes the rows so far; later rows continue the count. The last row stays as well, so that the next part begins with
    /// the row that its times must follow.
    pub(crate) fn split(&mut self) -> Self {
        fn last<T: Copy>(v: &[T]) -> Vec<T> {
            v.last().copied().into_iter().collect()
        }
        let next = Self {
            origin: self.origin,
            rows_read: self.rows_read,
            chosen: self.chosen.iter().map(|v| last(v)).collect(),
            seen: std::mem::take(&mut self.seen),
            follows: true,
            time_s: last(&self.time_s),
            rows: last(&self.rows),
            values: self.values.iter().map(|v| last(v)).collect(),
            nan_cells: vec![(0, 0); self.values.len()],
        };
        std::mem::replace(self, next)
    }

    /// Sorts the rows by time; rows of one time keep their order.
    pub(crate) fn sort(&mut self) {
        if self.time_s.is_sorted() {
            return;
        }
        let mut order: Vec<usize> = (0..self.time_s.len()).collect();
        order.sort_by(|a, b| self.time_s[*a].total_cmp(&self.time_s[*b]));
        self.pick(order.iter().copied());
    }

    /// Texts in the first filter column, and in the last one of each choice, for messages.
    pub(crate) fn seen(&self, list: usize) -> String {
        let seen = self.seen.get(list).into_iter().flatten();
        seen.map(|s| format!("'{s}'"))
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// Records a text of a filter column, for the error when no row matches.
    pub(crate) fn saw(&mut self, list: usize, text: &[u8]) {
        let Some(seen) = self.seen.get_mut(list).filter(|s| s.len() < 5) else {
            return;
        };
        let text = String::from_utf8_lossy(text);
        if !seen.iter().any(|s| *s == text) {
            seen.push(text.into_owned());
        }
    }
}

/// Keeps what is marked.
pub(crate) fn filter<T>(v: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    v.retain(|_| keep.next().copied().unwrap_or(true));
}
