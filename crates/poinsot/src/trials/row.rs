//! One trial by one method.

use crate::mass_numbers::names as mass_names;
use indexmap::IndexMap;
use nalgebra::{DMatrix, DVector};
use poinsot_formats::address;
use poinsot_identify::{Estimate, Source, Status};
use serde::{Deserialize, Serialize};

/// One number of a row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowNumber {
    /// Address, for example `base.mass_kg`, `base.inertia_kg_m2.xx`, `gyro.bias_rad_s.x`.
    pub name: String,
    /// True value.
    pub truth: f64,
    /// Estimate, if the trial determined it.
    pub estimate: Option<f64>,
    /// Stated sigma, if the method has one.
    pub sigma: Option<f64>,
    /// Sigma of the Cramer-Rao bound, if the number is identifiable.
    pub bound: Option<f64>,
}

impl RowNumber {
    /// Estimate minus truth.
    pub fn error(&self) -> Option<f64> {
        self.estimate.map(|x| x - self.truth)
    }

    /// Error over the stated sigma.
    pub fn z(&self) -> Option<f64> {
        Some(self.error()? / self.sigma?)
    }

    /// Whether the stated 95 % interval holds the truth.
    pub(crate) fn holds(&self, error: f64) -> bool {
        let reach = |sigma: f64| poinsot_formats::HALF_WIDTH_95 * sigma;
        self.sigma.is_some_and(|sigma| error.abs() <= reach(sigma))
    }
}

/// Normalised squared error of several numbers together.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Nees {
    /// `e^T C^-1 e`.
    pub square: f64,
    /// Count of the numbers.
    pub dof: u64,
}

/// One trial by one method.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// Number of the trial.
    pub trial: u64,
    /// Status of the estimate; `None` without an answer.
    pub status: Option<Status>,
    /// Why the answer is not reliable, or why there is none.
    pub evidence: Vec<String>,
    /// Every number with known truth.
    pub numbers: Vec<RowNumber>,
    /// Numbers that the trial drew, by address.
    pub drawn: Vec<(String, f64)>,
    /// Iterations taken.
    pub iterations: u64,
    /// Chi-square per degree of freedom, mean over the segments.
    pub chi2_per_dof: Option<f64>,
    /// Chi-square per number of each kind of sensor, mean over the segments.
    pub channels: IndexMap<String, f64>,
    /// That of all determined mass properties.
    pub nees: Option<Nees>,
    /// CPU time including its part of the simulation, s.
    pub seconds: f64,
}

impl Row {
    /// A trial without an answer.
    pub(crate) fn failed(trial: u64, why: String, expected: &[RowNumber]) -> Self {
        Self {
            trial,
            evidence: vec![why],
            numbers: expected.to_vec(),
            ..Self::default()
        }
    }

    /// Compares what a method found with the true numbers.
    pub(crate) fn judged(
        trial: u64,
        found: Result<Estimate, String>,
        expected: &[RowNumber],
    ) -> Self {
        match found {
            Ok(estimate) => Self {
                trial,
                ..judged(&estimate, expected)
            },
            Err(why) => Self::failed(trial, why, expected),
        }
    }

    /// The row, if there is an answer.
    ///
    /// # Errors
    /// Why there is none.
    pub fn answer(&self) -> Result<&Self, String> {
        let why = || self.evidence.join("; ");
        self.status.map(|_| self).ok_or_else(why)
    }

    /// A determined number by address.
    pub fn number(&self, name: &str) -> Option<&RowNumber> {
        self.determined().find(|n| n.name == name)
    }

    /// Every determined number.
    pub fn determined(&self) -> impl Iterator<Item = &RowNumber> {
        self.numbers.iter().filter(|n| n.estimate.is_some())
    }
}

/// Compares an estimate with true numbers, as from [`super::Study::expected`].
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// let study = trials::Study::of_case(&case, &model.clone(), model)?;
/// let judged = trials::judged(&identified.estimate, &study.expected(&[], &Default::default()));
/// let number = judged.number("bus.inertia_kg_m2.zz").unwrap();
/// assert_eq!(number.error().unwrap(), number.estimate.unwrap() - 2.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn judged(estimate: &Estimate, expected: &[RowNumber]) -> Row {
    let mut numbers = expected.to_vec();
    for found in estimated_numbers(estimate) {
        if let Some(number) = numbers.iter_mut().find(|n| n.name == found.name) {
            (number.estimate, number.sigma) = (found.estimate, found.sigma);
        }
    }
    let segments = estimate.fit.len().max(1) as f64;
    let mut channels: IndexMap<String, f64> = IndexMap::new();
    for channel in estimate.fit.iter().flat_map(|f| &f.channels) {
        let share = channel.chi2_per_number.unwrap_or(f64::NAN) / segments;
        *channels.entry(channel.name.clone()).or_default() += share;
    }
    let chi2 = estimate.fit.iter().map(|f| f.chi2_per_dof).sum::<f64>() / segments;
    Row {
        status: Some(estimate.status),
        evidence: estimate.doubts(),
        iterations: estimate.iterations as u64,
        chi2_per_dof: poinsot_formats::finite(chi2),
        channels,
        nees: nees(estimate, &numbers),
        numbers,
        ..Row::default()
    }
}

/// Every number determined by data; its truth is not known here.
pub(crate) fn estimated_numbers(estimate: &Estimate) -> Vec<RowNumber> {
    let mut list = Vec::new();
    let mut add = |name, number: &poinsot_identify::Number| {
        list.push(RowNumber {
            name,
            truth: f64::NAN,
            estimate: number.value,
            sigma: number.sigma,
            bound: None,
        });
    };
    for body in estimate.bodies.iter().filter(|b| b.asked) {
        for (name, number) in mass_names(&body.name).into_iter().zip(body.numbers()) {
            if number.source == Source::Data && number.value.is_some() {
                add(name, &number);
            }
        }
    }
    for item in &estimate.nuisance {
        if item.number.value.is_some() && item.number.sigma.is_some() {
            add(address(&item.name, item.unit), &item.number);
        }
    }
    list
}

/// `e^T C^-1 e` over the mass properties with the stated covariance; `None` if it is singular or a true value is
/// missing.
fn nees(estimate: &Estimate, numbers: &[RowNumber]) -> Option<Nees> {
    let is_mass = |name: &str| estimate.nuisance.iter().all(|n| n.name != name);
    let all = estimate.covariance_names.iter().enumerate();
    let (at, names): (Vec<usize>, Vec<&String>) = all.filter(|(_, name)| is_mass(name)).unzip();
    let n = names.len();
    if n == 0 {
        return None;
    }
    let mut scaled = DVector::zeros(n);
    let mut sigma = vec![1.0; n];
    for (i, name) in names.iter().enumerate() {
        let wanted = address(name, estimate.covariance_units[at[i]]);
        let number = numbers.iter().find(|x| x.name == wanted)?;
        sigma[i] = estimate.covariance[at[i]][at[i]].sqrt();
        scaled[i] = number.error()? / sigma[i];
    }
    let correlation = DMatrix::from_fn(n, n, |i, j| {
        estimate.covariance[at[i]][at[j]] / (sigma[i] * sigma[j])
    });
    let l = correlation.cholesky()?.unpack();
    if (0..n).any(|i| l[(i, i)] < 1.0e-6) {
        return None;
    }
    let white = l.solve_lower_triangular(&scaled)?;
    Some(Nees {
        square: white.norm_squared(),
        dof: n as u64,
    })
}
