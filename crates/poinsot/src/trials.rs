//! Monte Carlo: one exact motion, many draws of sensor noise, one identification each.
//!
//! The trial number selects the random stream of a sensor, so every trial can be repeated separately. A trial by a
//! method is a [`Row`]; every statistic is made from rows.

mod row;
mod sums;

pub use poinsot_formats::{Band, BandedFile};
pub(crate) use row::estimated_numbers;
pub use row::{Nees, Row, RowNumber, judged};
pub(crate) use sums::position;
pub use sums::{NumberSums, OUTSIDE, Sums};

use crate::bind::{RELATIVE_ACCURACY, solve};
use crate::case::Case;
use crate::channel_names::names;
use crate::error::Error;
use crate::identify::{Question, estimate_by};
use crate::mass_numbers::names as mass_names;
use crate::simulate::{Exact, keep_measured, scalar_errors, simulate_exact, stream};
use poinsot_dynamics::{Instrument, Tree};
use poinsot_formats::address;
use poinsot_identify::{Estimate, Problem, axis_name, cramer_rao, predicted_covariance};
use poinsot_model::{Axes, Model, Sensor};
use poinsot_spatial::MassProperties;
use poinsot_telemetry::Table;
use std::collections::HashMap;

/// Sigmas of the Cramer-Rao bound by address; empty if it does not exist.
pub type Bound = HashMap<String, f64>;

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

    /// Runs one trial; its row has the bounds given.
    pub fn trial(&self, number: u64, bound: &Bound) -> Row {
        let (tables, biases) = self.draw(number);
        let found = self.estimate(&tables, &self.question, self.diagnose);
        let found = found.map_err(|error| error.to_string());
        Row::judged(number, found, &self.expected(&biases, bound))
    }

    /// Applies a method to measurements from [`Self::draw`].
    ///
    /// # Errors
    /// The method fails.
    pub fn estimate(
        &self,
        tables: &[Table],
        question: &Question,
        diagnose: bool,
    ) -> Result<Estimate, Error> {
        let by = |problem: &Problem| estimate_by(problem, question, diagnose);
        solve(&self.model, tables, question.relative_accuracy, by)
    }

    /// The Cramer-Rao bound of the experiment at the true values.
    ///
    /// # Errors
    /// Invalid model or telemetry.
    pub fn bound(&self) -> Result<Estimate, Error> {
        let model = self.true_model();
        solve(&model, &self.exact, RELATIVE_ACCURACY, cramer_rao)
    }

    /// What `predict` says of the experiment at the true values, with exact known numbers: trials do not draw them.
    ///
    /// # Errors
    /// Invalid model or telemetry.
    pub fn predicted(&self) -> Result<Estimate, Error> {
        let mut model = self.true_model();
        model.knowledge.uncertain.clear();
        solve(&model, &self.exact, RELATIVE_ACCURACY, predicted_covariance)
    }

    /// The model with the true numbers as nominal ones.
    pub fn true_model(&self) -> Model {
        let mut model = self.model.clone();
        for (body, truth) in model.bodies.iter_mut().zip(&self.truth) {
            body.nominal = *truth;
        }
        model
    }

    /// Sigmas of the Cramer-Rao bound; empty if it does not exist.
    pub fn bound_sigmas(&self) -> Bound {
        let numbers = self.bound().map(|bound| estimated_numbers(&bound));
        let numbers = numbers.unwrap_or_default().into_iter();
        numbers.filter_map(|n| Some((n.name, n.sigma?))).collect()
    }

    /// True mass properties and the biases from [`Self::draw`], with their bounds and without an estimate.
    pub fn expected(&self, biases: &[Vec<f64>], bound: &Bound) -> Vec<RowNumber> {
        let mut all = Vec::new();
        let mut add = |name: String, truth| {
            all.push(RowNumber {
                bound: bound.get(&name).copied(),
                name,
                truth,
                ..RowNumber::default()
            });
        };
        for (body, truth) in self.model.bodies.iter().zip(&self.truth) {
            let named = mass_names(&body.name).into_iter().zip(truth.to_array());
            named.for_each(|(name, x)| add(name, x));
        }
        for (sensor, bias) in self.sensors.iter().zip(biases) {
            let turned = match sensor.kind.axes() {
                Axes::Sensor => sensor.R_BS,
                Axes::Inertial => nalgebra::Matrix3::identity(),
                Axes::None => {
                    let own = scalar_errors(&self.model, sensor, bias, &[]).into_iter();
                    own.for_each(|(name, unit, x)| add(address(&name, unit), x));
                    continue;
                }
            };
            if bias.len() == 3 {
                let bias = turned * nalgebra::Vector3::from_column_slice(bias);
                let unit = self.model.unit_of(sensor);
                for k in 0..3 {
                    let name = format!("{}.bias_{}", sensor.name, axis_name(k));
                    add(address(&name, unit), bias[k]);
                }
            }
        }
        all
    }
}

/// Applies the errors of a sensor to its channels; missing channels are ignored.
fn disturb(table: &mut Table, sensor: &str, channels: &[String], instrument: &mut Instrument) {
    let of = |sensor: &str, name: &String| {
        let mut all = table.channels.iter();
        all.position(|c| c.sensor == sensor && c.name == *name)
    };
    let find = |name: &String| of(sensor, name).or_else(|| of("", name));
    let at: Vec<Option<usize>> = channels.iter().map(find).collect();
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
