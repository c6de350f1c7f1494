//! Columns of a Parquet file: what they hold, and their cells batch by batch.

use crate::number::{Cell, RawCell};
use crate::row_columns::{RowCells, RowColumn};
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

    /// The same column of rows, without any.
    pub fn no_rows(&self) -> RowColumn {
        RowColumn {
            name: self.name.clone(),
            cells: match self.kind {
                Kind::Text => RowCells::Text(Vec::new()),
                Kind::Unsigned => RowCells::Count(Vec::new()),
                _ => RowCells::Number(Vec::new()),
            },
        }
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
    Numbers(Vec<Cell>),
    /// 64-bit integers: a double cannot represent every one.
    Whole(Vec<Option<i64>>),
    /// Counts since 1970, so many to a second.
    Instants(Vec<Option<i64>>, i64),
    Texts(Vec<Option<ByteArray>>),
}

impl Cells {
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Whole(cells) | Self::Instants(cells, _) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }

    /// The type's name where the cells are no numbers.
    pub fn no_numbers(&self) -> Option<&'static str> {
        match self {
            Self::Numbers(_) | Self::Whole(_) => None,
            Self::Instants(..) => Some("timestamp"),
            Self::Texts(_) => Some("text"),
        }
    }

    /// Adds the cells to those of the same kind.
    pub fn append_to(self, rows: &mut RowCells) {
        match (rows, self) {
            (RowCells::Number(all), Self::Numbers(cells)) => {
                all.extend(cells.into_iter().map(Cell::value));
            }
            (RowCells::Count(all), Self::Numbers(cells)) => {
                all.extend(cells.into_iter().map(|c| c.or_nan() as u64));
            }
            (RowCells::Text(all), Self::Texts(cells)) => {
                let text = |cell: &ByteArray| String::from_utf8_lossy(cell.data()).into_owned();
                all.extend(
                    cells
                        .iter()
                        .map(|c| c.as_ref().map_or_else(String::new, text)),
                );
            }
            _ => {}
        }
    }

    /// The cell of a row as a number.
    pub fn number(&self, row: usize) -> Cell {
        let cell = match self {
            Self::Numbers(cells) => cells.get(row).copied(),
            Self::Whole(cells) => cells
                .get(row)
                .map(|n| n.map_or(Cell::Empty, |n| Cell::Number(n as f64))),
            Self::Instants(..) | Self::Texts(_) => None,
        };
        cell.unwrap_or(Cell::Empty)
    }

    /// The cell of a row; an instant is in seconds since 1970.
    pub fn stored(&self, row: usize) -> RawCell<'_> {
        let parts = |cells: &[Option<i64>], of| Some(RawCell::Parts((*cells.get(row)?)?, of));
        let cell = match self {
            Self::Numbers(cells) => match cells.get(row) {
                Some(Cell::Number(x)) => Some(RawCell::Number(*x)),
                _ => None,
            },
            Self::Whole(cells) => parts(cells, 1),
            Self::Instants(cells, per_second) => parts(cells, *per_second),
            Self::Texts(cells) => cells
                .get(row)
                .and_then(|text| Some(RawCell::Text(text.as_ref()?.data()))),
        };
        cell.unwrap_or(RawCell::Empty)
    }
}

/// The next cells of a column, at most so many.
pub(crate) fn next(reader: &mut ColumnReader, kind: Kind, most: usize) -> Result<Cells> {
    let unsigned = kind == Kind::Unsigned;
    Ok(match reader {
        ColumnReader::BoolColumnReader(r) => numbers(r, most, |b| f64::from(u8::from(b)))?,
        ColumnReader::FloatColumnReader(r) => numbers(r, most, f64::from)?,
        ColumnReader::DoubleColumnReader(r) => numbers(r, most, |x| x)?,
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            numbers(r, most, |n| f64::from(n.cast_unsigned()))?
        }
        ColumnReader::Int32ColumnReader(r) => numbers(r, most, f64::from)?,
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            numbers(r, most, |n| n.cast_unsigned() as f64)?
        }
        ColumnReader::Int64ColumnReader(r) => match kind {
            Kind::Instant(per_second) => Cells::Instants(decode(r, most, None, Some)?, per_second),
            _ => Cells::Whole(decode(r, most, None, Some)?),
        },
        ColumnReader::Int96ColumnReader(r) => {
            let nanoseconds = |t: Int96| Some(t.to_nanos());
            Cells::Instants(decode(r, most, None, nanoseconds)?, NANOSECONDS)
        }
        ColumnReader::ByteArrayColumnReader(r) => Cells::Texts(decode(r, most, None, Some)?),
        ColumnReader::FixedLenByteArrayColumnReader(r) => {
            Cells::Texts(decode(r, most, None, |bytes| Some(bytes.into()))?)
        }
    })
}

/// Cells of a column of numbers.
fn numbers<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    most: usize,
    value: impl Fn(T::T) -> f64,
) -> Result<Cells> {
    let cell = |x: T::T| match value(x) {
        x if x.is_nan() => Cell::NotANumber,
        x => Cell::Number(x),
    };
    Ok(Cells::Numbers(decode(reader, most, Cell::Empty, cell)?))
}

/// Values with the empty cells between them.
fn decode<T: DataType, V: Clone>(
    reader: &mut ColumnReaderImpl<T>,
    most: usize,
    empty: V,
    value: impl Fn(T::T) -> V,
) -> Result<Vec<V>> {
    let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(most));
    reader.read_records(most, Some(&mut levels), None, &mut values)?;
    let mut values = values.into_iter().map(value);
    // A column in which no cell may be empty has no levels.
    if levels.is_empty() {
        return Ok(values.collect());
    }
    let cell = |level: i16| (level > 0).then(|| values.next()).flatten();
    let cells = levels.into_iter().map(cell);
    Ok(cells.map(|c| c.unwrap_or_else(|| empty.clone())).collect())
}
