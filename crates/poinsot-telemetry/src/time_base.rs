//! Checks the times of a file: present, strictly increasing, in seconds.

use crate::columns::Columns;
use crate::conversion::Conversion;
use crate::error::not_strict;
use crate::median::median_step;
use crate::plan::{Plan, PlannedChannel};
use poinsot_files::{Faults, Place, as_read, rounded};
use std::path::Path;

/// Median steps outside this range, s, indicate a wrong unit.
const PLAUSIBLE_STEP: std::ops::RangeInclusive<f64> = 1e-5..=1e5;

/// A record holds several runs if its gaps exceed this multiple of the covered time, and the longest gap exceeds
/// `APART_STEPS` median steps.
const APART: f64 = 30.0;
const APART_STEPS: f64 = 1e4;

/// Drops rows that repeat the previous row; other disorder is an error.
pub(crate) fn check(
    path: &Path,
    plan: &Plan,
    columns: &mut Columns,
    strict: bool,
    repairs: &mut Vec<String>,
) -> Result<(), Faults> {
    let fault = |row: u64, problem: String, advice: &str| {
        Faults::one(
            "E0208",
            Place::cell(path, row, &plan.time_column),
            problem,
            advice,
        )
    };
    let zero = columns.own_zero_s();
    let mut keep = vec![true; columns.rows.len()];
    let (mut repeated, mut first_repeated) = (0_u64, 0_u64);
    let mut previous: Option<(f64, u64, usize)> = None;
    let rows = columns.time_s.iter().zip(&columns.rows).zip(&mut keep);
    for (k, ((&time, &row), keep)) in rows.enumerate() {
        if !time.is_finite() {
            let (problem, advice) = match time.is_nan() {
                true => ("the row has no time", "give it one or leave the row out"),
                false => ("the time is infinite", "correct it or leave the row out"),
            };
            return Err(fault(row, problem.to_owned(), advice));
        }
        if let Some((before, row_before, k_before)) = previous {
            if time < before {
                return Err(fault(
                    row,
                    format!(
                        "time goes back from {} s (row {row_before}) to {} s",
                        as_read(before + zero),
                        as_read(time + zero)
                    ),
                    "choose one run by [telemetry] where, or cut the file into segments",
                ));
            }
            if time == before {
                if let Some(column) = difference(plan, columns, k_before, k) {
                    return Err(fault(
                        row,
                        format!(
                            "time {} s is already in row {row_before} with another value of '{column}'",
                            as_read(time + zero)
                        ),
                        "keep one of the rows",
                    ));
                }
                *keep = false;
                repeated += 1;
                if repeated == 1 {
                    first_repeated = row;
                }
                continue;
            }
        }
        previous = Some((time, row, k));
    }
    if repeated > 0 {
        let repair = format!("{repeated} rows that repeat the row before them dropped");
        let place = Place::row(path, first_repeated);
        if strict {
            return Err(not_strict(place, &repair));
        }
        repairs.push(format!("{}: {repair} (this is the first)", place));
        columns.retain(&keep);
    }
    check_step(path, plan, columns)
}

/// The first column in which two rows differ; two missing samples count as equal.
fn difference<'a>(plan: &'a Plan, columns: &Columns, a: usize, b: usize) -> Option<&'a str> {
    plan.channels
        .iter()
        .zip(&columns.values)
        .find(|(_, values)| {
            let bits = |k: usize| values.get(k).filter(|x| !x.is_nan());
            bits(a) != bits(b)
        })
        .map(|(channel, _)| channel.column.as_str())
}

/// Returns an error for several runs in one file.
pub(crate) fn check_one_run(path: &Path, plan: &Plan, columns: &Columns) -> Result<(), Faults> {
    let pulse = |c: &PlannedChannel| matches!(c.conversion, Conversion::Pulse(..));
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
    Err(Faults::one(
        "E0208",
        Place::cell(path, row, &plan.time_column),
        format!(
            "time jumps from {} s (row {row_before}) to {} s in a record of {} s: these are several runs",
            as_read(from + columns.own_zero_s()),
            as_read(to + columns.own_zero_s()),
            rounded(covered, 9)
        ),
        "choose one by --time-s or [telemetry] where, or give each as a segment",
    ))
}

fn check_step(path: &Path, plan: &Plan, columns: &Columns) -> Result<(), Faults> {
    let Some(median_s) = median_step(&columns.time_s) else {
        return Ok(());
    };
    if PLAUSIBLE_STEP.contains(&median_s) {
        return Ok(());
    }
    let usual = |factor: f64| (1e-3..=60.0).contains(&(median_s * factor));
    let likely = if median_s < 1.0 {
        [(86400.0, "d"), (3600.0, "h")]
            .into_iter()
            .find(|(factor, _)| usual(*factor))
    } else {
        [(1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")]
            .into_iter()
            .find(|(factor, _)| usual(*factor))
    };
    let (why, unit) = match likely {
        Some((_, unit)) => (format!(": its unit is likely {unit}"), unit),
        None => (String::new(), "..."),
    };
    let median_s = rounded(median_s, 4);
    let column = &plan.time_column;
    Err(Faults::one(
        "E0209",
        Place::cell(path, 0, column),
        format!("the median step is {median_s} s, outside 1e-5 to 1e5 s{why}"),
        format!(
            "map it by [telemetry.columns] time_s = {{ column = \"{column}\", unit = \"{unit}\" }}"
        ),
    ))
}
