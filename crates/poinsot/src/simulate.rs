//! `poinsot simulate`: a case with a model becomes telemetry and the truth behind it.

mod record;
mod truth;

use crate::case::{Case, CaseError, Format, Scenario, read_case};
use crate::progress::step;
use poinsot_dynamics::{ControlError, ControlledVehicle, MotionSample, Prescribed, Tree, WheelUse};
use poinsot_model::{Model, ModelError, Nuisance, SensorKind, read_model};
use poinsot_telemetry::{Table, TelemetryError};
use record::Recorder;
pub(crate) use record::names;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Codes of the errors of a simulation beyond those of case, model and telemetry, for `poinsot explain`.
pub const SIMULATE_CODES: [(&str, &str); 2] = [
    (
        "E0509",
        "The motion cannot be computed: something moves that has no inertia, or the tolerance cannot be met.",
    ),
    ("E0510", "The output folder cannot be made or written."),
];

/// Samples between two reports of progress.
const REPORTED: usize = 500;

/// Why a simulation gave nothing.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// The case file was refused.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The model file was refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The motion cannot be computed.
    #[error("E0509 {}: {error}", file.display())]
    Motion {
        /// The case file.
        file: PathBuf,
        /// Why.
        error: ControlError,
    },
    /// The telemetry cannot be written.
    #[error(transparent)]
    Telemetry(#[from] TelemetryError),
    /// The folder cannot be written.
    #[error("E0510 {}: {source}", path.display())]
    Write {
        /// What was to be written.
        path: PathBuf,
        /// The answer of the operating system.
        source: std::io::Error,
    },
}

impl SimulateError {
    /// Whether the surroundings (disk, permission) failed and not the question.
    pub fn is_environment(&self) -> bool {
        match self {
            Self::Case(e) => e.environment,
            Self::Model(e) => e.environment,
            Self::Motion { .. } => false,
            Self::Telemetry(e) => e.is_environment(),
            Self::Write { .. } => true,
        }
    }
}

/// Telemetry with the truth behind it.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// What the sensors report; exact where the model has no sensor for a channel.
    pub table: Table,
    /// The document `truth.json` (`poinsot.truth/1`).
    pub truth: serde_json::Value,
}

/// The files of a simulation.
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

/// Runs the case file and writes telemetry and truth into `out`, which is made if it does not exist.
/// Nothing stands under a final name unless both are complete.
///
/// # Errors
/// Case or model are refused, the motion cannot be computed, or the disk refuses.
pub fn simulate(case_path: &Path, out: &Path) -> Result<Written, SimulateError> {
    let case = read_case(case_path)?;
    let model = read_model(&case.model)?;
    let simulation = simulate_case(&case, &model)?;
    let name = match case.format {
        Format::Csv => "telemetry.csv",
        Format::Parquet => "telemetry.parquet",
    };
    let failed = |path: &Path, source| SimulateError::Write {
        path: path.to_owned(),
        source,
    };
    std::fs::create_dir_all(out).map_err(|e| failed(out, e))?;
    let workshop = tempfile::Builder::new()
        .prefix(".poinsot-")
        .tempdir_in(out)
        .map_err(|e| failed(out, e))?;
    poinsot_telemetry::write(&workshop.path().join(name), &simulation.table.channels)?;
    let text = format!("{:#}\n", simulation.truth);
    let draft = workshop.path().join("truth.json");
    let whole = std::fs::File::create(&draft).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    whole.map_err(|e| failed(&draft, e))?;
    let (telemetry, truth) = (out.join(name), out.join("truth.json"));
    std::fs::rename(workshop.path().join(name), &telemetry).map_err(|e| failed(&telemetry, e))?;
    if let Err(e) = std::fs::rename(&draft, &truth) {
        // Telemetry without its truth must not stand alone; what hinders that is the same fault.
        let _ = std::fs::remove_file(&telemetry);
        return Err(failed(&truth, e));
    }
    let channels = &simulation.table.channels;
    Ok(Written {
        telemetry,
        truth,
        rows: case.times().len(),
        channels: channels.len(),
    })
}

/// Runs a case in memory; the model's nominal numbers are the truth.
///
/// # Errors
/// The case does not fit the model, or the motion cannot be computed.
pub fn simulate_case(case: &Case, model: &Model) -> Result<Simulation, SimulateError> {
    simulate_trial(case, model, 0)
}

/// The same with the noise of one of many trials: equal seed and trial give equal bits.
///
/// # Errors
/// As [`simulate_case`].
pub fn simulate_trial(case: &Case, model: &Model, trial: u64) -> Result<Simulation, SimulateError> {
    let scenario = case.bind(model)?;
    let Recorded {
        recorder,
        first,
        used,
    } = record(case, model, &scenario, trial)?;
    let mut truth = truth::document(case, model, &scenario, first.as_ref(), &recorder, trial);
    if let Some(object) = truth.as_object_mut().filter(|_| !used.is_empty()) {
        object.insert("wheel_use".to_owned(), wheel_use(model, &used));
    }
    Ok(Simulation {
        table: recorder.table(&scenario),
        truth,
    })
}

/// The readings of perfect sensors.
#[derive(Debug, Clone)]
pub struct Exact {
    /// Only what some sensor measures, and the motion of joints, wheels and thrusters.
    pub table: Table,
    /// Bias that the case gives each sensor of the model; it is not in the table.
    pub biases: Vec<Option<Vec<f64>>>,
}

/// What perfect sensors read, each at its own times and place, and the biases that the case gives them.
///
/// # Errors
/// As [`simulate_case`].
pub fn simulate_exact(case: &Case, model: &Model) -> Result<Exact, SimulateError> {
    let mut perfect = model.clone();
    for sensor in &mut perfect.sensors {
        sensor.noise_covariance = None;
        sensor.quantisation = 0.0;
        sensor.bias = Nuisance::Known;
    }
    let mut scenario = case.bind(model)?;
    let biases = scenario.sensors.iter_mut().map(|s| s.bias.take()).collect();
    let recorded = record(case, &perfect, &scenario, 0)?;
    let mut table = recorded.recorder.table(&scenario);
    keep_measured(model, &mut table);
    Ok(Exact { table, biases })
}

/// Leaves out what no sensor of the model measures: a simulation knows the whole motion, an experiment does
/// not. Joints, wheels and thrusters are commanded and stay.
pub(crate) fn keep_measured(model: &Model, table: &mut Table) {
    let blind: Vec<String> = SensorKind::ALL
        .into_iter()
        .filter(|kind| !kind.is_scalar() && model.sensors_of(*kind).next().is_none())
        .flat_map(|kind| names(model, kind, &[]))
        .collect();
    table.channels.retain(|c| !blind.contains(&c.name));
}

/// A run: what was read, the first instant, and how far a controller used the wheels.
struct Recorded {
    recorder: Recorder,
    first: Option<MotionSample>,
    used: Vec<WheelUse>,
}

fn record(
    case: &Case,
    model: &Model,
    scenario: &Scenario,
    trial: u64,
) -> Result<Recorded, SimulateError> {
    let motion = |error| SimulateError::Motion {
        file: case.path().to_owned(),
        error,
    };
    let tree = Tree::new(model);
    let mut recorder = Recorder::new(model, scenario, &tree, case.seed, trial);
    let mut first: Option<MotionSample> = None;
    let mut taken = 0_usize;
    let take = |sample: &MotionSample| {
        if first.is_none() {
            first = Some(sample.clone());
        }
        recorder.take(sample);
        taken += 1;
        if taken.is_multiple_of(REPORTED) {
            step("simulating samples", taken, scenario.times.len());
        }
    };
    let (start, times) = (&scenario.start, &scenario.times);
    let mut used = Vec::new();
    match &scenario.control {
        None => Prescribed::new(model, &scenario.plan, case.tolerance)
            .and_then(|vehicle| vehicle.run(start, times, take))
            .map_err(|e| motion(e.into()))?,
        Some(c) => {
            used = ControlledVehicle::new(model, &c.law, &c.limits, case.tolerance)
                .and_then(|vehicle| vehicle.run(start, &c.wheel_speed, times, take))
                .map_err(motion)?;
        }
    }
    Ok(Recorded {
        recorder,
        first,
        used,
    })
}

/// How far the controller used each wheel, and whether a limit cut its commands.
fn wheel_use(model: &Model, used: &[WheelUse]) -> serde_json::Value {
    let wheels = model.wheels.iter().zip(used);
    wheels
        .map(|(wheel, used)| {
            let numbers = serde_json::json!({
                "largest_speed_rad_s": used.speed,
                "largest_torque_N_m": used.torque,
                "saturated": used.limited,
            });
            (wheel.name.clone(), numbers)
        })
        .collect::<serde_json::Map<_, _>>()
        .into()
}

/// One random stream per sensor and trial.
pub(crate) fn stream(trial: u64, sensor: usize) -> u64 {
    (trial << 16) | (sensor as u64 & 0xffff)
}

/// Rate of a sensor in a scenario, relative to the rows.
fn every(scenario: &Scenario, sensor: usize) -> usize {
    scenario.sensors.get(sensor).map_or(1, |s| s.every)
}
