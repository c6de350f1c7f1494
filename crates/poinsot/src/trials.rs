//! Monte Carlo: one exact motion, many draws of sensor noise, one identification each.
//!
//! The trial number selects the random stream of a sensor, so every trial can be repeated separately. Trials run in
//! parallel and are reduced in order, so the result does not depend on the number of threads.

mod interval;
pub(crate) mod statistics;
mod sums;

pub use interval::Interval;
pub use poinsot_formats::{Band, ParameterStatistics, Statistics};
pub use statistics::{statistics, statistics_of};
pub(crate) use sums::position;
pub use sums::{NumberSums, SUMS_SCHEMA, Sums};

use crate::bind::{RELATIVE_ACCURACY, bind};
use crate::case::Case;
use crate::channel_names::names;
use crate::error::Error;
use crate::identify::{Question, estimate_by};
use crate::progress::step;
use crate::simulate::{Exact, keep_measured, scalar_errors, simulate_exact, stream};
use nalgebra::{DMatrix, DVector};
use poinsot_dynamics::{Instrument, Tree};
use poinsot_formats::address;
use poinsot_identify::{
    BodyEstimate, Estimate, Problem, Source, Status, TENSOR, axis_name, cramer_rao,
    predicted_covariance, tensor_name,
};
use poinsot_model::{Axes, Model, Sensor};
use poinsot_papers::{Kernel, method};
use poinsot_spatial::MassProperties;
use poinsot_telemetry::Table;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A repeatable experiment.
#[derive(Debug, Clone)]
pub struct Study {
    /// Measurements of ideal sensors, one table per segment.
    pub exact: Vec<Table>,
    /// The nominal model of the identification: nominal numbers, unknowns, sensors with declared noise.
    pub model: Model,
    /// The true sensors: those of the model, unless a study tests a wrong declaration.
    pub sensors: Vec<Sensor>,
    /// True mass properties, one per body.
    pub truth: Vec<MassProperties>,
    /// True bias of each sensor in sensor axes; `None`: zero, or drawn from its prior.
    pub biases: Vec<Option<Vec<f64>>>,
    /// Method with its variant and settings.
    pub question: Question,
    /// Whether maximum likelihood searches for causes of a misfit; the numbers do not change.
    pub diagnose: bool,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether each trial draws the phase of rounding steps. Otherwise an exactly repeating motion is rounded equally
    /// in every trial, and scatter between experiments appears as bias.
    pub draw_phase: bool,
    /// Relative range around the declared rounding step from which each trial draws the true step. The motion then
    /// passes the steps differently in each trial, as in experiments that are not exact copies.
    pub step_spread: f64,
}

/// One number of one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialNumber {
    /// Address, for example `base.mass_kg`, `base.inertia_kg_m2.xx`, `gyro.bias_rad_s.x`.
    pub name: String,
    /// Estimate.
    pub value: f64,
    /// Estimate minus truth.
    pub error: f64,
    /// Stated sigma; NaN if the method has none.
    pub sigma: f64,
}

/// Result of one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Status of the estimate.
    pub status: Status,
    /// Why the result is not reliable.
    pub doubts: Vec<String>,
    /// Iterations taken.
    pub iterations: usize,
    /// Chi-square per degree of freedom, mean over the segments.
    pub chi2_per_dof: f64,
    /// Chi-square per number of each kind of sensor, mean over the segments.
    pub channels: Vec<(String, f64)>,
    /// Every determined number with known truth.
    pub numbers: Vec<TrialNumber>,
    /// Normalised squared error of all determined mass properties, and their number.
    pub nees: Option<(f64, usize)>,
}

/// One trial. A failed trial has its reason.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Number.
    pub number: u64,
    /// Result, or the reason of the failure.
    pub outcome: Result<Answer, String>,
}

impl Study {
    /// The experiment of a case; `truth` is the true model, `model` the nominal one.
    ///
    /// # Errors
    /// The case does not fit the model or cannot be simulated.
    pub fn of_case(case: &Case, truth: &Model, model: Model) -> Result<Self, Error> {
        let Exact { table, biases } = simulate_exact(case, truth)?;
        Ok(Self {
            biases,
            seed: case.seed,
            ..Self::new(vec![table], truth, model)
        })
    }

    /// The experiment of noise-free tables.
    pub fn of_tables(mut exact: Vec<Table>, truth: &Model, model: Model) -> Self {
        for table in &mut exact {
            keep_measured(&model, table);
        }
        Self::new(exact, truth, model)
    }

    fn new(exact: Vec<Table>, truth: &Model, model: Model) -> Self {
        Self {
            exact,
            truth: truth.bodies.iter().map(|b| b.nominal).collect(),
            biases: vec![None; model.sensors.len()],
            sensors: model.sensors.clone(),
            model,
            question: Question::default(),
            diagnose: true,
            seed: 1,
            draw_phase: true,
            step_spread: 0.0,
        }
    }

    /// Measurements in one trial, and the bias of each sensor.
    pub fn draw(&self, trial: u64) -> (Vec<Table>, Vec<Vec<f64>>) {
        let tree = Tree::new(&self.model);
        let mut tables = self.exact.clone();
        let mut biases = vec![Vec::new(); self.sensors.len()];
        for (segment, table) in tables.iter_mut().enumerate() {
            for (i, sensor) in self.sensors.iter().enumerate() {
                // One bias for all segments, because it belongs to the sensor.
                let given = match (segment, self.biases.get(i)) {
                    (0, given) => given.and_then(|b| b.as_deref()),
                    _ => biases.get(i).map(Vec::as_slice),
                };
                let own = stream(trial, (segment << 8) | i);
                let mut instrument = Instrument::new(sensor, &tree, self.seed, own, given);
                if self.draw_phase {
                    instrument.draw_phase();
                }
                if self.step_spread > 0.0 {
                    instrument.draw_step(self.step_spread);
                }
                biases[i] = instrument.bias().to_vec();
                let channels = names(&self.model, sensor.kind, &sensor.of);
                disturb(table, &sensor.name, &channels, &mut instrument);
            }
        }
        (tables, biases)
    }

    /// Runs one trial.
    pub fn trial(&self, number: u64) -> Trial {
        let (tables, biases) = self.draw(number);
        let truth = self.true_numbers(&biases);
        let outcome = self
            .answer(&tables, &truth, &self.question, self.diagnose)
            .map_err(|error| error.to_string());
        Trial { number, outcome }
    }

    /// Applies a method to measurements from [`Self::draw`] and compares the result with the truth.
    ///
    /// # Errors
    /// The method fails.
    pub fn answer(
        &self,
        tables: &[Table],
        truth: &HashMap<String, f64>,
        question: &Question,
        diagnose: bool,
    ) -> Result<Answer, Error> {
        let by = |problem: &Problem| estimate_by(problem, question, diagnose);
        let estimate = solve(&self.model, tables, question.relative_accuracy, by)?;
        Ok(judged(&estimate, truth))
    }

    /// The kernel of a published method for this experiment, which draws and solves trials itself.
    ///
    /// # Errors
    /// The method has no kernel for it.
    pub fn kernel(&self, question: &Question) -> Result<Box<dyn Kernel>, Error> {
        let own = method(&question.method);
        let by = |problem: &Problem| {
            let own = own.map(|m| m.kernel(problem, question.variant.as_deref()));
            own.transpose()
        };
        let kernel = solve(&self.model, &self.exact, question.relative_accuracy, by)?;
        kernel.flatten().ok_or_else(|| {
            Error::usage(
                "kernel",
                &question.method,
                "this method has no kernel for this experiment",
                "take kernel out of the plan",
            )
        })
    }

    /// Runs trials in parallel; the results are in order of their numbers.
    pub fn run(&self, trials: Range<u64>) -> Vec<Trial> {
        let total = usize::try_from(trials.end.saturating_sub(trials.start)).unwrap_or(usize::MAX);
        let done = AtomicUsize::new(0);
        let run = |n| {
            let trial = self.trial(n);
            step("trials", done.fetch_add(1, Ordering::Relaxed) + 1, total);
            trial
        };
        trials.into_par_iter().map(run).collect()
    }

    /// The Cramer-Rao bound of the experiment at the true values.
    ///
    /// # Errors
    /// Invalid model or telemetry.
    pub fn bound(&self) -> Result<Estimate, Error> {
        solve(
            &self.true_model(),
            &self.exact,
            RELATIVE_ACCURACY,
            cramer_rao,
        )
    }

    /// What `predict` says of the experiment at the true values.
    ///
    /// # Errors
    /// Invalid model or telemetry.
    pub fn predicted(&self) -> Result<Estimate, Error> {
        solve(
            &self.true_model(),
            &self.exact,
            RELATIVE_ACCURACY,
            predicted_covariance,
        )
    }

    /// The model with the true numbers as nominal ones.
    pub fn true_model(&self) -> Model {
        let mut model = self.model.clone();
        for (body, truth) in model.bodies.iter_mut().zip(&self.truth) {
            body.nominal = *truth;
        }
        model
    }

    /// True mass properties and the biases from [`Self::draw`], by address.
    pub fn true_numbers(&self, biases: &[Vec<f64>]) -> HashMap<String, f64> {
        let mut all = HashMap::new();
        for (body, truth) in self.model.bodies.iter().zip(&self.truth) {
            all.extend(mass_names(&body.name).into_iter().zip(values(truth)));
        }
        for (sensor, bias) in self.sensors.iter().zip(biases) {
            let turned = match sensor.kind.axes() {
                Axes::Sensor => sensor.R_BS,
                Axes::Inertial => nalgebra::Matrix3::identity(),
                Axes::None => {
                    let own = scalar_errors(&self.model, sensor, bias, &[]).into_iter();
                    all.extend(own.map(|(name, unit, x)| (address(&name, unit), x)));
                    continue;
                }
            };
            if bias.len() == 3 {
                let bias = turned * nalgebra::Vector3::from_column_slice(bias);
                let unit = self.model.unit_of(sensor);
                for k in 0..3 {
                    let name = format!("{}.bias_{}", sensor.name, axis_name(k));
                    all.insert(address(&name, unit), bias[k]);
                }
            }
        }
        all
    }
}

/// Binds measurements to a model and solves their problem.
fn solve<T>(
    model: &Model,
    tables: &[Table],
    relative_accuracy: f64,
    by: impl FnOnce(&Problem) -> Result<T, Error>,
) -> Result<T, Error> {
    let tree = Tree::new(model);
    let bound = bind(model, &tree, tables)?;
    by(&Problem {
        relative_accuracy,
        ..bound.problem(model, &tree)
    })
}

/// Compares the estimate of a kernel with true numbers by address; `names` as of [`mass_names`].
pub(crate) fn judged_body(
    body: &MassProperties,
    names: &[String],
    truth: &HashMap<String, f64>,
) -> Answer {
    let number = |(name, value): (&String, f64)| {
        Some(TrialNumber {
            error: value - truth.get(name)?,
            value,
            sigma: f64::NAN,
            name: name.clone(),
        })
    };
    Answer {
        status: Status::Converged,
        doubts: Vec::new(),
        iterations: 1,
        chi2_per_dof: f64::NAN,
        channels: Vec::new(),
        nees: None,
        numbers: names.iter().zip(values(body)).filter_map(number).collect(),
    }
}

/// Compares an estimate with true numbers by address, as from [`Study::true_numbers`].
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// let truth = [("bus.inertia_kg_m2.zz".to_owned(), 2.5)].into();
/// let judged = trials::judged(&identified.estimate, &truth);
/// let number = &judged.numbers[0];
/// assert_eq!(number.error, number.value - 2.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn judged(estimate: &Estimate, truth: &HashMap<String, f64>) -> Answer {
    let numbers: Vec<TrialNumber> = estimated_numbers(estimate)
        .into_iter()
        .filter_map(|(name, value, sigma)| {
            Some(TrialNumber {
                error: value - truth.get(&name)?,
                value,
                sigma,
                name,
            })
        })
        .collect();
    let segments = estimate.fit.len().max(1) as f64;
    let mut channels: Vec<(String, f64)> = Vec::new();
    for channel in estimate.fit.iter().flat_map(|f| &f.channels) {
        let share = channel.chi2_per_number.unwrap_or(f64::NAN) / segments;
        match channels.iter_mut().find(|(name, _)| *name == channel.name) {
            Some((_, sum)) => *sum += share,
            None => channels.push((channel.name.clone(), share)),
        }
    }
    Answer {
        status: estimate.status,
        doubts: estimate.doubts(),
        iterations: estimate.iterations,
        chi2_per_dof: estimate.fit.iter().map(|f| f.chi2_per_dof).sum::<f64>() / segments,
        channels,
        nees: nees(estimate, &numbers),
        numbers,
    }
}

/// Applies the errors of a sensor to its channels; missing channels are ignored.
fn disturb(table: &mut Table, sensor: &str, channels: &[String], instrument: &mut Instrument) {
    let find = |table: &Table, name: &String| {
        let own = |own: &str| {
            table
                .channels
                .iter()
                .position(|c| c.sensor == own && c.name == *name)
        };
        own(sensor).or_else(|| own(""))
    };
    let at: Vec<Option<usize>> = channels.iter().map(|name| find(table, name)).collect();
    let samples = at.iter().flatten().map(|&k| table.channels[k].values.len());
    let samples = samples.min().unwrap_or(0);
    let mut exact = vec![0.0; at.len()];
    let mut reading = Vec::with_capacity(at.len());
    for k in 0..samples {
        let first = at.iter().flatten().next();
        let time_s = first.map_or(0.0, |&c| table.channels[c].time_s[k]);
        for (x, channel) in exact.iter_mut().zip(&at) {
            *x = channel.map_or(0.0, |c| table.channels[c].values[k]);
        }
        instrument.disturb(time_s, &exact, &mut reading);
        for (x, channel) in reading.iter().zip(&at) {
            if let Some(c) = channel {
                table.channels[*c].values[k] = *x;
            }
        }
    }
}

/// Every number determined by data: address, value, sigma (NaN if the method states none).
pub(crate) fn estimated_numbers(estimate: &Estimate) -> Vec<(String, f64, f64)> {
    let mut list = Vec::new();
    for body in estimate.bodies.iter().filter(|b| b.asked) {
        for (name, number) in numbers_of(body) {
            if let (Source::Data, Some(value)) = (number.source, number.value) {
                let sigma = number.sigma.unwrap_or(f64::NAN);
                let name = address(&format!("{}.{name}", body.name), "");
                list.push((name, value, sigma));
            }
        }
    }
    for item in &estimate.nuisance {
        if let (Some(value), Some(sigma)) = (item.number.value, item.number.sigma) {
            list.push((address(&item.name, item.unit), value, sigma));
        }
    }
    list
}

/// Mass, mass centre and central inertia in the order of [`mass_names`].
fn values(body: &MassProperties) -> impl Iterator<Item = f64> {
    let centre = body.p_BoBcm_B.iter().copied();
    let inertia = TENSOR.into_iter().map(|at| body.I_BBcm_B[at]);
    std::iter::once(body.mass).chain(centre).chain(inertia)
}

/// Addresses of mass, mass centre and central inertia of a body.
pub(crate) fn mass_names(body: &str) -> Vec<String> {
    let com = (0..3).map(|k| format!("com_{}", axis_name(k)));
    let inertia = (0..6).map(|k| format!("inertia_{}", tensor_name(k)));
    let all = std::iter::once("mass".to_owned()).chain(com).chain(inertia);
    all.map(|name| address(&format!("{body}.{name}"), ""))
        .collect()
}

/// Mass, mass centre and central inertia of a body with their names.
pub(crate) fn numbers_of(
    body: &BodyEstimate,
) -> impl Iterator<Item = (String, &poinsot_identify::Number)> {
    let mass = std::iter::once(("mass".to_owned(), &body.mass));
    let com = (0..3).map(|k| (format!("com_{}", axis_name(k)), &body.com[k]));
    let inertia = (0..6).map(|k| (format!("inertia_{}", tensor_name(k)), &body.inertia[k]));
    mass.chain(com).chain(inertia)
}

/// `e^T C^-1 e` over the mass properties with the stated covariance; `None` if it is singular or a true value is
/// missing.
fn nees(estimate: &Estimate, numbers: &[TrialNumber]) -> Option<(f64, usize)> {
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
        scaled[i] = number.error / sigma[i];
    }
    let correlation = DMatrix::from_fn(n, n, |i, j| {
        estimate.covariance[at[i]][at[j]] / (sigma[i] * sigma[j])
    });
    let l = correlation.cholesky()?.unpack();
    if (0..n).any(|i| l[(i, i)] < 1.0e-6) {
        return None;
    }
    let white = l.solve_lower_triangular(&scaled)?;
    Some((white.norm_squared(), n))
}
