//! Parquet functions of a build without the feature `parquet`: they return an error.

use crate::bytes::Opened;
use crate::columns::Columns;
use crate::error::parquet;
use crate::plan::Plan;
use crate::selection::WhenFull;
use crate::{Channel, ReadOptions};
use poinsot_files::{Faults, Place};
use std::fs::File;
use std::path::Path;

/// Error text.
const ABSENT: &str = "this program was built without Parquet (feature `parquet`)";

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
pub(crate) fn write_parquet(_: &mut File, _: &[f64], _: &[Channel]) -> Result<(), String> {
    Err(ABSENT.to_owned())
}
