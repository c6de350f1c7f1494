//! Reads files into a table.

use crate::bytes::{check_unchanged, is_standard_input, open, unreadable};
use crate::columns::{Columns, filter};
use crate::content_hash::hashed;
use crate::error::{no_match, no_rows};
use crate::memory::Spooled;
use crate::packing::unpacked_name;
use crate::plan::{Plan, PlannedChannel};
use crate::selection::WhenFull;
use crate::{
    Part, ReadOptions, Source, Table, Turned, assemble, check_conventions, csv_reader, full_name,
    map_faults, memory, mount, orbital, parquet_reader, plan, time_base,
};
use poinsot_files::{Faults, Place, as_read};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Reads the files of one segment into one table.
///
/// Formats: CSV (`.csv`, `.txt`, `.dat`; compressed: `.csv.gz`, `.csv.zst`), Parquet (`.parquet`, `.pq`); `-` is
/// standard input. Each file keeps its own time base. Values are converted to SI; empty and NaN cells become missing
/// samples; quaternions are normalised and made continuous in sign. Every repair is listed in [`Table::repairs`].
///
/// # Errors
/// The first fault found, with its place; see `E02xx`.
///
/// ```
/// use poinsot_telemetry::{ReadOptions, read};
///
/// # let folder = std::env::temp_dir().join(format!("poinsot-read-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("arm.csv");
/// // An empty cell is a missing sample.
/// std::fs::write(&path, "time_s,joint1_rad,joint2_rad\n0,0.1,1.0\n1,0.2,\n2,0.4,3.0\n")?;
/// let table = read(&[&path], &ReadOptions::default())?;
/// assert_eq!(table.channel("joint1_rad").unwrap().values, [0.1, 0.2, 0.4]);
/// assert_eq!(table.channel("joint2_rad").unwrap().time_s[..], [0.0, 2.0]);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read<P: AsRef<Path>>(paths: &[P], options: &ReadOptions) -> Result<Table, Faults> {
    let file = |path: &P| Part::File(path.as_ref().to_owned());
    read_parts(&paths.iter().map(file).collect::<Vec<_>>(), options)
}

/// Reads the sources of one segment (files or columns in memory) into one table; see [`read()`].
///
/// # Errors
/// The first fault found, with its place; see `E02xx`.
///
/// ```
/// use poinsot_telemetry::{MemoryColumns, Part, ReadOptions, Values, read_parts};
/// use std::sync::Arc;
///
/// // Columns in memory; NaN is a missing sample.
/// let numbers = |name: &str, values: &[f64]| (name.to_owned(), Values::Numbers(values.to_vec()));
/// let columns = vec![
///     numbers("time_s", &[0.0, 1.0, 2.0]),
///     numbers("joint1_rad", &[0.1, f64::NAN, 0.4]),
/// ];
/// let part = Part::Memory(Arc::new(MemoryColumns { name: "<arrays>".to_owned(), columns }));
/// let table = read_parts(&[part], &ReadOptions::default())?;
/// assert_eq!(table.channels[0].values, [0.1, 0.4]);
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn read_parts(parts: &[Part], options: &ReadOptions) -> Result<Table, Faults> {
    if let Some(fault) = map_faults(&options.map).into_iter().next() {
        return Err(fault.refused.of(&fault.channel));
    }
    let mut reading = Reading {
        options,
        table: Table::default(),
        found: assemble::Found::default(),
        unused: plan::Unused::new(options),
    };
    for part in parts {
        reading.part(part)?;
    }
    let Reading {
        mut table, unused, ..
    } = reading;
    let paths: Vec<PathBuf> = parts.iter().map(|p| p.path().to_owned()).collect();
    unused.check(&paths, &mut table.repairs)?;
    mount(&mut table, &options.mountings);
    if let Some(map) = &options.map.orbital_frame {
        orbital::to_inertial(&mut table, map)?;
    }
    let mut map = options.map.clone();
    for turned in Turned::ALL {
        if *turned.declared(&mut map) {
            turned.turn(&mut table)?;
        }
    }
    if options.check_conventions {
        check_conventions(&table)?;
    }
    Ok(table)
}

/// The table during reading.
struct Reading<'a> {
    options: &'a ReadOptions,
    table: Table,
    found: assemble::Found,
    unused: plan::Unused<'a>,
}

impl Reading<'_> {
    /// Reads a source.
    fn part(&mut self, part: &Part) -> Result<(), Faults> {
        let path = part.path();
        let options = ReadOptions {
            origin: self.table.origin.or(self.options.origin),
            ..self.options.with_map(self.options.map.for_file(path))
        };
        let repairs = &mut self.table.repairs;
        let read = match part {
            Part::File(path) => decode(path, None, &options, repairs, None),
            Part::Stream(stream) => decode(path, Some(stream), &options, repairs, None),
            Part::Memory(columns) => memory::read(columns, &options),
        };
        let (mut plan, mut columns, sha256) = read?;
        check_any_row(path, &plan, &columns, &options)?;
        self.table.origin = columns.origin.or(options.origin);
        self.unused.mark(path, &plan);
        let notes = plan.notes.iter();
        let notes = notes.map(|note| format!("{}: {note}", path.display()));
        self.table.repairs.extend(notes);
        for name in &plan.ignored {
            if !self.table.ignored.contains(name) {
                self.table.ignored.push(name.clone());
            }
        }
        let rows = columns.rows_read;
        if options.time_s.is_some() || options.every > 1 {
            self.table.repairs.push(format!(
                "{}: {} of {rows} rows selected by --time-s and --every",
                path.display(),
                columns.rows.len()
            ));
        }
        self.table.sources.push(Source {
            path: path.display().to_string(),
            sha256,
            rows,
            time_s: [
                columns.time_s.first().copied().unwrap_or_default(),
                columns.time_s.last().copied().unwrap_or_default(),
            ],
        });
        self.without_rows(path, &mut plan, &mut columns);
        let (strict, table) = (options.strict, &mut self.table);
        time_base::check(path, &plan, &mut columns, strict, &mut table.repairs)?;
        if options.one_run {
            time_base::check_one_run(path, &plan, &columns)?;
        }
        assemble::add(path, &plan, columns, strict, &mut self.found, table)
    }

    /// Leaves out the channels for which there is no row.
    fn without_rows(&mut self, path: &Path, plan: &mut Plan, columns: &mut Columns) {
        for (k, choice) in plan.choices.iter().enumerate() {
            let chosen = columns.chosen.get(k);
            if chosen.is_some_and(|rows| rows.contains(&true)) {
                continue;
            }
            let group = |c: &PlannedChannel| Some(c.part?.0);
            let of_choice = plan.channels.iter().filter(|c| c.choice == Some(k));
            let groups: HashSet<usize> = of_choice.filter_map(group).collect();
            let own = |c: &PlannedChannel| {
                c.choice == Some(k) || group(c).is_some_and(|g| groups.contains(&g))
            };
            let names = plan.channels.iter().filter(|c| own(c));
            let name = |c: &PlannedChannel| match c.part {
                Some(_) => full_name(&c.name.sensor, "attitude"),
                None => c.name.full(),
            };
            let mut names: Vec<String> = names.map(name).collect();
            names.dedup();
            if let Some((index, text)) = choice.last().filter(|_| !names.is_empty()) {
                self.table.repairs.push(format!(
                    "{}: no row has '{text}' in '{}', so there is no {}; the first values there are {}",
                    path.display(),
                    plan.header.get(*index).map_or("", String::as_str),
                    names.join(", "),
                    columns.seen(k + 1)
                ));
            }
            let keep: Vec<bool> = plan.channels.iter().map(|c| !own(c)).collect();
            filter(&mut columns.values, &keep);
            filter(&mut columns.nan_cells, &keep);
            filter(&mut plan.channels, &keep);
        }
    }
}

/// Reads a file in parts of at most `1 / share` of the memory limit; full parts go to `take`, the rest is returned.
pub(crate) fn read_file_in_parts(
    path: &Path,
    options: &ReadOptions,
    share: usize,
    repairs: &mut Vec<String>,
    take: &mut WhenFull,
) -> Result<(Plan, Columns, String), Faults> {
    let options = ReadOptions {
        memory_mib: (options.memory_limit_mib() / share).max(1),
        ..options.clone()
    };
    decode(path, None, &options, repairs, Some(take))
}

/// Returns an error if the selection of rows or times is empty.
fn check_any_row(
    path: &Path,
    plan: &Plan,
    columns: &Columns,
    options: &ReadOptions,
) -> Result<(), Faults> {
    if !columns.time_s.is_empty() {
        return Ok(());
    }
    if let Some((column, text)) = options.map.all.row_filter.first() {
        let problem = format!("no row of {} matches", path.display());
        let advice = format!(
            "choose among the values there, the first are {}",
            columns.seen(0)
        );
        return Err(no_match(column, text, problem, advice));
    }
    if let Some([from, to]) = options.time_s {
        let text = format!("{},{}", as_read(from), as_read(to));
        let problem = format!("no row of {} lies between these times, s", path.display());
        let advice = "choose times of the record (`poinsot inspect` shows them)";
        return Err(no_match(&plan.time_column, &text, problem, advice));
    }
    Ok(())
}

/// Selects the decoder by file suffix, or by the first bytes if there is none.
fn decode(
    path: &Path,
    stream: Option<&Spooled>,
    options: &ReadOptions,
    repairs: &mut Vec<String>,
    full: Option<&mut WhenFull>,
) -> Result<(Plan, Columns, String), Faults> {
    let ending = unpacked_name(path).extension().and_then(|e| e.to_str());
    let named = match ending.map(str::to_lowercase).as_deref() {
        Some("parquet" | "pq") => Some(true),
        Some("csv" | "txt" | "dat") => Some(false),
        _ => None,
    };
    let by_bytes = stream.is_some() || is_standard_input(path);
    if named.is_none() && !by_bytes {
        let problem = "the kind of file is not known from its name";
        let advice = "give a .csv, .csv.gz, .csv.zst or .parquet file";
        return Err(Faults::one("E0202", Place::file(path), problem, advice));
    }
    let opened = match stream {
        Some(stream) => stream.opened.clone(),
        None => open(path)?,
    };
    let is_parquet = match by_bytes {
        true => opened.first(4).map_err(unreadable(path))? == b"PAR1",
        false => named == Some(true),
    };
    let ((plan, columns), sha256) = hashed(path, &opened, || match is_parquet {
        true => parquet_reader::read(path, &opened, options, repairs, full),
        false => csv_reader::read(path, &opened, options, repairs, full),
    })?;
    check_unchanged(path, &opened)?;
    if columns.rows_read == 0 {
        return Err(no_rows(Place::file(path)));
    }
    Ok((plan, columns, sha256))
}
