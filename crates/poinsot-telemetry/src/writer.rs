//! Writes channels to CSV or Parquet; reading them back gives the same bits.

use crate::Channel;
use crate::cursor::{Cursor, cursors};
use crate::error::{parquet, unreadable};
#[cfg(not(feature = "parquet"))]
use crate::parquet_reader::ABSENT;
#[cfg(feature = "parquet")]
use crate::parquet_writer::ParquetRows;
use poinsot_files::{Faults, Place, Stage, folder_of};
use std::borrow::Cow;
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;

/// Rows that are written together: a row group of Parquet.
pub const GROUP: usize = 1 << 16;

/// Writes channels to `path`: CSV, or Parquet (float64, Snappy) if the suffix is `.parquet` or `.pq`.
///
/// One column `time_s` with the union of all times, one column per channel, an empty cell or null for a missing
/// sample. CSV numbers are the shortest that read back to the same double. The file appears only when complete and on
/// disk; its folder is created if missing.
///
/// # Errors
/// E0219 for duplicate names, values that are not finite, or times that do not increase;
/// E0201 if writing fails.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// # let folder = std::env::temp_dir().join(format!("poinsot-write-{}", std::process::id()));
/// let path = folder.join("arm.csv");
/// let angle = channel("joint1_rad", "rad", &[0.0, 0.1], &[0.5, 0.25]);
/// write(&path, std::slice::from_ref(&angle))?;
/// // Reading back gives the same bits.
/// assert_eq!(read(&[&path], &ReadOptions::default())?.channels[0].values, angle.values);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(path: &Path, channels: &[Channel]) -> Result<(), Faults> {
    let mut stage = Stage::new(folder_of(path)).map_err(unwritten)?;
    let name = path.file_name().unwrap_or_default();
    write_pieces(&mut stage, Path::new(name), channels, |_| Ok(()))?;
    stage.commit().map_err(unwritten)?;
    Ok(())
}

/// Writes telemetry as one file of a result: the samples of `channels`, and those that `fill` adds to them. `name` is relative
/// to the folder of `stage`.
///
/// # Errors
/// As [`write()`], and those of `fill`.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// use poinsot_files::Stage;
/// use std::path::Path;
///
/// # let folder = std::env::temp_dir().join(format!("poinsot-pieces-{}", std::process::id()));
/// let angle = |time: f64| channel("joint1_rad", "rad", &[time], &[0.5 * time]);
/// let mut stage = Stage::new(&folder)?;
/// write_pieces(&mut stage, Path::new("arm.csv"), &[angle(0.0)], |writer| {
///     // No later sample has a time of at most 0.1 s.
///     writer.add(vec![angle(0.1)], 0.1)?;
///     writer.add(vec![angle(0.2)], f64::INFINITY)
/// })?;
/// stage.commit()?;
/// let text = std::fs::read_to_string(folder.join("arm.csv"))?;
/// assert_eq!(text, "time_s,joint1_rad\n0.0,0.0\n0.1,0.05\n0.2,0.1\n");
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_pieces<T>(
    stage: &mut Stage,
    name: &Path,
    channels: &[Channel],
    fill: impl FnOnce(&mut RowWriter<'_>) -> Result<T, Faults>,
) -> Result<T, Faults> {
    let path = &stage.target(name);
    let filled = stage.fill(name, |file| {
        let mut writer = RowWriter::open(file, path, channels)?;
        let filled = fill(&mut writer)?;
        writer.finish()?;
        Ok(filled)
    });
    filled.map_err(unwritten)
}

/// Telemetry that is written while its rows are made.
pub struct RowWriter<'f> {
    path: &'f Path,
    rows: Rows<'f>,
    /// Samples that are not yet written, and the last time that is.
    pending: Cow<'f, [Channel]>,
    written: f64,
}

/// Rows of a format.
enum Rows<'f> {
    Csv(BufWriter<&'f mut File>),
    #[cfg(feature = "parquet")]
    Parquet(ParquetRows<'f>),
}

impl<'f> RowWriter<'f> {
    fn open(file: &'f mut File, path: &'f Path, channels: &'f [Channel]) -> Result<Self, Faults> {
        let written = f64::NEG_INFINITY;
        check(path, channels, written)?;
        let names = channels.iter().map(|c| c.full());
        let rows = match path.extension().and_then(|e| e.to_str()) {
            #[cfg(not(feature = "parquet"))]
            Some("parquet" | "pq") => return Err(parquet(Place::file(path), ABSENT)),
            #[cfg(feature = "parquet")]
            Some("parquet" | "pq") => {
                let opened = ParquetRows::open(file, names);
                Rows::Parquet(opened.map_err(|e| parquet(Place::file(path), e.to_string()))?)
            }
            _ => {
                let mut out = BufWriter::with_capacity(1 << 16, file);
                csv_header(&mut out, names).map_err(failed(path))?;
                Rows::Csv(out)
            }
        };
        Ok(Self {
            path,
            rows,
            pending: channels.into(),
            written,
        })
    }

    /// Adds the next samples of every channel, in the order of the channels. No later one has a time of at most `until`, s.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn add(&mut self, channels: Vec<Channel>, until: f64) -> Result<(), Faults> {
        for (pending, new) in self.pending.to_mut().iter_mut().zip(channels) {
            if pending.values.is_empty() {
                *pending = new;
                continue;
            }
            pending.time_s = [&*pending.time_s, &*new.time_s].concat().into();
            pending.values.extend(new.values);
        }
        check(self.path, &self.pending, self.written)?;
        let written = self.write(until)?;
        for (channel, n) in self.pending.to_mut().iter_mut().zip(written) {
            channel.time_s = channel.time_s[n..].into();
            channel.values.drain(..n);
        }
        Ok(())
    }

    /// Writes whole groups of the rows up to `until`; at infinity, all rows. Returns how many samples of each channel that are.
    fn write(&mut self, until: f64) -> Result<Vec<usize>, Faults> {
        let mut times = union_of_times(&self.pending);
        if until < f64::INFINITY {
            let complete = times.partition_point(|t| *t <= until);
            times.truncate(complete / GROUP * GROUP);
        }
        self.written = times.last().copied().unwrap_or(self.written);
        let mut cursors = cursors(&self.pending);
        for times in times.chunks(GROUP) {
            let done = match &mut self.rows {
                Rows::Csv(out) => csv_rows(out, times, &mut cursors),
                #[cfg(feature = "parquet")]
                Rows::Parquet(out) => out.group(times, &mut cursors),
            };
            done.map_err(failed(self.path))?;
        }
        Ok(cursors.iter().map(|cursor| cursor.next).collect())
    }

    fn finish(mut self) -> Result<(), Faults> {
        self.write(f64::INFINITY)?;
        let ended = match self.rows {
            Rows::Csv(mut out) => out.flush(),
            #[cfg(feature = "parquet")]
            Rows::Parquet(out) => out.finish(),
        };
        ended.map_err(failed(self.path))
    }
}

fn failed(path: &Path) -> impl Fn(io::Error) -> Faults {
    move |source| unreadable(path, "cannot be written", &source)
}

/// E0201 in place of E0002: a telemetry file cannot be written.
fn unwritten(mut faults: Faults) -> Faults {
    for fault in faults.list.iter_mut().filter(|f| f.code == "E0002") {
        fault.code = "E0201";
    }
    faults
}

/// Checks samples that follow the rows up to the time `after`, s.
fn check(path: &Path, channels: &[Channel], after: f64) -> Result<(), Faults> {
    let mut names = HashSet::new();
    for c in channels {
        let name = c.full();
        let mut pairs = c.time_s.iter().zip(c.time_s.iter().skip(1));
        let later = |t: &f64| t.is_finite() && *t > after;
        let increase = pairs.all(|(a, b)| a < b) && c.time_s.iter().all(later);
        let (problem, advice) = if name == "time_s" || !names.insert(name.clone()) {
            ("two columns of this name", "rename one channel")
        } else if c.time_s.len() != c.values.len() {
            let problem = "times and values differ in number";
            (problem, "give one time per value")
        } else if !increase {
            let problem = "the times are not strictly increasing numbers";
            (problem, "sort them and leave out what repeats")
        } else if !c.values.iter().all(|x| x.is_finite()) {
            let advice = "correct what it comes from, or leave the sample out";
            ("a value is not finite", advice)
        } else {
            continue;
        };
        let place = Place::cell(path, 0, &name);
        return Err(Faults::one("E0219", place, problem, advice));
    }
    Ok(())
}

/// All times at which some channel has a sample, ascending.
fn union_of_times(channels: &[Channel]) -> Vec<f64> {
    let mut bases: Vec<&Arc<[f64]>> = Vec::new();
    for c in channels {
        if !bases
            .iter()
            .any(|b| Arc::ptr_eq(b, &c.time_s) || **b == c.time_s)
        {
            bases.push(&c.time_s);
        }
    }
    if let [only] = bases.as_slice() {
        return only.to_vec();
    }
    let mut times: Vec<f64> = bases.iter().flat_map(|b| b.iter().copied()).collect();
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    times
}

fn csv_header(out: &mut impl Write, names: impl Iterator<Item = String>) -> io::Result<()> {
    out.write_all(b"time_s")?;
    for name in names {
        if name.contains([',', '"', '\n', '\r']) {
            write!(out, ",\"{}\"", name.replace('"', "\"\""))?;
        } else {
            write!(out, ",{name}")?;
        }
    }
    out.write_all(b"\n")
}

fn csv_rows(out: &mut impl Write, times: &[f64], cursors: &mut [Cursor<'_>]) -> io::Result<()> {
    for &time in times {
        // Debug gives the shortest text that reads back to the same double, with an exponent if it is long.
        write!(out, "{time:?}")?;
        for cursor in &mut *cursors {
            match cursor.at(time) {
                Some(value) => write!(out, ",{value:?}")?,
                None => out.write_all(b",")?,
            }
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}
