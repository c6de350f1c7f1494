//! Columns of a Parquet file: what they hold, and their cells batch by batch.

use crate::number::Cell;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as Stored};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType, Int96};
use parquet::errors::Result;
use parquet::schema::types::{SchemaDescriptor, Type};

/// Counts of the finest timestamps per second.
const NANOSECONDS: i64 = 1_000_000_000;

/// What telemetry can use of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Numbers and truth values.
    Number,
    /// Whole numbers without sign; stored in signed integers of the same size.
    Unsigned,
    /// Nothing but empty cells.
    Null,
    Text,
    /// Counts since 1970, so many to a second.
    Instant(i64),
}

/// A column that is read.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub name: String,
    /// Its place among the columns of numbers and texts, of which a nested column has several.
    pub leaf: usize,
    pub kind: Kind,
}

impl Column {
    /// The column at a place of the header; for one that cannot be read, the name of its type.
    pub fn of(schema: &SchemaDescriptor, root: usize) -> std::result::Result<Self, String> {
        let nested = || "list or structure".to_owned();
        let mut leaves =
            (0..schema.num_columns()).filter(|&k| schema.get_column_root_idx(k) == root);
        let (Some(leaf), None) = (leaves.next(), leaves.next()) else {
            return Err(nested());
        };
        let column = schema.get_column_root(leaf);
        if !column.is_primitive() || schema.column(leaf).max_rep_level() > 0 {
            return Err(nested());
        }
        Ok(Self {
            name: column.name().to_owned(),
            leaf,
            kind: kind(column)?,
        })
    }
}

fn kind(column: &Type) -> std::result::Result<Kind, String> {
    let info = column.get_basic_info();
    let stored = column.get_physical_type();
    match (stored, info.logical_type_ref()) {
        (_, Some(LogicalType::Unknown)) => Ok(Kind::Null),
        (Stored::BOOLEAN | Stored::FLOAT | Stored::DOUBLE, _) => Ok(Kind::Number),
        (Stored::INT96, _) => Ok(Kind::Instant(NANOSECONDS)),
        (Stored::INT32 | Stored::INT64, Some(LogicalType::Integer(whole))) => {
            Ok(match whole.is_signed {
                true => Kind::Number,
                false => Kind::Unsigned,
            })
        }
        (Stored::INT64, Some(LogicalType::Timestamp(stamp))) => {
            Ok(Kind::Instant(match stamp.unit {
                TimeUnit::MILLIS => 1_000,
                TimeUnit::MICROS => 1_000_000,
                TimeUnit::NANOS => NANOSECONDS,
            }))
        }
        (Stored::BYTE_ARRAY, Some(LogicalType::String | LogicalType::Json)) => Ok(Kind::Text),
        (_, None) => converted_kind(stored, info.converted_type()),
        (_, Some(other)) => Err(format!("{other:?}")),
    }
}

/// What a column of an older writer holds, which knows no logical types.
fn converted_kind(stored: Stored, old: ConvertedType) -> std::result::Result<Kind, String> {
    use ConvertedType as Old;
    let whole = matches!(stored, Stored::INT32 | Stored::INT64);
    match old {
        Old::NONE | Old::INT_8 | Old::INT_16 | Old::INT_32 | Old::INT_64 if whole => {
            Ok(Kind::Number)
        }
        Old::UINT_8 | Old::UINT_16 | Old::UINT_32 | Old::UINT_64 if whole => Ok(Kind::Unsigned),
        Old::TIMESTAMP_MILLIS if stored == Stored::INT64 => Ok(Kind::Instant(1_000)),
        Old::TIMESTAMP_MICROS if stored == Stored::INT64 => Ok(Kind::Instant(1_000_000)),
        Old::UTF8 | Old::JSON if stored == Stored::BYTE_ARRAY => Ok(Kind::Text),
        Old::NONE => Err(stored.to_string()),
        old => Err(old.to_string()),
    }
}

/// Cells of some rows of a column; `None` is an empty cell.
pub(crate) enum Cells {
    Numbers(Vec<Option<f64>>),
    /// 64-bit integers: a double cannot represent every one.
    Whole(Vec<Option<i64>>),
    /// Counts since 1970, so many to a second.
    Instants(Vec<Option<i64>>, i64),
    Texts(Vec<Option<String>>),
}

impl Cells {
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Whole(cells) | Self::Instants(cells, _) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }

    /// As numbers; the type's name for texts and instants.
    pub fn numbers(&self) -> std::result::Result<Vec<Cell>, &'static str> {
        let cell = |x: Option<f64>| match x {
            None => Cell::Empty,
            Some(x) if x.is_nan() => Cell::NotANumber,
            Some(x) => Cell::Number(x),
        };
        match self {
            Self::Numbers(cells) => Ok(cells.iter().map(|x| cell(*x)).collect()),
            Self::Whole(cells) => Ok(cells.iter().map(|x| cell(x.map(|x| x as f64))).collect()),
            Self::Instants(..) => Err("timestamp"),
            Self::Texts(_) => Err("text"),
        }
    }

    /// As texts: strings unchanged, numbers formatted, instants as seconds since 1970.
    pub fn texts(self) -> Vec<Option<String>> {
        let number = |x: Option<f64>| x.filter(|x| !x.is_nan()).map(|x| x.to_string());
        match self {
            Self::Texts(cells) => cells,
            Self::Numbers(cells) => cells.into_iter().map(number).collect(),
            Self::Whole(cells) => {
                let text = |x: Option<i64>| x.map(|x| x.to_string());
                cells.into_iter().map(text).collect()
            }
            Self::Instants(cells, per_second) => {
                let text = |x: Option<i64>| x.map(|x| decimal_seconds(x, per_second));
                cells.into_iter().map(text).collect()
            }
        }
    }
}

/// A count of fractions of a second as an exact decimal.
fn decimal_seconds(count: i64, per_second: i64) -> String {
    let sign = if count < 0 { "-" } else { "" };
    let (count, per_second) = (count.unsigned_abs(), per_second.unsigned_abs());
    let digits = per_second.ilog10() as usize;
    let (whole, part) = (count / per_second, count % per_second);
    format!("{sign}{whole}.{part:0digits$}")
}

/// The next cells of a column, at most so many.
pub(crate) fn next(reader: &mut ColumnReader, kind: Kind, most: usize) -> Result<Cells> {
    let unsigned = kind == Kind::Unsigned;
    Ok(match reader {
        ColumnReader::BoolColumnReader(r) => {
            Cells::Numbers(decode(r, most, |b| f64::from(u8::from(b)))?)
        }
        ColumnReader::FloatColumnReader(r) => Cells::Numbers(decode(r, most, f64::from)?),
        ColumnReader::DoubleColumnReader(r) => Cells::Numbers(decode(r, most, |x| x)?),
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            Cells::Numbers(decode(r, most, |n| f64::from(n.cast_unsigned()))?)
        }
        ColumnReader::Int32ColumnReader(r) => Cells::Numbers(decode(r, most, f64::from)?),
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            Cells::Numbers(decode(r, most, |n| n.cast_unsigned() as f64)?)
        }
        ColumnReader::Int64ColumnReader(r) => match kind {
            Kind::Instant(per_second) => Cells::Instants(decode(r, most, |n| n)?, per_second),
            _ => Cells::Whole(decode(r, most, |n| n)?),
        },
        ColumnReader::Int96ColumnReader(r) => {
            Cells::Instants(decode(r, most, |t: Int96| t.to_nanos())?, NANOSECONDS)
        }
        ColumnReader::ByteArrayColumnReader(r) => Cells::Texts(decode(r, most, text)?),
        ColumnReader::FixedLenByteArrayColumnReader(r) => {
            Cells::Texts(decode(r, most, |bytes| text(bytes.into()))?)
        }
    })
}

fn text(bytes: ByteArray) -> String {
    String::from_utf8_lossy(bytes.data()).into_owned()
}

/// Values with the empty cells between them.
fn decode<T: DataType, V>(
    reader: &mut ColumnReaderImpl<T>,
    most: usize,
    value: impl Fn(T::T) -> V,
) -> Result<Vec<Option<V>>> {
    let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(most));
    reader.read_records(most, Some(&mut levels), None, &mut values)?;
    let mut values = values.into_iter().map(value);
    // A column in which no cell may be empty has no levels.
    if levels.is_empty() {
        return Ok(values.map(Some).collect());
    }
    let cell = |level: i16| if level > 0 { values.next() } else { None };
    Ok(levels.into_iter().map(cell).collect())
}
