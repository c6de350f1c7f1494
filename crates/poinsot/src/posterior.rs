//! A vehicle after an answer of `identify`: its values and its covariance are the nominal values and the prior of the next
//! experiment.

use crate::case::Want;
use crate::error::Error;
use crate::mass_numbers::{names, with_answer};
use nalgebra::{DMatrix, SymmetricEigen};
use poinsot_files::Place;
use poinsot_formats::{EstimateFile, NumberFile, address, read_estimate};
use poinsot_model::{Model, Posterior, PosteriorKnown};
use std::path::Path;

/// Least eigenvalue of a correlation matrix that was read or calculated with round-off.
const LEAST: f64 = 1.0e-10;

/// The model after an answer (`estimate.json`, or its folder): the numbers that the answer determines are the nominal ones, and its
/// covariance replaces their declared priors. An answer that is not reliable is refused unless it is accepted.
///
/// # Errors
/// The file cannot be read, is not reliable (E0601), or belongs to another vehicle (E0605).
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-after-{}", std::process::id()));
/// write_estimate(&out, &identified)?;
/// let after = posterior::after_answer(&model, &out, false)?;
/// // The sigmas are those of the answer.
/// let posterior = after.knowledge.posterior.unwrap();
/// let sigma = identified.estimate.bodies[0].inertia[0].sigma.unwrap();
/// let xx = posterior.place("bus.inertia_kg_m2.xx").unwrap();
/// assert!((posterior.between(xx, xx).sqrt() / sigma - 1.0).abs() < 1.0e-6);
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn after_answer(model: &Model, path: &Path, accept_unreliable: bool) -> Result<Model, Error> {
    let (path, answer) = read_estimate(path)?;
    reliable(&answer, &path, accept_unreliable)?;
    same_unknowns(model, &answer, &path)?;
    let mut after = model.clone();
    for body in &mut after.bodies {
        body.nominal = with_answer(body, Some(&answer));
    }
    after.knowledge.posterior = Some(posterior(model, &answer));
    Ok(after)
}

/// One sigma of a wanted number under the posterior of a model; `None` without one, or where it does not determine the number.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-known-{}", std::process::id()));
/// write_estimate(&out, &identified)?;
/// let after = posterior::after_answer(&model, &out, false)?;
/// let xx = &case::estimated_numbers(&model)[0];
/// let stated = identified.estimate.bodies[0].inertia[0].sigma.unwrap();
/// assert!((posterior::known_sigma(&after, xx).unwrap() / stated - 1.0).abs() < 1.0e-6);
/// assert_eq!(posterior::known_sigma(&model, xx), None);
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn known_sigma(model: &Model, want: &Want) -> Option<f64> {
    let posterior = model.knowledge.posterior.as_ref()?;
    let mut terms = Vec::new();
    for term in &want.terms {
        let body = model.bodies.get(term.body)?;
        if body.estimate.has(term.number) {
            let place = posterior.place(&names(&body.name)[term.number])?;
            terms.push((place, term.factor));
        }
    }
    let row = |(i, a): &(usize, f64)| -> f64 {
        let products = terms.iter().map(|(j, b)| a * b * posterior.between(*i, *j));
        products.sum()
    };
    Some(terms.iter().map(row).sum::<f64>().max(0.0).sqrt())
}

/// Refuses an answer that is not reliable, unless it is accepted.
pub(crate) fn reliable(estimate: &EstimateFile, path: &Path, accept: bool) -> Result<(), Error> {
    match (estimate.unreliable().first(), accept) {
        (Some(why), false) => Err(Error::report(
            path,
            format!("its numbers are not reliable: {why}"),
            "correct the cause, or accept them with --accept-unreliable",
        )),
        _ => Ok(()),
    }
}

/// Checks that bodies and unknown numbers of an answer are those of the model.
fn same_unknowns(model: &Model, answer: &EstimateFile, path: &Path) -> Result<(), Error> {
    let refuse = |problem: String| {
        let problem = format!("this answer belongs to another vehicle: {problem}");
        let advice = "give an answer that was made with the model of the case";
        Err(Error::one("E0605", Place::file(path), problem, advice))
    };
    let word = |unknown: bool| if unknown { "unknown" } else { "known" };
    if let Some(other) = answer.bodies.keys().find(|b| model.body(b).is_none()) {
        return refuse(format!("the model has no body \"{other}\""));
    }
    for body in &model.bodies {
        let Some(found) = answer.bodies.get(&body.name) else {
            return refuse(format!("it has no body \"{}\"", body.name));
        };
        let known = found.map(NumberFile::is_known);
        for (k, name) in names(&body.name).iter().enumerate() {
            let unknown = body.estimate.has(k);
            if known[k] == unknown {
                let (here, there) = (word(unknown), word(!unknown));
                return refuse(format!(
                    "{name} is {here} in the model and {there} in the answer"
                ));
            }
        }
    }
    Ok(())
}

/// The covariance of an answer, split into the part of the data and that of known numbers.
pub(crate) fn posterior(model: &Model, answer: &EstimateFile) -> Posterior {
    let of = &answer.covariance;
    let has_variance = |n: &&String| of.between(n, n).is_some_and(|v| v.is_finite() && v > 0.0);
    let numbers: Vec<String> = of.names.iter().filter(has_variance).cloned().collect();
    let n = numbers.len();
    let whole = |i: usize, j: usize| of.between(&numbers[i], &numbers[j]).unwrap_or(0.0);
    let (known, known_covariance) = known(model, answer, &numbers);
    let mut told = Posterior {
        known,
        known_covariance,
        ..Posterior::default()
    };
    let sigmas: Vec<f64> = (0..n).map(|k| whole(k, k).sqrt()).collect();
    let stated = |(name, sigma): (&String, &f64)| {
        let data = answer.known_numbers.sigma_data.get(name);
        data.copied()
            .filter(|_| !told.known.is_empty())
            .unwrap_or(*sigma)
    };
    let of_data: Vec<f64> = numbers.iter().zip(&sigmas).map(stated).collect();
    let own = |i: usize, j: usize| whole(i, j) - told.of_known(i, j);
    told.covariance = positive(&of_data, |i, j| own(i, j) / (sigmas[i] * sigmas[j]));
    told.numbers = numbers;
    told
}

/// A positive definite covariance with these sigmas and correlations, which round-off may have left without one.
fn positive(sigmas: &[f64], correlation: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    let n = sigmas.len();
    if n == 0 {
        return Vec::new();
    }
    let within = |i: usize, j: usize| correlation(i, j).clamp(-1.0, 1.0);
    let eigen = SymmetricEigen::new(DMatrix::from_fn(n, n, within));
    let values = DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| v.max(LEAST)));
    let positive = &eigen.eigenvectors * values * eigen.eigenvectors.transpose();
    let root = |k: usize| sigmas[k] / positive[(k, k)].sqrt();
    let row = |i| {
        (0..n)
            .map(|j| positive[(i, j)] * root(i) * root(j))
            .collect()
    };
    (0..n).map(row).collect()
}

/// The known numbers on which an answer depends, and their covariance.
fn known(
    model: &Model,
    answer: &EstimateFile,
    numbers: &[String],
) -> (Vec<PosteriorKnown>, Vec<Vec<f64>>) {
    let (mut all, mut places) = (Vec::new(), Vec::new());
    let told = &answer.known_numbers;
    let between = |i: usize, j: usize| {
        let row = told.covariance.get(i);
        row.and_then(|row| *row.get(j)?).unwrap_or_else(|| {
            // A file of an earlier version has sigmas alone.
            let own = &told.sensitivities[i];
            let sigma = own.estimate_sigma.unwrap_or(own.sigma);
            if i == j { sigma * sigma } else { 0.0 }
        })
    };
    for uncertain in model.uncertain() {
        let number = uncertain.number;
        for component in 0..number.components() {
            let at = address(&number.name(model, component), number.unit());
            let place = told.sensitivities.iter().position(|s| s.number == at);
            let Some(k) = place.filter(|k| between(*k, *k) >= f64::MIN_POSITIVE) else {
                continue;
            };
            let step = number.round_step(model, component).size;
            let change = &told.sensitivities[k].change;
            let slope = |name: &String| change.get(name).map_or(0.0, |c| c / step);
            all.push(PosteriorKnown {
                address: at,
                slopes: numbers.iter().map(slope).collect(),
            });
            places.push(k);
        }
    }
    let sigmas: Vec<f64> = places.iter().map(|k| between(*k, *k).sqrt()).collect();
    let covariance = positive(&sigmas, |i, j| {
        between(places[i], places[j]) / (sigmas[i] * sigmas[j])
    });
    (all, covariance)
}
