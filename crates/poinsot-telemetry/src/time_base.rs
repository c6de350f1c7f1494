//! Checks the times of a file: present, strictly increasing, in seconds.

use crate::columns::Columns;
use crate::conversion::Conversion;
use crate::error::not_strict;
use crate::median::median_step;
use crate::plan::{Plan, PlannedChannel};
use poinsot_files::{Faults, Place, as_read, counted, rounded};
use std::path::Path;

/// Median steps outside this range, s, indicate a wrong unit.
const PLAUSIBLE_STEP: std::ops::RangeInclusive<f64> = 1e-5..=1e5;

/// A record holds several runs if its gaps exceed this multiple of the covered time, and the longest gap exceeds
/// `APART_STEPS` median steps.
const APART: f64 = 30.0;
const APART_STEPS: f64 = 1e4;

/// Share of steps back in time beyond which rows are in no order; several runs in one file have fewer.
const SHUFFLED: f64 = 0.25;

/// Puts the rows in the order of time and joins those of one time; other disorder is an error.
pub(crate) fn check(
    path: &Path,
    plan: &Plan,
    columns: &mut Columns,
    strict: bool,
    repairs: &mut Vec<String>,
) -> Result<(), Faults> {
    let mut records = records(plan, columns);
    let mut sorted = false;
    for rows in &mut records {
        if plan.chooses_all() && !columns.follows && is_shuffled(columns, rows) {
            rows.sort_by(|a, b| columns.time_s[*a].total_cmp(&columns.time_s[*b]));
            sorted = true;
        }
        check_order(path, plan, columns, rows)?;
    }
    if sorted {
        let place = Place::cell(path, 0, &plan.time_column);
        let repair = "rows in no order of time sorted";
        if strict {
            return Err(not_strict(place, repair));
        }
        repairs.push(format!("{place}: {repair}"));
    }
    let times = |rows: &Vec<usize>| rows.iter().map(|k| columns.time_s[*k]).collect();
    let steps: Vec<Vec<f64>> = records.iter().map(times).collect();
    columns.sort();
    join(path, plan, columns, strict, repairs)?;
    steps
        .iter()
        .try_for_each(|times| check_step(path, plan, times))
}

/// The rows that follow each other in time: all, or those of each choice where every channel has rows of its own.
fn records(plan: &Plan, columns: &Columns) -> Vec<Vec<usize>> {
    if !plan.chooses_all() {
        return vec![(0..columns.rows.len()).collect()];
    }
    let of = |chosen: &Vec<bool>| {
        let rows = chosen.iter().enumerate().filter(|(_, own)| **own);
        rows.map(|(k, _)| k).collect()
    };
    columns.chosen.iter().map(of).collect()
}

/// Whether the rows of a channel are in no order of time.
fn is_shuffled(columns: &Columns, rows: &[usize]) -> bool {
    let goes_back = |w: &&[usize]| matches!(w, [a, b] if columns.time_s[*b] < columns.time_s[*a]);
    rows.windows(2).filter(goes_back).count() as f64 > SHUFFLED * rows.len() as f64
}

fn no_order(path: &Path, plan: &Plan, row: u64, problem: String, advice: &str) -> Faults {
    let place = Place::cell(path, row, &plan.time_column);
    Faults::one("E0208", place, problem, advice)
}

/// Every row has a time, not before the one of the row above it.
fn check_order(path: &Path, plan: &Plan, columns: &Columns, rows: &[usize]) -> Result<(), Faults> {
    let zero = columns.own_zero_s();
    let mut before = (f64::NEG_INFINITY, 0);
    for k in rows {
        let (time, row) = (columns.time_s[*k], columns.rows[*k]);
        let (problem, advice) = if time.is_nan() {
            let problem = "the row has no time".to_owned();
            (problem, "give it one or leave the row out")
        } else if time.is_infinite() {
            let problem = "the time is infinite".to_owned();
            (problem, "correct it or leave the row out")
        } else if time < before.0 {
            let [from, to] = [before.0, time].map(|t| as_read(t + zero));
            let above = before.1;
            let problem = format!("time goes back from {from} s (row {above}) to {to} s");
            let advice = "choose one run by [telemetry] where, or cut the file into segments";
            (problem, advice)
        } else {
            before = (time, row);
            continue;
        };
        return Err(no_order(path, plan, row, problem, advice));
    }
    Ok(())
}

/// Joins the rows of one time, of which each has the samples that the others lack; drops those that repeat another.
fn join(
    path: &Path,
    plan: &Plan,
    columns: &mut Columns,
    strict: bool,
    repairs: &mut Vec<String>,
) -> Result<(), Faults> {
    let mut keep = vec![true; columns.rows.len()];
    // Rows that repeat one, and that complete one: how many, and the first.
    let (mut repeated, mut completed) = ((0_u64, 0_u64), (0_u64, 0_u64));
    let (mut first, zero) = (0, columns.own_zero_s());
    for (k, keep) in keep.iter_mut().enumerate().skip(1) {
        if columns.time_s[k] != columns.time_s[first] {
            first = k;
            continue;
        }
        let (row_before, row) = (columns.rows[first], columns.rows[k]);
        let time = as_read(columns.time_s[k] + zero);
        let mut adds = false;
        for (channel, values) in plan.channels.iter().zip(&mut columns.values) {
            let (old, new) = (values[first], values[k]);
            if new.is_nan() || new == old {
                continue;
            }
            if !old.is_nan() {
                let column = &channel.column;
                let problem = format!(
                    "time {time} s is already in row {row_before} with another value of '{column}'"
                );
                return Err(no_order(path, plan, row, problem, "keep one of the rows"));
            }
            values[first] = new;
            adds = true;
        }
        *keep = false;
        let count = if adds { &mut completed } else { &mut repeated };
        if count.0 == 0 {
            count.1 = row;
        }
        count.0 += 1;
    }
    if !keep.contains(&false) {
        return Ok(());
    }
    columns.pick((0..keep.len()).filter(|k| keep[*k]));
    let joined = "joined to the row before, which has the same time";
    let told = [
        (repeated, "dropped: the same as the row before"),
        (completed, joined),
    ];
    // Rows that belong to one channel each, or to none, are no repetition.
    let every_row = !plan.chooses_all() && !plan.channels.is_empty();
    for ((count, first), what) in told.into_iter().filter(|t| every_row && t.0.0 > 0) {
        let place = Place::row(path, first);
        let repair = format!("{} {what}", counted(count, "row"));
        if strict {
            return Err(not_strict(place, &repair));
        }
        repairs.push(format!("{place}: {repair} (this is the first)"));
    }
    Ok(())
}

/// Returns an error for several runs in one file.
pub(crate) fn check_one_run(path: &Path, plan: &Plan, columns: &Columns) -> Result<(), Faults> {
    let pulse = |c: &PlannedChannel| matches!(c.transform.conversion, Conversion::Pulse(..));
    let Some(median_s) = median_step(&columns.time_s) else {
        return Ok(());
    };
    // Pulses have no regular step.
    if plan.channels.iter().all(pulse) {
        return Ok(());
    }
    let (mut covered, mut apart, mut longest) = (0.0, 0.0, (0.0, [0.0; 2], [0; 2]));
    let rows = columns.time_s.iter().zip(&columns.rows);
    for ((a, row_a), (b, row_b)) in rows.clone().zip(rows.skip(1)) {
        let step = b - a;
        if step <= 3.0 * median_s {
            covered += step;
            continue;
        }
        apart += step;
        if step > longest.0 {
            longest = (step, [*a, *b], [*row_a, *row_b]);
        }
    }
    let (step, [from, to], [row_before, row]) = longest;
    if step <= APART_STEPS * median_s || apart <= APART * covered {
        return Ok(());
    }
    let [from, to] = [from, to].map(|t| as_read(t + columns.own_zero_s()));
    let covered = rounded(covered, 9);
    let problem = format!(
        "time jumps from {from} s (row {row_before}) to {to} s in a record of {covered} s: these are several runs"
    );
    let advice = "choose one by --time-s or [telemetry] where, or give each as a segment";
    Err(no_order(path, plan, row, problem, advice))
}

fn check_step(path: &Path, plan: &Plan, times: &[f64]) -> Result<(), Faults> {
    let Some(median_s) = median_step(times) else {
        return Ok(());
    };
    if PLAUSIBLE_STEP.contains(&median_s) {
        return Ok(());
    }
    let usual = |factor: f64| (1e-3..=60.0).contains(&(median_s * factor));
    let units = [
        (86400.0, "d"),
        (3600.0, "h"),
        (1e-3, "ms"),
        (1e-6, "us"),
        (1e-9, "ns"),
    ];
    let (why, unit) = match units.into_iter().find(|(factor, _)| usual(*factor)) {
        Some((_, unit)) => (format!(": its unit is likely {unit}"), unit),
        None => (String::new(), "..."),
    };
    let (median_s, column) = (rounded(median_s, 4), &plan.time_column);
    let problem = format!("the median step is {median_s} s, outside 1e-5 to 1e5 s{why}");
    let advice = format!(
        "map it by [telemetry.columns] time_s = {{ column = \"{column}\", unit = \"{unit}\" }}"
    );
    let place = Place::cell(path, 0, column);
    Err(Faults::one("E0209", place, problem, advice))
}
