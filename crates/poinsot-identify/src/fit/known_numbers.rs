//! Known numbers within their uncertainty: unknowns with a prior, whatever kind of number they are.
//!
//! The fit goes on from the one with exact numbers, with columns of the known numbers (`experiment/known_columns.rs`)
//! beside its own and the declared covariance as a prior; every prediction and every column is that of the vehicle with the
//! numbers moved. Informative data shrink the prior of a number;
//! otherwise it keeps its value and its prior enters the covariance (a consider parameter: Schmidt 1966). One sigma of
//! a known number is therefore no misfit.

mod effects;

pub(crate) use effects::{Effects, shifts};

use crate::fit::degrees_of_freedom::{Loosened, fitted_numbers};
use crate::fit::experiment::{DIFFERENCE, Experiment, Iterate, body_slopes, slopes};
use crate::fit::search::search;
use crate::fit::{Fitted, ITERATIONS, fit_from};
use crate::problem::Problem;
use crate::problem::parameters::{KnownUnknown, Parameters, Unknown, UnknownKind};
use crate::problem::prior::{Conflict, LEAST_SHARE, PriorTest};
use nalgebra::{DMatrix, DVector};
use poinsot_formats::address;
use poinsot_model::{Model, rounded};

/// Effect of one sigma of a number on all predictions together, in their noise, below which it is left out.
pub(crate) const SILENT: f64 = 1.0e-3;

/// All unknowns of an experiment with the known numbers that show behind them, and the point where these have the values of the
/// model. `None` where all known numbers are exact, or nothing depends on them.
fn widened(experiment: &Experiment, at: &Iterate) -> Option<(Parameters, Iterate)> {
    let problem = experiment.problem;
    let all = shown(experiment, at, unknowns(problem.model))?;
    let parameters = extended(problem, experiment.parameters, &all);
    Some((parameters, behind(at, &all)))
}

/// The fit with known numbers within their uncertainty.
pub(crate) struct KnownFit {
    /// All unknowns, the known numbers last: [`Self::fitted`] is the fit with these.
    pub parameters: Parameters,
    pub fitted: Fitted,
    /// Whether the known numbers were left at their values, because no such vehicle fits.
    pub left: bool,
    /// Which one the data contradict, where that explains the misfit.
    pub contradiction: Option<Conflict>,
    /// Test of the known numbers against the data, where they were fitted.
    pub test: Option<PriorTest>,
}

/// The known numbers at the values of the model, with their uncertainty: what a fit of ideal measurements would end with.
pub(crate) fn known_at(experiment: &Experiment, at: &Iterate) -> Option<KnownFit> {
    let (parameters, first) = widened(experiment, at)?;
    let fitted = fit_from(&experiment.with_parameters(&parameters), first, 0)?;
    Some(KnownFit {
        parameters,
        fitted,
        left: false,
        contradiction: None,
        test: None,
    })
}

/// Fits on with the known numbers within their uncertainty; `None` where all of them are exact, or nothing depends on them.
pub(crate) fn fit_known(experiment: &Experiment, fitted: &Fitted) -> Option<KnownFit> {
    let (parameters, first) = widened(experiment, &fitted.at)?;
    let wide = experiment.with_parameters(&parameters);
    let start = fit_from(&wide, first.clone(), 0)?;
    let found = fit_wide(&wide, &first)?;
    let done = found.converged;
    let (worst, per_number, test) = contradicted(&wide, &found);
    // A misfit beyond the uncertainty of known numbers needs another cause.
    let left = per_number > experiment.settings.misfit && (worst.is_some() || !done);
    if left && !fitted.converged {
        return None;
    }
    let mut fitted = if left { start } else { found };
    fitted.converged = left || done;
    Some(KnownFit {
        parameters,
        fitted,
        left,
        contradiction: worst.filter(|_| !left && done),
        test: test.filter(|_| !left && done),
    })
}

/// The fit from a point; where it does not converge, the search from there and from the nominal numbers. With exact forces that are
/// 5 % off no body explains more than a few pulses, so that the fit before this one may have ended anywhere.
fn fit_wide(wide: &Experiment, at: &Iterate) -> Option<Fitted> {
    let direct = fit_from(wide, at.clone(), ITERATIONS)?;
    if direct.converged {
        return Some(direct);
    }
    let found = search(wide, &[at.clone(), wide.nominal_point()]);
    // A number far beyond its uncertainty stands for another cause.
    let within = |f: &Fitted| f.converged && contradicted(wide, f).0.is_none();
    Some(found.filter(within).unwrap_or(direct))
}

/// A point of the fit without the known numbers, with these at the values of the model.
fn behind(at: &Iterate, all: &[Unknown]) -> Iterate {
    let nominal = all.iter().map(|u| u.nominal);
    Iterate {
        x: at.x.iter().copied().chain(nominal).collect(),
        initial_states: at.initial_states.clone(),
    }
}

/// The place of a known number among those on which an earlier answer depends, and its covariances with these.
fn told(model: &Model, name: &str, unit: &str) -> Option<(usize, Vec<f64>)> {
    let posterior = model.knowledge.posterior.as_ref()?;
    let at = address(name, unit);
    let place = posterior.known.iter().position(|k| k.address == at)?;
    Some((place, posterior.known_covariance[place].clone()))
}

/// Uncertain known numbers as unknowns.
fn unknowns(model: &Model) -> Vec<Unknown> {
    let mut all = Vec::new();
    for uncertain in model.uncertain() {
        let number = uncertain.number;
        for component in 0..number.components() {
            let name = number.name(model, component);
            let declared = || number.absolute(model, component, uncertain.sigma);
            let earlier = told(model, &name, number.unit());
            let variance = earlier.as_ref().map(|(place, row)| row[*place]);
            let sigma = variance.map_or_else(declared, f64::sqrt);
            if sigma.is_nan() || sigma <= 0.0 {
                continue;
            }
            let known = KnownUnknown {
                number,
                component,
                sigma,
                correlation: model.knowledge.correlation(number),
                told: earlier,
                slopes: Vec::new(),
            };
            let values = (number.value(model, component), sigma);
            let kind = UnknownKind::Known(known);
            all.push(Unknown::new(kind, (name, number.unit()), values));
        }
    }
    all
}

/// The unknowns with the known numbers behind them, and what those do to the barycentric parameters.
fn extended(problem: &Problem, parameters: &Parameters, all: &[Unknown]) -> Parameters {
    let mut out = parameters.clone();
    let x = parameters.nominal_vector();
    for unknown in all {
        let mut unknown = unknown.clone();
        if let UnknownKind::Known(known) = &mut unknown.kind {
            let shift = (known.number, known.component, DIFFERENCE * known.sigma);
            let slopes = body_slopes((problem, problem.model), parameters, &x, shift);
            known.slopes = slopes.unwrap_or_default();
        }
        out.unknowns.push(unknown);
    }
    out
}

/// The numbers that show in the predictions or in an earlier answer.
fn shown(experiment: &Experiment, at: &Iterate, all: Vec<Unknown>) -> Option<Vec<Unknown>> {
    if all.is_empty() {
        return None;
    }
    let whole = extended(experiment.problem, experiment.parameters, &all);
    let columns = slopes(&experiment.with_parameters(&whole), &behind(at, &all))?;
    let shows = |k: usize| {
        let readings = columns.slopes[k].iter().flatten().flatten();
        let square: f64 = readings.map(|v| v.norm_squared()).sum();
        let own = told(experiment.problem.model, &all[k].name, all[k].unit);
        own.is_some() || square.sqrt() * all[k].natural > SILENT
    };
    let keep: Vec<bool> = (0..all.len()).map(shows).collect();
    let pairs = all.into_iter().zip(keep);
    let all: Vec<Unknown> = pairs.filter_map(|(u, k)| k.then_some(u)).collect();
    (!all.is_empty()).then_some(all)
}

/// The known number that the data contradict most, in the size of the residual that is left; chi-square per number left;
/// and the test of all of them.
///
/// Every number is tested as wrong alone (a score test): what correlates with it says by how much it may move.
fn contradicted(
    experiment: &Experiment,
    fitted: &Fitted,
) -> (Option<Conflict>, f64, Option<PriorTest>) {
    let parameters = experiment.parameters;
    let numbers = fitted_numbers(experiment, fitted);
    let dof = fitted.rows().saturating_sub(numbers).max(1);
    let per_number = fitted.chi2() / dof as f64;
    let Some(weights) = parameters.known_covariance().cholesky() else {
        return (None, per_number, None);
    };
    let weights = weights.inverse();
    let pull = Pull::new(parameters, fitted, &weights);
    let places = parameters.known_places();
    let apart = places.iter().enumerate().filter_map(|(k, place)| {
        let unknown = &parameters.unknowns[*place];
        let sigma = unknown.kind.known()?.sigma;
        let known = pull.known[(k, k)].max(LEAST_SHARE * weights[(k, k)]);
        let z = pull.score[k].abs() / (known * per_number.max(1.0)).sqrt();
        // The estimate from the data and the other numbers, without the declared uncertainty of this one.
        let variance = (1.0 / known - 1.0 / weights[(k, k)]).max(0.0);
        Some((
            z,
            unknown,
            sigma,
            (unknown.nominal + pull.score[k] / known, variance),
        ))
    });
    let worst = apart.max_by(|a, b| a.0.total_cmp(&b.0));
    let limit = experiment.settings.contradiction_sigmas;
    let test = worst
        .as_ref()
        .map(|w| PriorTest::of_largest("known numbers", w.0, places.len(), limit));
    let said = worst.filter(|w| w.0 > limit).map(|(z, unknown, sigma, alone)| {
        let unit = if unknown.unit == "1" { "" } else { unknown.unit };
        let numbers = [unknown.nominal, sigma, alone.0, alone.1.sqrt()];
        let [nominal, sigma, alone, own] = numbers.map(|x| rounded(x, 5));
        Conflict {
            text: format!(
                "the known number {} is inconsistent with the data: model {nominal} ± {sigma} {unit}, estimated {alone} ± {own} {unit}, difference {z:.0} sigma; correct the number or its uncertainty",
                unknown.name
            ),
            ratio: 1.0 + pull.square,
        }
    });
    (said, per_number, test)
}

/// What pulls the known numbers away from their declared values.
struct Pull {
    /// Slope of half the data's chi-square over a shift of each declared value.
    score: DVector<f64>,
    /// What the data and the other numbers know of such shifts: the inverse of their covariance.
    known: DMatrix<f64>,
    /// Square of the moves, in sigmas after the data.
    square: f64,
}

impl Pull {
    /// `weights` is the inverse of the declared covariance. What the fit leaves at nominal values may be off by them.
    fn new(parameters: &Parameters, fitted: &Fitted, weights: &DMatrix<f64>) -> Self {
        let (loosened, places) = (Loosened::new(fitted), parameters.known_places());
        let change =
            |k: &usize| fitted.at.x[*k] + loosened.moved(*k) - parameters.unknowns[*k].nominal;
        let changes = DVector::from_iterator(places.len(), places.iter().map(change));
        let posterior = loosened.covariance(&places);
        let score = weights * changes;
        Self {
            known: weights - weights * &posterior * weights,
            square: score.dot(&(posterior * &score)),
            score,
        }
    }
}
