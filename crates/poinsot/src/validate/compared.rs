//! One quantity from two sources over time, and its difference.

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
    pub sigmas: Option<Sigmas>,
}

/// A difference in units of the declared noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sigmas {
    /// RMS of a component.
    pub rms: f64,
    /// Largest component.
    pub largest: f64,
    /// p-value of the whiteness test of the difference; `None` if not computed.
    pub whiteness_p: Option<f64>,
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
}
