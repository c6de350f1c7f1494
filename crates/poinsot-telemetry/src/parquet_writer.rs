//! Writes channels as Parquet: float64, Snappy.

use crate::cursor::cursors;
use crate::{Channel, full_name};
use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use std::fs::File;
use std::sync::Arc;

/// Rows per batch.
const BATCH: usize = 65_536;

/// Writes the channels at the given times; an error is text.
pub(crate) fn write_parquet(
    file: &mut File,
    times: &[f64],
    channels: &[Channel],
) -> Result<(), String> {
    encode(file, times, channels).map_err(|e| e.to_string())
}

fn encode(
    file: &mut File,
    times: &[f64],
    channels: &[Channel],
) -> Result<(), parquet::errors::ParquetError> {
    let mut fields = vec![Field::new("time_s", DataType::Float64, false)];
    fields.extend(
        channels
            .iter()
            .map(|c| Field::new(full_name(&c.sensor, &c.name), DataType::Float64, true)),
    );
    let schema = Arc::new(Schema::new(fields));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .build();
    let mut writer = ArrowWriter::try_new(file, Arc::clone(&schema), Some(properties))?;
    let mut cursors = cursors(channels);
    for times in times.chunks(BATCH) {
        let mut arrays: Vec<ArrayRef> = vec![Arc::new(Float64Array::from(times.to_vec()))];
        for cursor in &mut cursors {
            let column: Float64Array = times.iter().map(|&t| cursor.at(t)).collect();
            arrays.push(Arc::new(column));
        }
        writer.write(&RecordBatch::try_new(Arc::clone(&schema), arrays)?)?;
    }
    writer.close()?;
    Ok(())
}
