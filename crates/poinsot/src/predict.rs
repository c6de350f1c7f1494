//! The command `predict`: the accuracy of a planned manoeuvre before it is flown.
//!
//! The case is simulated with ideal sensors, and the measurements are linearised at the true values. With the declared
//! noise this gives the Cramer-Rao bound. Neither telemetry nor an estimator is used.

mod file;
mod peaks;
mod written;

use crate::bind::{bind, cut_at, solve};
use crate::case::{Case, Scenario, Want, estimated_numbers, read_case};
use crate::error::{Error, check_accuracy, unsupported};
use crate::simulate::{free_joints, is_read, simulate_exact, simulate_exact_watched};
pub use file::prediction_file;
#[doc(hidden)]
pub use peaks::Peaks;
use poinsot_dynamics::Tree;
use poinsot_formats::{AgainstDurationFile, PeakFile, SigmasFile, WantedFile, finite};
use poinsot_identify::{BodyEstimate, Estimate, Problem, Source, WantedTerm, predicted_covariance};
use poinsot_model::{Joint, Model, read_model};
use poinsot_spatial::MASS_PROPERTY_NAMES;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
pub use written::{prediction_paths, write_predictions};

/// Predicted accuracy of a case.
pub struct Prediction {
    /// The vehicle; its numbers are the true values.
    pub model: Model,
    /// Path of the case.
    pub case: String,
    /// Duration of the manoeuvre, s.
    pub duration_s: f64,
    /// The bound: values are the true ones, sigmas are the bound.
    pub bound: Estimate,
    /// Wanted and predicted sigmas.
    pub wants: Vec<WantedFile>,
    /// Assumptions.
    pub assumptions: Vec<String>,
    /// Largest values of the motion at its samples.
    pub peaks: Vec<PeakFile>,
    /// Sigmas for shorter records; `None` if not requested.
    pub against_duration: Option<AgainstDurationFile>,
}

impl Prediction {
    /// Whether the case reaches its wanted sigmas; without `[[want]]`, whether every requested number is determined.
    pub fn passes(&self) -> bool {
        match self.wants.is_empty() {
            true => self.bound.passes(),
            false => self.wants.iter().all(|w| w.met),
        }
    }
}

/// Predicts the accuracy of a case.
///
/// # Errors
/// Case or model are invalid, the motion cannot be computed, or a required sensor is missing.
///
/// ```
/// use poinsot::predict::predict;
///
/// let case = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/case.toml");
/// let prediction = predict(&case, 1.0)?;
/// // The manoeuvre determines all six elements of the tensor.
/// assert!(prediction.passes());
/// assert_eq!(prediction.bound.identifiability.rank, 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn predict(case: &Path, relative_accuracy: f64) -> Result<Prediction, Error> {
    let case = read_case(case)?;
    let model = read_model(&case.model)?;
    predict_case(&case, model, relative_accuracy)
}

/// Predicts several cases in order; with `durations`, also sigmas for shorter records.
///
/// # Errors
/// As [`predict`], of the first case that fails.
///
/// ```
/// use poinsot::predict::predict_all;
///
/// let case = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/case.toml");
/// let all = predict_all(&[case], 1.0, true)?;
/// // Sigmas of the records that end after each twelfth of the duration.
/// assert_eq!(all[0].against_duration.as_ref().unwrap().end_s.len(), 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn predict_all(
    cases: &[PathBuf],
    relative_accuracy: f64,
    durations: bool,
) -> Result<Vec<Prediction>, Error> {
    let one = |case: &PathBuf| {
        let case = read_case(case)?;
        let mut prediction = predict_case(&case, read_model(&case.model)?, relative_accuracy)?;
        if durations {
            let model = &prediction.model;
            let wants = match prediction.wants.is_empty() {
                true => estimated_numbers(model),
                false => case.wants(model)?,
            };
            let found = against_duration(&case, model, &wants, relative_accuracy)?;
            prediction.against_duration = Some(found);
        }
        Ok(prediction)
    };
    // The evaluations of a single case keep the cores busy outside of the pool.
    let all: Vec<Result<Prediction, Error>> = match cases {
        [only] => vec![one(only)],
        _ => cases.par_iter().map(one).collect(),
    };
    all.into_iter().collect()
}

/// Predicts the accuracy of a case in memory.
///
/// # Errors
/// As [`predict`].
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// use poinsot::predict::predict_case;
///
/// // Half the noise halves every sigma.
/// let mut quiet = model.clone();
/// quiet.sensors[0].noise_covariance = model.sensors[0].noise_covariance.map(|c| c / 4.0);
/// let sigma = |model| {
///     let prediction = predict_case(&case, model, 1.0)?;
///     Ok::<_, Error>(prediction.bound.bodies[0].inertia[5].sigma.unwrap())
/// };
/// assert!((sigma(model)? / sigma(quiet)? - 2.0).abs() < 1.0e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn predict_case(
    case: &Case,
    model: Model,
    relative_accuracy: f64,
) -> Result<Prediction, Error> {
    check_accuracy(relative_accuracy)?;
    let scenario = case.bind(&model)?;
    refuse_unread(&scenario, &model)?;
    let wants = case.wants(&model)?;
    case.check_fit(&model)?;
    let mut peaks = Peaks::default();
    let exact = simulate_exact_watched(case, &model, scenario.clone(), |s| peaks.take(s))?;
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &[exact.table])?;
    let estimate = predicted_covariance(&Problem {
        relative_accuracy,
        ..bound.problem(&model, &tree)
    })?;
    let without_label = |r: &String| r.trim_start_matches(": ").to_owned();
    let met = |want: Want| {
        let sigma = wanted_sigma(&estimate, &want);
        WantedFile {
            name: want.name,
            unit: want.unit.to_owned(),
            wanted_sigma: want.sigma,
            met: sigma.is_some_and(|s| s <= want.sigma),
            sigma,
        }
    };
    Ok(Prediction {
        wants: wants.into_iter().map(met).collect(),
        peaks: peaks.named(&model, &scenario),
        against_duration: None,
        case: case.path().display().to_string(),
        duration_s: case.duration_s,
        bound: estimate,
        assumptions: bound.repairs.iter().map(without_label).collect(),
        model,
    })
}

/// A joint without command must have a sensor, or a spring that alone moves it.
fn refuse_unread(scenario: &Scenario, model: &Model) -> Result<(), Error> {
    let free = free_joints(model, scenario).into_iter();
    let mut unread = free.filter(|(joint, drive)| {
        let swings = joint.is_passive() && !drive.has_motor();
        !swings && !is_read(model, joint)
    });
    let Some((Joint { name, .. }, _)) = unread.next() else {
        return Ok(());
    };
    Err(unsupported(
        format!("joint '{name}' moves by torque or spring, but no sensor measures it"),
        "add [[sensor]] type = \"joint_position\" for it, or prescribe it with [[joint_motion]]",
    ))
}

/// Sigma of a wanted number under the covariance of an estimate or bound.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// let numbers = case::estimated_numbers(&model);
/// let sigma = predict::wanted_sigma(&identified.estimate, &numbers[0]).unwrap();
/// let stated = identified.estimate.bodies[0].inertia[0].sigma.unwrap();
/// assert!((sigma / stated - 1.0).abs() < 1.0e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn wanted_sigma(estimate: &Estimate, want: &Want) -> Option<f64> {
    let mut parts: Vec<(usize, f64)> = Vec::new();
    for term in &want.terms {
        let body = estimate.bodies.get(term.body)?;
        if body.numbers()[term.number].source == Source::Known {
            continue;
        }
        let name = covariance_name(body, term);
        let at = estimate.covariance_names.iter().position(|n| *n == name)?;
        parts.push((at, term.factor));
    }
    let covariance = &estimate.covariance;
    let row = |(i, a): &(usize, f64)| -> f64 {
        parts.iter().map(|(j, b)| a * b * covariance[*i][*j]).sum()
    };
    let variance: f64 = parts.iter().map(row).sum();
    variance.is_finite().then(|| variance.max(0.0).sqrt())
}

/// Name of a number in the covariance of an estimate: `bus.mass`, `bus.com_x`, `bus.inertia_xx`.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// use poinsot_identify::WantedTerm;
///
/// let term = WantedTerm { body: 0, number: 9, factor: 1.0 };
/// let name = predict::covariance_name(&identified.estimate.bodies[0], &term);
/// assert!(name == "bus.inertia_zz" && identified.estimate.covariance_names.contains(&name));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn covariance_name(body: &BodyEstimate, term: &WantedTerm) -> String {
    format!("{}.{}", body.name, MASS_PROPERTY_NAMES[term.number])
}

/// Number of equally spaced ends of the record.
const PARTS: u32 = 12;

/// Sigmas of the wanted numbers for records that end after each twelfth of the duration.
///
/// # Errors
/// The case cannot be simulated.
///
/// ```
#[doc = include_str!("../doc/case.txt")]
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
