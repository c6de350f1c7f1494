//! One quantity from two sources over time, and its difference.

use poinsot_formats::{ComparedQuantityFile, InSigmasFile};

/// One quantity from two sources.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Compared {
    /// Name, for example `base position`, `joint joint1`, `gyro`.
    pub name: String,
    /// Unit of the difference.
    pub unit: &'static str,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Names of the components of both sides.
    pub components: Vec<String>,
    /// Values of the model, one row per component.
    pub model: Vec<Vec<f64>>,
    /// Values of the other side.
    pub against: Vec<Vec<f64>>,
    /// Names of the components of the difference; for an attitude, a small rotation in base axes.
    pub difference_components: Vec<String>,
    /// Model minus other side, one row per component.
    pub difference: Vec<Vec<f64>>,
    /// Largest norm of the difference.
    pub largest: f64,
    /// Its time, s.
    pub largest_at_s: f64,
    /// RMS norm.
    pub rms: f64,
    /// The difference in units of the declared noise, if any.
    pub sigmas: Option<InSigmasFile>,
}

impl Compared {
    /// The quantity with the statistics of its difference.
    pub(super) fn measured(mut self) -> Self {
        self.largest_at_s = self.time_s.first().copied().unwrap_or(0.0);
        let mut square = 0.0;
        for (k, time) in self.time_s.iter().enumerate() {
            let rows = self.difference.iter().filter_map(|row| row.get(k));
            let own: f64 = rows.map(|x| x * x).sum();
            square += own;
            // NaN must not count as agreement.
            if own.sqrt() > self.largest || own.is_nan() {
                (self.largest, self.largest_at_s) = (own.sqrt(), *time);
            }
        }
        self.rms = (square / self.time_s.len().max(1) as f64).sqrt();
        self
    }

    /// The quantity in the result file.
    pub(super) fn file(&self) -> ComparedQuantityFile {
        ComparedQuantityFile {
            quantity: self.name.clone(),
            unit: self.unit.to_owned(),
            samples: self.time_s.len(),
            largest: self.largest,
            largest_at_s: self.largest_at_s,
            rms: self.rms,
            sigmas: self.sigmas,
        }
    }
}
