//! Curves of the instruments at points of bodies.

use super::{PredictedChannel, Sieve, channel, three};
use crate::likelihood::perfect;
use crate::motion::{Instant, Motion, State};
use crate::parameters::Parameters;
use crate::point_sensor::{InstrumentErrors, PointKind, PointReadings};
use crate::segment::Segment;
use poinsot_spatial::Vector3;

/// One instrument in the course of a segment.
struct One {
    errors: InstrumentErrors,
    next: usize,
    sieve: Sieve,
    /// What a perfect instrument read at the grid time before, for the lag; of an increment the velocity.
    before: Option<(f64, Vector3)>,
    /// Grid time, velocity and acceleration where the interval in hand began.
    began: Option<(usize, Vector3, Vector3)>,
}

/// Measured and predicted readings of all instruments of a segment, in the order of the segment.
pub(super) struct PointCurves<'a> {
    points: &'a [PointReadings],
    all: Vec<One>,
    pub channels: Vec<PredictedChannel>,
}

impl<'a> PointCurves<'a> {
    pub fn new(segment: &'a Segment, parameters: &Parameters, x: &[f64], points: usize) -> Self {
        let list = &segment.observations.points;
        Self {
            points: list,
            all: list
                .iter()
                .map(|p| One {
                    errors: InstrumentErrors::of(parameters, x, p.sensor),
                    next: 0,
                    sieve: Sieve::new(p.readings.len(), points),
                    before: None,
                    began: None,
                })
                .collect(),
            channels: list
                .iter()
                .map(|p| {
                    let mut c = match p.kind {
                        PointKind::SpecificForce => {
                            channel("accelerometer", ["m/s2"; 2], &["acc_x", "acc_y", "acc_z"])
                        }
                        PointKind::VelocityIncrement => {
                            channel("velocity_increment", ["m/s"; 2], &["dv_x", "dv_y", "dv_z"])
                        }
                    };
                    c.samples = p.readings.len();
                    c
                })
                .collect(),
        }
    }

    /// The readings at grid time k.
    pub fn sample(
        &mut self,
        motion: &mut Motion,
        state: &State,
        instant: &Instant,
        (t, k): (f64, usize),
    ) {
        for ((one, p), curve) in self.all.iter_mut().zip(self.points).zip(&mut self.channels) {
            let now = perfect(motion, state, instant, p, k);
            let rate = match one.before.replace((t, now)) {
                Some((earlier, x)) if t > earlier => (now - x) / (t - earlier),
                _ => Vector3::zeros(),
            };
            let Some(reading) = p.readings.get(one.next) else {
                continue;
            };
            if reading.to == k {
                let began = one.began.filter(|(from, _, _)| *from == reading.from);
                let expected = match (p.kind, began) {
                    (PointKind::SpecificForce, _) => Some(one.errors.reading(&now, &rate)),
                    (PointKind::VelocityIncrement, Some((_, v, a))) => {
                        Some(one.errors.reading(&(now - v), &(rate - a)))
                    }
                    (PointKind::VelocityIncrement, None) => None,
                };
                if let Some(expected) = expected.filter(|_| one.sieve.keeps()) {
                    let residual = reading.value - expected;
                    curve.push(t, &three(&reading.value), &three(&expected), &residual);
                }
                one.next += 1;
            }
            if p.readings.get(one.next).is_some_and(|r| r.from == k) {
                one.began = Some((k, now, rate));
            }
        }
    }
}
