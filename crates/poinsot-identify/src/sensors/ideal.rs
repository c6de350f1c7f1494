//! Ideal measurements before and after, for a lag.

use super::{ideal_measurement, vector};
use crate::motion::{Motion, State};
use crate::motion::{Vehicle, parabola_slope};
use crate::problem::segment::Segment;
use poinsot_spatial::Vector3;

/// Ideal measurements at all grid times, one series per sensor; empty if not requested.
#[derive(Default)]
pub(crate) struct IdealSeries {
    series: Vec<Vec<Vector3>>,
}

impl IdealSeries {
    /// Propagates the motion for the selected sensors, one entry per sensor of the segment. `None` where the vehicle
    /// cannot move.
    pub fn new(
        vehicle: &Vehicle,
        segment: &Segment,
        start: &State,
        wanted: &[bool],
    ) -> Option<Self> {
        let o = &segment.observations;
        let mut series = vec![Vec::new(); o.sensors.len()];
        let mut wanted = wanted.to_vec();
        let mut motion = Motion::new(vehicle, segment, Vec::new(), 0);
        let mut state = *start;
        for k in 0..o.time_s.len() {
            if !wanted.contains(&true) {
                break;
            }
            let (instant, _) = motion.velocity(&state, k)?;
            let all = o.sensors.iter().zip(&mut series).zip(&mut wanted);
            for ((record, series), wanted) in all.filter(|(_, wanted)| **wanted) {
                // The state determines most rates: no series is needed.
                match ideal_measurement(record, &mut motion, (&state, k), &instant) {
                    Some((value, None)) => series.push(vector(&value)),
                    _ => *wanted = false,
                }
            }
            state = motion.advance(&state, k)?;
        }
        Some(Self { series })
    }

    /// Slope over time of a sensor's series at grid time k; zero without a series.
    pub fn rate(&self, sensor: usize, t: &[f64], k: usize) -> Vector3 {
        match self.series.get(sensor) {
            Some(series) if series.len() >= 2 && series.len() == t.len() => {
                Vector3::from_fn(|axis, _| parabola_slope(t, |i| series[i][axis], k))
            }
            _ => Vector3::zeros(),
        }
    }
}
