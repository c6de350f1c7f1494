//! Rows with named columns, for files of results.

/// A named column; all columns of a file have equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct RowColumn {
    /// Name.
    pub name: String,
    /// Cells.
    pub cells: RowCells,
}

/// Cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum RowCells {
    /// Numbers; `None` and NaN are empty cells.
    Number(Vec<Option<f64>>),
    /// Whole numbers.
    Count(Vec<u64>),
    /// Text.
    Text(Vec<String>),
}
