//! Parquet in a build without the feature `parquet`: an error.

use crate::ReadOptions;
use crate::bytes::Opened;
use crate::columns::Columns;
use crate::error::parquet;
use crate::plan::Plan;
use crate::row_columns::RowColumn;
use crate::selection::WhenFull;
use poinsot_files::{Faults, Place};
use std::fs::File;
use std::path::Path;

/// Error text.
pub(crate) const ABSENT: &str = "this program was built without Parquet (feature `parquet`)";

/// Returns the error.
pub(crate) fn read(
    path: &Path,
    _: &Opened,
    _: &ReadOptions,
    _: &mut Vec<String>,
    _: Option<&mut WhenFull>,
) -> Result<(Plan, Columns), Faults> {
    Err(parquet(Place::file(path), ABSENT))
}

/// Returns the error.
pub(crate) fn read_rows(path: &Path, _: File) -> Result<Vec<RowColumn>, Faults> {
    Err(parquet(Place::file(path), ABSENT))
}

/// Returns the error.
pub(crate) fn write_rows(_: &mut File, _: &[RowColumn]) -> Result<(), &'static str> {
    Err(ABSENT)
}
