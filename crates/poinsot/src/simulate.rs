//! The command `simulate`: a case with a model gives telemetry and the true values.

mod record;
mod truth;

use crate::bind::mountings;
use crate::case::{Case, Format, SIMULATED, Scenario, read_case};
use crate::channel_names::joint_channels;
use crate::error::{Error, no_motion};
use crate::progress::step;
use crate::written::{check_outputs, result_json};
use poinsot_dynamics::{Flight, Halt, JointDrive, MotionError, MotionSample, Vehicle, WheelUse};
use poinsot_files::{Pace, Place, Stage};
use poinsot_formats::{TruthFile, sha256_of};
use poinsot_model::{Joint, Model, Nuisance, SensorKind, read_model};
use poinsot_spatial::InertialParameters;
use poinsot_telemetry::{GROUP, Mounting, Table, mount, write_pieces};
use record::Recorder;
use std::path::{Path, PathBuf};
pub(crate) use truth::{mass as true_mass, scalar_errors};

/// Samples between two progress reports.
const REPORTED: usize = 500;

/// Telemetry with its true values.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// Sensor output; exact values for channels without a sensor.
    pub table: Table,
    /// The document `truth.json`.
    pub truth: TruthFile,
}

/// Files written by a simulation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// `telemetry.csv` or `telemetry.parquet`.
    pub telemetry: PathBuf,
    /// `truth.json`.
    pub truth: PathBuf,
    /// Rows of telemetry.
    pub rows: usize,
    /// Channels of telemetry.
    pub channels: usize,
}

/// Runs the case file and writes telemetry and truth into `out`, which is created if missing. Either both files are
/// written, or none. Its memory does not grow with the number of rows.
///
/// # Errors
/// Case or model are invalid, the motion cannot be computed, or writing fails.
///
/// ```
/// use poinsot::simulate::simulate;
///
/// let case = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/case.toml");
/// # let out = std::env::temp_dir().join(format!("poinsot-simulate-{}", std::process::id()));
/// let written = simulate(&case, &out)?;
/// // 10 s at 5 Hz.
/// assert_eq!(written.rows, 51);
/// assert!(written.telemetry.exists() && written.truth.exists());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate(case_path: &Path, out: &Path) -> Result<Written, Error> {
    let case = read_case(case_path)?;
    let name = match case.format {
        Format::Csv => "telemetry.csv",
        Format::Parquet => "telemetry.parquet",
    };
    let (telemetry, truth) = (out.join(name), out.join("truth.json"));
    let outputs = [telemetry.clone(), truth.clone()];
    check_outputs("--out", &outputs, &[case_path, &case.model])?;
    let model = read_model(&case.model)?;
    let scenario = case.bind(&model)?;
    let rows = scenario.times.count();
    case.check_memory(&model, rows.min(GROUP), SIMULATED)?;
    let mut recorder = Recorder::new(&model, &scenario, case.seed, 0);
    // Files are in sensor axes, tables in body axes.
    let back: Vec<Mounting> = mountings(&model).iter().map(Mounting::inverse).collect();
    let in_sensor_axes = |mut table: Table| {
        mount(&mut table, &back);
        table.channels
    };
    let mut stage = Stage::new(out)?;
    // Before the first row it has names alone.
    let first = recorder.drain(&scenario).channels;
    let mut file = write_pieces(&mut stage, Path::new(name), &first, |writer| {
        let truth = recorded_trial(&case, &model, &scenario, &mut recorder, |recorder| {
            if recorder.rows() < GROUP {
                return Ok(());
            }
            let until = recorder.until();
            writer.add(in_sensor_axes(recorder.drain(&scenario)), until)
        })?;
        let last = in_sensor_axes(recorder.drain(&scenario));
        writer.add(last, f64::INFINITY)?;
        Ok(truth)
    })?;
    let sum = stage.last().and_then(sha256_of);
    let sum = sum.map_err(|e| Error::io(&telemetry, "cannot be read", &e))?;
    file.files.insert(name.to_owned(), sum);
    let text = result_json(out, &file, true)?;
    stage.add(Path::new("truth.json"), text.as_bytes())?;
    stage.commit()?;
    Ok(Written {
        telemetry,
        truth,
        rows,
        channels: first.len(),
    })
}

/// Runs a case in memory; the nominal numbers of the model are the true values.
///
/// # Errors
/// The case does not fit the model, or the motion cannot be computed.
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// let simulation = simulate::simulate_case(&case, &model)?;
/// assert_eq!(simulation.table.channel("omega_x").unwrap().values.len(), 51);
/// assert_eq!(simulation.truth.bodies["bus"].mass.inertia_kg_m2.zz.value, 2.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate_case(case: &Case, model: &Model) -> Result<Simulation, Error> {
    simulate_trial(case, model, 0)
}

/// Runs a case with the noise of one trial; equal seed and trial give equal bits.
///
/// # Errors
/// As [`simulate_case`].
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// let rate = |trial| {
///     let simulated = simulate::simulate_trial(&case, &model, trial)?;
///     Ok::<_, Error>(simulated.table.channel("omega_x").unwrap().values.clone())
/// };
/// // The same trial gives the same bits, another trial other noise.
/// assert_eq!(rate(3)?, rate(3)?);
/// assert_ne!(rate(3)?, rate(4)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate_trial(case: &Case, model: &Model, trial: u64) -> Result<Simulation, Error> {
    let scenario = case.bind(model)?;
    case.check_memory(model, scenario.times.count(), SIMULATED)?;
    let mut recorder = Recorder::new(model, &scenario, case.seed, trial);
    let truth = recorded_trial(case, model, &scenario, &mut recorder, |_| Ok(()))?;
    let table = recorder.drain(&scenario);
    Ok(Simulation { table, truth })
}

/// Runs a case into a recorder; `kept` is called after every row, and its error ends the motion.
fn recorded_trial(
    case: &Case,
    model: &Model,
    scenario: &Scenario,
    recorder: &mut Recorder,
    mut kept: impl FnMut(&mut Recorder) -> Result<(), Error>,
) -> Result<TruthFile, Error> {
    let (mut taken, mut failed) = (0, None);
    let used = run(case, model, None, scenario, |sample| {
        recorder.take(sample);
        report(&mut taken, scenario.times.count());
        failed = kept(recorder).err();
        failed.is_none()
    })?;
    failed.map_or(Ok(()), Err)?;
    Ok(truth::truth(case, model, recorder, &used))
}

/// Ideal measurements.
#[derive(Debug, Clone)]
pub struct Exact {
    /// Measured channels, and the motion of joints, wheels and thrusters.
    pub table: Table,
    /// Bias of each sensor given in the case; it is not applied to the table.
    pub biases: Vec<Option<Vec<f64>>>,
}

/// Ideal measurements at the times and positions of the sensors, and the biases of the case.
///
/// # Errors
/// As [`simulate_case`].
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// // Without noise. All wheels at rest again at 10 s: the box, without momentum, is at rest too.
/// let exact = simulate::simulate_exact(&case, &model)?.table;
/// let rate = exact.channel("omega_x").unwrap();
/// assert!(rate.values.last().unwrap().abs() < 1.0e-12);
/// // At 2.5 s the wheel about x has 1 N m s, and the box with 1 kg m2 the opposite.
/// let [at] = poinsot_telemetry::resample(rate, &[2.4], None)[..] else { unreachable!() };
/// assert!((at.unwrap() + 0.96).abs() < 1.0e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate_exact(case: &Case, model: &Model) -> Result<Exact, Error> {
    simulate_exact_watched(case, model, case.bind(model)?, |_| {})
}

/// Ideal measurements of a bound case with progress reports; `watch` receives every sample.
pub(crate) fn simulate_exact_watched(
    case: &Case,
    model: &Model,
    scenario: Scenario,
    mut watch: impl FnMut(&MotionSample),
) -> Result<Exact, Error> {
    let (mut taken, total) = (0, scenario.times.count());
    simulate_exact_of(case, model, scenario, |sample| {
        watch(sample);
        report(&mut taken, total);
    })
}

/// Ideal measurements of a modified scenario; `watch` receives every instant.
///
/// # Errors
/// As [`simulate_case`].
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// // A bound case may be changed before it runs: half the times.
/// let mut scenario = case.bind(&model)?;
/// scenario.times = poinsot_dynamics::Times::Even { rows: 26, rate_hz: case.rate_hz };
/// let mut seen = 0;
/// simulate::simulate_exact_of(&case, &model, scenario, |_| seen += 1)?;
/// assert_eq!(seen, 26);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate_exact_of(
    case: &Case,
    model: &Model,
    mut scenario: Scenario,
    watch: impl FnMut(&MotionSample),
) -> Result<Exact, Error> {
    let perfect = without_errors(model);
    let biases = scenario.sensors.iter_mut().map(|s| s.bias.take()).collect();
    let mut table = recorded(case, &perfect, None, &scenario, watch)?;
    keep_measured(model, &mut table);
    // Motion by torques and springs is not commanded, so it needs a sensor.
    for (joint, _) in free_joints(model, &scenario) {
        if !is_read(model, joint) {
            let own = joint_channels(joint);
            table.channels.retain(|c| !own.contains(&c.name));
        }
    }
    Ok(Exact { table, biases })
}

/// Drops channels that no sensor of the model measures. Commanded channels of joints, wheels and thrusters remain.
pub(crate) fn keep_measured(model: &Model, table: &mut Table) {
    let kinds = SensorKind::with_axes();
    let unread = kinds.filter(|kind| model.sensors_of(*kind).next().is_none());
    let blind: Vec<&str> = unread.flat_map(SensorKind::columns).copied().collect();
    table.channels.retain(|c| !blind.contains(&c.name.as_str()));
}

/// Ideal measurements of a vehicle with other mass properties, at the times of the scenario. All other channels are of
/// the exact motion.
pub(crate) fn perfect_table(
    case: &Case,
    model: &Model,
    bodies: &[InertialParameters],
    mut scenario: Scenario,
) -> Result<Table, Error> {
    let perfect = without_errors(model);
    scenario.sensors_only = false;
    for sensor in &mut scenario.sensors {
        (sensor.every, sensor.bias) = (1, None);
    }
    recorded(case, &perfect, Some(bodies), &scenario, |_| {})
}

/// What perfect sensors measure; `watch` receives every sample.
fn recorded(
    case: &Case,
    perfect: &Model,
    bodies: Option<&[InertialParameters]>,
    scenario: &Scenario,
    mut watch: impl FnMut(&MotionSample),
) -> Result<Table, Error> {
    case.check_memory(perfect, scenario.times.count(), SIMULATED)?;
    let mut recorder = Recorder::new(perfect, scenario, case.seed, 0);
    run(case, perfect, bodies, scenario, |sample| {
        watch(sample);
        recorder.take(sample);
        true
    })?;
    Ok(recorder.drain(scenario))
}

/// The model with ideal sensors.
fn without_errors(model: &Model) -> Model {
    let mut perfect = model.clone();
    for sensor in &mut perfect.sensors {
        sensor.noise_covariance = None;
        sensor.slow.clear();
        sensor.quantisation = 0.0;
        sensor.bias = Nuisance::Known;
    }
    perfect
}

/// Reports progress after some samples.
fn report(taken: &mut usize, total: usize) {
    *taken += 1;
    if taken.is_multiple_of(REPORTED) {
        step("simulating samples", *taken, total);
    }
}

/// Simulates the scenario and passes on every sample, until one for which `take` is false; returns the use of the wheels by a
/// controller. `bodies` replace the model's mass properties.
///
/// # Errors
/// As [`simulate_case`]; E0006 where the rows so far took so long that all of them will not end within the limit of time.
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// let mut largest = 0.0_f64;
/// let scenario = case.bind(&model)?;
/// simulate::run(&case, &model, None, &scenario, |sample| {
///     largest = largest.max(sample.w_NB_B.x.abs());
///     true
/// })?;
/// // A wheel with 1 N m s in a box with 1 kg m2, nearly at 2.5 s.
/// assert!((0.9..=1.0).contains(&largest));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(
    case: &Case,
    model: &Model,
    bodies: Option<&[InertialParameters]>,
    scenario: &Scenario,
    mut take: impl FnMut(&MotionSample) -> bool,
) -> Result<Vec<WheelUse>, Error> {
    let rows = scenario.times.count();
    let pace = Pace::new(case.words(rows));
    let paced = |sample: &MotionSample| pace.check(1, rows).is_ok() && take(sample);
    let mut vehicle = Vehicle::from(model);
    if let Some(bodies) = bodies {
        vehicle.bodies = bodies.to_vec();
    }
    let used = Flight::new(vehicle, &scenario.plan, case.tolerance)
        .and_then(|flight| flight.run_while(&scenario.start, scenario.times.clone(), paced))
        .map_err(|error| refusal(case, model, error))?;
    pace.over()?;
    Ok(used)
}

/// The error names the joint that cannot move.
fn refusal(case: &Case, model: &Model, error: MotionError) -> Error {
    let MotionError::Halt(Halt::Joint { coordinate, .. }) = error else {
        return no_motion(case.path(), error);
    };
    let joint = model.moving_joints().nth(coordinate);
    let joint = joint.map_or("", |j| j.name.as_str());
    let problem = format!(
        "joint \"{joint}\" moves by torque or spring, but its outboard bodies have no inertia about its axis (singular mass matrix)"
    );
    let advice = "give them mass off the axis or inertia about it, or prescribe its motion with [[joint_motion]]";
    Error::one("E0509", Place::file(case.path()), problem, advice)
}

/// Joints moved by torques or springs in a case, in model order, with what moves them.
pub(crate) fn free_joints<'m>(
    model: &'m Model,
    scenario: &'m Scenario,
) -> Vec<(&'m Joint, &'m JointDrive)> {
    let driven = model.moving_joints().zip(&scenario.plan.joints);
    driven.filter(|(_, drive)| drive.is_free()).collect()
}

/// Whether a position sensor of the model measures this joint.
pub(crate) fn is_read(model: &Model, joint: &Joint) -> bool {
    let at = model.joint(&joint.name);
    let mut sensors = model.sensors_of(SensorKind::JointPosition);
    at.is_some_and(|at| sensors.any(|s| s.of.contains(&at)))
}

/// One random stream per sensor and trial.
pub(crate) fn stream(trial: u64, sensor: usize) -> u64 {
    (trial << 16) | (sensor as u64 & 0xffff)
}
