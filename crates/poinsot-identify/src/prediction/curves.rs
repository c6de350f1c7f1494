//! Predicted and measured curves of every sensor, for figures.
//!
//! Statistics come from every sample; curves keep at most a given number of points.

use crate::answer;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::fit_starts;
use crate::likelihood::{ChannelResidual, Evaluated, InitialState};
use crate::methods::flexible::explained;
use crate::methods::linear::{linear, solve_linear};
use crate::motion::input_noise::InputNoise;
use crate::motion::{Motion, State, Vehicle, tilted};
use crate::problem::parameters::Parameters;
use crate::problem::refusal::NO_MOTION;
use crate::problem::segment::{Segment, SensorRecord, SensorValue};
use crate::problem::settings::Settings;
use crate::problem::{Problem, ProblemError};
use crate::sensors::{DueSample, IdealSeries, Predictor, SampleStream, SpareVectors, across};
use crate::solution::estimate::Estimate;
use poinsot_dynamics::{Kinematics, SensorErrors, composite, momentum, wheel_momentum};
use poinsot_formats::Row;
pub use poinsot_formats::{Channel as PredictedChannel, Segment as Prediction};
use poinsot_model::{Joint, JointKind, Model, SensorKind, printed_unit};
use poinsot_spatial::{InertialParameters, MassProperties, UnitQuaternion, Vector3};

/// Bars of a histogram of whitened residuals, from -4 to 4 sigma; what lies outside is in the last bars.
pub const HISTOGRAM_BARS: usize = 32;
/// Lags of the autocorrelation, from 1.
pub const LAGS: usize = 20;
/// Steps of pose, momentum and biases at given mass properties.
const STARTS: usize = 8;
/// Half the width of the histogram, sigmas.
const HISTOGRAM_REACH: f64 = 4.0;

/// Maximum likelihood with what its answer predicts, at most `points` points a curve.
///
/// # Errors
/// As [`crate::maximum_likelihood`].
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let (estimate, curves) = maximum_likelihood_predicted(&problem, Loss::Gaussian, 100)?;
/// // One set of curves for each segment.
/// assert_eq!(curves.len(), estimate.fit.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn maximum_likelihood_predicted(
    problem: &Problem,
    options: impl Into<Settings>,
    points: usize,
) -> Result<(Estimate, Vec<Prediction>), ProblemError> {
    let explained = explained(problem, options.into())?;
    let problem = &explained.problem(problem);
    let ended = &explained.ended;
    let solution = &ended.solution;
    let taken = problem.with_segments(ended.segments.as_deref().unwrap_or(problem.segments));
    let moved = ended.shifted.as_ref().map(|c| c.problem(&taken));
    let mut experiment = Experiment::new(moved.as_ref().unwrap_or(&taken), &solution.parameters);
    if let Some(own) = &solution.likelihood {
        experiment.wheels = own.wheels;
    }
    let predictions = predict(&experiment, &ended.at, points);
    Ok((answer::write_with_remedies(problem, solution), predictions))
}

/// The linear method with what its answer predicts, at most `points` points a curve.
///
/// # Errors
/// As [`crate::linear`].
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let (estimate, curves) = linear_predicted(&problem, 100)?;
/// assert_eq!(curves.len(), estimate.fit.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn linear_predicted(
    problem: &Problem,
    points: usize,
) -> Result<(Estimate, Vec<Prediction>), ProblemError> {
    let estimate = linear(problem)?;
    let solution = solve_linear(problem)?;
    let experiment = Experiment::new(problem, &solution.parameters);
    let at = solution.point(&experiment);
    Ok((estimate, predict(&experiment, &at, points)))
}

/// What given mass properties predict, one entry a body of the model: pose, momentum and biases are fitted
/// to the readings, nothing else. Empty where such bodies cannot move.
///
/// # Errors
/// The model or the data are not valid for the method.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let nominal = model.bodies[0].nominal;
/// let curves = predicted_by(&problem, &[nominal], 100)?;
/// assert_eq!(curves.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn predicted_by(
    problem: &Problem,
    bodies: &[MassProperties],
    points: usize,
) -> Result<Vec<Prediction>, ProblemError> {
    let mut model = problem.model.clone();
    for (body, given) in model.bodies.iter_mut().zip(bodies) {
        body.nominal = *given;
        body.prior = None;
    }
    let held = problem.with_model(&model);
    let parameters = held.parameters_or_momentum(held.linear_equations())?;
    let experiment = Experiment::new(&held, &parameters);
    match fit_starts(&experiment, experiment.nominal_point(), STARTS) {
        Ok(at) => Ok(predict(&experiment, &at, points)),
        // Bodies without a motion: an answer, but no curve.
        Err(fault) if fault.code() == NO_MOTION => Ok(Vec::new()),
        Err(other) => Err(other),
    }
}

/// Empty where the vehicle cannot move as the answer says.
pub(crate) fn predict(experiment: &Experiment, at: &Iterate, points: usize) -> Vec<Prediction> {
    let Some(evaluated) = experiment.evaluate(at, false) else {
        return Vec::new();
    };
    let of = |(s, one): (usize, &Evaluated)| {
        let mut prediction = segment(experiment, &at.x, &at.initial_states[s], s, points)?;
        for channel in &mut prediction.channels {
            if let Some(own) = one.channels.iter().find(|c| c.name == channel.name) {
                statistics(channel, own);
            }
        }
        Some(prediction)
    };
    let segments = evaluated.iter().enumerate();
    segments.map(|one| of(one).unwrap_or_default()).collect()
}

fn segment(
    experiment: &Experiment,
    x: &[f64],
    initial_state: &InitialState,
    at: usize,
    points: usize,
) -> Option<Prediction> {
    let problem = experiment.problem;
    let segment = &problem.segments[at];
    let setting = experiment.setting();
    let tree = tilted(problem.tree, experiment.parameters, x);
    let vehicle = setting.vehicle(&tree, (at, segment), x);
    let mut state = *initial_state;
    let mut motion = Motion::new(&vehicle, segment, Vec::new(), 0);
    let late: Vec<bool> = segment
        .observations
        .sensors
        .iter()
        .map(|r| experiment.parameters.sensor_errors(x, r.sensor).lag_s != 0.0)
        .collect();
    let ideal = IdealSeries::new(&vehicle, segment, &state, &late)?;
    let mut recorder = Recorder::new((problem.model, segment), experiment.parameters, x, points);
    let (silent, mut spare) = (InputNoise::default(), SpareVectors::default());
    for k in 0..segment.observations.time_s.len() {
        let (instant, _) = motion.velocity(&state, k)?;
        recorder.motion_at((&vehicle, motion.used()), &state, &instant.twist.w, k);
        for one in &mut recorder.all {
            let around = Predictor {
                observations: &segment.observations,
                ideal: &ideal,
                inputs: &silent,
                spare: &mut spare,
            };
            if let Some(due) = one.stream.at(around, &mut motion, (&state, k), &instant) {
                one.sample(&segment.observations.time_s, &due);
            }
        }
        state = motion.advance(&state, k)?;
    }
    Some(recorder.finish())
}

/// Keeps one of n samples.
struct Decimator {
    stride: usize,
    seen: usize,
}

impl Decimator {
    fn new(samples: usize, points: usize) -> Self {
        Self {
            stride: samples.div_ceil(points.max(1)).max(1),
            seen: 0,
        }
    }

    fn keeps(&mut self) -> bool {
        self.seen += 1;
        (self.seen - 1).is_multiple_of(self.stride)
    }
}

/// Joint positions, joint rates, wheel speeds and bodies at an instant.
type Inputs<'a> = (&'a [f64], &'a [f64], &'a [f64], &'a [InertialParameters]);

/// One sensor in the course of a segment.
struct SensorCursor {
    errors: SensorErrors,
    stream: SampleStream,
    sieve: Decimator,
    channel: PredictedChannel,
}

impl SensorCursor {
    /// A sample of the sensor at the times of a grid.
    fn sample(&mut self, time_s: &[f64], due: &DueSample) {
        if !self.sieve.keeps() {
            return;
        }
        let (measured, predicted) = (&due.sample.value, &due.predicted);
        let residual = predicted.residual(measured, &self.errors, &due.rate);
        let reading = self.errors.reading(&predicted.vector(), &due.rate);
        let (t, channel) = (time_s[due.sample.to], &mut self.channel);
        match (measured, &predicted.value) {
            (SensorValue::Attitude(measured), SensorValue::Attitude(truth)) => {
                let expected = truth * UnitQuaternion::from_scaled_axis(reading);
                let own = xyzw(measured, last(&channel.measured));
                push(channel, t, &own, &xyzw(&expected, Some(own)), &residual);
            }
            (
                SensorValue::Direction {
                    seen_B, normal_B, ..
                },
                _,
            ) => {
                let residual = across(normal_B) * residual;
                push(channel, t, seen_B.as_slice(), reading.as_slice(), &residual);
            }
            (SensorValue::Vector(measured), _) => {
                let (own, expected) = (measured.as_slice(), reading.as_slice());
                push(channel, t, own, expected, &residual);
            }
            // A record of mixed values has no meaning.
            _ => {}
        }
    }
}

struct Recorder<'a> {
    segment: &'a Segment,
    all: Vec<SensorCursor>,
    /// Samples and errors of the gyro whose rates give the measured momentum.
    gyro: (Vec<(usize, Vector3)>, SensorErrors),
    kinematics: Option<Kinematics>,
    sieves: [Decimator; 2],
    prediction: Prediction,
}

const MOTION: usize = 0;
const MOMENTUM: usize = 1;

impl<'a> Recorder<'a> {
    fn new(
        (model, segment): (&Model, &'a Segment),
        parameters: &Parameters,
        x: &[f64],
        points: usize,
    ) -> Self {
        let moving = model.joints.iter().filter(|j| j.kind != JointKind::Fixed);
        let position = |j: &Joint| SensorKind::JointPosition.unit(j.kind == JointKind::Prismatic);
        let firings = segment.firings.iter().filter_map(|f| {
            let name = model.thrusters.get(f.thruster)?.name.clone();
            Some((name, f.start_s, f.end_s, f.force))
        });
        let o = &segment.observations;
        let momentum = channel("momentum", ["N m s"; 2], &["h_x", "h_y", "h_z"]);
        let rates: Vec<(usize, Vector3)> = o.rates().collect();
        let gyro = o.best_gyro().and_then(|r| r.sensor);
        let cursor = |(record, stream): (&SensorRecord, SampleStream)| SensorCursor {
            errors: parameters.sensor_errors(x, record.sensor),
            stream,
            sieve: Decimator::new(record.samples.len(), points),
            channel: PredictedChannel {
                samples: record.samples.len(),
                ..sensor_channel(record)
            },
        };
        Self {
            segment,
            all: o
                .sensors
                .iter()
                .zip(SampleStream::all(&o.sensors))
                .map(cursor)
                .collect(),
            sieves: [o.time_s.len(), rates.len()].map(|n| Decimator::new(n, points)),
            gyro: (rates, parameters.sensor_errors(x, gyro)),
            kinematics: None,
            prediction: Prediction {
                label: segment.label.clone(),
                momentum,
                joints: moving.map(|j| row(&j.name, position(j))).collect(),
                wheels: model.wheels.iter().map(|w| row(&w.name, "rad/s")).collect(),
                modes: model.modes.iter().map(|m| row(&m.name, "kg05 m")).collect(),
                firings: firings.collect(),
                ..Prediction::default()
            },
        }
    }

    fn finish(self) -> Prediction {
        Prediction {
            channels: self.all.into_iter().map(|f| f.channel).collect(),
            ..self.prediction
        }
    }

    /// Motion of the base and momentum at grid time k.
    fn motion_at(
        &mut self,
        (vehicle, inputs): (&Vehicle, Inputs),
        state: &State,
        w: &Vector3,
        k: usize,
    ) {
        if self.sieves[MOTION].keeps() {
            self.motion_point(vehicle, state, w, k);
        }
        let Ok(at) = self.gyro.0.binary_search_by_key(&k, |r| r.0) else {
            return;
        };
        let measured = self.gyro.0[at].1;
        if self.sieves[MOMENTUM].keeps() {
            self.momentum_point((vehicle, inputs), state, (&measured, w), k);
        }
    }

    fn motion_point(&mut self, vehicle: &Vehicle, state: &State, w: &Vector3, k: usize) {
        let o = &self.segment.observations;
        let p = &mut self.prediction;
        let (dof, wheels) = (vehicle.tree.dof(), vehicle.tree.rotors.len());
        for (joint, row) in p.joints.iter_mut().enumerate() {
            row.values.push(o.joint_position[k * dof + joint]);
        }
        for (k, row) in p.modes.iter_mut().enumerate() {
            row.values.push(state.internal[2 * k]);
        }
        for (k, joint) in vehicle.passive.joints().iter().enumerate() {
            let row = p.joints.get_mut(joint.coordinate);
            if let Some(q) = row.and_then(|row| row.values.last_mut()) {
                *q = state.internal[2 * (vehicle.modes.len() + k)];
            }
        }
        for (wheel, row) in p.wheels.iter_mut().enumerate() {
            row.values.push(o.wheel_speed[k * wheels + wheel]);
        }
        p.time_s.push(o.time_s[k]);
        p.omega_rad_s.push([w.x, w.y, w.z]);
        let before = p.q_xyzw.last().copied();
        p.q_xyzw.push(xyzw(&state.R_NB, before));
    }

    /// Angular momentum about the mass centre does not depend on the velocity of the base.
    fn momentum_point(
        &mut self,
        (vehicle, (q, rates, speed, bodies)): (&Vehicle, Inputs),
        state: &State,
        (measured, predicted): (&Vector3, &Vector3),
        k: usize,
    ) {
        let kinematics = self
            .kinematics
            .get_or_insert_with(|| Kinematics::new(vehicle.tree));
        kinematics.place(vehicle.tree, q);
        let mut about_centre = |w: &Vector3| {
            kinematics.set_velocities(vehicle.tree, &Vector3::zeros(), w, rates);
            let lh = momentum(bodies, kinematics);
            let l: Vector3 = lh.fixed_rows::<3>(0).into();
            let wheel = wheel_momentum(vehicle.tree, kinematics, &vehicle.spin, speed);
            let c = composite(bodies, kinematics).p_BoScm_B();
            state.R_NB * (lh.fixed_rows::<3>(3) + wheel - c.cross(&l))
        };
        let own = about_centre(&self.gyro.1.corrected(measured));
        let expected = about_centre(predicted);
        let t = self.segment.observations.time_s[k];
        let p = &mut self.prediction.momentum;
        push(p, t, own.as_slice(), expected.as_slice(), &(own - expected));
        p.samples += 1;
    }
}

/// An empty channel of a sensor.
fn sensor_channel(record: &SensorRecord) -> PredictedChannel {
    let unit = printed_unit(record.kind.unit(false));
    let measured = match record.kind {
        SensorKind::Direction => "1",
        kind if kind.is_rotation() => "1",
        _ => unit,
    };
    channel(&record.name, [measured, unit], record.kind.columns())
}

fn channel(name: &str, [unit, residual_unit]: [&str; 2], components: &[&str]) -> PredictedChannel {
    PredictedChannel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        residual_unit: residual_unit.to_owned(),
        components: components.iter().map(|c| (*c).to_owned()).collect(),
        measured: vec![Vec::new(); components.len()],
        predicted: vec![Vec::new(); components.len()],
        residual: vec![Vec::new(); 3],
        ..PredictedChannel::default()
    }
}

/// A named list without values.
fn row(name: &str, unit: &str) -> Row {
    Row {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values: Vec::new(),
    }
}

/// Adds a point to a curve.
fn push(
    to: &mut PredictedChannel,
    t: f64,
    measured: &[f64],
    predicted: &[f64],
    residual: &Vector3,
) {
    to.time_s.push(t);
    for (rows, values) in [
        (&mut to.measured, measured),
        (&mut to.predicted, predicted),
        (&mut to.residual, residual.as_slice()),
    ] {
        for (row, x) in rows.iter_mut().zip(values) {
            row.push(*x);
        }
    }
}

/// The quaternion with the sign that continues the one before.
fn xyzw(q: &UnitQuaternion, before: Option<[f64; 4]>) -> [f64; 4] {
    let now = [q.i, q.j, q.k, q.w];
    let along = before.map_or(1.0, |b| b.iter().zip(&now).map(|(a, b)| a * b).sum());
    if along < 0.0 { now.map(|x| -x) } else { now }
}

fn last(rows: &[Vec<f64>]) -> Option<[f64; 4]> {
    let mut out = [0.0; 4];
    for (o, row) in out.iter_mut().zip(rows) {
        *o = *row.last()?;
    }
    Some(out)
}

fn statistics(channel: &mut PredictedChannel, all: &ChannelResidual) {
    for axis in 0..all.numbers {
        let mut bars = vec![0_u64; HISTOGRAM_BARS];
        for white in &all.white {
            let place = (white[axis] + HISTOGRAM_REACH) / (2.0 * HISTOGRAM_REACH);
            let bar = (place * HISTOGRAM_BARS as f64).clamp(0.0, (HISTOGRAM_BARS - 1) as f64);
            bars[bar as usize] += 1;
        }
        channel.histogram.push(bars);
        let series: Vec<f64> = all.white.iter().map(|w| w[axis]).collect();
        channel.autocorrelation.push(autocorrelation(&series));
    }
}

/// Empty for series too short or without any residual.
fn autocorrelation(series: &[f64]) -> Vec<f64> {
    let n = series.len();
    let mean = series.iter().sum::<f64>() / n.max(1) as f64;
    let square = |e: &f64| (e - mean) * (e - mean);
    let variance: f64 = series.iter().map(square).sum();
    if n < 2 * LAGS || variance <= 1.0e-12 * n as f64 {
        return Vec::new();
    }
    (1..=LAGS)
        .map(|lag| {
            let product = |(a, b): (&f64, &f64)| (a - mean) * (b - mean);
            series.iter().zip(&series[lag..]).map(product).sum::<f64>() / variance
        })
        .collect()
}
