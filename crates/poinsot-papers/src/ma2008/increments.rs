//! Relative velocity from an accelerometer or velocity increments, as in Sec. II.B for option 2.
//!
//! The sum from the first sample is the velocity of the base origin in N up to a constant, which option 2 eliminates.
//! The error of each interval remains in all later samples.

use poinsot_identify::{Segment, SensorRecord, SensorSample, SensorValue};
use poinsot_model::SensorKind;
use poinsot_spatial::{Matrix3, Vector3};

/// Time differences below this are zero, s.
const SAME: f64 = 1.0e-9;

/// Velocity of the base origin in N up to a constant, m/s; `None` without a sample.
pub(super) struct Relative {
    pub velocity: Vec<Option<Vector3>>,
    /// Error covariance per interval, in N, m2/s2.
    pub step: Matrix3,
}

/// Integrates the first accelerometer of the base; `None` without one.
pub(super) fn relative(segment: &Segment) -> Option<Relative> {
    let kinds = [SensorKind::Accelerometer, SensorKind::VelocityIncrement];
    let own = |r: &&SensorRecord| kinds.contains(&r.kind) && r.body == 0 && r.samples.len() > 1;
    let instrument = segment.observations.sensors.iter().find(own)?;
    let s = &segment.samples;
    // Sample at each grid time.
    let samples: Vec<Option<usize>> = segment
        .observations
        .time_s
        .iter()
        .map(|t| at(&s.time_s, *t))
        .collect();
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
    for pair in std::iter::once(None)
        .chain(instrument.samples.iter().map(Some))
        .zip(&instrument.samples)
    {
        let (before, reading) = pair;
        let (from, change) = match instrument.kind {
            SensorKind::VelocityIncrement => (reading.from, Some(vector(reading))),
            _ => (
                before.map_or(reading.to, |b| b.to),
                before.and_then(|b| trapezoid(segment, &sample, b, reading)),
            ),
        };
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
            let Some(change) = change else { break };
            sum += change;
            set(end, &sum);
            longest = longest.max(s.time_s[end] - s.time_s[start]);
        }
        last = Some(end);
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
    times
        .get(k)
        .filter(|own| (*own - t).abs() <= SAME)
        .map(|_| k)
}

/// Integral of the specific force over one interval, in N, by the trapezoid rule.
fn trapezoid(
    segment: &Segment,
    sample: &impl Fn(usize) -> Option<usize>,
    before: &SensorSample,
    now: &SensorSample,
) -> Option<Vector3> {
    let (a, b) = (sample(before.to)?, sample(now.to)?);
    let s = &segment.samples;
    let dt = s.time_s[b] - s.time_s[a];
    Some((s.R_NB[a] * vector(before) + s.R_NB[b] * vector(now)) * (0.5 * dt))
}
