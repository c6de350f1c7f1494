//! Reads CSV with one header row, and the text that exports put around it.

use crate::bytes::{ByteFault, Opened, TextBytes, check_unchanged, sha256_of};
use crate::clock::Clock;
use crate::columns::Columns;
use crate::csv_rows::{CsvRows, Row};
use crate::error::{Place, shown};
use crate::number::{Cell, InvalidNumber, RawCell};
use crate::packing::{Packing, damaged};
use crate::plan::{self, Plan};
use crate::selection::{Selection, WhenFull};
use crate::size::Rows;
use crate::{Encoding, Layout, ReadOptions, TelemetryError};
use std::io::{self, Read, Seek};
use std::path::Path;

/// Reads a CSV file row by row; unused columns are not parsed.
pub(crate) fn read(
    path: &Path,
    opened: &Opened,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    mut full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns, String), TelemetryError> {
    let io = |source| TelemetryError::Io {
        path: path.to_owned(),
        what: "cannot be read",
        source,
    };
    let (unpacked, rows, packed_sha256) = unpacked(path, opened)?;
    let layout = options.map.for_file(path).layout;
    let above = layout.header_row.unwrap_or(1).saturating_sub(1);
    let bytes = TextBytes::new(unpacked, above);
    let mut reader = CsvRows::new(bytes, layout.delimiter.unwrap_or(b','), layout.comment);
    let (header, units) = headers(path, &mut reader, (above, layout, options))?;
    let mut selection = options.selection();
    let plan = plan::build(path, &header, units.as_deref(), options)?;
    let mut clock = plan.clock.clone();
    if full.is_none() {
        options.limit().check_ahead(path, &plan, options, rows)?;
    }
    let mut columns = Columns::with_channels(plan.channels.len());
    reader.used = plan.used_columns().max().map_or(0, |last| last + 1);
    let mut last_row = 0;
    while let Some(row) = readable(path, reader.next_row())? {
        // A row is passed on only when another follows, because the last one may have to be dropped.
        selection.check(path, &plan, &mut columns, rows, full.as_deref_mut())?;
        last_row = above + row.line;
        columns.rows_read += 1;
        let taken = take_row(
            path,
            &plan,
            &mut clock,
            &row,
            last_row,
            &mut selection,
            &mut columns,
        );
        columns.origin = clock.origin;
        let Err(error) = taken else {
            continue;
        };
        let is_last = readable(path, reader.next_row())?.is_none();
        if !is_last || reader.ends_a_line() {
            return Err(error);
        }
        if !options.recover {
            return Err(TelemetryError::Truncated {
                place: Place::row(path, last_row),
                why: how_cut(&error),
            });
        }
        repairs.push(format!(
            "{}: cut last row dropped",
            Place::row(path, last_row)
        ));
        columns.rows_read -= 1;
        columns.drop_row(last_row);
        last_row = 0;
    }
    if last_row > 0 && !reader.ends_a_line() {
        let row = Place::row(path, last_row);
        repairs.push(take_unended(&row, options.recover, last_row, &mut columns));
    }
    selection.check(path, &plan, &mut columns, rows, full)?;
    check_unchanged(path, opened)?;
    let sha256 = match packed_sha256 {
        Some(packed) => packed,
        None => reader.sha256().map_err(io)?,
    };
    Ok((plan, columns, sha256))
}

/// The text of a file, its rows, and its hash where it is packed.
type Unpacked = (Box<dyn Read>, Rows, Option<String>);

fn unpacked(path: &Path, opened: &Opened) -> Result<Unpacked, TelemetryError> {
    let io = |source| TelemetryError::Io {
        path: path.to_owned(),
        what: "cannot be read",
        source,
    };
    let mut file = opened.file.try_clone().map_err(io)?;
    refuse_utf16(path, &mut file)?;
    let packing = Packing::of(&mut file).map_err(io)?;
    if let Packing::None = packing {
        let rows = Rows::of_text(&mut file, opened.len).map_err(io)?;
        return Ok((packing.reader(file).map_err(io)?, rows, None));
    }
    let lines = packing.reader(file.try_clone().map_err(io)?);
    let rows = lines.and_then(Rows::of_lines);
    let rows = rows.map_err(|source| damaged(path, source))?;
    file.rewind().map_err(io)?;
    let sha256 = sha256_of(path, &mut file, || true)?;
    Ok((packing.reader(file).map_err(io)?, rows, Some(sha256)))
}

/// Header row, and the row of units where there is one.
fn headers(
    path: &Path,
    reader: &mut CsvRows<impl Read>,
    (above, layout, options): (u64, Layout, &ReadOptions),
) -> Result<(Vec<String>, Option<Vec<String>>), TelemetryError> {
    let Some(row) = readable(path, reader.next_whole_row())? else {
        return Err(TelemetryError::Header {
            place: Place::file(path),
            why: "the file is empty; begin it with a header row".into(),
        });
    };
    let header_line = above + row.line;
    let header = header_of(path, header_line, &row, options.encoding)?;
    if let Some(why) = no_header(&header, layout.comment) {
        return Err(TelemetryError::Header {
            place: Place::row(path, header_line),
            why,
        });
    }
    if layout.units_row != Some(true) {
        return Ok((header, None));
    }
    let units = match readable(path, reader.next_whole_row())? {
        Some(row) => Some(header_of(path, above + row.line, &row, options.encoding)?),
        None => None,
    };
    Ok((header, units))
}

/// Drops the last row, which has no line end, where files are recovered; what is to be said of it.
fn take_unended(row: &Place, recover: bool, last_row: u64, columns: &mut Columns) -> String {
    if !recover {
        return format!("{row}: the last row has no line end; assumed complete");
    }
    columns.rows_read -= 1;
    columns.drop_row(last_row);
    format!("{row}: last row dropped: it has no line end, so its last number may be cut")
}

/// Adds one data row to the columns; on error part of the row may have been added.
fn take_row(
    path: &Path,
    plan: &Plan,
    clock: &mut Clock,
    record: &Row,
    row: u64,
    selection: &mut Selection,
    columns: &mut Columns,
) -> Result<(), TelemetryError> {
    if record.len != plan.width {
        let hint = if record.cell(0).starts_with(b"#") {
            "; leave the line out, or write [telemetry] comment = \"#\""
        } else if record.len > plan.width {
            ": a decimal comma or a comma in a text without quotes adds fields; write a point, or quotes around the text"
        } else {
            "; complete the row: an empty cell means no sample"
        };
        return Err(TelemetryError::Ragged {
            place: Place::row(path, row),
            actual: record.len,
            expected: plan.width,
            hint,
        });
    }
    for (k, (index, text)) in plan.filter.iter().enumerate() {
        let cell = record.cell(*index);
        if k == 0 {
            columns.saw(&String::from_utf8_lossy(cell));
        }
        if cell != text.as_bytes() {
            return Ok(());
        }
    }
    let fault = |index: usize, column: &str, why: InvalidNumber| TelemetryError::Number {
        place: Place::cell(path, row, column),
        value: shown(record.cell(index)),
        why: why.text(index == plan.time_index),
    };
    let text = |index: usize| record.cell(index);
    let cell = |index: usize| RawCell::Text(text(index));
    let time = clock.seconds(cell(plan.time_index), plan.week_index.map(cell));
    let time_s = match time.map_err(|why| fault(plan.time_index, &plan.time_column, why))? {
        Cell::Number(x) => x,
        Cell::Empty | Cell::NotANumber => f64::NAN,
    };
    columns.origin = clock.origin;
    if !selection.keeps(time_s, columns.origin) {
        return Ok(());
    }
    columns.time_s.push(time_s);
    columns.rows.push(row);
    for (k, channel) in plan.channels.iter().enumerate() {
        let value = channel.conversion.cell(text(channel.index));
        let value = value.map_err(|why| fault(channel.index, &channel.column, why))?;
        columns.push(k, row, value);
    }
    Ok(())
}

fn how_cut(error: &TelemetryError) -> String {
    match error {
        TelemetryError::Ragged {
            actual, expected, ..
        } => format!("{actual} of {expected} fields, no line end"),
        TelemetryError::Number { place, value, .. } => {
            format!("'{value}' in column '{}', no line end", place.column)
        }
        other => other.to_string(),
    }
}

fn header_of(
    path: &Path,
    line: u64,
    record: &Row,
    encoding: Encoding,
) -> Result<Vec<String>, TelemetryError> {
    let mut header = Vec::with_capacity(record.len);
    for field in record.cells() {
        if encoding == Encoding::Latin1 {
            let text: String = field.iter().map(|&b| char::from(b)).collect();
            header.push(text.trim().to_owned());
            continue;
        }
        let text = std::str::from_utf8(field).map_err(|e| TelemetryError::Format {
            place: Place::row(path, line),
            why: format!(
                "the header is not UTF-8 ('{}', byte {} of the name); save the file as UTF-8, or read it by --encoding latin1",
                shown(field),
                e.valid_up_to()
            ),
        })?;
        header.push(text.trim().to_owned());
    }
    Ok(header)
}

/// Why the first row is not a header.
fn no_header(header: &[String], comment: Option<u8>) -> Option<String> {
    let first = header.first()?.chars().next()?;
    let usual = matches!(first, '#' | '%' | '!');
    (usual && comment.is_none()).then(|| {
        format!("the first row begins with '{first}'; write [telemetry] comment = \"{first}\" if such lines are comments, or header_row = N for a header in line N")
    })
}

fn refuse_utf16<R: Read + Seek>(path: &Path, file: &mut R) -> Result<(), TelemetryError> {
    let io = |source| TelemetryError::Io {
        path: path.to_owned(),
        what: "cannot be read",
        source,
    };
    let mut mark = Vec::new();
    file.by_ref().take(2).read_to_end(&mut mark).map_err(io)?;
    file.rewind().map_err(io)?;
    if mark == [0xff, 0xfe] || mark == [0xfe, 0xff] {
        return Err(TelemetryError::Format {
            place: Place::file(path),
            why: "the file is UTF-16; save it as UTF-8".into(),
        });
    }
    Ok(())
}

/// What was read of the text; an error names the file.
fn readable<T>(path: &Path, read: io::Result<T>) -> Result<T, TelemetryError> {
    read.map_err(|source| match source.get_ref() {
        Some(fault) if fault.is::<ByteFault>() => TelemetryError::Format {
            place: Place::file(path),
            why: source.to_string(),
        },
        _ => damaged(path, source),
    })
}
