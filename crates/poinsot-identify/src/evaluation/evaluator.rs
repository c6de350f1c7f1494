//! A problem evaluated at any value of its unknowns, for other methods.

use crate::fit::experiment::{Experiment, Iterate};
use crate::likelihood::{InitialState, InitialStateColumns};
use crate::problem::parameters::{Parameters, axis_name};
use crate::problem::prior;
use crate::problem::refusal::{no_motion, wrong_length};
use crate::problem::segment::{Observations, Segment};
use crate::problem::{Problem, ProblemError};
use nalgebra::{DMatrix, DVector};
use poinsot_solve::BlockQr;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3, skew};

/// Share of a column that must be left after those before it: less is not determined.
const DETERMINED: f64 = 1.0e-10;

/// Name and unit of one unknown of an evaluation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EvaluatedUnknown {
    /// `<segment>.start.turn_x` (a turn from the nominal start, in B), `.position_x`, `.linear_momentum_x`,
    /// `.angular_momentum_x` (about the mass centre; all in N), then the names of
    /// [`Parameters`](crate::Parameters).
    pub name: String,
    /// Unit, SI.
    pub unit: &'static str,
}

/// Residuals of one sensor in one segment: three numbers a sample, the third of a direction zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SensorResiduals {
    /// Segment.
    pub segment: String,
    /// Name of its [`SensorRecord`](crate::SensorRecord), for example `gyro`.
    pub sensor: String,
    /// Unit of `raw`.
    pub unit: &'static str,
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// Measured less predicted: attitude as a small turn in its body, rates in theirs, velocity and position in N.
    pub raw: Vec<Vector3>,
    /// The same whitened by the declared noise, that of the inputs included.
    pub white: Vec<Vector3>,
    /// Row of the first number of `white` in [`Evaluation::residuals`] and [`Evaluation::jacobian`].
    pub first_row: usize,
}

/// A problem at one value of its unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Residuals by segment and kind of sensor.
    pub sensors: Vec<SensorResiduals>,
    /// All whitened residuals: those of the sensors in their order, then those of declared priors.
    pub residuals: DVector<f64>,
    /// Slopes of the residuals over the unknowns, whitening held, to first order in the residual of an attitude: one row
    /// per residual, one column per unknown.
    pub jacobian: DMatrix<f64>,
    /// Fisher information `J^T J`, priors included.
    pub information: DMatrix<f64>,
    /// Its inverse; `None` where a combination of the unknowns is not determined.
    pub covariance: Option<DMatrix<f64>>,
    /// Logarithm of the density of all measurements, priors left out.
    pub log_likelihood: f64,
    /// Half the sum of squares of the residuals of priors, negative.
    pub log_prior: f64,
}

/// A problem with its unknowns, ready to be evaluated.
///
/// ```
/// use poinsot_dynamics::Tree;
/// use poinsot_identify::{
///     Evaluator, Noise, Observations, Problem, Samples, Segment, SensorRecord, SensorValue,
/// };
/// use poinsot_model::{SensorKind, parse_model};
/// use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
///
/// let model = parse_model(r#"
/// schema = "poinsot.model/1"
/// name = "tumbling box"
/// [[body]]
/// name = "box"
/// mass_kg = 10.0
/// com_m = [0.0, 0.0, 0.0]
/// inertia_kg_m2 = { xx = 1.0, yy = 2.0, zz = 2.5 }
/// estimate = ["inertia"]
/// [[wheel]]
/// name = "wheel"
/// body = "box"
/// axis = [0.0, 0.0, 1.0]
/// spin_inertia_kg_m2 = 0.01
/// [[sensor]]
/// name = "gyro"
/// type = "gyro"
/// noise_rad_s = 1.0e-4
/// "#, "box.toml")?;
/// let tree = Tree::new(&model);
/// // Three samples of a rate; a program would read them from a file.
/// let rates = [[0.10, 0.020, 0.0], [0.099, 0.021, 0.001], [0.098, 0.022, 0.002]].map(Vector3::from);
/// let time_s = vec![0.0, 0.5, 1.0];
/// let segment = Segment {
///     label: "first".to_owned(),
///     samples: Samples {
///         time_s: time_s.clone(),
///         R_NB: vec![UnitQuaternion::identity(); 3],
///         w_NB_B: rates.to_vec(),
///         wheel_speed: vec![10.0; 3],
///         ..Samples::default()
///     },
///     observations: Observations {
///         time_s,
///         sensors: vec![
///             SensorRecord::of_base(SensorKind::Gyro, Matrix3::identity() * 1.0e-8)
///                 .at_every_time(rates.map(SensorValue::Vector)),
///         ],
///         wheel_speed: vec![10.0; 3],
///         ..Observations::default()
///     },
///     ..Segment::default()
/// };
/// let none = Matrix3::zeros();
/// let noise = Noise {
///     gyro_sensor: None,
///     gyro: Matrix3::identity() * 1.0e-8,
///     attitude: none,
///     velocity: none,
///     position: none,
///     joint_position: vec![],
///     joint_rate: vec![],
///     wheel_speed: vec![0.0],
///     seen_gyro: 1.0,
///     seen_velocity: 0.0,
///     seen_joint_rate: 0.0,
/// };
/// let segments = [segment];
/// let problem = Problem {
///     model: &model,
///     tree: &tree,
///     segments: &segments,
///     noise: &noise,
///     relative_accuracy: 1.0,
///     pace: None,
/// };
/// let evaluator = Evaluator::new(&problem)?;
/// let mut x = evaluator.nominal();
/// assert_eq!(evaluator.unknowns().len(), x.len());
/// let here = evaluator.at(&x)?;
/// assert_eq!(here.jacobian.shape(), (9, x.len()));
/// assert_eq!(here.sensors[0].sensor, "gyro");
/// // Three samples of three numbers each.
/// assert_eq!(here.residuals.len(), 9);
/// x.pop();
/// assert!(evaluator.at(&x).unwrap_err().to_string().starts_with("E0411"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Evaluator<'a> {
    problem: Problem<'a>,
    parameters: Parameters,
    unknowns: Vec<EvaluatedUnknown>,
    /// The nominal start of every segment.
    start: Iterate,
}

impl<'a> Evaluator<'a> {
    /// Checks the arrays of a problem and lists its unknowns: those of [`maximum_likelihood`](crate::maximum_likelihood).
    ///
    /// # Errors
    /// The model or the data are not valid, or an array is too short, too long or ragged.
    pub fn new(problem: &Problem<'a>) -> Result<Self, ProblemError> {
        problem.check_samples()?;
        problem
            .segments
            .iter()
            .try_for_each(|s| check(problem, s))?;
        problem.check_observations()?;
        let parameters = problem.likelihood_parameters()?;
        let experiment = Experiment::new(problem, &parameters);
        let start = experiment.nominal_point();
        let mut unknowns = Vec::new();
        for (segment, columns) in problem.segments.iter().zip(&experiment.unknown) {
            for (part, unit) in parts(columns) {
                unknowns.extend((0..3).map(|k| EvaluatedUnknown {
                    name: format!("{}.start.{part}_{}", segment.label, axis_name(k)),
                    unit,
                }));
            }
            for (name, parts) in internal_parts(problem) {
                unknowns.extend(parts.map(|(part, unit)| EvaluatedUnknown {
                    name: format!("{}.start.{name}.{part}", segment.label),
                    unit,
                }));
            }
        }
        unknowns.extend(parameters.unknowns.iter().map(|u| EvaluatedUnknown {
            name: u.name.clone(),
            unit: u.unit,
        }));
        Ok(Self {
            problem: *problem,
            start,
            unknowns,
            parameters,
        })
    }

    /// The unknowns, in the order of the values.
    pub fn unknowns(&self) -> &[EvaluatedUnknown] {
        &self.unknowns
    }

    /// Values of the model and of the first samples.
    pub fn nominal(&self) -> Vec<f64> {
        let experiment = Experiment::new(&self.problem, &self.parameters);
        let initial_states = self.start.initial_states.iter().zip(&experiment.unknown);
        let initial_states =
            initial_states.flat_map(|(initial_state, columns)| values(initial_state, columns));
        initial_states.chain(self.start.x.iter().copied()).collect()
    }

    /// Residuals, slopes, information and likelihood at values of the unknowns.
    ///
    /// # Errors
    /// There are not as many values as unknowns (E0411), or the vehicle has no motion with them (E0405).
    pub fn at(&self, values: &[f64]) -> Result<Evaluation, ProblemError> {
        expect("values of the unknowns", values.len(), self.unknowns.len())?;
        let mut experiment = Experiment::new(&self.problem, &self.parameters);
        experiment.keep_rows = true;
        let (initial_states, x) = values.split_at(values.len() - self.parameters.len());
        let mut point = Iterate {
            x: x.to_vec(),
            initial_states: self.start.initial_states.clone(),
        };
        let mut places = Vec::new();
        let mut first = 0;
        for (initial_state, columns) in point.initial_states.iter_mut().zip(&experiment.unknown) {
            let count = columns.count();
            let turn = put(
                initial_state,
                columns,
                &initial_states[first..first + count],
            );
            places.push(SegmentColumns {
                first,
                count,
                shared: initial_states.len(),
                turn: columns.attitude.then(|| turn_slopes(&turn)),
            });
            first += count;
        }
        let evaluated = experiment.evaluate(&point, true).ok_or_else(no_motion)?;
        let mut rows = Rows {
            width: self.unknowns.len(),
            slopes: Vec::new(),
            residuals: Vec::new(),
        };
        let (mut sensors, mut deviance) = (Vec::new(), 0.0);
        let segments = self.problem.segments.iter().zip(&evaluated);
        for ((segment, one), place) in segments.clone().zip(&places) {
            deviance += one.cost;
            for channel in &one.channels {
                let mut residuals = SensorResiduals {
                    segment: segment.label.clone(),
                    sensor: channel.name.clone(),
                    unit: channel.unit,
                    first_row: rows.residuals.len(),
                    ..SensorResiduals::default()
                };
                let log_det = segment.observations.sensors[channel.sensor].log_det();
                for row in one.kept.of(Some(channel.sensor)) {
                    residuals.time_s.push(segment.observations.time_s[row.at]);
                    residuals.raw.push(row.raw);
                    residuals.white.push(row.white);
                    deviance += log_det + channel.numbers as f64 * std::f64::consts::TAU.ln();
                    rows.push_all(&row.rows, place);
                }
                sensors.push(residuals);
            }
        }
        let readings = rows.residuals.len();
        for ((_, one), place) in segments.zip(&places) {
            // A weak prior of an unmeasured initial state is no measurement.
            for row in one.kept.of(None) {
                deviance -= row.white.norm_squared();
                rows.push_all(&row.rows, place);
            }
        }
        let calibration = prior::calibration(&self.problem, &self.parameters, x).rows;
        let design = prior::design(&self.problem, &self.parameters, x);
        let design = design.ok_or_else(no_motion)?.rows;
        let shared = SegmentColumns {
            first: 0,
            count: 0,
            shared: initial_states.len(),
            turn: None,
        };
        for row in calibration.iter().chain(&design) {
            rows.push(&row.gradient, row.residual, &shared);
        }
        Ok(rows.evaluation(sensors, -0.5 * deviance, readings))
    }
}

/// Positions of a segment's columns among the unknowns.
struct SegmentColumns {
    first: usize,
    count: usize,
    shared: usize,
    /// Change of the attitude at the start with the turn from the nominal one.
    turn: Option<Matrix3>,
}

/// Rows of all residuals.
struct Rows {
    width: usize,
    slopes: Vec<f64>,
    residuals: Vec<f64>,
}

impl Rows {
    /// Rows of a reading: slopes of the prediction over the start of its segment and the shared unknowns, then the residual.
    fn push_all(&mut self, rows: &[Vec<f64>], place: &SegmentColumns) {
        for (residual, slopes) in rows.iter().filter_map(|row| row.split_last()) {
            self.push(slopes, *residual, place);
        }
    }

    fn push(&mut self, slopes: &[f64], residual: f64, place: &SegmentColumns) {
        let at = self.slopes.len();
        self.slopes.resize(at + self.width, 0.0);
        let (own, shared) = slopes.split_at(place.count);
        let target = &mut self.slopes[at..];
        // The residual is measured less predicted.
        for (to, from) in target[place.first..].iter_mut().zip(own) {
            *to = -from;
        }
        if let Some(turn) = &place.turn {
            let own = Vector3::from_column_slice(&target[place.first..place.first + 3]);
            let turned = turn.transpose() * own;
            target[place.first..place.first + 3].copy_from_slice(turned.as_slice());
        }
        for (to, from) in target[place.shared..].iter_mut().zip(shared) {
            *to = -from;
        }
        self.residuals.push(residual);
    }

    fn evaluation(
        self,
        sensors: Vec<SensorResiduals>,
        log_likelihood: f64,
        readings: usize,
    ) -> Evaluation {
        let jacobian = DMatrix::from_row_slice(self.residuals.len(), self.width, &self.slopes);
        let priors = self.residuals[readings..].iter();
        Evaluation {
            sensors,
            log_prior: -0.5 * priors.map(|r| r * r).sum::<f64>(),
            residuals: DVector::from_vec(self.residuals),
            information: jacobian.transpose() * &jacobian,
            covariance: covariance(&jacobian),
            log_likelihood,
            jacobian,
        }
    }
}

/// `(J^T J)^-1` from the triangle of J with columns of length one.
fn covariance(jacobian: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = jacobian.ncols();
    let lengths: Vec<f64> = jacobian.column_iter().map(|c| c.norm()).collect();
    if lengths.iter().any(|l| l.is_nan() || *l <= 0.0) {
        return None;
    }
    let mut qr = BlockQr::new(n);
    qr.push(jacobian.nrows(), |i, j| jacobian[(i, j)] / lengths[j]);
    let triangle = qr.finish().r;
    let r = DMatrix::from_fn(n, n, |i, j| triangle[(i, j)]);
    if (0..n).any(|i| r[(i, i)].is_nan() || r[(i, i)].abs() < DETERMINED) {
        return None;
    }
    let inverse = r.solve_upper_triangular(&DMatrix::identity(n, n))?;
    let scaled = &inverse * inverse.transpose();
    Some(DMatrix::from_fn(n, n, |i, j| {
        scaled[(i, j)] / (lengths[i] * lengths[j])
    }))
}

/// Parts of a start that are unknown, in the order of the columns.
fn parts(columns: &InitialStateColumns) -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = [
        ("turn", "rad"),
        ("position", "m"),
        ("linear_momentum", "N s"),
        ("angular_momentum", "N m s"),
    ];
    let pairs = all.into_iter().zip(columns.parts());
    pairs.filter_map(|(part, wanted)| wanted.then_some(part))
}

/// Names of modes and passive joints, with the two parts of the state of each and their units.
fn internal_parts<'a>(problem: &Problem<'a>) -> Vec<(&'a str, [(&'static str, &'static str); 2])> {
    let modes = problem.model.modes.iter();
    let amplitude = [("amplitude", "kg^0.5 m"), ("momentum", "kg^0.5 m/s")];
    let modes = modes.map(|mode| (mode.name.as_str(), amplitude));
    let passive = problem.model.passive_joints(problem.tree);
    let joints = passive.joints().iter().map(|own| {
        let joint = &problem.model.joints[problem.tree.coordinates[own.coordinate]];
        let parts = match joint.slides() {
            true => [("position", "m"), ("momentum", "N s")],
            false => [("position", "rad"), ("momentum", "N m s")],
        };
        (joint.name.as_str(), parts)
    });
    modes.chain(joints).collect()
}

/// Values of the unknown parts of a nominal start.
fn values(start: &InitialState, columns: &InitialStateColumns) -> Vec<f64> {
    let all = [Vector3::zeros(), start.p_NoBo_N, start.P, start.h_SScm_N];
    let wanted = all.iter().zip(columns.parts()).filter(|part| part.1);
    let internal = start.internal.iter().take(2 * columns.internal);
    let vectors = wanted.flat_map(|(v, _)| v.iter());
    vectors.chain(internal).copied().collect()
}

/// Puts values into a nominal start. Gives the turn from it.
fn put(initial_state: &mut InitialState, columns: &InitialStateColumns, values: &[f64]) -> Vector3 {
    let mut parts = values.chunks_exact(3).map(Vector3::from_column_slice);
    let mut take = |wanted: bool| wanted.then(|| parts.next()).flatten();
    let turn = take(columns.attitude).unwrap_or_default();
    initial_state.R_NB *= UnitQuaternion::from_scaled_axis(turn);
    initial_state.p_NoBo_N = take(columns.position).unwrap_or(initial_state.p_NoBo_N);
    initial_state.P = take(columns.linear).unwrap_or(initial_state.P);
    initial_state.h_SScm_N = take(columns.angular).unwrap_or(initial_state.h_SScm_N);
    let own = values.iter().skip(columns.count() - 2 * columns.internal);
    let internal = initial_state.internal.iter_mut();
    internal.zip(own).for_each(|(x, value)| *x = *value);
    turn
}

/// Small turn in B per change of a rotation vector (Chirikjian 2012, eq. 10.86).
fn turn_slopes(phi: &Vector3) -> Matrix3 {
    let angle = phi.norm();
    let k = skew(phi);
    let (first, second) = match angle < 1.0e-4 {
        true => (0.5, 1.0 / 6.0),
        false => (
            (1.0 - angle.cos()) / (angle * angle),
            (angle - angle.sin()) / angle.powi(3),
        ),
    };
    Matrix3::identity() - k * first + k * k * second
}

fn expect(what: impl Into<String>, found: usize, expected: usize) -> Result<(), ProblemError> {
    match found == expected {
        true => Ok(()),
        false => Err(wrong_length(&what.into(), found, expected)),
    }
}

/// Every array of a segment that an evaluation reads.
fn check(problem: &Problem, segment: &Segment) -> Result<(), ProblemError> {
    let (dof, wheels) = (problem.tree.dof(), problem.tree.rotors.len());
    let label = &segment.label;
    let array = |name: &str, found: usize, expected: usize| {
        expect(format!("segment '{label}', {name}"), found, expected)
    };
    let s = &segment.samples;
    let samples = s.time_s.len();
    array("samples.R_NB", s.R_NB.len(), samples)?;
    array("samples.w_NB_B", s.w_NB_B.len(), samples)?;
    array(
        "samples.joint_position",
        s.joint_position.len(),
        samples * dof,
    )?;
    array("samples.joint_rate", s.joint_rate.len(), samples * dof)?;
    array("samples.wheel_speed", s.wheel_speed.len(), samples * wheels)?;
    if let Some(t) = &s.translation {
        array("samples.translation.v_NBo_N", t.v_NBo_N.len(), samples)?;
        array("samples.translation.p_NoBo_N", t.p_NoBo_N.len(), samples)?;
    }
    let o: &Observations = &segment.observations;
    let n = o.time_s.len();
    array(
        "observations.joint_position",
        o.joint_position.len(),
        n * dof,
    )?;
    array("observations.joint_rate", o.joint_rate.len(), n * dof)?;
    array("observations.wheel_speed", o.wheel_speed.len(), n * wheels)?;
    if problem.model.environment.gravity_gradient || !o.orbit.is_empty() {
        array("observations.orbit", o.orbit.len(), n)?;
    }
    for record in &o.sensors {
        let last = record.samples.iter().map(|s| s.to.max(s.from)).max();
        if let Some(last) = last.filter(|last| *last >= n) {
            let what = format!("last grid time of observations.sensors '{}'", record.name);
            array(&what, last + 1, n)?;
        }
    }
    let thrusters = problem.model.thrusters.len();
    if let Some(firing) = segment.firings.iter().find(|f| f.thruster >= thrusters) {
        array("thruster of a firing", firing.thruster + 1, thrusters)?;
    }
    let noise = problem.noise;
    expect("noise.joint_position", noise.joint_position.len(), dof)?;
    expect("noise.joint_rate", noise.joint_rate.len(), dof)?;
    expect("noise.wheel_speed", noise.wheel_speed.len(), wheels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_turn_slopes_are_those_of_the_rotation() {
        for phi in [
            Vector3::new(0.4, -1.1, 0.7),
            Vector3::new(2.0e-5, 0.0, -1.0e-5),
        ] {
            let here = UnitQuaternion::from_scaled_axis(phi);
            for k in 0..3 {
                let mut step = Vector3::zeros();
                step[k] = 1.0e-5;
                let [up, down] = [step, -step].map(|d| UnitQuaternion::from_scaled_axis(phi + d));
                let turn = ((here.inverse() * up).scaled_axis()
                    - (here.inverse() * down).scaled_axis())
                    / 2.0e-5;
                assert!(
                    (turn - turn_slopes(&phi).column(k)).norm() < 1.0e-9,
                    "{phi}"
                );
            }
        }
    }
}
