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
