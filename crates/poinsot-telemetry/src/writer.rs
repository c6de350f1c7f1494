//! Writes channels to CSV or Parquet; reading them back gives the same bits.

use crate::cursor::cursors;
use crate::error::{parquet, unreadable};
#[cfg(not(feature = "parquet"))]
use crate::parquet_reader::write_parquet;
#[cfg(feature = "parquet")]
use crate::parquet_writer::write_parquet;
use crate::{Channel, full_name};
use poinsot_files::{Faults, Place, Stage, folder_of};
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;

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
    write_staged(&mut stage, Path::new(name), channels)?;
    stage.commit().map_err(unwritten)?;
    Ok(())
}

/// Writes channels as one file of a result; `name` is relative to the folder of `stage`.
///
/// # Errors
/// As [`write()`].
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// use poinsot_files::Stage;
/// use std::path::Path;
///
/// # let folder = std::env::temp_dir().join(format!("poinsot-staged-{}", std::process::id()));
/// let angle = channel("joint1_rad", "rad", &[0.0, 0.1], &[0.5, 0.25]);
/// let mut stage = Stage::new(&folder)?;
/// write_staged(&mut stage, Path::new("arm.csv"), &[angle])?;
/// // The file appears with the others of its result.
/// assert!(!folder.join("arm.csv").exists());
/// stage.commit()?;
/// assert!(folder.join("arm.csv").exists());
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_staged(stage: &mut Stage, name: &Path, channels: &[Channel]) -> Result<(), Faults> {
    let path = &stage.target(name);
    check(path, channels)?;
    let times = union_of_times(channels);
    let extension = path.extension().and_then(|e| e.to_str());
    let filled = stage.fill(name, |file| match extension {
        Some("parquet" | "pq") => {
            write_parquet(file, &times, channels).map_err(|why| parquet(Place::file(path), why))
        }
        _ => write_csv(file, &times, channels)
            .map_err(|source| unreadable(path, "cannot be written", &source)),
    });
    filled.map_err(unwritten)
}

/// E0201 in place of E0002: a telemetry file cannot be written.
fn unwritten(mut faults: Faults) -> Faults {
    for fault in faults.list.iter_mut().filter(|f| f.code == "E0002") {
        fault.code = "E0201";
    }
    faults
}

fn check(path: &Path, channels: &[Channel]) -> Result<(), Faults> {
    let mut names = HashSet::new();
    for c in channels {
        let name = full_name(&c.sensor, &c.name);
        let mut pairs = c.time_s.iter().zip(c.time_s.iter().skip(1));
        let increase = pairs.all(|(a, b)| a < b) && c.time_s.iter().all(|t| t.is_finite());
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
        if !bases.iter().any(|b| Arc::ptr_eq(b, &c.time_s)) {
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

fn write_csv(file: &mut File, times: &[f64], channels: &[Channel]) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    out.write_all(b"time_s")?;
    for c in channels {
        let name = full_name(&c.sensor, &c.name);
        if name.contains([',', '"', '\n', '\r']) {
            write!(out, ",\"{}\"", name.replace('"', "\"\""))?;
        } else {
            write!(out, ",{name}")?;
        }
    }
    out.write_all(b"\n")?;
    let mut cursors = cursors(channels);
    for &time in times {
        // Debug gives the shortest text that reads back to the same double, with an exponent if it is long.
        write!(out, "{time:?}")?;
        for cursor in &mut cursors {
            match cursor.at(time) {
                Some(value) => write!(out, ",{value:?}")?,
                None => out.write_all(b",")?,
            }
        }
        out.write_all(b"\n")?;
    }
    out.flush()
}
