//! Unit errors that telemetry alone does not contradict: detected by the size of the result, or by a fit in another
//! unit.

use crate::bind::{RELATIVE_ACCURACY, solve};
use poinsot_identify::{Estimate, Problem, Settings, Status, maximum_likelihood_with};
use poinsot_model::Model;
use poinsot_telemetry::checks::{Check, Finding, Policy};
use poinsot_telemetry::{Channel, Table, median_step};
use std::f64::consts::PI;

/// Ratios of estimated to nominal inertia caused by unit errors.
const FACTORS: [(f64, &str); 10] = [
    (30.0 / PI, "wheel speeds in rpm used as rad/s"),
    (PI / 30.0, "wheel speeds in rad/s mapped as rpm"),
    (
        180.0 / PI,
        "wheel speeds in deg/s used as rad/s, or body rates in rad/s mapped as deg/s",
    ),
    (PI / 180.0, "body rates in deg/s used as rad/s"),
    (2.0 * PI, "wheel speeds in rad/s mapped as turns per second"),
    (0.5 / PI, "wheel speeds in turns per second used as rad/s"),
    (
        1.0e3,
        "a factor of a thousand (g for kg, mN for N) in the model or the telemetry",
    ),
    (
        1.0e-3,
        "a factor of a thousand (kg for g, N for mN) in the model or the telemetry",
    ),
    (1.0e4, "kg cm2 for kg m2 in the model"),
    (1.0e-4, "kg m2 for kg cm2 in the model"),
];
/// Factors that correct body rates, and the mistake.
const RATES: [(f64, &str); 2] = [
    (PI / 180.0, "body rates in deg/s used as rad/s"),
    (PI / 30.0, "body rates in rpm used as rad/s"),
];
/// Chi-square per degree of freedom below which a record fits.
const FITS: f64 = 10.0;
/// Largest residual chi-square relative to that of the rates themselves.
const UNEXPLAINED: f64 = 0.01;
/// Rotation per sample, rad, above which a fit is slow, and above which it takes minutes.
const FAST: f64 = 0.03;
const FAR: f64 = 0.3;
/// Share of a record that another reading of it must fit before the whole is tried.
const BEGINNING: f64 = 0.125;
/// Tolerance of the mean factor, relative.
const MEAN: f64 = 0.15;
/// Tolerance of the factor of one axis about the mean, relative.
const SPREAD: f64 = 0.4;
/// Detects a unit error from the ratio of estimated to nominal inertia.
pub(crate) fn units(estimate: &Estimate) -> Vec<Finding> {
    if estimate.status == Status::Rejected {
        return Vec::new();
    }
    let factor_of = |k: usize, body: &poinsot_identify::BodyEstimate| {
        let n = body.inertia.get(k)?;
        let ratio = n.value? / n.nominal;
        (ratio > 0.0 && ratio.is_finite()).then(|| ratio.ln())
    };
    let mut all = Vec::new();
    for body in estimate.bodies.iter().filter(|b| b.asked) {
        // Indices of xx, yy, zz among the inertia elements.
        let Some([x, y, z]) = [0, 2, 5]
            .map(|k| factor_of(k, body))
            .into_iter()
            .collect::<Option<Vec<f64>>>()
            .and_then(|v| <[f64; 3]>::try_from(v).ok())
        else {
            continue;
        };
        let mean = (x + y + z) / 3.0;
        let even = [x, y, z].iter().all(|l| (l - mean).abs() < SPREAD);
        let known = FACTORS.iter().find(|(f, _)| (mean - f.ln()).abs() < MEAN);
        if let (true, Some((_, words))) = (even, known) {
            all.push(finding(
                Check::Units,
                &body.name,
                format!(
                    "the data fit {:.3} times the nominal inertia about every axis; possible cause: {words}",
                    mean.exp()
                ),
            ));
        }
    }
    all
}

/// Detects exchanged axes or a wrong unit of body rates, if a record without attitude contradicts the model. Records
/// with attitude are tested on reading.
pub(crate) fn rates(model: &Model, tables: &[Table], estimate: &Estimate) -> Option<Finding> {
    let answered = !matches!(estimate.status, Status::Rejected | Status::IterationLimit);
    if answered || has_attitude(tables) {
        return None;
    }
    let exchanged = ORDERS.map(|order| (read_along(tables, order), along(order)));
    let scaled = RATES.map(|(factor, words)| (scaled(tables, factor), words.to_owned()));
    let mut all: Vec<(Vec<Table>, String)> = exchanged.into_iter().chain(scaled).collect();
    if turn_per_reading(tables) > FAST {
        // Fast motion is slow to integrate in any axes: test units first.
        all.rotate_left(ORDERS.len());
    }
    let explained = |other: &[Table]| {
        let left = fit(model, &beginning(other), |_, found| Some(largest(found)));
        left.is_none_or(|left| left < FITS) && fits(model, other).unwrap_or(false)
    };
    let (_, words) = all.into_iter().find(|(other, _)| explained(other))?;
    let text = format!("the data contradict the model; they fit with {words}");
    Some(finding(Check::Units, "omega", text))
}

/// Detects times in milliseconds: a record without attitude with large rotation between samples that fits after
/// conversion. Tested before the fit, which would take minutes.
pub(crate) fn times(model: &Model, tables: &[Table]) -> Option<Finding> {
    let turn = turn_per_reading(tables);
    if turn < FAR || has_attitude(tables) {
        return None;
    }
    let other = changed(tables, |channel| {
        channel.time_s = channel.time_s.iter().map(|t| t * 1.0e-3).collect();
    });
    let text = format!(
        "the vehicle turns by {turn:.1} rad between samples; the times are probably in ms, not s"
    );
    fits(model, &other)?.then(|| finding(Check::Units, "time_s", text))
}

fn has_attitude(tables: &[Table]) -> bool {
    let mut channels = tables.iter().flat_map(|t| &t.channels);
    channels.any(|c| c.name == "q_w")
}

/// The tables with every channel changed.
fn changed(tables: &[Table], change: impl FnMut(&mut Channel)) -> Vec<Table> {
    let mut all = tables.to_vec();
    all.iter_mut()
        .flat_map(|t| &mut t.channels)
        .for_each(change);
    all
}

/// Typical rotation between gyro samples, rad; the largest of all tables.
fn turn_per_reading(tables: &[Table]) -> f64 {
    let of = |table: &Table| {
        let rates = table
            .channels
            .iter()
            .filter(|c| RATE_COLUMNS.contains(&c.name.as_str()));
        let square = |c: &Channel| {
            let sum: f64 = c.values.iter().map(|w| w * w).sum();
            sum / c.values.len().max(1) as f64
        };
        let step = rates.clone().find_map(|c| median_step(&c.time_s));
        rates.map(square).sum::<f64>().sqrt() * step.unwrap_or(0.0)
    };
    tables.iter().map(of).fold(0.0, f64::max)
}

/// Column orders other than x, y, z: two exchanged, or all three.
const ORDERS: [[usize; 3]; 5] = [[1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
const RATE_COLUMNS: [&str; 3] = ["omega_x", "omega_y", "omega_z"];

fn along(order: [usize; 3]) -> String {
    let read = order.map(|k| RATE_COLUMNS[k]).join(", ");
    format!("body rates with x, y, z in the columns {read}")
}

/// The tables with body rates from other columns.
fn read_along(tables: &[Table], order: [usize; 3]) -> Vec<Table> {
    changed(tables, |channel| {
        if let Some(axis) = RATE_COLUMNS.iter().position(|name| *name == channel.name) {
            RATE_COLUMNS[inverse(order)[axis]].clone_into(&mut channel.name);
        }
    })
}

fn inverse(order: [usize; 3]) -> [usize; 3] {
    [0, 1, 2].map(|k| order.iter().position(|o| *o == k).unwrap_or(k))
}

/// The tables with body rates multiplied by a factor.
fn scaled(tables: &[Table], factor: f64) -> Vec<Table> {
    changed(tables, |channel| {
        if channel.name.starts_with("omega_") {
            channel.values.iter_mut().for_each(|w| *w *= factor);
        }
    })
}

/// The first samples of every column, up to one time for all columns of a table.
fn beginning(tables: &[Table]) -> Vec<Table> {
    let mut all = tables.to_vec();
    for table in &mut all {
        let ends = |c: &Channel| Some((*c.time_s.first()?, *c.time_s.last()?));
        let all = table.channels.iter().filter_map(ends);
        let whole = all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let Some((first, last)) = whole else {
            continue;
        };
        let end = first + BEGINNING * (last - first);
        for channel in &mut table.channels {
            let kept = channel.time_s.partition_point(|t| *t <= end);
            channel.values.truncate(kept);
            channel.time_s = channel.time_s.iter().copied().take(kept).collect();
        }
    }
    all
}

/// A fit to these tables. `None` if the problem is invalid.
fn fit<T>(
    model: &Model,
    tables: &[Table],
    ask: impl FnOnce(&Problem, &Estimate) -> Option<T>,
) -> Option<T> {
    let options = Settings {
        undiagnosed: true,
        ..Settings::default()
    };
    let asked = |problem: &Problem| Ok(ask(problem, &maximum_likelihood_with(problem, options)?));
    solve(model, tables, RELATIVE_ACCURACY, asked).ok()?
}

/// Largest chi-square per degree of freedom of a segment.
fn largest(found: &Estimate) -> f64 {
    found.fit.iter().map(|f| f.chi2_per_dof).fold(0.0, f64::max)
}

/// Whether the model explains these tables: chi-square is small, also compared with that of the rates themselves.
/// Rates below the declared noise fit any model. `None` if the problem is invalid.
fn fits(model: &Model, tables: &[Table]) -> Option<bool> {
    fit(model, tables, |other, found| {
        let answered = matches!(found.status, Status::Converged | Status::Partial);
        let mut asked = found.bodies.iter().filter(|b| b.asked);
        let determined = asked.any(|b| b.inertia.iter().any(|n| n.value.is_some()));
        let left = largest(found);
        let explained = left < UNEXPLAINED * rates_over_noise(other)?;
        Some(answered && determined && left < FITS && explained)
    })
}

/// Mean square of the body rates relative to their noise variance, per number.
fn rates_over_noise(problem: &Problem) -> Option<f64> {
    let weight = problem.noise.gyro.try_inverse()?;
    let rates = || problem.segments.iter().flat_map(|s| s.observations.rates());
    let sum: f64 = rates()
        .map(|(_, w)| (w.transpose() * weight * w)[(0, 0)])
        .sum();
    Some(sum / (3.0 * rates().count().max(1) as f64))
}

/// A finding of the fit, which concerns no single samples.
pub(crate) fn finding(check: Check, channel: &str, text: String) -> Finding {
    Finding {
        check,
        channel: channel.to_owned(),
        count: 0,
        of: 0,
        first_times_s: Vec::new(),
        text,
        policy: Policy::Report,
    }
}
