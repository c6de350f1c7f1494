//! Reads Parquet files with the same column names as CSV.
//!
//! The third-party decoder panics on some damaged files; panics become errors here.

use crate::bytes::{Opened, check_unchanged, sha256_of};
use crate::clock::Clock;
use crate::columns::Columns;
use crate::error::{Place, shown};
use crate::number::Cell;
use crate::parquet_bytes::ParquetBytes;
use crate::parquet_dictionaries;
use crate::parquet_pages::{self, Checksums};
use crate::plan::{self, Plan};
use crate::selection::{Selection, WhenFull};
use crate::size::Rows;
use crate::{ReadOptions, TelemetryError};
use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, TimestampMicrosecondType,
    TimestampMillisecondType, TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};
use arrow_schema::{DataType, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ArrowReaderOptions, ParquetRecordBatchReaderBuilder};
use parquet::file::metadata::ParquetMetaData;
use std::fs::File;
use std::io::Seek;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Rows decoded at a time.
const BATCH: usize = 8192;

/// Reads the planned columns of a Parquet file batch by batch.
pub(crate) fn read(
    path: &Path,
    opened: &Opened,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns, String), TelemetryError> {
    let file = opened.file.try_clone();
    let file = file.map_err(|source| TelemetryError::Io {
        path: path.to_owned(),
        what: "cannot be read",
        source,
    })?;
    let decoded = catch_unwind(AssertUnwindSafe(|| {
        decode(path, file, opened.len, options, repairs, full)
    }));
    let (plan, columns, sha256) = decoded
        .unwrap_or_else(|_| Err(refused(path, "the file is damaged (the decoder stopped)")))?;
    check_unchanged(path, opened)?;
    Ok((plan, columns, sha256))
}

fn refused(path: &Path, why: impl ToString) -> TelemetryError {
    TelemetryError::Parquet {
        place: Place::file(path),
        why: why.to_string().replace('\n', " "),
    }
}

fn decode(
    path: &Path,
    file: File,
    bytes: u64,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    mut full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns, String), TelemetryError> {
    let io = |source| TelemetryError::Io {
        path: path.to_owned(),
        what: "cannot be read",
        source,
    };
    let mut whole = file.try_clone().map_err(io)?;
    // Without the embedded Arrow schema, strings and dictionaries of strings have one plain type.
    let plain = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
    let builder = ParquetRecordBatchReaderBuilder::try_new_with_options(ParquetBytes(file), plain)
        .map_err(|e| refused(path, e))?;
    let declared = plausible_rows(path, builder.metadata(), bytes)?;
    let header: Vec<String> = builder
        .schema()
        .fields()
        .iter()
        .map(|f| f.name().clone())
        .collect();
    let plan = plan::build(path, &header, None, options)?;
    let mut clock = plan.clock.clone();
    let fields = builder.schema().fields();
    let time = fields.get(plan.time_index).map(|f| f.data_type());
    if matches!(time, Some(DataType::Timestamp(..))) {
        clock = clock.instants();
    }
    let rows = Rows::Declared(declared);
    if full.is_none() {
        options.limit().check_ahead(path, &plan, options, rows)?;
    }
    whole.rewind().map_err(io)?;
    let sha256 = sha256_of(path, &mut whole)?;
    let mask = ProjectionMask::roots(builder.parquet_schema(), used(&plan));
    let pages = whole.try_clone().map_err(io)?;
    let excess = parquet_dictionaries::excess(pages, builder.metadata(), &mask);
    if let Some(why) = excess.map_err(|e| refused(path, e))? {
        return Err(refused(path, why));
    }
    let sums = whole.try_clone().map_err(io)?;
    let sums = parquet_pages::compare(sums, builder.metadata(), &mask).map_err(io)?;
    let sound = sound_rows(path, &sums, declared, options.recover, repairs)?;
    let reader = builder
        .with_projection(mask)
        .with_batch_size(BATCH)
        .with_limit(usize::try_from(sound).unwrap_or(usize::MAX))
        .build()
        .map_err(|e| refused(path, e))?;
    let mut columns = Columns::with_channels(plan.channels.len());
    let mut selection = options.selection();
    for batch in reader {
        let batch = batch.map_err(|e| refused(path, e))?;
        take_batch(
            path,
            &plan,
            &mut clock,
            &header,
            &batch,
            &mut selection,
            &mut columns,
        )?;
        let full = full.as_deref_mut();
        selection.check(path, &plan, &mut columns, rows, full)?;
    }
    if columns.rows_read as u64 != sound {
        return Err(refused(
            path,
            format!(
                "the footer declares {sound} rows, the columns have {}",
                columns.rows_read
            ),
        ));
    }
    Ok((plan, columns, sha256))
}

/// Columns that are read.
fn used(plan: &Plan) -> Vec<usize> {
    let mut roots: Vec<usize> = plan.channels.iter().map(|c| c.index).collect();
    roots.push(plan.time_index);
    roots.extend(plan.filter.iter().map(|f| f.0));
    roots
}

/// Rows before the first page with a wrong checksum; an error without `recover`.
fn sound_rows(
    path: &Path,
    sums: &Checksums,
    declared: u64,
    recover: bool,
    repairs: &mut Vec<String>,
) -> Result<u64, TelemetryError> {
    let name = path.display();
    if let Some(bad) = &sums.bad {
        let place = Place::cell(path, bad.row + 1, &bad.column);
        if !recover || bad.row == 0 {
            let more = match bad.row {
                0 => "no row before it is left",
                _ => "the rows before it can be kept by --recover",
            };
            return Err(TelemetryError::Parquet {
                place,
                why: format!(
                    "the page of this row does not match its checksum: its bytes were changed; {more}"
                ),
            });
        }
        repairs.push(format!(
            "{place}: {} rows from here on dropped: a page does not match its checksum",
            declared.saturating_sub(bad.row)
        ));
        return Ok(bad.row.min(declared));
    }
    if sums.compared > 0 {
        let (compared, pages) = (sums.compared, sums.pages);
        repairs.push(format!(
            "{name}: checksums of {compared} of {pages} pages compared"
        ));
    }
    Ok(declared)
}

/// Rows declared in the footer, after its sizes were compared with the file's.
fn plausible_rows(
    path: &Path,
    metadata: &ParquetMetaData,
    bytes: u64,
) -> Result<u64, TelemetryError> {
    let mut rows = 0_u64;
    for group in metadata.row_groups() {
        let n = u64::try_from(group.num_rows())
            .map_err(|_| refused(path, "a row group declares a negative number of rows"))?;
        rows = rows.saturating_add(n);
        for column in group.columns() {
            let size = u64::try_from(column.compressed_size());
            let start = u64::try_from(
                column
                    .dictionary_page_offset()
                    .unwrap_or_else(|| column.data_page_offset()),
            );
            let inside = matches!((start, size), (Ok(a), Ok(b)) if a.saturating_add(b) <= bytes);
            if !inside || column.uncompressed_size() < 0 {
                return Err(refused(
                    path,
                    format!(
                        "column '{}' does not lie inside the file",
                        column.column_path().string()
                    ),
                ));
            }
        }
    }
    if u64::try_from(metadata.file_metadata().num_rows()) != Ok(rows) {
        return Err(refused(
            path,
            "the footer and the row groups disagree on the number of rows",
        ));
    }
    Ok(rows)
}

fn take_batch(
    path: &Path,
    plan: &Plan,
    clock: &mut Clock,
    header: &[String],
    batch: &RecordBatch,
    selection: &mut Selection,
    columns: &mut Columns,
) -> Result<(), TelemetryError> {
    let first = columns.rows_read as u64 + 1;
    let column = |index: usize| -> Result<(&dyn Array, &str), TelemetryError> {
        let name = header.get(index).map_or("", String::as_str);
        let array = batch
            .schema_ref()
            .index_of(name)
            .ok()
            .and_then(|k| batch.columns().get(k))
            .ok_or_else(|| refused(path, format!("column '{name}' is missing in a batch")))?;
        Ok((array.as_ref(), name))
    };
    let mut keep = vec![true; batch.num_rows()];
    for (k, (index, text)) in plan.filter.iter().enumerate() {
        let (array, name) = column(*index)?;
        let texts = texts(array).ok_or_else(|| unsupported(path, name, array))?;
        for (keep, cell) in keep.iter_mut().zip(&texts) {
            let cell = cell.as_deref().unwrap_or_default();
            if k == 0 {
                columns.saw(cell);
            }
            *keep &= cell == text;
        }
    }
    let cells = |index: usize| -> Result<Vec<Option<String>>, TelemetryError> {
        let (array, name) = column(index)?;
        texts(array).ok_or_else(|| unsupported(path, name, array))
    };
    let times = cells(plan.time_index)?;
    let weeks = plan.week_index.map(cells).transpose()?;
    for (k, (cell, keep)) in times.iter().zip(&mut keep).enumerate() {
        let row = first + k as u64;
        let week = weeks
            .as_ref()
            .map(|w| w.get(k).and_then(Option::as_deref).unwrap_or_default());
        let text = cell.as_deref().unwrap_or_default();
        let time = clock.seconds(text.as_bytes(), week.map(str::as_bytes));
        let time = time.map_err(|why| TelemetryError::Number {
            place: Place::cell(path, row, &plan.time_column),
            value: shown(text.as_bytes()),
            why: why.text(true),
        })?;
        let time_s = match time {
            Cell::Number(x) => x,
            Cell::Empty | Cell::NotANumber => f64::NAN,
        };
        columns.origin = clock.origin;
        *keep = *keep && selection.keeps(time_s + columns.own_zero_s());
        if *keep {
            columns.rows.push(row);
            columns.time_s.push(time_s);
        }
    }
    for (k, channel) in plan.channels.iter().enumerate() {
        let (array, name) = column(channel.index)?;
        let cells = numbers(array).ok_or_else(|| unsupported(path, name, array))?;
        for ((cell, keep), row) in cells.into_iter().zip(&keep).zip(first..) {
            if *keep {
                columns.push(k, row, channel.conversion.number(cell));
            }
        }
    }
    columns.rows_read += batch.num_rows();
    Ok(())
}

fn unsupported(path: &Path, name: &str, array: &dyn Array) -> TelemetryError {
    TelemetryError::Parquet {
        place: Place::cell(path, 0, name),
        why: format!(
            "type {} is not supported; store numbers as float64, times as seconds or timestamps",
            array.data_type()
        ),
    }
}

/// A numeric column as cells; `None` for other types.
fn numbers(array: &dyn Array) -> Option<Vec<Cell>> {
    match array.data_type() {
        DataType::Float64 => primitive::<Float64Type>(array, |x| x),
        DataType::Float32 => primitive::<Float32Type>(array, f64::from),
        DataType::Int8 => primitive::<Int8Type>(array, f64::from),
        DataType::Int16 => primitive::<Int16Type>(array, f64::from),
        DataType::Int32 => primitive::<Int32Type>(array, f64::from),
        DataType::Int64 => primitive::<Int64Type>(array, |x| x as f64),
        DataType::UInt8 => primitive::<UInt8Type>(array, f64::from),
        DataType::UInt16 => primitive::<UInt16Type>(array, f64::from),
        DataType::UInt32 => primitive::<UInt32Type>(array, f64::from),
        DataType::UInt64 => primitive::<UInt64Type>(array, |x| x as f64),
        DataType::Boolean => Some(
            array
                .as_boolean_opt()?
                .iter()
                .map(|b| b.map_or(Cell::Empty, |b| Cell::Number(f64::from(u8::from(b)))))
                .collect(),
        ),
        DataType::Null => Some(vec![Cell::Empty; array.len()]),
        _ => None,
    }
}

fn primitive<T: ArrowPrimitiveType>(
    array: &dyn Array,
    value: impl Fn(T::Native) -> f64,
) -> Option<Vec<Cell>> {
    let cell = |x: Option<T::Native>| match x.map(&value) {
        None => Cell::Empty,
        Some(x) if x.is_nan() => Cell::NotANumber,
        Some(x) => Cell::Number(x),
    };
    Some(array.as_primitive_opt::<T>()?.iter().map(cell).collect())
}

/// Counts of a timestamp column, and the counts per second.
fn timestamps(array: &dyn Array, unit: TimeUnit) -> Option<(Vec<Option<i64>>, i64)> {
    fn counts<T: ArrowPrimitiveType<Native = i64>>(array: &dyn Array) -> Option<Vec<Option<i64>>> {
        Some(array.as_primitive_opt::<T>()?.iter().collect())
    }
    Some(match unit {
        TimeUnit::Second => (counts::<TimestampSecondType>(array)?, 1),
        TimeUnit::Millisecond => (counts::<TimestampMillisecondType>(array)?, 1_000),
        TimeUnit::Microsecond => (counts::<TimestampMicrosecondType>(array)?, 1_000_000),
        TimeUnit::Nanosecond => (counts::<TimestampNanosecondType>(array)?, 1_000_000_000),
    })
}

/// A count of fractional seconds as an exact decimal.
fn decimal_seconds(count: i64, per_second: i64) -> String {
    let sign = if count < 0 { "-" } else { "" };
    let (count, per_second) = (count.unsigned_abs(), per_second.unsigned_abs());
    let digits = per_second.ilog10() as usize;
    let (whole, part) = (count / per_second, count % per_second);
    match digits {
        0 => format!("{sign}{whole}"),
        _ => format!("{sign}{whole}.{part:0digits$}"),
    }
}

/// A filter column as texts: strings unchanged, numbers formatted, timestamps as seconds since 1970.
fn texts(array: &dyn Array) -> Option<Vec<Option<String>>> {
    let owned = |s: Option<&str>| s.map(str::to_owned);
    match array.data_type() {
        DataType::Utf8 => Some(array.as_string_opt::<i32>()?.iter().map(owned).collect()),
        DataType::LargeUtf8 => Some(array.as_string_opt::<i64>()?.iter().map(owned).collect()),
        DataType::Utf8View => Some(array.as_string_view_opt()?.iter().map(owned).collect()),
        DataType::Timestamp(unit, _) => {
            let (counts, per_second) = timestamps(array, *unit)?;
            let text = |count: Option<i64>| count.map(|n| decimal_seconds(n, per_second));
            Some(counts.into_iter().map(text).collect())
        }
        // A double cannot represent every 64-bit integer.
        DataType::Int64 => {
            let cells = array.as_primitive_opt::<Int64Type>()?.iter();
            Some(cells.map(|x| x.map(|x| x.to_string())).collect())
        }
        _ => {
            let text = |cell| match cell {
                Cell::Number(x) => Some(format!("{x}")),
                Cell::Empty | Cell::NotANumber => None,
            };
            Some(numbers(array)?.into_iter().map(text).collect())
        }
    }
}
