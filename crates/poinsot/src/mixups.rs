//! Mistakes in telemetry that show only against the model: units by the size of the answer, signs of wheels by
//! the residual of momentum. Nothing is applied; what is found is said.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use poinsot_identify::{Estimate, Problem, Segment, Status, maximum_likelihood};
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
    (
        2.0 * PI,
        "wheel speeds in rad/s that are mapped as turns per second",
    ),
    (
        0.5 / PI,
        "wheel speeds in turns per second that are read as rad/s",
    ),
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
/// How far the mean factor may be off, relative.
const MEAN: f64 = 0.15;
/// How far the factor of one axis may be off the mean, relative.
const SPREAD: f64 = 0.4;
/// How much smaller chi-square must become.
const DECISIVE: f64 = 10.0;
/// Samples of a segment that are used.
const MOST: usize = 2000;

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

/// Wheels whose speed fits the momentum far better with another sign, scale or axis. Candidates are ranked by
/// the momentum of one rigid body; the best two must then explain the misfit of the fit itself.
pub(crate) fn wheels(problem: &Problem, estimate: &Estimate) -> Vec<Finding> {
    let now = misfit(estimate);
    let segments: Vec<Segment> = problem.segments.iter().map(shortened).collect();
    let mut ranked: Vec<(f64, String, String, Map)> = candidates(problem.model)
        .into_iter()
        .filter_map(|(what, channel, map)| {
            Some((
                momentum_residual(problem.model, &segments, &map)?,
                what,
                channel,
                map,
            ))
        })
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, what, channel, map) in ranked.into_iter().take(2) {
        let changed: Vec<Segment> = segments.iter().map(|s| mapped(s, &map)).collect();
        let Ok(then) = maximum_likelihood(&Problem {
            segments: &changed,
            ..*problem
        }) else {
            continue;
        };
        let possible =
            (then.bodies.iter()).all(|b| !b.asked || b.physically_consistent != Some(false));
        if possible && then.status != Status::Rejected && misfit(&then) * DECISIVE < now {
            let text = format!(
                "{what} chi-square per degree of freedom falls from {now:.1} to {:.2}; check the column and the axis in the model (not applied)",
                misfit(&then)
            );
            return vec![finding(Check::WheelSign, &channel, text)];
        }
    }
    Vec::new()
}

/// Chi-square per degree of freedom over all segments.
fn misfit(estimate: &Estimate) -> f64 {
    let (sum, n) = estimate.fit.iter().fold((0.0, 0.0), |(sum, n), f| {
        let samples = f.samples as f64;
        (sum + f.chi2_per_dof * samples, n + samples)
    });
    sum / n
}

/// Root mean square of `I w + h_wheels - R^T H` with the best inertia and momentum: what one rigid body leaves of
/// conservation. `None` where the motion does not determine them or the inertia is no possible one.
fn momentum_residual(model: &Model, segments: &[Segment], map: &Map) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for segment in segments {
        let s = &segment.samples;
        let mut normal = SMatrix::<f64, 9, 9>::zeros();
        let mut right = SVector::<f64, 9>::zeros();
        let mut square = 0.0;
        for (k, (w, R)) in s.w_NB_B.iter().zip(&s.R_NB).enumerate() {
            let row = s.wheel_speed.get(k * map.len()..(k + 1) * map.len())?;
            let mut h = Vector3::zeros();
            for (wheel, (from, factor)) in model.wheels.iter().zip(map) {
                h += wheel.axis_B * (wheel.spin_inertia * factor * row.get(*from)?);
            }
            let to_body = R.inverse().to_rotation_matrix();
            let mut rows = SMatrix::<f64, 3, 9>::zeros();
            rows.fixed_view_mut::<3, 6>(0, 0)
                .copy_from(&SMatrix::<f64, 3, 6>::new(
                    w.x, w.y, w.z, 0.0, 0.0, 0.0, 0.0, w.x, 0.0, w.y, w.z, 0.0, 0.0, 0.0, w.x, 0.0,
                    w.y, w.z,
                ));
            rows.fixed_view_mut::<3, 3>(0, 6)
                .copy_from(&(-to_body.matrix()));
            normal += rows.transpose() * rows;
            right -= rows.transpose() * h;
            square += h.norm_squared();
        }
        // Columns to unit length: rates are small, rotations are not.
        let scale = SVector::<f64, 9>::from_fn(|i, _| normal[(i, i)].sqrt().recip());
        if !scale.iter().all(|x| x.is_finite()) {
            return None;
        }
        let scaled = SMatrix::<f64, 9, 9>::from_fn(|i, j| normal[(i, j)] * scale[i] * scale[j]);
        let x = scaled
            .cholesky()?
            .solve(&right.component_mul(&scale))
            .component_mul(&scale);
        let inertia = Matrix3::new(x[0], x[1], x[2], x[1], x[3], x[4], x[2], x[4], x[5]);
        if inertia.symmetric_eigenvalues().min() <= 0.0 {
            return None;
        }
        sum += (square - x.dot(&right)).max(0.0);
        count += s.w_NB_B.len() as f64;
    }
    (count > 0.0).then(|| (sum / count).sqrt())
}

/// For each wheel after the change: which wheel's column it takes, times what.
type Map = Vec<(usize, f64)>;

fn candidates(model: &Model) -> Vec<(String, String, Map)> {
    let n = model.wheels.len();
    let same: Map = (0..n).map(|k| (k, 1.0)).collect();
    let column = |k: usize| {
        format!(
            "{}_rad_s",
            model.wheels.get(k).map_or("", |w| w.name.as_str())
        )
    };
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
        all.push((
            format!("with the sign of {} turned", names.join(", ")),
            names.join(","),
            map,
        ));
    }
    for k in 0..n {
        for (factor, unit) in [
            (PI / 30.0, "rpm"),
            (PI / 180.0, "deg/s"),
            (2.0 * PI, "turns per second"),
        ] {
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
    let end = s.time_s.last().copied().unwrap_or_default();
    let o = &mut short.observations;
    let grid = o.time_s.len();
    let kept = o.time_s.partition_point(|t| *t <= end);
    let rows = |values: &mut Vec<f64>| values.truncate(values.len() / grid.max(1) * kept);
    rows(&mut o.joint_position);
    rows(&mut o.joint_rate);
    rows(&mut o.wheel_speed);
    o.time_s.truncate(kept);
    o.rate.truncate(kept);
    o.attitude.truncate(kept);
    o.velocity.truncate(kept);
    o.position.truncate(kept);
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
