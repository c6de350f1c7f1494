//! Unit errors that telemetry alone does not contradict: detected by the size of the result, or by a fit in another
//! unit.

use crate::bind::{RELATIVE_ACCURACY, solve};
use crate::channel_names::XYZ;
use poinsot_identify::{Estimate, Problem, Settings, Status, maximum_likelihood_with};
use poinsot_model::Model;
use poinsot_telemetry::checks::{Check, Finding, Policy};
use poinsot_telemetry::{Change, Channel, Repair, Table, median_step};
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
/// Chi-square per degree of freedom below which a record fits.
const FITS: f64 = 10.0;
/// Largest residual chi-square relative to that of the rates themselves.
const UNEXPLAINED: f64 = 0.01;
/// Rotation per sample, rad, above which a fit takes minutes.
const FAR: f64 = 0.3;
/// Gyro samples of the part that is fitted as it was read.
const SHORT: usize = 100;
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

/// What makes a record turn far between samples: what puts it right, the channels, and the mistake.
const FAST: [(Change, &str, &str); 3] = [
    (
        Change::Clock(1.0e-3),
        "time_s",
        "the times are probably in ms, not s",
    ),
    (
        Change::Factor(PI / 180.0),
        "omega",
        "the body rates are probably in deg/s, not rad/s",
    ),
    (
        Change::Factor(PI / 30.0),
        "omega",
        "the body rates are probably in rpm, not rad/s",
    ),
];

/// Detects units of a record without attitude that turns far between samples, and fits in another unit. Tested before the fit,
/// which would take minutes.
pub(crate) fn of_fast_record(model: &Model, tables: &[Table]) -> Option<Finding> {
    let turn = turn_per_reading(tables);
    let mut channels = tables.iter().flat_map(|t| &t.channels);
    if turn < FAR || channels.any(|c| c.name == "q_w") {
        return None;
    }
    let put_right = |change: Change| {
        let mut all = tables.to_vec();
        for channel in all.iter_mut().flat_map(|t| &mut t.channels) {
            match change {
                Change::Clock(x) => {
                    channel.time_s = channel.time_s.iter().map(|t| t * x).collect();
                }
                Change::Factor(x) if channel.name.starts_with("omega_") => {
                    channel.values.iter_mut().for_each(|w| *w *= x);
                }
                _ => {}
            }
        }
        all
    };
    let right = |row: &&(Change, _, _)| {
        let fit = fit(model, &put_right(row.0));
        fit.is_some_and(|fit| fit.explains && fit.answers)
    };
    let (change, channel, words) = FAST.iter().find(right)?;
    let scaled = matches!(change, Change::Factor(_));
    if scaled && fit(model, &liveliest(tables)).is_some_and(|fit| fit.explains) {
        // Read as it is, it fits too: a spin about one axis fits with any factor of its rate.
        return None;
    }
    let text = format!("the vehicle turns by {turn:.1} rad between samples; {words}");
    let channels = XYZ.map(|k| format!("omega_{k}")).to_vec();
    Some(Finding {
        repair: Some(Repair {
            channels,
            change: *change,
        }),
        ..finding(Check::Units, channel, text)
    })
}

/// The part of all tables in which the rates change most.
fn liveliest(tables: &[Table]) -> Vec<Table> {
    let mut all = tables.to_vec();
    for table in &mut all {
        let rates = || {
            let all = table.channels.iter();
            all.filter(|c| c.name.starts_with("omega_"))
        };
        let Some(times) = rates().next().map(|c| c.time_s.clone()) else {
            continue;
        };
        let range = |from: usize, c: &Channel| {
            let part = c.values.iter().skip(from).take(SHORT);
            let (least, most) = part.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(*x), b.max(*x))
            });
            most - least
        };
        let change = |from: &usize| rates().map(|c| range(*from, c)).sum::<f64>();
        let starts = (0..times.len()).step_by(SHORT / 2);
        let from = starts.max_by(|a, b| change(a).total_cmp(&change(b)));
        let from = from.unwrap_or(0).min(times.len().saturating_sub(SHORT));
        let end = times.get(from + SHORT).or(times.last()).copied();
        let (start, end) = (times.get(from).copied(), end);
        for channel in &mut table.channels {
            let place = |t: Option<f64>| channel.time_s.partition_point(|own| Some(*own) < t);
            let part = place(start)..place(end);
            channel.values = channel.values.get(part.clone()).unwrap_or(&[]).to_vec();
            channel.time_s = channel.time_s[part].into();
        }
    }
    all
}

/// Typical rotation between gyro samples, rad; the largest of all tables.
fn turn_per_reading(tables: &[Table]) -> f64 {
    let of = |table: &Table| {
        let all = table.channels.iter();
        let rates = all.filter(|c| c.name.starts_with("omega_"));
        let square = |c: &Channel| {
            let sum: f64 = c.values.iter().map(|w| w * w).sum();
            sum / c.values.len().max(1) as f64
        };
        let step = rates.clone().find_map(|c| median_step(&c.time_s));
        rates.map(square).sum::<f64>().sqrt() * step.unwrap_or(0.0)
    };
    tables.iter().map(of).fold(0.0, f64::max)
}

/// A fit to tables.
struct Fit {
    /// Chi-square is small, also compared with that of the rates themselves: rates below the declared noise fit any model.
    explains: bool,
    /// A number is determined.
    answers: bool,
}

/// The fit to these tables; `None` if the problem is invalid.
fn fit(model: &Model, tables: &[Table]) -> Option<Fit> {
    let settings = Settings {
        undiagnosed: true,
        ..Settings::default()
    };
    let asked = |problem: &Problem| {
        let found = maximum_likelihood_with(problem, settings)?;
        let answered = matches!(found.status, Status::Converged | Status::Partial);
        let mut asked = found.bodies.iter().filter(|b| b.asked);
        let determined = asked.any(|b| b.inertia.iter().any(|n| n.value.is_some()));
        let left = found.fit.iter().map(|f| f.chi2_per_dof);
        let left = left.fold(0.0, f64::max);
        let rates = rates_over_noise(problem);
        let explained = rates.is_some_and(|rates| left < UNEXPLAINED * rates);
        let ended = !matches!(found.status, Status::IterationLimit | Status::Rejected);
        Ok(Fit {
            explains: ended && left < FITS && explained,
            answers: answered && determined,
        })
    };
    solve(model, tables, RELATIVE_ACCURACY, asked).ok()
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
        repair: None,
    }
}
