//! Writes rows with named columns as Parquet or CSV.

use std::fs::File;

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
pub fn write_rows(file: &mut File, columns: &[RowColumn]) -> std::io::Result<()> {
    encode(file, columns)
}

#[cfg(feature = "parquet")]
fn encode(file: &mut File, columns: &[RowColumn]) -> std::io::Result<()> {
    use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray, UInt64Array};
    use arrow_schema::{DataType, Field, Schema};
    use parquet::arrow::ArrowWriter;
    use parquet::basic::Compression;
    use parquet::file::properties::WriterProperties;
    use std::sync::Arc;

    let field = |column: &RowColumn| {
        let (kind, empty) = match column.cells {
            RowCells::Number(_) => (DataType::Float64, true),
            RowCells::Count(_) => (DataType::UInt64, false),
            RowCells::Text(_) => (DataType::Utf8, false),
        };
        Field::new(&column.name, kind, empty)
    };
    let array = |column: &RowColumn| -> ArrayRef {
        match &column.cells {
            RowCells::Number(cells) => {
                let finite = cells.iter().map(|x| x.filter(|x| !x.is_nan()));
                Arc::new(finite.collect::<Float64Array>())
            }
            RowCells::Count(cells) => Arc::new(UInt64Array::from(cells.clone())),
            RowCells::Text(cells) => Arc::new(StringArray::from(cells.clone())),
        }
    };
    let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .build();
    let mut writer = ArrowWriter::try_new(file, Arc::clone(&schema), Some(properties))?;
    let arrays = columns.iter().map(array).collect();
    let batch = RecordBatch::try_new(schema, arrays).map_err(std::io::Error::other)?;
    writer.write(&batch)?;
    writer.close()?;
    Ok(())
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
