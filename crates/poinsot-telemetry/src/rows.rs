//! Writes rows with named columns as Parquet or CSV.

#[cfg(not(feature = "parquet"))]
use crate::row_columns::RowCells;
use crate::row_columns::RowColumn;
use std::fs::File;

/// Suffix of files written by [`write_rows`]: `parquet`, or `csv` in a build without Parquet.
pub const ROWS_EXTENSION: &str = if cfg!(feature = "parquet") {
    "parquet"
} else {
    "csv"
};

/// Writes rows in the format of [`ROWS_EXTENSION`].
///
/// # Errors
/// Writing or encoding fails.
///
/// ```
/// use poinsot_telemetry::{ROWS_EXTENSION, RowCells, RowColumn, write_rows};
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
/// assert!(std::fs::metadata(&path)?.len() > 0);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_rows(file: &mut File, columns: &[RowColumn]) -> std::io::Result<()> {
    encode(file, columns)
}

#[cfg(feature = "parquet")]
fn encode(file: &mut File, columns: &[RowColumn]) -> std::io::Result<()> {
    crate::parquet_writer::write_rows(file, columns).map_err(std::io::Error::other)
}

#[cfg(not(feature = "parquet"))]
fn encode(file: &mut File, columns: &[RowColumn]) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(file);
    writer.write_record(columns.iter().map(|c| c.name.as_str()))?;
    let rows = columns.first().map_or(0, |c| match &c.cells {
        RowCells::Number(cells) => cells.len(),
        RowCells::Count(cells) => cells.len(),
        RowCells::Text(cells) => cells.len(),
    });
    for k in 0..rows {
        let cell = |column: &RowColumn| match &column.cells {
            RowCells::Number(cells) => match cells.get(k).copied().flatten() {
                Some(x) if !x.is_nan() => format!("{x:?}"),
                _ => String::new(),
            },
            RowCells::Count(cells) => cells.get(k).map_or(String::new(), u64::to_string),
            RowCells::Text(cells) => cells.get(k).cloned().unwrap_or_default(),
        };
        writer.write_record(columns.iter().map(cell))?;
    }
    writer.flush()
}
