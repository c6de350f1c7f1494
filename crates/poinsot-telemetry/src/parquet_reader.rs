//! Reads Parquet files with the same column names as CSV.
//!
//! The third-party decoder panics on some damaged files; panics become errors here.

use crate::ReadOptions;
use crate::bytes::{Opened, unreadable};
use crate::columns::Columns;
use crate::error::{WRITE_AGAIN, parquet};
use crate::intake::Intake;
use crate::number::{Cell, RawCell};
use crate::parquet_column::{self, Cells, Column, Kind};
use crate::parquet_pages::{self, is_mismatch};
use crate::parquet_seal;
use crate::plan::{self, Plan};
use crate::row_columns::RowColumn;
use crate::selection::WhenFull;
use crate::size::Rows;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use poinsot_files::{Faults, Place, check_memory, counted};
use std::collections::BTreeMap;
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Rows decoded at a time.
const BATCH: usize = 8192;
/// Memory of a cell of rows, bytes.
const OF_CELL: f64 = size_of::<String>() as f64;

/// Reads the planned columns of a Parquet file batch by batch.
pub(crate) fn read(
    path: &Path,
    opened: &Opened,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns), Faults> {
    guarded(path, || decode(path, opened, options, repairs, full))
}

/// Reads all columns of a file that [`write_rows`](crate::write_rows) wrote.
pub(crate) fn read_rows(path: &Path, file: File) -> Result<Vec<RowColumn>, Faults> {
    guarded(path, || rows(path, file))
}

fn guarded<T>(path: &Path, decode: impl FnOnce() -> Result<T, Faults>) -> Result<T, Faults> {
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    decoded.unwrap_or_else(|_| Err(refused(path, "the file is damaged (the decoder stopped)")))
}

fn rows(path: &Path, file: File) -> Result<Vec<RowColumn>, Faults> {
    let file = Opened::stream(file).map_err(unreadable(path))?.file;
    let refused = |e: ParquetError| refused(path, e);
    let reader = SerializedFileReader::new(file.clone()).map_err(refused)?;
    let metadata = reader.metadata();
    let schema = metadata.file_metadata().schema_descr();
    let all = (0..schema.root_schema().get_fields().len()).map(|root| {
        let column = Column::of(schema, root).map_err(|kind| unsupported(path, "", &kind));
        Ok((root, column?))
    });
    let used = all.collect::<Result<Used, Faults>>()?;
    let cells = plausible_rows(path, metadata, file.len)? as f64 * used.len() as f64;
    check_memory(&path.display().to_string(), cells * OF_CELL)?;
    let leaves: Vec<usize> = used.values().map(|c| c.leaf).collect();
    if let Some(why) = parquet_pages::excess(&file, metadata, &leaves).map_err(refused)? {
        return Err(self::refused(path, why));
    }
    let mut columns: Vec<RowColumn> = used.values().map(Column::no_rows).collect();
    for k in 0..metadata.num_row_groups() {
        let group = reader.get_row_group(k);
        let group = group.and_then(|g| Group::open(g.as_ref(), &used));
        let mut group = group.map_err(refused)?;
        while let Some(batch) = group.next(BATCH).map_err(refused)? {
            let cells = columns.iter_mut().zip(batch.into_values());
            cells.for_each(|(column, cells)| cells.append_to(&mut column.cells));
        }
    }
    Ok(columns)
}

fn refused(path: &Path, why: impl ToString) -> Faults {
    parquet(Place::file(path), why.to_string().replace('\n', " "))
}

fn decode(
    path: &Path,
    opened: &Opened,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    mut full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns), Faults> {
    let file = &opened.file;
    let refused = |e: ParquetError| refused(path, e);
    let reader = SerializedFileReader::new(file.clone()).map_err(refused)?;
    let metadata = reader.metadata();
    if !parquet_seal::is_intact(file, metadata).map_err(unreadable(path))? {
        repairs.push(changed(path, options.recover)?);
    }
    let declared = plausible_rows(path, metadata, opened.file.len)?;
    let schema = metadata.file_metadata().schema_descr();
    let roots = schema.root_schema().get_fields();
    let header: Vec<String> = roots.iter().map(|f| f.name().to_owned()).collect();
    let plan = plan::build(path, &header, None, options)?;
    let rows = Rows::Declared(declared);
    let mut intake = Intake::new(path, &plan, options);
    if full.is_none() {
        intake.check_ahead(rows)?;
    }
    let mut used = Used::new();
    for root in plan.used_columns() {
        let name = header.get(root).map_or("", String::as_str);
        let column = Column::of(schema, root).map_err(|kind| unsupported(path, name, &kind))?;
        used.insert(root, column);
    }
    let leaves: Vec<usize> = used.values().map(|c| c.leaf).collect();
    if let Some(why) = parquet_pages::excess(file, metadata, &leaves).map_err(refused)? {
        return Err(self::refused(path, why));
    }
    let time = used.get(&plan.time_index).map(|c| c.kind);
    if matches!(time, Some(Kind::Instant(_))) {
        intake = intake.instants();
    }
    let (mut first, mut sound) = (0, declared);
    for (k, own) in metadata.row_groups().iter().enumerate() {
        let open = || {
            reader
                .get_row_group(k)
                .and_then(|g| Group::open(g.as_ref(), &used))
        };
        let mut group = open().map_err(refused)?;
        loop {
            let read = intake.columns.rows_read as u64;
            let most = usize::try_from(sound - read).map_or(BATCH, |n| n.min(BATCH));
            match group.next(most) {
                Ok(None) => break,
                Ok(Some(batch)) => {
                    take(path, &plan, &used, &batch, &mut intake)?;
                    intake.make_room(rows, full.as_deref_mut())?;
                }
                Err(e) if is_mismatch(&e) && sound == declared => {
                    let bad = parquet_pages::mismatch(file, own, &leaves);
                    let (row, column) = bad.ok_or_else(|| refused(e))?;
                    sound = first + row;
                    let place = Place::cell(path, sound + 1, &column);
                    repairs.push(cut(&place, sound, declared, options.recover)?);
                    // Again, up to that page.
                    group = open().map_err(refused)?;
                    group.skip(read - first).map_err(refused)?;
                }
                Err(e) => return Err(refused(e)),
            }
        }
        first += u64::try_from(own.num_rows()).unwrap_or(0);
    }
    let columns = intake.finished()?;
    if columns.rows_read as u64 != sound {
        let read = columns.rows_read;
        let why = format!("the footer declares {sound} rows, the columns have {read}");
        return Err(self::refused(path, why));
    }
    Ok((plan, columns))
}

/// The repair for a file that does not match its own checksum: it is read all the same.
fn changed(path: &Path, recover: bool) -> Result<String, Faults> {
    let place = Place::file(path);
    let what = "the file does not match its checksum: its bytes were changed";
    match recover {
        true => Ok(format!("{place}: {what}; read all the same")),
        false => {
            let advice = format!("{WRITE_AGAIN}; --recover reads it all the same");
            Err(Faults::one("E0216", place, what, advice))
        }
    }
}

/// The repair for a page that does not match its checksum: the rows from there on are dropped.
fn cut(place: &Place, sound: u64, declared: u64, recover: bool) -> Result<String, Faults> {
    if recover && sound > 0 {
        let rows = counted(declared - sound, "row");
        return Ok(format!(
            "{place}: {rows} from here on dropped: a page does not match its checksum"
        ));
    }
    let more = match sound {
        0 => "no row before it is left",
        _ => "the rows before it can be kept by --recover",
    };
    let what = "the page of this row does not match its checksum: its bytes were changed";
    let advice = format!("{more}; {WRITE_AGAIN}");
    Err(Faults::one("E0216", place.clone(), what, advice))
}

/// Adds a batch of rows to the columns.
fn take(
    path: &Path,
    plan: &Plan,
    used: &Used,
    batch: &Batch,
    intake: &mut Intake,
) -> Result<(), Faults> {
    let rows = batch.values().map(Cells::len).min().unwrap_or(0);
    let first = intake.columns.rows_read as u64 + 1;
    let channels = plan.channels.iter().enumerate();
    let channels = channels.filter_map(|(k, c)| Some((k, c, batch.get(&c.index)?)));
    for (_, channel, cells) in channels.clone() {
        if let Some(kind) = cells.no_numbers() {
            let name = used.get(&channel.index).map_or("", |c| c.name.as_str());
            return Err(unsupported(path, name, kind));
        }
    }
    let mut kept = Vec::with_capacity(rows);
    for k in 0..rows {
        let cell = |index| batch.get(&index).map_or(RawCell::Empty, |c| c.stored(k));
        if intake.keeps(first + k as u64, cell)? {
            kept.push(k);
        }
    }
    for (k, channel, cells) in channels {
        for &row in &kept {
            let cell = match intake.columns.reads(k, channel.choice) {
                true => channel.transform.number(cells.number(row)),
                false => Cell::Empty,
            };
            intake.columns.push(k, first + row as u64, cell);
        }
    }
    intake.columns.rows_read += rows;
    Ok(())
}

/// The columns that are read, by their place in the header.
type Used = BTreeMap<usize, Column>;

fn unsupported(path: &Path, name: &str, kind: &str) -> Faults {
    let advice = format!("store numbers as float64, times as seconds or timestamps; {WRITE_AGAIN}");
    let problem = format!("type {kind} is not supported");
    Faults::one("E0216", Place::cell(path, 0, name), problem, advice)
}

/// Cells of some rows, by their column's place in the header.
type Batch = BTreeMap<usize, Cells>;

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

    /// Leaves out the next rows.
    fn skip(&mut self, rows: u64) -> parquet::errors::Result<()> {
        let mut left = usize::try_from(rows).unwrap_or(usize::MAX);
        while left > 0 {
            let most = left.min(BATCH);
            self.next(most)?;
            left -= most;
        }
        Ok(())
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

/// Rows declared in the footer, after its sizes were compared with the file's.
fn plausible_rows(path: &Path, metadata: &ParquetMetaData, bytes: u64) -> Result<u64, Faults> {
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
