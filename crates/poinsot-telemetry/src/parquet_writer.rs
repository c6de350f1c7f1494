//! Writes columns as Parquet, compressed by Snappy.

use crate::cursor::Cursor;
use crate::parquet_seal;
use crate::row_columns::{RowCells, RowColumn};
use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Stored};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::fs::File;
use std::io;
use std::sync::Arc;

/// A file of numbers whose rows come in groups.
pub(crate) struct ParquetRows<'f>(SerializedFileWriter<&'f mut File>);

impl<'f> ParquetRows<'f> {
    /// Begins a file with the time and these columns.
    pub fn open(file: &'f mut File, names: impl Iterator<Item = String>) -> Result<Self> {
        let time = number("time_s", Repetition::REQUIRED);
        let others = names.map(|name| number(&name, Repetition::OPTIONAL));
        let fields: Result<_> = std::iter::once(time).chain(others).collect();
        open(file, fields?).map(Self)
    }

    /// Adds the rows of some times.
    pub fn group(&mut self, times: &[f64], cursors: &mut [Cursor<'_>]) -> io::Result<()> {
        let mut group = self.0.next_row_group()?;
        if let Some(column) = group.next_column()? {
            write_whole::<DoubleType>(column, times)?;
        }
        for cursor in cursors {
            if let Some(column) = group.next_column()? {
                write_numbers(column, times.iter().map(|&t| cursor.at(t)))?;
            }
        }
        group.close()?;
        Ok(())
    }

    /// Ends the file, and seals it.
    pub fn finish(mut self) -> io::Result<()> {
        self.0.append_key_value_metadata(parquet_seal::unsealed());
        parquet_seal::seal(self.0.into_inner()?)
    }
}

/// Writes rows with named columns.
pub(crate) fn write_rows(file: &mut File, columns: &[RowColumn]) -> Result<()> {
    let fields = columns.iter().map(|c| match c.cells {
        RowCells::Number(_) => number(&c.name, Repetition::OPTIONAL),
        RowCells::Count(_) => primitive(&c.name, Stored::INT64, LogicalType::integer(64, false)),
        RowCells::Text(_) => primitive(&c.name, Stored::BYTE_ARRAY, LogicalType::String),
    });
    let mut writer = open(file, fields.collect::<Result<_>>()?)?;
    let mut group = writer.next_row_group()?;
    for column in columns {
        let Some(writer) = group.next_column()? else {
            break;
        };
        match &column.cells {
            RowCells::Number(cells) => {
                write_numbers(writer, cells.iter().map(|x| x.filter(|x| !x.is_nan())))?;
            }
            RowCells::Count(cells) => {
                let cells: Vec<i64> = cells.iter().map(|n| n.cast_signed()).collect();
                write_whole::<Int64Type>(writer, &cells)?;
            }
            RowCells::Text(cells) => {
                let cells: Vec<ByteArray> = cells.iter().map(|s| s.as_str().into()).collect();
                write_whole::<ByteArrayType>(writer, &cells)?;
            }
        }
    }
    group.close()?;
    writer.close()?;
    Ok(())
}

fn open(file: &mut File, fields: Vec<Type>) -> Result<SerializedFileWriter<&mut File>> {
    let schema = Type::group_type_builder("schema")
        .with_fields(fields.into_iter().map(Arc::new).collect())
        .build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .build();
    SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))
}

fn number(name: &str, repetition: Repetition) -> Result<Type> {
    Type::primitive_type_builder(name, Stored::DOUBLE)
        .with_repetition(repetition)
        .build()
}

/// A column without empty cells.
fn primitive(name: &str, stored: Stored, logical: LogicalType) -> Result<Type> {
    Type::primitive_type_builder(name, stored)
        .with_repetition(Repetition::REQUIRED)
        .with_converted_type(ConvertedType::from(Some(logical.clone())))
        .with_logical_type(Some(logical))
        .build()
}

/// A column without empty cells.
fn write_whole<T: DataType>(mut column: SerializedColumnWriter<'_>, cells: &[T::T]) -> Result<()> {
    column.typed::<T>().write_batch(cells, None, None)?;
    column.close()
}

/// Numbers of which some cells are empty.
fn write_numbers(
    mut column: SerializedColumnWriter<'_>,
    cells: impl Iterator<Item = Option<f64>>,
) -> Result<()> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    for cell in cells {
        levels.push(i16::from(cell.is_some()));
        values.extend(cell);
    }
    let writer = column.typed::<DoubleType>();
    writer.write_batch(&values, Some(&levels), None)?;
    column.close()
}
