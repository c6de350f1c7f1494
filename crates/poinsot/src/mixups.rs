//! Mixed-up units that nothing in the telemetry contradicts: they show by the size of the answer.

use poinsot_identify::{Estimate, Status};
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
