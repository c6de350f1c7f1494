//! What an earlier identification told of the numbers of a vehicle.

/// Covariance of numbers about the values of the model after an earlier identification. It replaces the declared priors of these
/// numbers.
///
/// ```
/// use poinsot_model::{Posterior, PosteriorKnown};
///
/// let spin_inertia = PosteriorKnown {
///     address: "rw1.spin_inertia_kg_m2".to_owned(),
///     sigma: 1.0e-5,
///     slopes: vec![2.0e3],
/// };
/// let posterior = Posterior {
///     numbers: vec!["bus.inertia_kg_m2.xx".to_owned()],
///     covariance: vec![vec![1.0e-4]],
///     known: vec![spin_inertia],
/// };
/// // The error of the spin inertia adds (2e3 * 1e-5)^2.
/// assert!((posterior.between(0, 0) - 5.0e-4).abs() < 1.0e-12);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Posterior {
    /// Addresses of the numbers: `bus.mass_kg`, `gyro.bias_rad_s.x`.
    pub numbers: Vec<String>,
    /// Their covariance in SI, row by row, where every known number has its true value; positive definite.
    pub covariance: Vec<Vec<f64>>,
    /// Known numbers, whose errors are the same in the earlier records and in the next one.
    pub known: Vec<PosteriorKnown>,
}

/// A known number on which an earlier answer depends.
#[derive(Debug, Clone, PartialEq)]
pub struct PosteriorKnown {
    /// Its address: `rw1.spin_inertia_kg_m2`.
    pub address: String,
    /// One sigma after the earlier records, in its unit.
    pub sigma: f64,
    /// Change of each number of the answer with it, in SI.
    pub slopes: Vec<f64>,
}

impl Posterior {
    /// Place of a number.
    pub fn place(&self, address: &str) -> Option<usize> {
        self.numbers.iter().position(|own| own == address)
    }

    /// Covariance of two numbers, errors of known numbers included.
    pub fn between(&self, one: usize, other: usize) -> f64 {
        let of_known = |k: &PosteriorKnown| k.sigma * k.sigma * k.slopes[one] * k.slopes[other];
        self.covariance[one][other] + self.known.iter().map(of_known).sum::<f64>()
    }

    /// The numbers that are kept alone, with exact known numbers.
    pub fn exact_of(&self, keep: impl Fn(&str) -> bool) -> Self {
        let places = (0..self.numbers.len()).filter(|k| keep(&self.numbers[*k]));
        let places: Vec<usize> = places.collect();
        let row = |i: &usize| places.iter().map(|j| self.covariance[*i][*j]).collect();
        Self {
            numbers: places.iter().map(|k| self.numbers[*k].clone()).collect(),
            covariance: places.iter().map(row).collect(),
            known: Vec::new(),
        }
    }
}
