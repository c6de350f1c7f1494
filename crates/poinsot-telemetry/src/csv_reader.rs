//! Reads CSV with one header row, and the text that exports put around it.

use crate::bytes::{Opened, TextBytes, unreadable};
use crate::columns::Columns;
use crate::csv_rows::{CsvRows, Row};
use crate::error::shown;
use crate::intake::Intake;
use crate::map::mark;
use crate::number::{self, Cell, RawCell};
use crate::packing::{Packing, damaged};
use crate::plan::{self, Plan};
use crate::selection::WhenFull;
use crate::size::Rows;
use crate::{Encoding, ReadOptions};
use poinsot_files::{Faults, Place, counted};
use std::io::{self, Read};
use std::path::Path;

/// Reads a CSV file row by row; unused columns are not parsed.
pub(crate) fn read(
    path: &Path,
    opened: &Opened,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    mut full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns), Faults> {
    let (text, rows) = unpacked(path, opened)?;
    let layout = options.map.for_file(path).layout;
    let delimiter = layout.delimiter.as_deref().and_then(mark).unwrap_or(b',');
    let comment = layout.comment.as_deref().and_then(mark);
    let read_as = (delimiter, options.encoding);
    let named = layout.header_row;
    let named = named.map(|line| named_header(path, opened, line, read_as));
    let named = named.transpose()?;
    let above = named.as_ref().map_or(0, |n| n.lines);
    let mut reader = CsvRows::new(TextBytes::new(text, above), delimiter, comment);
    let header = match named {
        Some(named) => named.header,
        None => header(path, &mut reader, (comment, options))?,
    };
    let units = match layout.units_row {
        Some(true) => readable(path, reader.next_whole_row())?,
        _ => None,
    };
    let units = units.map(|row| header_of(path, above + row.line, &row, options.encoding));
    let units = units.transpose()?;
    let plan = plan::build(path, &header, units.as_deref(), options)?;
    let mut intake = Intake::new(path, &plan, options);
    if full.is_none() {
        intake.check_ahead(rows)?;
    }
    reader.used = plan.used_columns().max().map_or(0, |last| last + 1);
    let mut last_row = 0;
    while let Some(row) = readable(path, reader.next_row())? {
        // A row is passed on only when another follows, because the last one may have to be dropped.
        intake.make_room(rows, full.as_deref_mut())?;
        last_row = above + row.line;
        intake.columns.rows_read += 1;
        let cells = row.len;
        let Err(error) = take_row(path, &plan, &row, last_row, &mut intake) else {
            continue;
        };
        let is_last = readable(path, reader.next_row())?.is_none();
        if !is_last || reader.ends_a_line() {
            return Err(error);
        }
        if !options.recover {
            let place = Place::row(path, last_row);
            let how = how_cut(&error, cells, &plan);
            let problem = format!("the file ends inside this row ({how})");
            let advice = "use --recover to keep the rows before it";
            return Err(Faults::one("E0206", place, problem, advice));
        }
        let place = Place::row(path, last_row);
        repairs.push(format!("{place}: cut last row dropped"));
        intake.columns.drop_row(last_row);
        last_row = 0;
    }
    if last_row > 0 && !reader.ends_a_line() {
        let row = Place::row(path, last_row);
        repairs.push(match options.recover {
            true => format!(
                "{row}: last row dropped: it has no line end, so its last number may be cut"
            ),
            false => format!("{row}: the last row has no line end; assumed complete"),
        });
        if options.recover {
            intake.columns.drop_row(last_row);
        }
    }
    intake.make_room(rows, full)?;
    let columns = intake.finished()?;
    Ok((plan, columns))
}

/// The text of a file, and the number of its rows.
fn unpacked(path: &Path, opened: &Opened) -> Result<(Box<dyn Read>, Rows), Faults> {
    let first = opened.first(2).map_err(unreadable(path))?;
    if first == [0xff, 0xfe] || first == [0xfe, 0xff] {
        let problem = "the file is UTF-16";
        let advice = "save it as UTF-8";
        return Err(Faults::one("E0202", Place::file(path), problem, advice));
    }
    let packing = Packing::of(opened).map_err(unreadable(path))?;
    let rows = match packing {
        Packing::None => Rows::of_text(opened).map_err(unreadable(path))?,
        _ => {
            let lines = packing.reader(opened).and_then(Rows::of_lines);
            lines.map_err(|source| damaged(path, source))?
        }
    };
    let text = packing.reader(opened).map_err(unreadable(path))?;
    Ok((text, rows))
}

/// A header at a line that the map names.
struct NamedHeader {
    header: Vec<String>,
    /// Lines up to its end.
    lines: u64,
}

/// The header in a line, behind a sign of a comment; without a header, the numbers of the columns.
fn named_header(
    path: &Path,
    opened: &Opened,
    line: u64,
    (delimiter, encoding): (u8, Encoding),
) -> Result<NamedHeader, Faults> {
    let (text, _) = unpacked(path, opened)?;
    let above = line.saturating_sub(1);
    let mut reader = CsvRows::new(TextBytes::new(text, above), delimiter, None);
    let Some(row) = readable(path, reader.next_whole_row())? else {
        return Err(empty(path));
    };
    if line == 0 {
        let header = (1..=row.len).map(|k| k.to_string()).collect();
        return Ok(NamedHeader { header, lines: 0 });
    }
    let mut header = header_of(path, above + row.line, &row, encoding)?;
    if let Some(first) = header.first_mut() {
        *first = first.trim_start_matches(SIGNS).trim().to_owned();
        if first.is_empty() {
            header.remove(0);
        }
    }
    let lines = above + reader.lines();
    Ok(NamedHeader { header, lines })
}

/// Signs of a comment.
const SIGNS: [char; 3] = ['#', '%', '!'];

fn empty(path: &Path) -> Faults {
    let problem = "the file is empty";
    let advice = "begin it with a header row";
    Faults::one("E0205", Place::file(path), problem, advice)
}

/// The header of a file in which no line is named.
fn header(
    path: &Path,
    reader: &mut CsvRows<impl Read>,
    (comment, options): (Option<u8>, &ReadOptions),
) -> Result<Vec<String>, Faults> {
    let Some(row) = readable(path, reader.next_whole_row())? else {
        return Err(empty(path));
    };
    let line = row.line;
    let header = header_of(path, line, &row, options.encoding)?;
    // The character that says that the first row is not a header.
    let first = header.first().and_then(|name| name.chars().next());
    if let Some(first) = first.filter(|sign| SIGNS.contains(sign) && comment.is_none()) {
        let problem = format!("the first row begins with '{first}'");
        let advice = format!(
            "write [telemetry] header_row = {line} if it has the names, header_row = N for a header in line N, or comment = \"{first}\" if such lines are comments"
        );
        let place = Place::row(path, line);
        return Err(Faults::one("E0205", place, problem, advice));
    }
    Ok(header)
}

/// Adds one data row to the columns; on error part of the row may have been added.
fn take_row(
    path: &Path,
    plan: &Plan,
    record: &Row,
    row: u64,
    intake: &mut Intake,
) -> Result<(), Faults> {
    if record.len != plan.header.len() {
        let expected = plan.header.len();
        let mut problem =
            counted(record.len, "field") + &format!(" where the header has {expected}");
        let advice = if record.cell(0).starts_with(b"#") {
            "leave the line out, or write [telemetry] comment = \"#\""
        } else if record.len > expected {
            problem += ": a decimal comma or a comma in a text without quotes adds fields";
            "write a point, or quotes around the text"
        } else {
            "complete the row: an empty cell means no sample"
        };
        return Err(Faults::one("E0204", Place::row(path, row), problem, advice));
    }
    let number_of = |cell| number::with_point(cell, plan.decimal_comma);
    let time = number_of(record.cell(plan.time_index));
    let cell = |index: usize| match index == plan.time_index {
        true => &*time,
        false => record.cell(index),
    };
    if !intake.keeps(row, |index| RawCell::Text(cell(index)))? {
        return Ok(());
    }
    for (k, channel) in plan.channels.iter().enumerate() {
        let value = match intake.columns.reads(k, channel.choice) {
            false => Cell::Empty,
            true => {
                let cell = number_of(record.cell(channel.index));
                channel.transform.cell(&cell).map_err(|why| {
                    let place = Place::cell(path, row, &channel.column);
                    why.fault(place, &cell, channel.index == plan.time_index)
                })?
            }
        };
        intake.columns.push(k, row, value);
    }
    Ok(())
}

fn how_cut(fault: &Faults, cells: usize, plan: &Plan) -> String {
    match fault.list.as_slice() {
        [f] if f.code == "E0204" => format!("{cells} of {} fields, no line end", plan.header.len()),
        [f] if f.code == "E0203" => {
            let (value, column) = (&f.value, &f.place.name);
            format!("'{value}' in column '{column}', no line end")
        }
        _ => fault.to_string(),
    }
}

fn header_of(
    path: &Path,
    line: u64,
    record: &Row,
    encoding: Encoding,
) -> Result<Vec<String>, Faults> {
    let mut header = Vec::with_capacity(record.len);
    for field in record.cells() {
        if encoding == Encoding::Latin1 {
            let text: String = field.iter().map(|&b| char::from(b)).collect();
            header.push(text.trim().to_owned());
            continue;
        }
        let text = std::str::from_utf8(field).map_err(|e| {
            let (name, byte) = (shown(field), e.valid_up_to());
            let problem = format!("the header is not UTF-8 ('{name}', byte {byte} of the name)");
            let advice = "save the file as UTF-8, or read it by --encoding latin1";
            Faults::one("E0202", Place::row(path, line), problem, advice)
        })?;
        header.push(text.trim().to_owned());
    }
    Ok(header)
}

/// What was read of the text; an error names the file.
fn readable<T>(path: &Path, read: io::Result<T>) -> Result<T, Faults> {
    read.map_err(|mut source| {
        let no_text = source.get_mut().and_then(|f| f.downcast_mut::<Faults>());
        let Some(mut faults) = no_text.map(std::mem::take) else {
            return damaged(path, source);
        };
        let list = faults.list.iter_mut();
        list.for_each(|fault| fault.place = Place::file(path));
        faults
    })
}
