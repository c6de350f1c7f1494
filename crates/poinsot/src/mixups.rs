//! Mistakes in telemetry that show only against the model: units by the size of the answer, signs of wheels by
//! the residual of momentum. Nothing is applied; what is found is said.

use poinsot_dynamics::Tree;
use poinsot_identify::{Estimate, Noise, Problem, Segment, Status, linear};
use poinsot_model::Model;
use poinsot_telemetry::checks::{Check, Finding, Policy};
use std::f64::consts::PI;

/// Factors between the estimated and the nominal inertia that mistaken units make, and which.
const FACTORS: [(f64, &str); 10] = [
    (30.0 / PI, "wheel speeds in rpm that are read as rad/s"),
    (PI / 30.0, "wheel speeds in rad/s that are mapped as rpm"),
    (
        180.0 / PI,
        "wheel speeds in deg/s that are read as rad/s, or body rates in rad/s that are mapped as deg/s",
    ),
    (PI / 180.0, "body rates in deg/s that are read as rad/s"),
    (2.0 * PI, "wheel speeds in rad/s that are mapped as turns per second"),
    (0.5 / PI, "wheel speeds in turns per second that are read as rad/s"),
    (1.0e3, "a factor of a thousand (g for kg, mN for N) in the model or the telemetry"),
    (1.0e-3, "a factor of a thousand (kg for g, N for mN) in the model or the telemetry"),
    (1.0e4, "kg cm2 for kg m2 in the model"),
    (1.0e-4, "kg m2 for kg cm2 in the model"),
];
/// How far the mean factor may be off, relative.
const MEAN: f64 = 0.15;
/// How far the factor of one axis may be off the mean, relative.
const SPREAD: f64 = 0.4;
/// How much smaller the residual of momentum must become, as a factor of chi-square.
const DECISIVE: f64 = 5.0;
/// Samples of a segment that are used.
const MOST: usize = 4000;

/// Inertia that is a telling factor off the nominal one about every axis.
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
        // xx, yy, zz in the order of the ten parameters.
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
                    "the data ask for {:.3} times the nominal inertia about every axis, as {words} would",
                    mean.exp()
                ),
            ));
        }
    }
    all
}

/// Wheels whose speed fits the momentum far better with another sign, scale or axis.
pub(crate) fn wheels(
    model: &Model,
    tree: &Tree,
    segments: &[Segment],
    noise: &Noise,
    relative_accuracy: f64,
) -> Vec<Finding> {
    let short: Vec<Segment> = segments.iter().map(shortened).collect();
    let residual = |segments: &[Segment]| {
        let problem = Problem {
            model,
            tree,
            segments,
            noise,
            relative_accuracy,
        };
        let estimate = linear(&problem).ok()?;
        let possible = estimate
            .bodies
            .iter()
            .all(|b| !b.asked || b.physically_consistent != Some(false));
        let (sum, n) = estimate.fit.iter().fold((0.0, 0.0), |(sum, n), f| {
            (sum + f.chi2_per_dof * f.samples as f64, n + f.samples as f64)
        });
        possible.then_some(sum / n)
    };
    let now = residual(&short).unwrap_or(f64::INFINITY);
    let mut best: Option<(f64, String, String)> = None;
    for (what, channel, map) in candidates(model) {
        let changed: Vec<Segment> = short.iter().map(|s| mapped(s, &map)).collect();
        let Some(then) = residual(&changed) else {
            continue;
        };
        if then * DECISIVE < now && best.as_ref().is_none_or(|b| then < 0.5 * b.0) {
            best = Some((then, what, channel));
        }
    }
    let Some((then, what, channel)) = best else {
        return Vec::new();
    };
    let before = if now.is_finite() {
        format!("falls from {:.1} to {:.1} times the noise", now.sqrt(), then.sqrt())
    } else {
        format!("is {:.1} times the noise, and the body a possible one", then.sqrt())
    };
    vec![finding(
        Check::WheelSign,
        &channel,
        format!("{what} the residual of momentum {before}; check the column and the axis in the model (not applied)"),
    )]
}

/// For each wheel after the change: which wheel's column it takes, times what.
type Map = Vec<(usize, f64)>;

fn candidates(model: &Model) -> Vec<(String, String, Map)> {
    let n = model.wheels.len();
    let same: Map = (0..n).map(|k| (k, 1.0)).collect();
    let column = |k: usize| format!("{}_rad_s", model.wheels.get(k).map_or("", |w| w.name.as_str()));
    let mut all = Vec::new();
    if n == 0 || n > 8 {
        return all;
    }
    let signs = (1..1_usize << n).filter(|s| s.count_ones() <= 2 || *s == (1 << n) - 1);
    for signs in signs {
        let which: Vec<usize> = (0..n).filter(|k| signs >> k & 1 == 1).collect();
        let mut map = same.clone();
        for (k, slot) in map.iter_mut().enumerate() {
            if signs >> k & 1 == 1 {
                slot.1 = -1.0;
            }
        }
        let names: Vec<String> = which.iter().map(|k| column(*k)).collect();
        all.push((format!("with the sign of {} turned", names.join(", ")), names.join(","), map));
    }
    for k in 0..n {
        for (factor, unit) in [(PI / 30.0, "rpm"), (PI / 180.0, "deg/s"), (2.0 * PI, "turns per second")] {
            let mut map = same.clone();
            if let Some(slot) = map.get_mut(k) {
                slot.1 = factor;
            }
            all.push((format!("with {} read as {unit}", column(k)), column(k), map));
        }
        for other in k + 1..n {
            let mut map = same.clone();
            map.swap(k, other);
            all.push((
                format!("with {} and {} exchanged", column(k), column(other)),
                format!("{},{}", column(k), column(other)),
                map,
            ));
        }
    }
    all
}

fn mapped(segment: &Segment, map: &Map) -> Segment {
    let mut changed = segment.clone();
    for rows in [
        &mut changed.samples.wheel_speed,
        &mut changed.observations.wheel_speed,
    ] {
        for row in rows.chunks_exact_mut(map.len()) {
            let old = row.to_vec();
            for (slot, (from, factor)) in row.iter_mut().zip(map) {
                *slot = factor * old.get(*from).copied().unwrap_or_default();
            }
        }
    }
    changed
}

/// The first samples of a segment: enough for a sign.
fn shortened(segment: &Segment) -> Segment {
    let n = segment.samples.time_s.len();
    let mut short = segment.clone();
    if n <= MOST {
        return short;
    }
    let s = &mut short.samples;
    let rows = |values: &mut Vec<f64>| values.truncate(values.len() / n * MOST);
    rows(&mut s.joint_position);
    rows(&mut s.joint_rate);
    rows(&mut s.wheel_speed);
    s.time_s.truncate(MOST);
    s.R_NB.truncate(MOST);
    s.w_NB_B.truncate(MOST);
    if let Some(t) = &mut s.translation {
        t.v_NBo_N.truncate(MOST);
        t.p_NoBo_N.truncate(MOST);
    }
    short
}

fn finding(check: Check, channel: &str, text: String) -> Finding {
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
