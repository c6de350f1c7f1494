//! Converts the columns of one file to channels of the table.

use crate::channel_name::components;
use crate::columns::Columns;
use crate::conversion::{Conversion, Transform};
use crate::derive::derive;
use crate::error::{not_strict, number, twice};
use crate::median::median_step;
use crate::plan::{Plan, PlannedChannel};
use crate::{Channel, Overlap, Table, quaternion};
use poinsot_files::{Faults, Place, rounded};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// First place of each channel.
pub(crate) type Found = HashMap<String, Place>;

/// Adds the channels of one file.
pub(crate) fn add(
    path: &Path,
    plan: &Plan,
    mut columns: Columns,
    strict: bool,
    found: &mut Found,
    table: &mut Table,
) -> Result<(), Faults> {
    check_cells(path, plan, &columns, strict, &mut table.repairs)?;
    let pairs = plan.channels.iter().zip(&mut columns.values);
    pairs.for_each(|(channel, values)| channel.transform.continue_across_jumps(values));
    let channels = derive(path, plan, &mut columns)?;
    tidy_attitudes(path, &channels, &mut columns, strict, &mut table.repairs)?;
    let whole: Arc<[f64]> = columns.time_s.as_slice().into();
    let mut bases = vec![Arc::clone(&whole)];
    for (channel, values) in channels.iter().zip(columns.values) {
        let full = channel.name.full();
        let place = Place::cell(path, 0, &channel.column);
        if let Some(first) = found.get(&full) {
            return Err(twice(&full, first, &place));
        }
        let transform = &channel.transform;
        let (time_s, values) = match transform.conversion {
            Conversion::Pulse(_, force) => {
                let of = (transform, force);
                let (times, levels) = pulses(&place, &columns.rows, &whole, &values, of)?;
                (times.into(), levels)
            }
            _ if transform.increments => {
                let (times, rates) = mean_rates(&whole, &values);
                (shared(times, &mut bases), rates)
            }
            _ => without_gaps(&whole, values, &mut bases),
        };
        let is_held = !matches!(transform.conversion, Conversion::Pulse(..));
        let (time_s, values) = match transform.valve_late_s != [0.0; 2] && is_held {
            true => late(&time_s, &values, transform.valve_late_s),
            false => (time_s, values),
        };
        let time_s = match transform.late_s {
            0.0 => time_s,
            late_s => shared(time_s.iter().map(|t| t - late_s).collect(), &mut bases),
        };
        if values.is_empty() {
            table.repairs.push(format!("{place}: no samples; left out"));
            continue;
        }
        found.insert(full, place);
        table.channels.push(Channel {
            name: channel.name.name.clone(),
            sensor: channel.name.sensor.clone(),
            unit: channel.name.dimension.si().to_owned(),
            frame: channel.name.frame.to_owned(),
            time_s,
            values,
        });
    }
    Ok(())
}

/// Rejects infinite cells and lists NaN cells.
fn check_cells(
    path: &Path,
    plan: &Plan,
    columns: &Columns,
    strict: bool,
    repairs: &mut Vec<String>,
) -> Result<(), Faults> {
    let cells = columns.values.iter().zip(&columns.nan_cells);
    for (channel, (values, &(nan, first))) in plan.channels.iter().zip(cells) {
        if let Some((value, &row)) = values.iter().zip(&columns.rows).find(|c| c.0.is_infinite()) {
            let place = Place::cell(path, row, &channel.column);
            let advice = "correct it, or leave the cell empty where there is no sample";
            return Err(number(place, value.to_string(), "is infinite", advice));
        }
        if nan > 0 {
            let place = Place::cell(path, first, &channel.column);
            let repair = format!("{nan} NaN cells treated as missing samples");
            if strict {
                return Err(not_strict(place, &repair));
            }
            repairs.push(format!("{place}: {repair} (this is the first)"));
        }
    }
    Ok(())
}

fn tidy_attitudes(
    path: &Path,
    channels: &[PlannedChannel],
    columns: &mut Columns,
    strict: bool,
    repairs: &mut Vec<String>,
) -> Result<(), Faults> {
    let mut done: Vec<(&str, &str)> = Vec::new();
    for first in channels {
        let Some((prefix @ ("q" | "relative_q"), _)) = first.name.vector() else {
            continue;
        };
        let sensor = first.name.sensor.as_str();
        if done.contains(&(sensor, prefix)) {
            continue;
        }
        done.push((sensor, prefix));
        let mut indices = [0_usize; 4];
        for (axis, index) in components(prefix).iter().zip(&mut indices) {
            let name = format!("{prefix}_{axis}");
            let own = |c: &PlannedChannel| c.name.sensor == sensor && c.name.name == name;
            let Some(found) = channels.iter().position(own) else {
                let problem = format!("'{}' is missing", crate::full_name(sensor, &name));
                let advice = format!(
                    "add it: a quaternion needs {prefix}_x, {prefix}_y, {prefix}_z and {prefix}_w in one file"
                );
                return Err(Faults::one("E0214", Place::file(path), problem, advice));
            };
            *index = found;
        }
        let mut q = indices.map(|k| std::mem::take(&mut columns.values[k]));
        let repaired = quaternion::tidy(path, &first.column, &columns.rows, &mut q, strict)?;
        repairs.extend(repaired);
        for (k, values) in indices.into_iter().zip(q) {
            columns.values[k] = values;
        }
    }
    Ok(())
}

/// Times closer than this are one, s.
const SAME: f64 = 1.0e-9;

/// Converts pulses to a thrust held between samples. A pulse starts at the time of its row and lasts for the cell's
/// duration, s; the thrust is as late as the valve.
fn pulses(
    place: &Place,
    rows: &[u64],
    begins: &[f64],
    lasts: &[f64],
    (transform, force): (&Transform, f64),
) -> Result<(Vec<f64>, Vec<f64>), Faults> {
    let (mut times, mut levels) = (Vec::new(), Vec::new());
    let mut end = f64::NEG_INFINITY;
    let [opens, closes] = transform.valve_late_s;
    for ((begin, duration), row) in begins.iter().zip(lasts).zip(rows) {
        if *duration < 0.0 {
            let (place, value) = (place.at(*row), duration.to_string());
            let advice = "correct it, or leave the cell empty where there is no pulse";
            return Err(number(place, value, "is a negative duration", advice));
        }
        let (begin, stop) = (begin + opens, begin + duration + closes);
        // A valve that opens later than it closes does not open.
        if duration.is_nan() || *duration == 0.0 || begin >= stop {
            continue;
        }
        if begin > end {
            if end.is_finite() {
                times.push(end);
                levels.push(0.0);
            }
            times.push(begin);
            levels.push(force);
        } else if begin < end - SAME && transform.overlap.is_none() {
            let before = rounded(end - begin, 4);
            let problem = format!("the pulse begins {before} s before the one before it ends");
            let advice = "write overlap = \"merged\" for the column where the valve is open until both have ended, or \"replaced\" where a new command takes the place of the one before";
            return Err(Faults::one("E0208", place.at(*row), problem, advice));
        }
        end = match transform.overlap {
            Some(Overlap::Replaced) => stop,
            _ => end.max(stop),
        };
    }
    match (end.is_finite(), begins.first()) {
        (true, _) => times.push(end),
        (false, first) => times.extend(first),
    }
    levels.resize(times.len(), 0.0);
    Ok((times, levels))
}

/// Thrust held between samples that begins and ends late by these times, s.
fn late(times: &[f64], levels: &[f64], [opens, closes]: [f64; 2]) -> (Arc<[f64]>, Vec<f64>) {
    let (mut at, mut held): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for (time, level) in times.iter().zip(levels) {
        if held.last() == Some(level) {
            continue;
        }
        let shift = match (held.is_empty(), *level == 0.0) {
            (true, _) => 0.0,
            (_, true) => closes,
            (_, false) => opens,
        };
        // A command that is shorter than the delays has no effect.
        while at.last().is_some_and(|last| *last >= time + shift) {
            at.pop();
            held.pop();
        }
        if held.last() != Some(level) {
            at.push(time + shift);
            held.push(*level);
        }
    }
    (at.into(), held)
}

/// Longest interval of an increment relative to the usual one; beyond it, the increment before is missing.
const WHOLE_INTERVAL: f64 = 1.5;

/// Mean rates of increments since the sample before, at the middle of the intervals.
fn mean_rates(times: &[f64], increments: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let whole = times.iter().zip(increments).filter(|(_, x)| !x.is_nan());
    let whole: Vec<(&f64, &f64)> = whole.collect();
    let usual = median_step(times).unwrap_or(f64::INFINITY);
    let pairs = whole.iter().zip(whole.iter().skip(1));
    let rate = |((before, _), (time, x)): (&(&f64, &f64), &(&f64, &f64))| {
        let step = *time - *before;
        (step < WHOLE_INTERVAL * usual).then(|| (0.5 * (*time + *before), *x / step))
    };
    pairs.filter_map(rate).unzip()
}

/// Removes missing samples; columns with the same gaps share one time base.
fn without_gaps(
    whole: &Arc<[f64]>,
    values: Vec<f64>,
    bases: &mut Vec<Arc<[f64]>>,
) -> (Arc<[f64]>, Vec<f64>) {
    if !values.iter().any(|x| x.is_nan()) {
        return (Arc::clone(whole), values);
    }
    let samples = whole.iter().zip(values).filter(|(_, x)| !x.is_nan());
    let (times, values): (Vec<f64>, Vec<f64>) = samples.unzip();
    (shared(times, bases), values)
}

/// The time base with these times.
fn shared(times: Vec<f64>, bases: &mut Vec<Arc<[f64]>>) -> Arc<[f64]> {
    if let Some(base) = bases.iter().find(|b| b.as_ref() == times.as_slice()) {
        return Arc::clone(base);
    }
    let base: Arc<[f64]> = times.into();
    bases.push(Arc::clone(&base));
    base
}
