//! Known numbers within their uncertainty: unknowns with a prior, whatever kind of number they are.
//!
//! A known number enters the predictions through the model alone. So its column is a difference of two whole evaluations at
//! the end of the fit, the same way for a mass, a joint axis or a mounting. The fit goes on from there with these columns
//! beside its own and the declared covariance as a prior; every prediction is that of the vehicle with the numbers moved, and
//! the columns are made again where they have moved. What the data say of a number shrinks its prior; where they say
//! nothing it stays where it is and its prior goes into the covariance (a consider parameter: Schmidt 1966). One sigma of
//! a known number is therefore no misfit.

mod effects;

pub(crate) use effects::Effects;

use crate::conflict::Conflict;
use crate::fit::{Fitted, fit_from};
use crate::information::{Experiment, Point};
use crate::likelihood::KnownColumns;
use crate::parameters::{KnownUnknown, Parameters, Unknown, UnknownKind};
use crate::problem::Problem;
use crate::segment::{Segment, SensorValue};
use crate::solved::head;
use crate::walk::take_predictions;
use nalgebra::DMatrix;
use poinsot_dynamics::Tree;
use poinsot_model::{KnownNumber, LIKE_WHEELS, Model, SensorKind, rounded};
use poinsot_spatial::{UnitQuaternion, Vector3};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// Step of a difference, sigmas of the number. One sigma may be 10^5 times the noise of all readings together; the bend over
/// a step and its round-off must both stay far below the noise.
const STEP: f64 = 1.0e-5;
/// Effect of one sigma of a number on all predictions together, in their noise, below which it is left out.
const SILENT: f64 = 1.0e-3;
/// Most iterations with known numbers among the unknowns.
const TRIED: usize = 30;
/// Sigmas by which a known number may have moved since its columns were made. One sigma changes a column by a tenth at most
/// (inertia from a drawing), so columns this old move no answer by more than a hundredth of its sigma.
const FRESH: f64 = 0.1;
/// Fall of chi-square that a full step may still promise where the columns are differences.
const SETTLED: f64 = 1.0e-3;
/// Sigmas between a known number and what the data say of it, from which they contradict each other.
const FAR: f64 = 5.0;
/// Least share of a prior variance that the data leave to judge it by.
const SEEN: f64 = 1.0e-6;
/// Chi-square per degree of freedom that is left, below which a wrong known number explains a misfit.
const EXPLAINED: f64 = 1.5;

/// The vehicle with its known numbers at other values than those of the model.
pub(crate) struct Centre {
    model: Model,
    tree: Tree,
    segments: Option<Vec<Segment>>,
    /// The same unknowns, of that vehicle.
    pub parameters: Parameters,
}

impl Centre {
    /// `changes` are added to the numbers of the problem; `None` where no such vehicle can be asked about.
    pub fn new(
        problem: &Problem,
        parameters: &Parameters,
        changes: &[(KnownNumber, usize, f64)],
    ) -> Option<Self> {
        Self::from(problem, problem.model, parameters, changes)
    }

    /// The same from a vehicle whose numbers have moved already: turns are about directions of the `nominal` one.
    fn from(
        problem: &Problem,
        nominal: &Model,
        parameters: &Parameters,
        changes: &[(KnownNumber, usize, f64)],
    ) -> Option<Self> {
        let mut model = problem.model.clone();
        let mut segments = None;
        for (number, component, change) in changes.iter().filter(|c| c.2 != 0.0) {
            number.shift(nominal, &mut model, *component, *change);
            let acts_on_readings =
                matches!(number, KnownNumber::Force(_) | KnownNumber::Mounting(_));
            if acts_on_readings {
                let segments = segments.get_or_insert_with(|| problem.segments.to_vec());
                reread(segments, *number, *component, *change);
            }
        }
        let tree = Tree::new(&model);
        let parameters = parameters.of_vehicle(&model, &tree)?;
        Some(Self {
            model,
            tree,
            segments,
            parameters,
        })
    }

    /// The known numbers where a value of all unknowns has them.
    pub fn at(problem: &Problem, parameters: &Parameters, x: &[f64]) -> Option<Self> {
        let unknowns = parameters.unknowns.iter().zip(x);
        let changes = unknowns.filter_map(|(u, x)| {
            let known = u.kind.known()?;
            Some((known.number, known.component, x - u.nominal))
        });
        Self::new(problem, parameters, &changes.collect::<Vec<_>>())
    }

    /// The question asked of that vehicle.
    pub fn problem<'a>(&'a self, problem: &Problem<'a>) -> Problem<'a> {
        Problem {
            model: &self.model,
            tree: &self.tree,
            segments: self.segments.as_deref().unwrap_or(problem.segments),
            ..*problem
        }
    }
}

/// What would have been read with another thrust for each newton, or with a sensor mounted otherwise.
fn reread(segments: &mut [Segment], number: KnownNumber, component: usize, change: f64) {
    for segment in segments {
        match number {
            KnownNumber::Force(thruster) => {
                let firings = segment.firings.iter_mut();
                for f in firings.filter(|f| f.thruster == thruster) {
                    f.force *= 1.0 + change;
                }
            }
            KnownNumber::Mounting(sensor) => {
                let mut turn = Vector3::zeros();
                turn[component % 3] = change;
                let turn = UnitQuaternion::from_scaled_axis(turn);
                let records = segment.observations.sensors.iter_mut();
                for record in records.filter(|r| r.sensor == Some(sensor)) {
                    let attitude = record.kind == SensorKind::Attitude;
                    for sample in &mut record.samples {
                        sample.value = match sample.value {
                            SensorValue::Attitude(R) if attitude => {
                                SensorValue::Attitude(R * turn.inverse())
                            }
                            SensorValue::Vector(v) if !attitude => SensorValue::Vector(turn * v),
                            other => other,
                        };
                    }
                }
            }
            _ => {}
        }
    }
}

/// The fit with known numbers within their uncertainty.
pub(crate) struct KnownFit {
    kept: KeptColumns,
    /// All unknowns, the known numbers last.
    parameters: Parameters,
    pub fitted: Fitted,
    /// Whether the known numbers were left at their values, because no such vehicle fits.
    pub left: bool,
    /// Which one the data contradict, where that explains the misfit.
    pub contradiction: Option<Conflict>,
}

impl KnownFit {
    /// The experiment of which [`Self::fitted`] is the fit.
    pub fn experiment<'b>(&'b self, experiment: &'b Experiment<'b>) -> Experiment<'b> {
        let mut own = experiment.with_parameters(&self.parameters);
        own.kept = Arc::clone(&self.kept);
        own
    }
}

/// Columns with the values of the known numbers where they were made, sigmas.
pub(crate) type KeptColumns = Arc<Mutex<Option<(Vec<f64>, Arc<KnownColumns>)>>>;

/// Columns of the known numbers at a value of all unknowns: those kept, where the numbers have hardly moved.
pub(crate) fn columns_at(experiment: &Experiment, at: &Point) -> Option<Arc<KnownColumns>> {
    let unknowns = &experiment.parameters.unknowns;
    let places = places(experiment.parameters);
    let value = |p: &usize| at.x[*p] / unknowns[*p].natural;
    let here: Vec<f64> = places.iter().map(value).collect();
    let close = |old: &[f64]| {
        let mut pairs = old.iter().zip(&here);
        old.len() == here.len() && pairs.all(|(a, b)| (a - b).abs() < FRESH)
    };
    let mut kept = experiment.kept.lock().ok()?;
    if let Some((_, columns)) = kept.as_ref().filter(|(old, _)| close(old)) {
        return Some(Arc::clone(columns));
    }
    let columns = Arc::new(slopes(experiment, at)?);
    *kept = Some((here, Arc::clone(&columns)));
    Some(columns)
}

/// Fits on with the known numbers within their uncertainty; `None` where all of them are exact, or nothing depends on them.
pub(crate) fn fit_known(experiment: &Experiment, fitted: &Fitted) -> Option<KnownFit> {
    if !fitted.settled {
        return None;
    }
    let problem = experiment.problem;
    let all = unknowns(problem.model);
    let (all, columns) = shown(experiment, &fitted.at, all)?;
    let parameters = extended(problem, experiment.parameters, &all);
    let mut wide = experiment.with_parameters(&parameters);
    let nominal = all.iter().map(|u| u.nominal / u.natural).collect();
    wide.kept = Arc::new(Mutex::new(Some((nominal, Arc::new(columns)))));
    let first = behind(&fitted.at, &all);
    let found = fit_from(&wide, first.clone(), TRIED)?;
    let done = found.settled || promised(&found) < SETTLED;
    let (worst, per_number) = contradicted(&wide, &found);
    // What known numbers cannot explain within their uncertainty is looked for elsewhere.
    let left = per_number > EXPLAINED && (worst.is_some() || !done);
    let fitted = match left {
        true => Fitted {
            settled: true,
            ..fit_from(&wide, first, 0)?
        },
        false => Fitted {
            settled: done,
            ..found
        },
    };
    let kept = Arc::clone(&wide.kept);
    Some(KnownFit {
        kept,
        fitted,
        left,
        contradiction: worst.filter(|_| !left && done),
        parameters,
    })
}

/// How much a full step would still lower chi-square.
fn promised(fitted: &Fitted) -> f64 {
    let shared = &fitted.shared;
    let last = shared.nuisances + shared.mass;
    let nuisances = (0..shared.nuisances).map(|i| shared.r[(i, last)].powi(2));
    nuisances.sum::<f64>() + fitted.spectrum.decrease(&shared.rhs(), 0.0)
}

/// A point of the fit without the known numbers, with these at the values of the model.
fn behind(at: &Point, all: &[Unknown]) -> Point {
    let nominal = all.iter().map(|u| u.nominal);
    Point {
        x: at.x.iter().copied().chain(nominal).collect(),
        heads: at.heads.clone(),
    }
}

/// Uncertain known numbers as unknowns.
fn unknowns(model: &Model) -> Vec<Unknown> {
    let mut all = Vec::new();
    for uncertain in model.uncertain() {
        let number = uncertain.number;
        for component in 0..number.components() {
            let sigma = number.absolute(model, component, uncertain.sigma);
            if sigma.is_nan() || sigma <= 0.0 {
                continue;
            }
            let known = KnownUnknown {
                number,
                component,
                sigma,
                slopes: Vec::new(),
            };
            all.push(Unknown {
                kind: UnknownKind::Known(known),
                name: number.name(model, component),
                unit: number.unit(),
                nominal: number.value(model, component),
                natural: sigma,
            });
        }
    }
    all
}

/// The unknowns with the known numbers behind them, and what those do to the barycentric parameters.
fn extended(problem: &Problem, parameters: &Parameters, all: &[Unknown]) -> Parameters {
    let mut out = parameters.clone();
    let x = parameters.nominal_vector();
    let here = parameters.bodies(&x);
    for unknown in all {
        let mut unknown = unknown.clone();
        if let UnknownKind::Known(known) = &mut unknown.kind {
            let step = STEP * known.sigma;
            let change = (known.number, known.component, step);
            if let Some(there) = Centre::new(problem, parameters, &[change]) {
                let bodies = there.parameters.bodies(&x);
                for (body, (a, b)) in here.iter().zip(&bodies).enumerate() {
                    let pairs = a.to_array().into_iter().zip(b.to_array());
                    let slopes = pairs.enumerate().filter(|(_, (a, b))| a != b);
                    known
                        .slopes
                        .extend(slopes.map(|(k, (a, b))| (10 * body + k, (b - a) / step)));
                }
            }
        }
        out.unknowns.push(unknown);
    }
    out
}

/// The numbers that show in the predictions, with their columns at their nominal values.
fn shown(
    experiment: &Experiment,
    at: &Point,
    all: Vec<Unknown>,
) -> Option<(Vec<Unknown>, KnownColumns)> {
    if all.is_empty() {
        return None;
    }
    let whole = extended(experiment.problem, experiment.parameters, &all);
    let mut columns = slopes(&experiment.with_parameters(&whole), &behind(at, &all))?;
    let shows = |k: usize| {
        let sensors = columns.slopes.iter().flatten();
        let square: f64 = sensors
            .filter_map(|numbers| numbers.get(k))
            .flatten()
            .map(|v| v.norm_squared())
            .sum();
        square.sqrt() * all[k].natural > SILENT
    };
    let keep: Vec<bool> = (0..all.len()).map(shows).collect();
    for numbers in columns.slopes.iter_mut().flatten() {
        let mut kept = keep.iter();
        numbers.retain(|_| kept.next() == Some(&true));
    }
    let pairs = all.into_iter().zip(keep);
    let all: Vec<Unknown> = pairs.filter_map(|(u, k)| k.then_some(u)).collect();
    (!all.is_empty()).then_some((all, columns))
}

/// Slopes of all whitened predictions over each known number, by differences, at a value of all unknowns. Predictions are
/// compared with each other: whitening depends on the vehicle where inputs err, and its change times the residual is no
/// slope.
fn slopes(experiment: &Experiment, at: &Point) -> Option<KnownColumns> {
    let (own, kept) = experiment.parameters.without_known();
    let base = Point {
        x: kept.iter().map(|k| at.x[*k]).collect(),
        heads: at.heads.clone(),
    };
    let numbers: Vec<(&KnownUnknown, f64)> = places(experiment.parameters)
        .iter()
        .map(|p| (&experiment.parameters.unknowns[*p], at.x[*p]))
        .filter_map(|(u, x)| Some((u.kind.known()?, x - u.nominal)))
        .collect();
    let moved = numbers
        .iter()
        .map(|(n, change)| (n.number, n.component, *change));
    let centre = Centre::new(experiment.problem, &own, &moved.collect::<Vec<_>>())?;
    let there = centre.problem(experiment.problem);
    let mut perfect = there.segments.to_vec();
    take_predictions(
        &experiment.of_vehicle(&there, &centre.parameters),
        &base,
        &mut perfect,
    )?;
    let there = Problem {
        segments: &perfect,
        ..there
    };
    let here = experiment
        .of_vehicle(&there, &centre.parameters)
        .evaluate(&base, false)?;
    let differences = |k: usize| -> Option<Vec<Vec<Vec<Vector3>>>> {
        let number = numbers[k].0;
        let step = STEP * number.sigma;
        let change = (number.number, number.component, step);
        let nominal = experiment.problem.model;
        let centre = Centre::from(&there, nominal, &centre.parameters, &[change])?;
        let beside = centre.problem(&there);
        let evaluated = experiment
            .of_vehicle(&beside, &centre.parameters)
            .evaluate(&base, false)?;
        let segments = here.iter().zip(&evaluated);
        let slope = |(a, b): (&Vector3, &Vector3)| (a - b) / step;
        segments
            .map(|(a, b)| {
                let sensors = a.channels.iter().zip(&b.channels);
                sensors
                    .map(|(a, b)| {
                        let same = a.white.len() == b.white.len();
                        same.then(|| a.white.iter().zip(&b.white).map(slope).collect())
                    })
                    .collect()
            })
            .collect()
    };
    let by_number: Vec<Option<_>> = (0..numbers.len())
        .into_par_iter()
        .map(differences)
        .collect();
    let mut out = KnownColumns::default();
    for (s, one) in here.iter().enumerate() {
        let names = one.channels.iter().map(|c| c.name.clone());
        out.sensors.push(names.collect());
        let sensors = 0..one.channels.len();
        out.slopes.push(
            sensors
                .map(|i| {
                    let of = |all: &Option<Vec<Vec<Vec<Vector3>>>>| {
                        // A number that cannot be moved leaves nothing to say.
                        let all = all.as_ref().and_then(|all| all.get(s)?.get(i).cloned());
                        all.unwrap_or_default()
                    };
                    by_number.iter().map(of).collect()
                })
                .collect(),
        );
    }
    Some(out)
}

/// Places of the known numbers among the unknowns.
pub(crate) fn places(parameters: &Parameters) -> Vec<usize> {
    let unknowns = parameters.unknowns.iter().enumerate();
    let known = unknowns.filter(|(_, u)| u.kind.known().is_some());
    known.map(|(k, _)| k).collect()
}

/// Declared covariance of the known numbers among the unknowns, in their order.
pub(crate) fn declared_covariance(parameters: &Parameters) -> DMatrix<f64> {
    let of = |k: &usize| {
        let unknown = &parameters.unknowns[*k];
        (unknown.kind.known(), unknown.nominal)
    };
    let all: Vec<_> = places(parameters).iter().map(of).collect();
    let spin = |k: Option<&KnownUnknown>| {
        k.is_some_and(|k| matches!(k.number, KnownNumber::SpinInertia(_)))
    };
    DMatrix::from_fn(all.len(), all.len(), |i, j| {
        let ((a, own), (b, other)) = (all[i], all[j]);
        let product = a.map_or(0.0, |k| k.sigma) * b.map_or(0.0, |k| k.sigma);
        match () {
            () if i == j => product,
            () if spin(a) && spin(b) && own == other => LIKE_WHEELS * product,
            () => 0.0,
        }
    })
}

/// Covariance of the known numbers among the unknowns after the data, in their order.
pub(crate) fn covariance(parameters: &Parameters, fitted: &Fitted) -> DMatrix<f64> {
    let mass = fitted.shared.mass;
    let heads = head(
        &fitted.shared.r,
        fitted.shared.nuisances,
        &fitted.at.x[..mass],
    );
    let c = fitted.spectrum.covariance();
    let places: Vec<usize> = places(parameters).iter().map(|p| p - mass).collect();
    let slope = |k: usize| &heads.slope[places[k]];
    DMatrix::from_fn(places.len(), places.len(), |i, j| {
        let (a, b) = (slope(i), slope(j));
        let carried: f64 = (0..mass)
            .map(|p| a[p] * (0..mass).map(|q| c[(p, q)] * b[q]).sum::<f64>())
            .sum();
        carried + heads.covariance[(places[i], places[j])]
    })
}

/// How many numbers the data determined of the known ones: their count, less what the prior holds of each.
pub(crate) fn determined(parameters: &Parameters, fitted: &Fitted) -> f64 {
    let declared = declared_covariance(parameters);
    let n = declared.nrows();
    let inverse = declared.cholesky().map(|c| c.inverse());
    let held = inverse.map(|inverse| (inverse * covariance(parameters, fitted)).trace());
    n as f64 - held.unwrap_or(n as f64)
}

/// The known number that the data contradict most, in the size of the residual that is left; and chi-square per number left.
fn contradicted(experiment: &Experiment, fitted: &Fitted) -> (Option<Conflict>, f64) {
    let parameters = experiment.parameters;
    let rows: usize = fitted.evaluated.iter().map(|e| e.rows).sum();
    let chi2: f64 = fitted.evaluated.iter().map(|e| e.chi2).sum();
    let numbers = crate::maximum_likelihood::fitted_numbers(experiment, fitted);
    let per_number = chi2 / rows.saturating_sub(numbers).max(1) as f64;
    let posterior = covariance(parameters, fitted);
    let places = places(parameters);
    let apart = places.iter().enumerate().filter_map(|(k, place)| {
        let unknown = &parameters.unknowns[*place];
        let sigma = unknown.kind.known()?.sigma;
        let left = (1.0 - posterior[(k, k)] / (sigma * sigma)).max(SEEN);
        let change = fitted.at.x[*place] - unknown.nominal;
        let z = change.abs() / (sigma * (left * per_number.max(1.0)).sqrt());
        // What the data alone say, the declared uncertainty taken out again.
        let alone = (
            unknown.nominal + change / left,
            posterior[(k, k)].max(0.0) / left,
        );
        Some((z, unknown, sigma, alone))
    });
    let worst = apart.max_by(|a, b| a.0.total_cmp(&b.0));
    let said = worst.filter(|w| w.0 > FAR).map(|(z, unknown, sigma, alone)| {
        let unit = if unknown.unit == "1" { "" } else { unknown.unit };
        let numbers = [unknown.nominal, sigma, alone.0, alone.1.sqrt()];
        let [nominal, sigma, alone, own] = numbers.map(|x| rounded(x, 5));
        Conflict {
            text: format!(
                "the data contradict the known number {}: the model has {nominal} ± {sigma} {unit}, the data alone say {alone} ± {own} {unit}, {z:.0} sigma apart; correct the number or its uncertainty",
                unknown.name
            ),
            ratio: 1.0 + pull(parameters, fitted, &posterior),
        }
    });
    (said, per_number)
}

/// Square of what the declared uncertainties have moved the known numbers by, in their sigmas after the data.
fn pull(parameters: &Parameters, fitted: &Fitted, posterior: &DMatrix<f64>) -> f64 {
    let change = |k: &usize| fitted.at.x[*k] - parameters.unknowns[*k].nominal;
    let changes: Vec<f64> = places(parameters).iter().map(change).collect();
    let changes = DMatrix::from_column_slice(changes.len(), 1, &changes);
    let declared = declared_covariance(parameters).cholesky();
    let weighted = declared.map(|c| c.solve(&changes));
    weighted.map_or(0.0, |w| (w.transpose() * posterior * &w)[(0, 0)])
}
