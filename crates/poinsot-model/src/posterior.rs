//! What an earlier identification told of the numbers of a vehicle.

/// Covariance of numbers about the values of the model after an earlier identification. It replaces the declared priors of these
/// numbers.
///
/// ```
/// use poinsot_model::{Posterior, PosteriorKnown};
///
/// let spin_inertia = PosteriorKnown {
///     address: "rw1.spin_inertia_kg_m2".to_owned(),
///     slopes: vec![2.0e3],
/// };
/// let posterior = Posterior {
///     numbers: vec!["bus.inertia_kg_m2.xx".to_owned()],
///     covariance: vec![vec![1.0e-4]],
///     known: vec![spin_inertia],
///     known_covariance: vec![vec![1.0e-10]],
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
    /// Covariance of these after the earlier records, in their units.
    pub known_covariance: Vec<Vec<f64>>,
}

/// A known number on which an earlier answer depends.
#[derive(Debug, Clone, PartialEq)]
pub struct PosteriorKnown {
    /// Its address: `rw1.spin_inertia_kg_m2`.
    pub address: String,
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
        self.covariance[one][other] + self.of_known(one, other)
    }

    /// What known numbers add to the covariance of two numbers.
    pub fn of_known(&self, one: usize, other: usize) -> f64 {
        let rows = self.known.iter().zip(&self.known_covariance);
        let row = |(a, row): (&PosteriorKnown, &Vec<f64>)| {
            let terms = self.known.iter().zip(row).map(|(b, c)| c * b.slopes[other]);
            a.slopes[one] * terms.sum::<f64>()
        };
        rows.map(row).sum()
    }

    /// The numbers that are kept alone, with exact known numbers.
    pub fn exact_of(&self, keep: impl Fn(&str) -> bool) -> Self {
        let places = (0..self.numbers.len()).filter(|k| keep(&self.numbers[*k]));
        let places: Vec<usize> = places.collect();
        let row = |i: &usize| places.iter().map(|j| self.covariance[*i][*j]).collect();
        Self {
            numbers: places.iter().map(|k| self.numbers[*k].clone()).collect(),
            covariance: places.iter().map(row).collect(),
            ..Self::default()
        }
    }
}
