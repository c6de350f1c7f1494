//! Input of the method from a problem: requirements and samples. Sec. II.B for option 2: relative velocity from an
//! accelerometer or velocity increments. The sum from the first sample is the velocity of the base origin in N up to a
//! constant, which option 2 eliminates. The error of each interval remains in all later samples.

use super::Variant;
use super::arm::Raw;
use super::equations::Given;
use crate::method::Named;
use poinsot_files::{Faults, Place};
use poinsot_identify::{Problem, Segment, SensorRecord, SensorSample, SensorValue};
use poinsot_model::{EstimateSet, MomentumKnowledge, SensorKind};
use poinsot_spatial::{Matrix3, Vector3};

/// Time differences below this are zero, s.
const SAME: f64 = 1.0e-9;

/// Velocity of the base origin in N up to a constant, m/s; `None` without a sample.
struct Relative {
    pub velocity: Vec<Option<Vector3>>,
    /// Error covariance per interval, in N, m2/s2.
    pub step: Matrix3,
}

/// Integrates the first accelerometer of the base; `None` without one.
fn relative(segment: &Segment) -> Option<Relative> {
    let kinds = [SensorKind::Accelerometer, SensorKind::VelocityIncrement];
    let own = |r: &&SensorRecord| kinds.contains(&r.kind) && r.body == 0 && r.samples.len() > 1;
    let instrument = segment.observations.sensors.iter().find(own)?;
    let s = &segment.samples;
    // Sample at each grid time.
    let grid = segment.observations.time_s.iter();
    let samples: Vec<Option<usize>> = grid.map(|t| at(&s.time_s, *t)).collect();
    let sample = |grid: usize| samples.get(grid).copied().flatten();
    let mut velocity = vec![None; s.time_s.len()];
    let mut sum = Vector3::zeros();
    let mut last: Option<usize> = None;
    let mut set = |k: usize, sum: &Vector3| {
        // Lever arm from the sensor to the base origin.
        let arm = s.R_NB[k] * s.w_NB_B[k].cross(&instrument.p_BoS_B);
        velocity[k] = Some(sum - arm);
    };
    let mut longest: f64 = 0.0;
    let mut before = instrument.samples.first()?;
    for reading in &instrument.samples {
        let increment = instrument.kind == SensorKind::VelocityIncrement;
        let from = if increment { reading.from } else { before.to };
        let (Some(start), Some(end)) = (sample(from), sample(reading.to)) else {
            break;
        };
        // After a gap the constant is different.
        if last.is_some_and(|l| l != start) {
            break;
        }
        if last.is_none() {
            set(start, &sum);
        }
        if start != end {
            let dt = s.time_s[end] - s.time_s[start];
            sum += match increment {
                true => vector(reading),
                // The specific force by the trapezoid rule.
                false => {
                    let ends = s.R_NB[start] * vector(before) + s.R_NB[end] * vector(reading);
                    ends * (0.5 * dt)
                }
            };
            set(end, &sum);
            longest = longest.max(dt);
        }
        (before, last) = (reading, Some(end));
    }
    let step = match instrument.kind {
        SensorKind::VelocityIncrement => instrument.covariance,
        _ => instrument.covariance * (longest * longest),
    };
    Some(Relative { velocity, step })
}

fn vector(sample: &SensorSample) -> Vector3 {
    match sample.value {
        SensorValue::Vector(x) => x,
        SensorValue::Attitude(_) | SensorValue::Direction { .. } => Vector3::zeros(),
    }
}

/// Index of the sample at a time.
fn at(times: &[f64], t: f64) -> Option<usize> {
    let k = times.partition_point(|own| *own < t - SAME);
    let same = times.get(k).is_some_and(|own| (own - t).abs() <= SAME);
    same.then_some(k)
}

/// The momentum that the variant takes as known, or why the method cannot be applied.
pub(super) fn check(problem: &Problem, variant: Variant) -> Result<Given, Faults> {
    let model = problem.model;
    if let Some(body) = model.bodies.iter().skip(1).find(|b| b.estimate.any()) {
        let place = Place::item("body", &body.name);
        let what = "estimate: ma2008 needs every body but the base known";
        let advice = "take estimate out of it, or use --method auto";
        return Err(Faults::one("E0521", place, what, advice));
    }
    let base = model.bodies.first().map(|b| (b.name.as_str(), b.estimate));
    let (base, asked) = base.unwrap_or_default();
    if asked != EstimateSet::ALL {
        let place = Place::item("body", base);
        let what = "estimate: ma2008 identifies mass, mass centre and inertia of the base together";
        let advice = "write estimate = true, or use --method auto";
        return Err(Faults::one("E0522", place, what, advice));
    }
    let arm: f64 = model.bodies.iter().skip(1).map(|b| b.nominal.mass).sum();
    if arm.is_nan() || arm <= 0.0 {
        let place = Place::default().key("model");
        let what = format!(
            "the bodies beyond the base '{base}' have no mass: ma2008 needs an arm of known mass"
        );
        let advice = "describe it, or use --method auto";
        return Err(Faults::one("E0523", place, what, advice));
    }
    if let Some(wheel) = model.wheels.iter().find(|w| w.estimate) {
        let place = Place::item("wheel", &wheel.name);
        let what = "estimate: ma2008 needs its spin inertia known";
        let advice = "take estimate out of it, or use --method auto";
        return Err(Faults::one("E0527", place, what, advice));
    }
    let needed = match variant {
        Variant::KnownMomentum => 2,
        Variant::UnknownMomentum => 3,
    };
    for segment in problem.segments {
        let place = Place::item("segment", &segment.label);
        let samples = segment.samples.time_s.len();
        if !segment.firings.is_empty() {
            let what = "a thruster fires: ma2008 assumes that momentum is conserved";
            let advice = "cut the firing out, or use --method auto";
            return Err(Faults::one("E0526", place, what, advice));
        }
        if samples < needed {
            let variant = variant.name();
            let what = format!(
                "{samples} samples: variant {variant} needs at least {needed} for four unknowns"
            );
            let advice = "add samples at other arm configurations";
            return Err(Faults::one("E0528", place, what, advice));
        }
    }
    if variant == Variant::UnknownMomentum {
        return Ok(Given::default());
    }
    let pick = |k: MomentumKnowledge| match k {
        MomentumKnowledge::Known(value) => Some(value),
        MomentumKnowledge::Estimate => None,
    };
    let given = Given {
        p_C_N: pick(model.momentum.linear),
        h_C_N: pick(model.momentum.angular),
    };
    match given == Given::default() {
        true => Err(Faults::one(
            "E0524",
            Place::default(),
            "[momentum] linear_N_s and angular_N_m_s are both \"estimate\": variant known-momentum needs one of them or both in N (N s; N m s about the system mass centre at the first sample)",
            "give it, or use --variant unknown-momentum",
        )),
        false => Ok(given),
    }
}

/// Samples of a segment, and the covariance per interval if velocity is summed from increments.
pub(super) fn raws(
    problem: &Problem,
    segment: &Segment,
    given: &Given,
) -> Result<(Vec<Raw>, Option<Matrix3>), Faults> {
    let s = &segment.samples;
    let summed = match (&s.translation, given.p_C_N) {
        (None, None) => relative(segment),
        _ => None,
    };
    let velocity = |k: usize| match (&s.translation, &summed) {
        (Some(t), _) => Some(t.v_NBo_N[k]),
        (None, Some(relative)) => relative.velocity[k],
        (None, None) => None,
    };
    let (dof, wheels) = (problem.tree.dof(), problem.tree.rotors.len());
    let row = |list: &[f64], k: usize, n: usize| list[k * n..(k + 1) * n].to_vec();
    let raws: Vec<Raw> = (0..s.time_s.len())
        .filter_map(|k| {
            Some(Raw {
                R_NB: s.R_NB[k],
                v_NBo_N: velocity(k)?,
                w_NB_B: s.w_NB_B[k],
                q: row(&s.joint_position, k, dof),
                rates: row(&s.joint_rate, k, dof),
                wheel_speed: row(&s.wheel_speed, k, wheels),
            })
        })
        .collect();
    if raws.len() < 2 {
        return Err(no_velocity(segment));
    }
    Ok((raws, summed.map(|r| r.step)))
}

pub(super) fn no_velocity(segment: &Segment) -> Faults {
    let place = Place::item("segment", &segment.label);
    let what = "no velocity channel (v_x v_y v_z): ma2008 needs it for step 1";
    let advice = "add it, or velocity increments (dv_x dv_y dv_z) for variant unknown-momentum, or use --method maximum_likelihood";
    Faults::one("E0525", place, what, advice)
}
