//! Accuracy of shorter records of the same motion.

use super::wanted_sigma;
use crate::bind::{cut_at, solve};
use crate::case::{Case, Want};
use crate::error::Error;
use crate::simulate::simulate_exact;
use poinsot_formats::{AgainstDurationFile, SigmasFile, finite};
use poinsot_identify::predicted_covariance;
use poinsot_model::Model;
use rayon::prelude::*;

/// Number of equally spaced ends of the record.
const PARTS: u32 = 12;

/// Sigmas of the wanted numbers for records that end after each twelfth of the duration.
///
/// # Errors
/// The case cannot be simulated.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::predict::against_duration;
///
/// let found = against_duration(&case, &model, &case::estimated_numbers(&model), 1.0)?;
/// assert_eq!((found.end_s.len(), found.end_s[11], found.numbers.len()), (12, 10.0, 6));
/// // A longer record is never worse.
/// let of_xx: Vec<f64> = found.numbers[0].sigma.iter().copied().flatten().collect();
/// assert!(of_xx.windows(2).all(|pair| pair[1] < 1.001 * pair[0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn against_duration(
    case: &Case,
    model: &Model,
    wants: &[Want],
    relative_accuracy: f64,
) -> Result<AgainstDurationFile, Error> {
    let exact = simulate_exact(case, model)?.table;
    let parts = 1..=PARTS;
    let end = |part: u32| case.duration_s * f64::from(part) / f64::from(PARTS);
    let end_s: Vec<f64> = parts.map(end).collect();
    let sigmas = |end_s: &f64| -> Vec<Option<f64>> {
        let record = [cut_at(&exact, *end_s)];
        // A record with too few samples determines nothing.
        let estimate = solve(model, &record, relative_accuracy, predicted_covariance).ok();
        let sigma = |want: &Want| wanted_sigma(estimate.as_ref()?, want);
        wants.iter().map(sigma).collect()
    };
    let sigmas: Vec<Vec<Option<f64>>> = end_s.par_iter().map(sigmas).collect();
    let number = |(k, want): (usize, &Want)| SigmasFile {
        name: want.name.clone(),
        unit: want.unit.to_owned(),
        wanted_sigma: finite(want.sigma),
        sigma: sigmas.iter().map(|of_end| of_end[k]).collect(),
    };
    let numbers = wants.iter().enumerate().map(number).collect();
    Ok(AgainstDurationFile { end_s, numbers })
}
