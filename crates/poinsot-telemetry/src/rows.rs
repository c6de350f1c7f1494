//! Rows with named columns as Parquet.

#[cfg(not(feature = "parquet"))]
use crate::parquet_reader as parquet_writer;
#[cfg(feature = "parquet")]
use crate::parquet_writer;
use crate::row_columns::RowColumn;
use poinsot_files::Faults;
use std::fs::File;
use std::path::Path;

/// Suffix of files written by [`write_rows`].
pub const ROWS_EXTENSION: &str = "parquet";

/// Writes rows.
///
/// # Errors
/// Writing or encoding fails; the program was built without Parquet.
///
/// ```
/// use poinsot_telemetry::{ROWS_EXTENSION, RowCells, RowColumn, read_rows, write_rows};
///
/// # let folder = std::env::temp_dir().join(format!("poinsot-rows-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("trials").with_extension(ROWS_EXTENSION);
/// let column = |name: &str, cells| RowColumn { name: name.to_owned(), cells };
/// let columns = [
///     column("trial", RowCells::Count(vec![0, 1])),
///     column("error_kg", RowCells::Number(vec![Some(0.1), None])),
/// ];
/// write_rows(&mut std::fs::File::create(&path)?, &columns)?;
/// assert_eq!(read_rows(&path, std::fs::File::open(&path)?)?, columns);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_rows(file: &mut File, columns: &[RowColumn]) -> std::io::Result<()> {
    parquet_writer::write_rows(file, columns).map_err(std::io::Error::other)
}

/// Reads what [`write_rows`] wrote; `path` is named in errors.
///
/// # Errors
/// The file is damaged, or its rows would not fit into memory; the program was built without Parquet.
///
/// ```
/// use poinsot_telemetry::{RowCells, RowColumn, read_rows, write_rows};
///
/// # let path = std::env::temp_dir().join(format!("poinsot-read-rows-{}", std::process::id()));
/// let trial = RowColumn { name: "trial".to_owned(), cells: RowCells::Count(vec![7]) };
/// write_rows(&mut std::fs::File::create(&path)?, &[trial])?;
/// assert_eq!(read_rows(&path, std::fs::File::open(&path)?)?[0].cells, RowCells::Count(vec![7]));
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_rows(path: &Path, file: File) -> Result<Vec<RowColumn>, Faults> {
    crate::parquet_reader::read_rows(path, file)
}
