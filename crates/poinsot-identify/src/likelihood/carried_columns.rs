//! Known numbers as unknowns: columns that another evaluation gave.

use super::Setting;
use crate::problem::segment::{Segment, SensorRecord};
use poinsot_spatial::Vector3;

/// How the whitened predictions of every sample move with each known number.
#[derive(Debug, Clone, Default)]
pub(crate) struct KnownColumns {
    /// By segment: names of the sensors compared there.
    pub sensors: Vec<Vec<String>>,
    /// By number.
    pub slopes: Vec<PredictionSlopes>,
}

/// How the whitened predictions move with one number: by segment, sensor and sample. Empty for a number that cannot be moved.
pub(crate) type PredictionSlopes = Vec<Vec<Vec<Vector3>>>;

/// The columns of one segment in the course of an evaluation.
pub(super) struct CarriedColumns<'a> {
    /// Those of all segments; `None` without known numbers.
    known: Option<&'a KnownColumns>,
    /// Index of the segment, and the place of each of its sensors among the names there.
    segment: usize,
    sensors: Vec<Option<usize>>,
    /// Places of the other unknowns in the whole list.
    kept: Vec<usize>,
    /// Places of the known numbers.
    places: Vec<usize>,
}

impl<'a> CarriedColumns<'a> {
    pub fn new(
        setting: &Setting<'a>,
        (index, segment): (usize, &Segment),
        x: &[f64],
        kept: Vec<usize>,
    ) -> Self {
        let places: Vec<usize> = (0..x.len()).filter(|k| !kept.contains(k)).collect();
        let names = setting.known.and_then(|known| known.sensors.get(index));
        let place = |r: &SensorRecord| names?.iter().position(|name| *name == r.name);
        Self {
            known: setting.known,
            segment: index,
            sensors: segment.observations.sensors.iter().map(place).collect(),
            kept,
            places,
        }
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    fn slope(&self, number: usize, (sensor, reading): (usize, usize)) -> Vector3 {
        let slope = || {
            let sensors = self.known?.slopes.get(number)?.get(self.segment)?;
            let readings = sensors.get((*self.sensors.get(sensor)?)?)?;
            readings.get(reading).copied()
        };
        slope().unwrap_or_default()
    }

    /// The rows of one reading with the columns of the known numbers in their places, all whitened; the residual last.
    /// `weight` is the root of what a robust loss leaves of the reading.
    pub fn widen(
        &self,
        rows: &[Vector3],
        at: (usize, usize),
        (initial_columns, weight): (usize, f64),
        out: &mut Vec<Vector3>,
    ) {
        out.resize(rows.len() + self.places.len(), Vector3::zeros());
        let last = out.len() - 1;
        out[last] = rows.last().copied().unwrap_or_default();
        out[..initial_columns].copy_from_slice(&rows[..initial_columns]);
        for (from, to) in self.kept.iter().enumerate() {
            out[initial_columns + to] = rows[initial_columns + from];
        }
        for (k, to) in self.places.iter().enumerate() {
            out[initial_columns + to] = self.slope(k, at) * weight;
        }
    }
}
