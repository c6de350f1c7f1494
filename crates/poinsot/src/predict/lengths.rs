//! Accuracy of shorter records of the same motion.

use super::wanted_sigma;
use crate::bind::{bind, cut_at};
use crate::case::{Case, Want};
use crate::error::Error;
use crate::simulate::simulate_exact;
use poinsot_dynamics::Tree;
use poinsot_formats::{AgainstDurationFile, SigmasFile, finite};
use poinsot_identify::{Problem, predicted_covariance};
use poinsot_model::Model;
use rayon::prelude::*;

/// Number of equally spaced ends of the record.
const PARTS: u32 = 12;

/// Sigmas for a record that ends at this time.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// End of the record, s.
    pub end_s: f64,
    /// One entry per number; `None` if not identifiable.
    pub sigmas: Vec<Option<f64>>,
}

/// Sigmas of the wanted numbers for records that end after each twelfth of the duration.
///
/// # Errors
/// The case cannot be simulated.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::predict::against_duration;
///
/// let ended = against_duration(&case, &model, &case::estimated_numbers(&model), 1.0)?;
/// // A longer record is never worse.
/// let of_xx: Vec<f64> = ended.iter().filter_map(|e| e.sigmas[0]).collect();
/// assert!(of_xx.windows(2).all(|pair| pair[1] < 1.001 * pair[0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn against_duration(
    case: &Case,
    model: &Model,
    wants: &[Want],
    relative_accuracy: f64,
) -> Result<Vec<Ended>, Error> {
    let exact = simulate_exact(case, model)?.table;
    let tree = Tree::new(model);
    let of = |part: u32| {
        let end_s = case.duration_s * f64::from(part) / f64::from(PARTS);
        let bound = bind(model, &tree, &[cut_at(&exact, end_s)]).ok();
        // A record with too few samples determines nothing.
        let estimate = bound.and_then(|bound| {
            predicted_covariance(&Problem {
                relative_accuracy,
                ..bound.problem(model, &tree)
            })
            .ok()
        });
        let sigma = |want: &Want| wanted_sigma(estimate.as_ref()?, want);
        Ended {
            end_s,
            sigmas: wants.iter().map(sigma).collect(),
        }
    };
    Ok((1..=PARTS).into_par_iter().map(of).collect())
}

/// The sigmas for shorter records as a file.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::predict::{against_duration, against_duration_file};
///
/// let numbers = case::estimated_numbers(&model);
/// let ended = against_duration(&case, &model, &numbers, 1.0)?;
/// let file = against_duration_file(&ended, numbers.iter());
/// assert_eq!((file.end_s.len(), file.end_s[11], file.numbers.len()), (12, 10.0, 6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn against_duration_file<'w>(
    ended: &[Ended],
    wants: impl Iterator<Item = &'w Want>,
) -> AgainstDurationFile {
    let numbers = wants.enumerate().map(|(k, want)| SigmasFile {
        name: want.name.clone(),
        unit: want.unit.to_owned(),
        wanted_sigma: finite(want.sigma),
        sigma: ended.iter().map(|e| e.sigmas[k]).collect(),
    });
    AgainstDurationFile {
        end_s: ended.iter().map(|e| e.end_s).collect(),
        numbers: numbers.collect(),
    }
}
