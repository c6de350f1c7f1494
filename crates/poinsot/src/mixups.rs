//! Unit errors that telemetry alone does not contradict: detected by the size of the result, or by a fit in another
//! unit.

use crate::bind::{RELATIVE_ACCURACY, solve};
use crate::channel_names::XYZ;
use poinsot_identify::{
    BodyEstimate, Estimate, Problem, Settings, Status, maximum_likelihood_with,
};
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::checks::{Check, Finding};
use poinsot_telemetry::{
    Change, Channel, Repair, Table, UNIT_FACTORS, median_step, parse_unit, unit_mistake,
};

/// Ratios of estimated to nominal inertia caused by units of mass and length.
const FACTORS: [(f64, &str); 4] = [
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
/// Places of xx, yy, zz among the elements of the inertia.
const MOMENTS: [usize; 3] = [0, 2, 5];
/// Largest residual chi-square relative to that of the rates themselves.
const UNEXPLAINED: f64 = 0.01;
/// Rotation per sample, rad, above which a fit of another unit takes minutes, and of the beginning that tells whether the declared
/// one fits.
const FAR: f64 = 0.3;
const BEGINNING: f64 = 100.0;
/// Rotation per sample, rad, from which an attitude is not integrated from a gyro.
const FOLLOWED: f64 = 1.0;
/// Tolerance of the mean factor, relative.
const MEAN: f64 = 0.15;
/// Tolerance of the factor of one axis about the mean, relative.
const SPREAD: f64 = 0.4;

/// Detects a unit error from the ratio of estimated to nominal inertia.
pub(crate) fn units(model: &Model, estimate: &Estimate) -> Vec<Finding> {
    if estimate.status == Status::Rejected {
        return Vec::new();
    }
    let mut all = Vec::new();
    for body in estimate.bodies.iter().filter(|b| b.asked) {
        let [Some(x), Some(y), Some(z)] = MOMENTS.map(|k| factor(body, k)) else {
            continue;
        };
        let mean = (x + y + z) / 3.0;
        let even = [x, y, z].iter().all(|l| (l - mean).abs() < SPREAD);
        let mut known =
            of_rates(model, estimate).chain(FACTORS.map(|(x, words)| (x, words.to_owned())));
        let near = known.find(|(f, _)| (mean - f.ln()).abs() < MEAN);
        let Some((x, words)) = near.filter(|_| even) else {
            continue;
        };
        let text = format!(
            "the data fit {:.3} times the nominal inertia about every axis; possible cause: {words}",
            mean.exp()
        );
        let mut found = Finding::new(Check::Units, &body.name, 0, Vec::new(), text);
        // Wheels would tell the unit of forces.
        let forces = [1.0e3, 1.0e-3].contains(&x) && model.wheels.is_empty();
        let thrusters = model.thrusters.iter().filter(|_| forces);
        let channels: Vec<String> = thrusters.map(|t| format!("{}_N", t.name)).collect();
        let change = Change::Factor(1.0 / x);
        found.repair = (!channels.is_empty()).then_some(Repair { channels, change });
        all.push(found);
    }
    all
}

/// Ratios of estimated to nominal inertia caused by the unit of the wheels, or of body rates that no attitude tells.
fn of_rates(model: &Model, estimate: &Estimate) -> impl Iterator<Item = (f64, String)> {
    let wheels = !model.wheels.is_empty();
    let mut read = estimate.fit.iter().flat_map(|f| &f.channels);
    let rates = !read.any(|c| c.name.starts_with(SensorKind::Attitude.word()));
    let factors = UNIT_FACTORS[..3].iter().flat_map(|x| [*x, 1.0 / x]);
    factors.filter_map(move |x| {
        let of = |is: bool, what: &str, factor: f64| {
            let mistake = unit_mistake("rad/s", factor).filter(|_| is);
            mistake.map(|words| format!("{what} in {words}"))
        };
        let causes = [
            of(wheels, "wheel speeds", 1.0 / x),
            of(rates, "body rates", x),
        ];
        let causes: Vec<String> = causes.into_iter().flatten().collect();
        (!causes.is_empty()).then(|| (x, causes.join(", or ")))
    })
}

/// Logarithm of an estimated moment of inertia over the nominal one.
fn factor(body: &BodyEstimate, k: usize) -> Option<f64> {
    let n = body.inertia.get(k)?;
    let ratio = n.value? / n.nominal;
    (ratio > 0.0 && ratio.is_finite()).then(|| ratio.ln())
}

/// What makes a record turn far between samples.
const FAST: [Change; 3] = [
    Change::Clock(1.0e-3),
    Change::Factor(UNIT_FACTORS[0]),
    Change::Factor(UNIT_FACTORS[1]),
];

/// Detects units of a record without attitude that turns far between samples, and whose beginning fits in another unit but not as it
/// is declared; no gyro follows a turn of a radian between samples. Tested before the fit, which would take minutes.
pub(crate) fn of_fast_record(model: &Model, tables: &[Table]) -> Option<Finding> {
    let turn = turn_per_reading(tables);
    if turn < FAR || tables.iter().any(|t| t.channel("q_w").is_some()) {
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
    let off = |change: Change| {
        let right = put_right(change);
        // Most are wrong from the beginning.
        explained(model, &beginning(&right, BEGINNING))?;
        let off = explained(model, &right).filter(|off| off.is_finite())?;
        let nearest = !matches!(change, Change::Factor(x) if off > 0.5 * x.ln().abs());
        nearest.then_some((off, change))
    };
    let mut fits = FAST.into_iter().filter_map(off);
    let mut best = fits.next()?;
    // What leads to the nominal numbers is right: the others may take minutes.
    while best.0 > MEAN
        && let Some(next) = fits.next()
    {
        best = if next.0 < best.0 { next } else { best };
    }
    let (_, change) = best;
    let followed =
        turn < FOLLOWED && explained(model, &beginning(tables, BEGINNING / turn)).is_some();
    if followed {
        return None;
    }
    let (channel, what, si, x) = match change {
        Change::Clock(x) => ("time_s", "times", "s", x),
        Change::Factor(x) => ("omega", "body rates", "rad/s", x),
        _ => return None,
    };
    let unit = parse_unit(si).ok()?.times(x)?.symbol;
    let text = format!(
        "the vehicle turns by {turn:.1} rad between samples; the {what} are probably in {unit}, not {si}"
    );
    let mut found = Finding::new(Check::Units, channel, 0, Vec::new(), text);
    let channels = XYZ.map(|k| format!("omega_{k}")).to_vec();
    found.repair = Some(Repair { channels, change });
    Some(found)
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

/// The first samples of tables, by the longest step between readings.
fn beginning(tables: &[Table], samples: f64) -> Vec<Table> {
    let mut all = tables.to_vec();
    for table in &mut all {
        let steps = table.channels.iter().filter_map(|c| median_step(&c.time_s));
        let length_s = samples * steps.fold(0.0, f64::max);
        for c in &mut table.channels {
            let from = c.time_s.first().copied().unwrap_or_default();
            let count = c.time_s.partition_point(|t| *t <= from + length_s);
            c.time_s = c.time_s[..count].into();
            c.values.truncate(count);
        }
    }
    all
}

/// How far the moments of inertia of a fit are from the nominal ones, as the largest logarithm of their ratio: a spin about one axis
/// fits with any factor of its rate, and its moment tells which. Infinite where none is determined; `None` where the fit does not
/// explain its tables: chi-square is not small, also compared with that of the rates themselves, as rates below the declared noise
/// fit any model.
fn explained(model: &Model, tables: &[Table]) -> Option<f64> {
    let settings = Settings {
        undiagnosed: true,
        ..Settings::default()
    };
    let asked = |problem: &Problem| {
        let found = maximum_likelihood_with(problem, settings)?;
        let answered = matches!(found.status, Status::Converged | Status::Partial);
        let left = found.fit.iter().map(|f| f.chi2_per_dof);
        let left = left.reduce(f64::max).unwrap_or(f64::INFINITY);
        let explains = rates_over_noise(problem).is_some_and(|rates| left < UNEXPLAINED * rates);
        let asked = found.bodies.iter().filter(|b| b.asked);
        let moments = asked.flat_map(|b| MOMENTS.map(|k| factor(b, k)));
        let off = moments.flatten().map(f64::abs).reduce(f64::max);
        let off = off.filter(|_| answered).unwrap_or(f64::INFINITY);
        Ok((explains && left < settings.rejection).then_some(off))
    };
    solve(model, tables, RELATIVE_ACCURACY, asked).ok()?
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
