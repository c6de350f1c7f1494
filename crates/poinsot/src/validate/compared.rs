//! One quantity from two sources over time, and its difference.

use poinsot_formats::{ComparedQuantityFile, InSigmasFile};

/// Names and values, one row per component.
pub type Rows = (Vec<String>, Vec<Vec<f64>>);

/// One quantity from two sources.
#[derive(Debug, Clone, PartialEq)]
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
    /// A quantity with its statistics; `sides` holds names, model and other side, `difference` names and rows.
    pub fn new(
        name: &str,
        unit: &'static str,
        time_s: Vec<f64>,
        sides: (Vec<String>, Vec<Vec<f64>>, Vec<Vec<f64>>),
        difference: Rows,
    ) -> Self {
        let (components, model, against) = sides;
        let (difference_components, difference) = difference;
        let mut largest = (0.0_f64, time_s.first().copied().unwrap_or(0.0));
        let mut square = 0.0;
        for (k, time) in time_s.iter().enumerate() {
            let own: f64 = difference
                .iter()
                .filter_map(|row| row.get(k))
                .map(|x| x * x)
                .sum();
            square += own;
            // NaN must not count as agreement.
            if own.sqrt() > largest.0 || own.is_nan() {
                largest = (own.sqrt(), *time);
            }
        }
        Self {
            name: name.to_owned(),
            unit,
            rms: (square / time_s.len().max(1) as f64).sqrt(),
            time_s,
            components,
            model,
            against,
            difference_components,
            difference,
            largest: largest.0,
            largest_at_s: largest.1,
            sigmas: None,
        }
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
