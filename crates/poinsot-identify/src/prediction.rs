//! What the answer predicts for every sensor, beside what was measured: for the reader's eye.
//!
//! Statistics come from every sample; curves keep at most a given number of points.

mod points;

use crate::answer;
use crate::coordinates::FitOptions;
use crate::estimate::Estimate;
use crate::fit::fit_starts;
use crate::information::{Experiment, Point};
use crate::likelihood::{ChannelResidual, GyroErrors, Head, start, translation_lag};
use crate::linear::{linear, solve_linear};
use crate::maximum_likelihood::solve;
use crate::motion::{Motion, State, small_turn};
use crate::parameters::{Equations, Parameters, ParametersError};
use crate::problem::{Problem, ProblemError};
use crate::segment::{Firing, Segment};
use crate::vehicle::{Vehicle, tilted};
use poinsot_dynamics::{Kinematics, composite, momentum, wheel_momentum};
use poinsot_spatial::{MassProperties, UnitQuaternion, Vector3};
use points::PointCurves;

/// Bars of a histogram of whitened residuals, from -4 to 4 sigma; what lies outside is in the last bars.
pub const HISTOGRAM_BARS: usize = 32;
/// Lags of the autocorrelation, from 1.
pub const LAGS: usize = 20;
/// Steps of pose, momentum and biases at given mass properties.
const STARTS: usize = 8;
/// Half the width of the histogram, sigmas.
const HISTOGRAM_REACH: f64 = 4.0;

/// One segment as the answer predicts it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Name of the segment.
    pub label: String,
    /// Sensors, each at its own times.
    pub channels: Vec<PredictedChannel>,
    /// Predicted motion of the base.
    pub motion: PredictedMotion,
    /// Angular momentum about the system's mass centre in N, N m s: from the measured rates, and predicted.
    pub momentum: PredictedChannel,
    /// Joint positions at the times of `motion`, one row a joint, rad or m.
    pub joint_position: Vec<Vec<f64>>,
    /// Wheel speeds at the times of `motion`, one row a wheel, rad/s.
    pub wheel_speed: Vec<Vec<f64>>,
    /// Thruster firings.
    pub firings: Vec<Firing>,
}

/// Readings of one kind of sensor beside their prediction. One row a component.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PredictedChannel {
    /// Kind: gyro, attitude, velocity, position, accelerometer, velocity_increment.
    pub name: &'static str,
    /// Unit of readings and predictions.
    pub unit: &'static str,
    /// Unit of the residual.
    pub residual_unit: &'static str,
    /// Names of the components.
    pub components: Vec<&'static str>,
    /// Readings in the file.
    pub samples: usize,
    /// Times of the points kept, s.
    pub time_s: Vec<f64>,
    /// Measured.
    pub measured: Vec<Vec<f64>>,
    /// Predicted.
    pub predicted: Vec<Vec<f64>>,
    /// Measured less predicted, x, y, z; of an attitude the small rotation in body axes.
    pub residual: Vec<Vec<f64>>,
    /// Whitened residuals of all samples in [`HISTOGRAM_BARS`] bars, one row an axis.
    pub histogram: Vec<Vec<u64>>,
    /// Autocorrelation of the whitened residual at lags 1 to [`LAGS`], one row an axis.
    pub autocorrelation: Vec<Vec<f64>>,
}

/// Motion of the base at common times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PredictedMotion {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Angular velocity in B, rad/s.
    pub w_NB_B: Vec<[f64; 3]>,
    /// Attitude, scalar last.
    pub q_NB_xyzw: Vec<[f64; 4]>,
}

/// Maximum likelihood with what its answer predicts, at most `points` points a curve.
///
/// # Errors
/// As [`crate::maximum_likelihood`].
pub fn maximum_likelihood_predicted(
    problem: &Problem,
    options: impl Into<FitOptions>,
    points: usize,
) -> Result<(Estimate, Vec<Prediction>), ProblemError> {
    let (solved, at) = solve(problem, options.into())?;
    let mut experiment = Experiment::new(problem, &solved.parameters);
    experiment.wheels_smooth = solved.wheels_smooth;
    let predictions = match &solved.driven {
        Some(driven) => {
            let own = driven.problem(problem);
            predict(&driven.experiment(&experiment, &own), &at, points)
        }
        None => predict(&experiment, &at, points),
    };
    Ok((answer::write_with_remedies(problem, &solved), predictions))
}

/// The linear method with what its answer predicts, at most `points` points a curve.
///
/// # Errors
/// As [`crate::linear`].
pub fn linear_predicted(
    problem: &Problem,
    points: usize,
) -> Result<(Estimate, Vec<Prediction>), ProblemError> {
    let estimate = linear(problem)?;
    let solved = solve_linear(problem)?;
    let experiment = Experiment::new(problem, &solved.parameters);
    let at = experiment.point(&solved);
    Ok((estimate, predict(&experiment, &at, points)))
}

/// What given mass properties predict, one entry a body of the model: pose, momentum and biases are fitted
/// to the readings, nothing else. Empty where such bodies cannot move.
///
/// # Errors
/// The question cannot be asked.
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
    let held = Problem {
        model: &model,
        ..*problem
    };
    let fires = problem.segments.iter().any(|s| !s.firings.is_empty());
    let of = |equations| Parameters::new(&model, problem.tree, equations, fires);
    let parameters = match of(held.linear_equations()) {
        Err(ParametersError::RotationOfTree { .. }) => of(Equations::Momentum),
        other => other,
    }?;
    let experiment = Experiment::new(&held, &parameters);
    match fit_starts(&experiment, STARTS) {
        Ok(at) => Ok(predict(&experiment, &at, points)),
        // Such bodies cannot move: an answer, and no curve.
        Err(ProblemError::NoMotion) => Ok(Vec::new()),
        Err(other) => Err(other),
    }
}

/// Empty where the vehicle cannot move as the answer says.
pub(crate) fn predict(experiment: &Experiment, at: &Point, points: usize) -> Vec<Prediction> {
    let Some(evaluated) = experiment.evaluate(at, false) else {
        return Vec::new();
    };
    let segments = experiment.problem.segments;
    (0..segments.len())
        .map(|s| {
            segment(experiment, &at.x, &at.heads[s], s, points)
                .map(|mut prediction| {
                    for channel in &mut prediction.channels {
                        let own = evaluated[s]
                            .channels
                            .iter()
                            .find(|c| c.name == channel.name);
                        if let Some(own) = own {
                            statistics(channel, own);
                        }
                    }
                    prediction
                })
                .unwrap_or_default()
        })
        .collect()
}

fn segment(
    experiment: &Experiment,
    x: &[f64],
    head: &Head,
    at: usize,
    points: usize,
) -> Option<Prediction> {
    let problem = experiment.problem;
    let segment = &problem.segments[at];
    let setting = experiment.setting();
    let tree = tilted(problem.tree, experiment.parameters, x);
    let mut vehicle = Vehicle::new(
        &tree,
        &experiment.thrusters,
        experiment.parameters,
        &experiment.nominal_spin,
        x,
    );
    vehicle.wheels_smooth = setting.wheels_smooth;
    vehicle.curves = setting.curves.get(at);
    vehicle.steps = setting.steps(at);
    let (mut state, _) = start(head, experiment.unknown[at], x.len());
    let mut motion = Motion::new(&vehicle, segment, Vec::new(), 0);
    let mut recorder = Recorder::new(segment, experiment.parameters, x, points);
    let mut curves = PointCurves::new(segment, experiment.parameters, x, points);
    let samples = segment.observations.time_s.len();
    for k in 0..samples {
        let (instant, _) = motion.velocity(&state, k)?;
        let twist = instant.twist;
        recorder.sample((&vehicle, motion.used()), &state, (twist.v, twist.w), k);
        let t = segment.observations.time_s[k];
        curves.sample(&mut motion, &state, &instant, (t, k));
        if k + 1 < samples {
            state = motion.advance(&state, k)?;
        }
    }
    let mut prediction = recorder.prediction;
    prediction.channels.extend(curves.channels);
    Some(prediction)
}

/// Keeps one of every so many samples.
struct Sieve {
    stride: usize,
    seen: usize,
}

impl Sieve {
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

/// Joint positions, joint rates and wheel speeds at an instant.
type Inputs<'a> = (&'a [f64], &'a [f64], &'a [f64]);

struct Recorder<'a> {
    segment: &'a Segment,
    gyro: GyroErrors,
    attitude_lag: f64,
    kinematics: Option<Kinematics>,
    sieves: [Sieve; 4],
    motion: Sieve,
    /// Rate at the sample before, for the lag.
    before: Option<(f64, Vector3)>,
    velocity_before: Option<(f64, Vector3)>,
    /// How late velocity and position read, s.
    late: [f64; 2],
    prediction: Prediction,
}

const GYRO: usize = 0;
const ATTITUDE: usize = 1;
const VELOCITY: usize = 2;
const POSITION: usize = 3;

impl<'a> Recorder<'a> {
    fn new(segment: &'a Segment, parameters: &Parameters, x: &[f64], points: usize) -> Self {
        let o = &segment.observations;
        let (gyro, attitude_lag) = GyroErrors::of(parameters, x);
        let counts = [
            o.rate.iter().flatten().count(),
            o.attitude.iter().flatten().count(),
            o.velocity.iter().flatten().count(),
            o.position.iter().flatten().count(),
        ];
        let channels = vec![
            channel("gyro", ["rad/s"; 2], &["omega_x", "omega_y", "omega_z"]),
            channel("attitude", ["1", "rad"], &["q_x", "q_y", "q_z", "q_w"]),
            channel("velocity", ["m/s"; 2], &["v_x", "v_y", "v_z"]),
            channel("position", ["m"; 2], &["r_x", "r_y", "r_z"]),
        ];
        let momentum = channel("momentum", ["N m s"; 2], &["h_x", "h_y", "h_z"]);
        let mut prediction = Prediction {
            label: segment.label.clone(),
            channels,
            momentum,
            firings: segment.firings.clone(),
            ..Prediction::default()
        };
        for (c, count) in prediction.channels.iter_mut().zip(counts) {
            c.samples = count;
        }
        Self {
            segment,
            gyro,
            attitude_lag,
            kinematics: None,
            sieves: counts.map(|n| Sieve::new(n, points)),
            motion: Sieve::new(o.time_s.len(), points),
            before: None,
            velocity_before: None,
            late: translation_lag(parameters, x),
            prediction,
        }
    }

    fn sample(
        &mut self,
        (vehicle, inputs): (&Vehicle, Inputs),
        state: &State,
        (v, w): (Vector3, Vector3),
        k: usize,
    ) {
        let o = &self.segment.observations;
        let t = o.time_s[k];
        let acceleration = match self.before.replace((t, w)) {
            Some((earlier, rate)) if t > earlier => (w - rate) / (t - earlier),
            _ => Vector3::zeros(),
        };
        if self.motion.keeps() {
            self.motion_point(vehicle, state, &w, k);
        }
        let R = &state.R_NB;
        // Acceleration and velocity of the sensor points, for lags.
        let velocity = R * (v + w.cross(&o.velocity_arm_B));
        let moving = (
            match self.velocity_before.replace((t, velocity)) {
                Some((earlier, was)) if t > earlier => (velocity - was) / (t - earlier),
                _ => Vector3::zeros(),
            },
            R * (v + w.cross(&o.position_arm_B)),
        );
        let all = &mut self.prediction.channels;
        if let Some(measured) = o.rate[k].filter(|_| self.sieves[GYRO].keeps()) {
            let expected = self.gyro.reading(&w, &acceleration);
            all[GYRO].push(
                t,
                &three(&measured),
                &three(&expected),
                &(measured - expected),
            );
            self.momentum_point((vehicle, inputs), state, (&measured, &w), k);
        }
        let all = &mut self.prediction.channels;
        if let Some(measured) = o.attitude[k].filter(|_| self.sieves[ATTITUDE].keeps()) {
            let residual = small_turn(R, &measured) + w * self.attitude_lag;
            let own = xyzw(&measured, last(&all[ATTITUDE].measured));
            let expected = xyzw(R, Some(own));
            all[ATTITUDE].push(t, &own, &expected, &residual);
        }
        if let Some(measured) = o.velocity[k].filter(|_| self.sieves[VELOCITY].keeps()) {
            let expected = R * (v + w.cross(&o.velocity_arm_B)) - moving.0 * self.late[0];
            all[VELOCITY].push(
                t,
                &three(&measured),
                &three(&expected),
                &(measured - expected),
            );
        }
        if let Some(measured) = o.position[k].filter(|_| self.sieves[POSITION].keeps()) {
            let expected = state.p_NoBo_N + R * o.position_arm_B - moving.1 * self.late[1];
            all[POSITION].push(
                t,
                &three(&measured),
                &three(&expected),
                &(measured - expected),
            );
        }
    }

    fn motion_point(&mut self, vehicle: &Vehicle, state: &State, w: &Vector3, k: usize) {
        let o = &self.segment.observations;
        let p = &mut self.prediction;
        let (dof, wheels) = (vehicle.tree.dof(), vehicle.tree.rotors.len());
        p.joint_position.resize(dof, Vec::new());
        p.wheel_speed.resize(wheels, Vec::new());
        for (joint, row) in p.joint_position.iter_mut().enumerate() {
            row.push(o.joint_position[k * dof + joint]);
        }
        for (wheel, row) in p.wheel_speed.iter_mut().enumerate() {
            row.push(o.wheel_speed[k * wheels + wheel]);
        }
        p.motion.time_s.push(o.time_s[k]);
        p.motion.w_NB_B.push([w.x, w.y, w.z]);
        let before = p.motion.q_NB_xyzw.last().copied();
        p.motion.q_NB_xyzw.push(xyzw(&state.R_NB, before));
    }

    /// Angular momentum about the mass centre does not feel the velocity of the base.
    fn momentum_point(
        &mut self,
        (vehicle, (q, rates, speed)): (&Vehicle, Inputs),
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
            let lh = momentum(&vehicle.bodies, kinematics);
            let l: Vector3 = lh.fixed_rows::<3>(0).into();
            let wheel = wheel_momentum(vehicle.tree, kinematics, &vehicle.spin, speed);
            let c = composite(&vehicle.bodies, kinematics).p_BoScm_B();
            state.R_NB * (lh.fixed_rows::<3>(3) + wheel - c.cross(&l))
        };
        let own = about_centre(&self.gyro.corrected(measured));
        let expected = about_centre(predicted);
        let t = self.segment.observations.time_s[k];
        let p = &mut self.prediction.momentum;
        p.push(t, &three(&own), &three(&expected), &(own - expected));
        p.samples += 1;
    }
}

fn channel(
    name: &'static str,
    [unit, residual_unit]: [&'static str; 2],
    components: &[&'static str],
) -> PredictedChannel {
    PredictedChannel {
        name,
        unit,
        residual_unit,
        components: components.to_vec(),
        measured: vec![Vec::new(); components.len()],
        predicted: vec![Vec::new(); components.len()],
        residual: vec![Vec::new(); 3],
        ..PredictedChannel::default()
    }
}

impl PredictedChannel {
    fn push(&mut self, t: f64, measured: &[f64], predicted: &[f64], residual: &Vector3) {
        self.time_s.push(t);
        for (row, x) in self.measured.iter_mut().zip(measured) {
            row.push(*x);
        }
        for (row, x) in self.predicted.iter_mut().zip(predicted) {
            row.push(*x);
        }
        for (row, x) in self.residual.iter_mut().zip(residual.iter()) {
            row.push(*x);
        }
    }
}

fn three(v: &Vector3) -> [f64; 3] {
    [v.x, v.y, v.z]
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
    for axis in 0..3 {
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
