//! Reads Parquet files with the same column names as CSV.
//!
//! The third-party decoder panics on some damaged files; panics become errors here.

use crate::bytes::{Opened, check_unchanged, sha256_of};
use crate::clock::Clock;
use crate::columns::Columns;
use crate::content_hash::{LONG, ended};
use crate::error::{Place, shown};
use crate::number::{Cell, RawCell};
use crate::parquet_bytes::ParquetBytes;
use crate::parquet_column::{self, Cells, Column, Kind};
use crate::parquet_dictionaries;
use crate::parquet_pages::{self, Checksums};
use crate::plan::{self, Plan};
use crate::selection::{Selection, WhenFull};
use crate::size::Rows;
use crate::{ReadOptions, TelemetryError};
use parquet::column::reader::ColumnReader;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, Builder};

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
    let file = ParquetBytes::new(file.map_err(|source| unreadable(path, source))?);
    let work = || {
        let decode = || decode(path, &file, opened.len, options, repairs, full);
        let decoded = catch_unwind(AssertUnwindSafe(decode));
        decoded.unwrap_or_else(|_| Err(refused(path, "the file is damaged (the decoder stopped)")))
    };
    let ((plan, columns), sha256) = hashed(path, &file, opened.len, work)?;
    check_unchanged(path, opened)?;
    Ok((plan, columns, sha256))
}

/// The result of `work`, and SHA-256 of the file: of a long one on a thread beside it, which ends early if it fails.
fn hashed<T>(
    path: &Path,
    file: &ParquetBytes,
    bytes: u64,
    work: impl FnOnce() -> Result<T, TelemetryError>,
) -> Result<(T, String), TelemetryError> {
    let failed = AtomicBool::new(false);
    let hash = || sha256_of(path, file.reader_at(0), || !failed.load(Ordering::Relaxed));
    thread::scope(|scope| {
        let beside = match bytes > LONG {
            true => Builder::new().spawn_scoped(scope, hash).ok(),
            false => None,
        };
        let done = work();
        failed.store(done.is_err(), Ordering::Relaxed);
        let done = done?;
        let sha256 = match beside {
            Some(thread) => thread
                .join()
                .unwrap_or_else(|_| Err(unreadable(path, ended()))),
            None => hash(),
        };
        Ok((done, sha256?))
    })
}

fn unreadable(path: &Path, source: io::Error) -> TelemetryError {
    TelemetryError::Io {
        path: path.to_owned(),
        what: "cannot be read",
        source,
    }
}

fn refused(path: &Path, why: impl ToString) -> TelemetryError {
    TelemetryError::Parquet {
        place: Place::file(path),
        why: why.to_string().replace('\n', " "),
    }
}

fn decode(
    path: &Path,
    file: &ParquetBytes,
    bytes: u64,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    mut full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns), TelemetryError> {
    let reader = SerializedFileReader::new(file.clone()).map_err(|e| refused(path, e))?;
    let metadata = reader.metadata();
    let declared = plausible_rows(path, metadata, bytes)?;
    let schema = metadata.file_metadata().schema_descr();
    let roots = schema.root_schema().get_fields();
    let header: Vec<String> = roots.iter().map(|f| f.name().to_owned()).collect();
    let plan = plan::build(path, &header, None, options)?;
    let rows = Rows::Declared(declared);
    if full.is_none() {
        options.limit().check_ahead(path, &plan, options, rows)?;
    }
    let mut used = Used::new();
    for root in plan.used_columns() {
        let name = header.get(root).map_or("", String::as_str);
        let column = Column::of(schema, root).map_err(|kind| unsupported(path, name, &kind))?;
        used.insert(root, column);
    }
    let leaves: Vec<usize> = used.values().map(|c| c.leaf).collect();
    let excess = parquet_dictionaries::excess(file, metadata, &leaves);
    if let Some(why) = excess.map_err(|e| refused(path, e))? {
        return Err(refused(path, why));
    }
    let sums = parquet_pages::compare(file, metadata, &leaves);
    let sums = sums.map_err(|source| unreadable(path, source))?;
    let sound = sound_rows(path, &sums, declared, options.recover, repairs)?;
    let mut taken = Taken::new(path, &plan, &used, options);
    for k in 0..metadata.num_row_groups() {
        let group = reader.get_row_group(k).map_err(|e| refused(path, e))?;
        let group = Group::open(group.as_ref(), &used);
        let mut group = group.map_err(|e| refused(path, e))?;
        loop {
            let left = sound - taken.columns.rows_read as u64;
            let most = usize::try_from(left).map_or(BATCH, |n| n.min(BATCH));
            let Some(batch) = group.next(most).map_err(|e| refused(path, e))? else {
                break;
            };
            taken.batch(&batch)?;
            let full = full.as_deref_mut();
            let columns = &mut taken.columns;
            taken.selection.check(path, &plan, columns, rows, full)?;
        }
    }
    let columns = taken.columns;
    if columns.rows_read as u64 != sound {
        return Err(refused(
            path,
            format!(
                "the footer declares {sound} rows, the columns have {}",
                columns.rows_read
            ),
        ));
    }
    Ok((plan, columns))
}

/// The columns that are read, by their place in the header.
type Used = BTreeMap<usize, Column>;

fn unsupported(path: &Path, name: &str, kind: &str) -> TelemetryError {
    TelemetryError::Parquet {
        place: Place::cell(path, 0, name),
        why: format!(
            "type {kind} is not supported; store numbers as float64, times as seconds or timestamps"
        ),
    }
}

/// Cells of some rows, by their column's place in the header.
type Batch = BTreeMap<usize, Cells>;

/// A cell of a column, empty where the column is missing.
fn cell(cells: Option<&Cells>, row: usize) -> RawCell<'_> {
    cells.map_or(RawCell::Empty, |cells| cells.stored(row))
}

/// The used columns of one row group.
struct Group {
    readers: BTreeMap<usize, (ColumnReader, Kind)>,
    left: usize,
}

impl Group {
    fn open(group: &dyn RowGroupReader, used: &Used) -> parquet::errors::Result<Self> {
        let mut readers = BTreeMap::new();
        for (&root, column) in used {
            let reader = group.get_column_reader(column.leaf)?;
            readers.insert(root, (reader, column.kind));
        }
        let left = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        Ok(Self { readers, left })
    }

    /// The next rows, at most so many; `None` where no row is left, or a column has fewer.
    fn next(&mut self, most: usize) -> parquet::errors::Result<Option<Batch>> {
        let most = most.min(self.left);
        if most == 0 {
            return Ok(None);
        }
        self.left -= most;
        let mut batch = Batch::new();
        for (root, (reader, kind)) in &mut self.readers {
            batch.insert(*root, parquet_column::next(reader, *kind, most)?);
        }
        Ok(batch.values().all(|c| c.len() == most).then_some(batch))
    }
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

/// What was taken from the file so far.
struct Taken<'a> {
    path: &'a Path,
    plan: &'a Plan,
    used: &'a Used,
    clock: Clock,
    selection: Selection,
    columns: Columns,
}

impl<'a> Taken<'a> {
    fn new(path: &'a Path, plan: &'a Plan, used: &'a Used, options: &ReadOptions) -> Self {
        let mut clock = plan.clock.clone();
        let time = used.get(&plan.time_index).map(|c| c.kind);
        if matches!(time, Some(Kind::Instant(_))) {
            clock = clock.instants();
        }
        Self {
            path,
            plan,
            used,
            clock,
            selection: options.selection(),
            columns: Columns::with_channels(plan.channels.len()),
        }
    }

    fn batch(&mut self, batch: &Batch) -> Result<(), TelemetryError> {
        let rows = batch.values().map(Cells::len).min().unwrap_or(0);
        let first = self.columns.rows_read as u64 + 1;
        let channels = self.plan.channels.iter().enumerate();
        let channels = channels.filter_map(|(k, c)| Some((k, c, batch.get(&c.index)?)));
        for (_, channel, cells) in channels.clone() {
            if let Some(kind) = cells.no_numbers() {
                let name = self
                    .used
                    .get(&channel.index)
                    .map_or("", |c| c.name.as_str());
                return Err(unsupported(self.path, name, kind));
            }
        }
        let kept = self.kept(rows, first, batch)?;
        for (k, channel, cells) in channels {
            for &row in &kept {
                let cell = channel.conversion.number(cells.number(row));
                self.columns.push(k, first + row as u64, cell);
            }
        }
        self.columns.rows_read += rows;
        Ok(())
    }

    /// Which rows the filter and the times keep; the times of these are stored.
    fn kept(
        &mut self,
        rows: usize,
        first: u64,
        batch: &Batch,
    ) -> Result<Vec<usize>, TelemetryError> {
        let filter = self.plan.filter.iter();
        let filter: Vec<_> = filter.map(|(root, text)| (batch.get(root), text)).collect();
        let times = batch.get(&self.plan.time_index);
        let weeks = self.plan.week_index.map(|week| batch.get(&week));
        let mut kept = Vec::with_capacity(rows);
        for k in 0..rows {
            let mut keep = true;
            for (i, (cells, text)) in filter.iter().enumerate() {
                let found = cell(*cells, k).text();
                if i == 0 {
                    self.columns.saw(&String::from_utf8_lossy(&found));
                }
                keep &= *found == *text.as_bytes();
            }
            let row = first + k as u64;
            let time = self
                .clock
                .seconds(cell(times, k), weeks.map(|w| cell(w, k)));
            let time = time.map_err(|why| TelemetryError::Number {
                place: Place::cell(self.path, row, &self.plan.time_column),
                value: shown(&cell(times, k).text()),
                why: why.text(true),
            })?;
            let time_s = match time {
                Cell::Number(x) => x,
                Cell::Empty | Cell::NotANumber => f64::NAN,
            };
            self.columns.origin = self.clock.origin;
            if keep && self.selection.keeps(time_s, self.columns.origin) {
                self.columns.rows.push(row);
                self.columns.time_s.push(time_s);
                kept.push(k);
            }
        }
        Ok(kept)
    }
}
