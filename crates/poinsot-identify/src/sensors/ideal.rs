//! Ideal measurements before and after, for a lag.

use super::{ideal_measurement, vector};
use crate::motion::{Motion, State};
use crate::motion::{Vehicle, parabola_slope};
use crate::problem::segment::Segment;
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;

/// Ideal measurements at all grid times, one series per sensor; empty if not requested.
#[derive(Default)]
pub(crate) struct IdealSeries {
    series: Vec<Vec<Vector3>>,
}

/// Whether the state determines the rate of change of a kind's measurement.
fn knows_rate(kind: SensorKind) -> bool {
    let of_pose = [
        SensorKind::Attitude,
        SensorKind::Position,
        SensorKind::Direction,
    ];
    kind.is_relative() || of_pose.contains(&kind)
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
        let asked =
            |(w, r): (&bool, &crate::problem::segment::SensorRecord)| *w && !knows_rate(r.kind);
        let wanted: Vec<bool> = wanted.iter().zip(&o.sensors).map(asked).collect();
        let mut series = vec![Vec::new(); o.sensors.len()];
        if !wanted.contains(&true) {
            return Some(Self { series });
        }
        let mut motion = Motion::new(vehicle, segment, Vec::new(), 0);
        let samples = o.time_s.len();
        let mut state = *start;
        for k in 0..samples {
            let (instant, _) = motion.velocity(&state, k)?;
            let all = o.sensors.iter().zip(&mut series).zip(&wanted);
            for ((record, series), _) in all.filter(|(_, w)| **w) {
                let (value, _) = ideal_measurement(record, &mut motion, (&state, k), &instant);
                series.push(vector(&value));
            }
            if k + 1 < samples {
                state = motion.advance(&state, k)?;
            }
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
