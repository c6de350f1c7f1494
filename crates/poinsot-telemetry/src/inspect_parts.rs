//! Inspection of files of any size: large files are read in parts, in one pass.

use crate::checks::{Finding, SHOWN};
use crate::columns::Columns;
use crate::error::no_rows;
use crate::inspect::{ChannelSummary, Inspection, hull, notes};
use crate::plan::{self, Plan};
use crate::read::{read, read_file_in_parts};
use crate::selection::TOO_LARGE;
use crate::{ReadOptions, Source, Table, assemble, inspect, suggestions, time_base};
use poinsot_files::{Faults, Place};
use std::path::{Path, PathBuf};

/// Divisor of the memory limit for one part: its inspection needs more.
const PART: usize = 4;
/// Largest number of repair lines kept.
const LINES: usize = 100;

/// Inspects files of any size as [`inspect`] does.
///
/// Files larger than [`ReadOptions::memory_mib`] are read in parts. Extremes, counts and gaps are those of the whole
/// file; noise is the RMS over the parts; rate and quantum are those of the first part. Attitude is compared with the
/// gyro of the same file, in the part with the fastest motion.
///
/// # Errors
/// As [`read`](crate::read), except for the size.
///
/// ```
/// use poinsot_telemetry::{ReadOptions, inspect_files};
///
/// # let folder = std::env::temp_dir().join(format!("poinsot-inspect-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("arm.csv");
/// std::fs::write(&path, "time_s,joint1_rad,mode\n0,0.1,3\n1,0.2,3\n2,0.4,3\n")?;
/// let found = inspect_files(&[&path], &ReadOptions::default())?;
/// assert_eq!((found.sources[0].rows, found.channels[0].max), (3, 0.4));
/// // A column without a standard name is not used.
/// assert_eq!(found.ignored, ["mode"]);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspect_files<P: AsRef<Path>>(
    paths: &[P],
    options: &ReadOptions,
) -> Result<Inspection, Faults> {
    match read(paths, options) {
        Ok(table) => return Ok(inspect(&table)),
        Err(fault) if fault.code() == TOO_LARGE => {}
        Err(other) => return Err(other),
    }
    let paths: Vec<PathBuf> = paths.iter().map(|p| p.as_ref().to_owned()).collect();
    let mut unused = plan::Unused::new(options);
    let mut all: Option<Inspection> = None;
    for path in &paths {
        add(&mut all, in_parts(path, options, &mut unused)?);
    }
    let mut repairs = Vec::new();
    unused.check(&paths, &mut repairs)?;
    if let Some(all) = &mut all {
        all.repairs.append(&mut repairs);
    }
    all.map(finished)
        .ok_or_else(|| no_rows(Place::file(Path::new(""))))
}

/// Inspects one file.
fn in_parts(
    path: &Path,
    options: &ReadOptions,
    unused: &mut plan::Unused,
) -> Result<Inspection, Faults> {
    let mut repairs = Vec::new();
    let mut map = options.map.for_file(path);
    let all = map.columns.len();
    map.columns.retain(|c| c.rows.is_empty());
    let passed_over = all - map.columns.len();
    if passed_over > 0 {
        repairs.push(format!(
            "{}: {passed_over} channels with a row selection are skipped in a file of this size",
            path.display()
        ));
    }
    let options = &options.with_map(map);
    let mut parts = Parts {
        path,
        strict: options.strict,
        seen: None,
    };
    let (plan, rest, sha256) =
        read_file_in_parts(path, options, PART, &mut repairs, &mut |plan, columns| {
            parts.take(plan, columns)
        })?;
    let rows = rest.rows_read;
    parts.take(&plan, rest)?;
    unused.mark(path, &plan);
    let mut all = parts.seen.ok_or_else(|| no_rows(Place::file(path)))?;
    repairs.append(&mut all.repairs);
    all.repairs = repairs;
    all.sources = vec![Source {
        path: path.display().to_string(),
        sha256,
        rows,
        time_s: all.time_s.unwrap_or_default(),
    }];
    Ok(all)
}

/// Summary so far, and the last row before the next part.
struct Parts<'a> {
    path: &'a Path,
    strict: bool,
    seen: Option<Inspection>,
}

impl Parts<'_> {
    /// Inspects one part; its times must follow those of the previous part.
    fn take(&mut self, plan: &Plan, mut columns: Columns) -> Result<(), Faults> {
        let mut table = Table {
            ignored: plan.ignored.clone(),
            ..Table::default()
        };
        let strict = self.strict;
        time_base::check(self.path, plan, &mut columns, strict, &mut table.repairs)?;
        if columns.follows {
            columns.pick(1..columns.rows.len());
        }
        if columns.rows.is_empty() {
            return Ok(());
        }
        let mut found = assemble::Found::default();
        assemble::add(self.path, plan, columns, strict, &mut found, &mut table)?;
        add(&mut self.seen, inspect(&table));
        Ok(())
    }
}

/// Adds the summary of a later part or another file.
fn add(all: &mut Option<Inspection>, part: Inspection) {
    let Some(all) = all else {
        *all = Some(part);
        return;
    };
    all.sources.extend(part.sources);
    for channel in part.channels {
        match all.channels.iter_mut().find(|c| c.name == channel.name) {
            Some(before) => join(before, &channel),
            None => all.channels.push(channel),
        }
    }
    all.time_s = all.time_s.into_iter().chain(part.time_s).reduce(hull);
    for test in part.conventions {
        let same = |t: &&mut crate::ConventionTest| t.between == test.between;
        match all.conventions.iter_mut().find(same) {
            // The part with the fastest motion distinguishes the conventions best.
            Some(before) if test.rate > before.rate => *before = test,
            Some(_) => {}
            None => all.conventions.push(test),
        }
    }
    for name in part.ignored {
        if !all.ignored.contains(&name) {
            all.ignored.push(name);
        }
    }
    for line in part.repairs {
        if all.repairs.len() < LINES && !all.repairs.contains(&line) {
            all.repairs.push(line);
        }
    }
    for finding in part.findings {
        let same = |f: &&mut Finding| f.check == finding.check && f.channel == finding.channel;
        match all.findings.iter_mut().find(same) {
            Some(before) => {
                before.count += finding.count;
                before.of += finding.of;
                before.first_times_s.extend(&finding.first_times_s);
                before.first_times_s.truncate(SHOWN);
            }
            None => all.findings.push(finding),
        }
    }
}

/// Merges two consecutive stretches of one channel.
fn join(before: &mut ChannelSummary, next: &ChannelSummary) {
    let between = next.time_s[0] - before.time_s[1];
    let gap = before.rate_hz.is_some_and(|hz| between > 3.0 / hz);
    before.gaps += next.gaps + usize::from(gap);
    let usual = before.rate_hz.map_or(f64::INFINITY, |hz| 1.0 / hz);
    before.lost += next.lost + crate::inspect::missing(between, usual);
    let longest = before.longest_gap_s.max(next.longest_gap_s);
    before.longest_gap_s = if gap { longest.max(between) } else { longest };
    before.time_s[1] = next.time_s[1];
    before.constant = before.constant && next.constant && before.min == next.min;
    before.min = before.min.min(next.min);
    before.max = before.max.max(next.max);
    let (n, m) = (before.samples as f64, next.samples as f64);
    before.noise = match (before.noise, next.noise) {
        (Some(a), Some(b)) => Some(((n * a * a + m * b * b) / (n + m)).sqrt()),
        (one, other) => one.or(other),
    };
    let errors = [before.noise_relative_error, next.noise_relative_error];
    before.noise_relative_error = errors.into_iter().flatten().reduce(f64::max);
    before.noise_is_upper_bound |= next.noise_is_upper_bound;
    before.quantum = before.quantum.filter(|_| next.quantum.is_some());
    before.samples += next.samples;
}

/// Completes the summary of the whole file.
fn finished(mut all: Inspection) -> Inspection {
    all.notes = all.channels.iter().flat_map(notes).collect();
    all.notes.insert(
        0,
        "the files are larger than --memory-mib and were read in parts: noise is the mean over the parts; rate, quantum and the text of a finding are of the first part"
            .to_owned(),
    );
    all.suggestions = suggestions(&all.ignored);
    all
}
