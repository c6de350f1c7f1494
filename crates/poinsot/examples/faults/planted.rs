//! One experiment, one fault at a time: whether it is detected and named correctly.

use poinsot::Error;
use poinsot::bind::bind;
use poinsot::case::read_case;
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{FaultKind, maximum_likelihood};
use poinsot_model::{SensorKind, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table, check_conventions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Samples kept: every fifth of 50 Hz.
const STRIDE: usize = 5;
/// A lag of one sample at 50 Hz.
const LATE: usize = 1;
/// The lag, s.
const LATE_S: f64 = 0.02;
/// Size of an outlier, in sigmas of the gyro.
const OUTLIER: f64 = 20.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Planted {
    Nothing,
    GyroScale,
    WheelSign,
    WheelExchange,
    GyroLag,
    TrackerLag,
    WheelLag,
    VelocityLag,
    PositionLag,
    GyroInDegrees,
    WheelsInDegrees,
    Noise,
    Thruster,
    Outliers,
    Pendulum,
    Panel,
}

impl Planted {
    /// All faults.
    pub const ALL: [Self; 16] = [
        Self::Nothing,
        Self::GyroScale,
        Self::WheelSign,
        Self::WheelExchange,
        Self::GyroLag,
        Self::TrackerLag,
        Self::WheelLag,
        Self::VelocityLag,
        Self::PositionLag,
        Self::GyroInDegrees,
        Self::WheelsInDegrees,
        Self::Noise,
        Self::Thruster,
        Self::Outliers,
        Self::Pendulum,
        Self::Panel,
    ];

    /// Description.
    pub fn words(self) -> &'static str {
        match self {
            Self::Nothing => "none",
            Self::GyroScale => "gyro scale 1 %",
            Self::WheelSign => "sign of one wheel flipped",
            Self::WheelExchange => "speeds of two wheels exchanged",
            Self::GyroLag => "gyro 20 ms late",
            Self::TrackerLag => "star tracker 20 ms late",
            Self::WheelLag => "wheel speeds 20 ms late",
            Self::VelocityLag => "velocity 20 ms late, its noise a tenth",
            Self::PositionLag => "position 20 ms late, its noise a tenth",
            Self::GyroInDegrees => "gyro in deg/s, declared rad/s",
            Self::WheelsInDegrees => "one wheel in deg/s, declared rad/s",
            Self::Noise => "gyro noise understated by 3",
            Self::Thruster => "one thruster 10 % stronger",
            Self::Outliers => "3 % of the gyro readings off by 20 sigma",
            Self::Pendulum => "pendulum of 2 % of the mass",
            Self::Panel => "panel on a soft hinge",
        }
    }

    /// Whether the vehicle itself is another one.
    fn is_soft(self) -> bool {
        matches!(self, Self::Pendulum | Self::Panel)
    }

    /// Correct name in the diagnosis.
    pub fn fault(self) -> Option<FaultKind> {
        match self {
            Self::Nothing => None,
            Self::GyroScale => Some(FaultKind::GyroScale),
            Self::WheelSign => Some(FaultKind::WheelSign),
            Self::WheelExchange => Some(FaultKind::WheelExchange),
            Self::GyroLag
            | Self::TrackerLag
            | Self::WheelLag
            | Self::VelocityLag
            | Self::PositionLag => Some(FaultKind::Lag),
            Self::GyroInDegrees | Self::WheelsInDegrees => Some(FaultKind::Units),
            Self::Noise => Some(FaultKind::NoiseUnderstated),
            Self::Thruster => Some(FaultKind::Thrust),
            Self::Outliers => Some(FaultKind::Outliers),
            Self::Pendulum | Self::Panel => Some(FaultKind::NotRigid),
        }
    }

    /// Text required in the sentence besides the kind: the faulty sensor or actuator.
    fn culprit(self) -> &'static str {
        match self {
            Self::WheelSign | Self::WheelsInDegrees => "wheel2",
            Self::WheelExchange => "wheel1 and wheel2",
            Self::Thruster => "thr2",
            Self::TrackerLag => "tracker",
            Self::WheelLag => "a lag of the wheels",
            Self::VelocityLag => "a lag of the velocity",
            Self::PositionLag => "a lag of the position",
            Self::Nothing => "",
            Self::Pendulum | Self::Panel => "line at",
            _ => "gyro",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// Whether anything was reported.
    pub detected: bool,
    /// Whether the first finding names fault and part.
    pub named: bool,
    /// Name of the first finding.
    pub first: String,
    /// Whether the answer is refused or marked unreliable.
    pub doubted: bool,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Said {
    pub names: Vec<String>,
    pub text: String,
}

impl Said {
    pub fn error(text: String) -> Self {
        let names = vec!["error".to_owned()];
        Self { names, text }
    }
}

/// Trials of one fault.
pub struct Row {
    pub planted: Planted,
    pub trials: u64,
    pub detected: usize,
    pub named: usize,
    pub doubted: usize,
    /// Number of times each name came first.
    pub firsts: BTreeMap<String, usize>,
}

/// The experiment: truth and sensors of `data/cases/faults.toml`, nominal errors of a few percent. A vehicle that
/// is not rigid has its own case, and is identified as `rigid_bus.toml`.
pub fn experiment(planted: Planted) -> Result<Study, Error> {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let name = match planted {
        Planted::Pendulum => "slosh.toml",
        Planted::Panel => "hinged_panel.toml",
        _ => "faults.toml",
    };
    let case = read_case(&cases.join(name)).map_err(poinsot::simulate::SimulateError::from)?;
    let truth = read_model(&case.model)?;
    if planted.is_soft() {
        return Study::of_case(&case, &truth, read_model(cases.join("rigid_bus.toml"))?);
    }
    let mut model = truth.clone();
    for body in model.bodies.iter_mut().filter(|b| b.estimate.any()) {
        body.nominal.mass *= 1.05;
        body.nominal.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
        body.nominal.I_BBcm_B *= 0.93;
    }
    let sharp = match planted {
        Planted::VelocityLag => Some(SensorKind::Velocity),
        Planted::PositionLag => Some(SensorKind::Position),
        _ => None,
    };
    // 20 ms of this motion are below the original noise of the sensors, so they could not be detected.
    for sensor in model.sensors.iter_mut().filter(|s| Some(s.kind) == sharp) {
        sensor.noise_covariance = sensor.noise_covariance.map(|c| c * 0.01);
    }
    Study::of_case(&case, &truth, model)
}

/// Trials of one fault, in parallel.
pub fn row(study: &Study, planted: Planted, trials: u64) -> Row {
    let faulty = plant(study, planted);
    let outcomes: Vec<Outcome> = (0..trials)
        .into_par_iter()
        .map(|trial| outcome(&faulty, planted, trial))
        .collect();
    let mut firsts = BTreeMap::new();
    for outcome in outcomes.iter().filter(|o| o.detected) {
        *firsts.entry(outcome.first.clone()).or_insert(0) += 1;
    }
    Row {
        planted,
        trials,
        detected: outcomes.iter().filter(|o| o.detected).count(),
        named: outcomes.iter().filter(|o| o.named).count(),
        doubted: outcomes.iter().filter(|o| o.doubted).count(),
        firsts,
    }
}

/// The experiment with a fault in the ideal measurements, or in the sensors.
fn plant(study: &Study, planted: Planted) -> Study {
    let mut study = study.clone();
    let table = &mut study.exact[0];
    let gyro = |c: &Channel| c.name.starts_with("omega_");
    let attitude = |c: &Channel| c.name.starts_with("q_");
    match planted {
        Planted::GyroScale => scale(table, gyro, 1.01),
        Planted::WheelSign => scale(table, |c| c.name == "wheel2_rad_s", -1.0),
        Planted::WheelExchange => {
            for channel in &mut table.channels {
                channel.name = match channel.name.as_str() {
                    "wheel1_rad_s" => "wheel2_rad_s".to_owned(),
                    "wheel2_rad_s" => "wheel1_rad_s".to_owned(),
                    _ => continue,
                };
            }
        }
        Planted::GyroInDegrees => scale(table, gyro, 1.0_f64.to_degrees()),
        Planted::WheelsInDegrees => {
            scale(table, |c| c.name == "wheel2_rad_s", 1.0_f64.to_degrees())
        }
        // Telemetry shows less than the actual thrust.
        Planted::Thruster => scale(table, |c| c.name == "thr2_N", 1.0 / 1.1),
        Planted::GyroLag => delay(table, gyro),
        Planted::TrackerLag => late_s(table, attitude),
        Planted::WheelLag => delay(table, |c| c.name.starts_with("wheel")),
        Planted::VelocityLag => late_s(table, |c| c.name.starts_with("v_")),
        Planted::PositionLag => late_s(table, |c| c.name.starts_with("r_")),
        Planted::Noise => {
            for sensor in study
                .sensors
                .iter_mut()
                .filter(|s| s.kind == SensorKind::Gyro)
            {
                sensor.noise_covariance = sensor.noise_covariance.map(|c| c * 9.0);
            }
        }
        Planted::Nothing | Planted::Outliers | Planted::Pendulum | Planted::Panel => {}
    }
    if planted.is_soft() {
        return study;
    }
    for table in &mut study.exact {
        thin(table);
    }
    study
}

fn scale(table: &mut Table, wanted: impl Fn(&Channel) -> bool, factor: f64) {
    for channel in table.channels.iter_mut().filter(|c| wanted(c)) {
        channel.values.iter_mut().for_each(|x| *x *= factor);
    }
}

/// Delays every sample by 20 ms.
fn delay(table: &mut Table, wanted: impl Fn(&Channel) -> bool) {
    for channel in table.channels.iter_mut().filter(|c| wanted(c)) {
        let times: Vec<f64> = channel.time_s[LATE..].to_vec();
        channel.values.truncate(times.len());
        channel.time_s = times.into();
    }
}

/// Delays the times of slower sensors by 20 ms.
fn late_s(table: &mut Table, wanted: impl Fn(&Channel) -> bool) {
    for channel in table.channels.iter_mut().filter(|c| wanted(c)) {
        channel.time_s = channel.time_s.iter().map(|t| t + LATE_S).collect();
    }
}

/// Fast channels at a fifth of their rate, on the times of the first of them.
fn thin(table: &mut Table) {
    let fast = table
        .channels
        .iter()
        .map(|c| c.time_s.len())
        .max()
        .unwrap_or(0);
    let grid: Vec<f64> = table
        .channels
        .iter()
        .find(|c| c.time_s.len() == fast)
        .map(|c| {
            c.time_s
                .iter()
                .copied()
                .skip(STRIDE)
                .step_by(STRIDE)
                .collect()
        })
        .unwrap_or_default();
    for channel in table
        .channels
        .iter_mut()
        .filter(|c| c.time_s.len() + LATE >= fast)
    {
        let keep: Vec<usize> = (0..channel.time_s.len())
            .filter(|k| {
                let t = channel.time_s[*k];
                let at = grid.partition_point(|g| *g < t - 1.0e-6);
                grid.get(at).is_some_and(|g| (g - t).abs() < 1.0e-6)
            })
            .collect();
        channel.values = keep.iter().map(|k| channel.values[*k]).collect();
        channel.time_s = Arc::from_iter(keep.iter().map(|k| channel.time_s[*k]));
    }
}

fn outcome(study: &Study, planted: Planted, trial: u64) -> Outcome {
    let (mut tables, _) = study.draw(trial);
    if planted == Planted::Outliers {
        spoil(&mut tables[0], study, trial);
    }
    let (said, doubted) =
        diagnosed(study, &tables).unwrap_or_else(|e| (vec![Said::error(e)], true));
    let wanted = planted.fault();
    let right = |said: &Said| {
        let is = |name: &String| wanted.is_some_and(|f| f.name() == name);
        said.names.iter().any(is) && said.text.contains(planted.culprit())
    };
    Outcome {
        detected: !said.is_empty(),
        named: said.first().is_some_and(right),
        first: said.first().map(|f| f.names.join("|")).unwrap_or_default(),
        doubted,
    }
}

/// Findings reported to a user, on reading or by the diagnosis, and whether the answer is marked unreliable.
pub fn diagnosed(study: &Study, tables: &[Table]) -> Result<(Vec<Said>, bool), String> {
    for table in tables {
        if let Err(refusal) = check_conventions(table) {
            let text = refusal.to_string();
            // The check names the convention that fits best.
            let name = if text.contains("deg/s") {
                FaultKind::Units.name()
            } else {
                "conventions"
            };
            let names = vec![name.to_owned()];
            return Ok((vec![Said { names, text }], true));
        }
    }
    let tree = Tree::new(&study.model);
    let bound = bind(&study.model, &tree, tables).map_err(|e| e.to_string())?;
    let estimate =
        maximum_likelihood(&bound.problem(&study.model, &tree)).map_err(|e| e.to_string())?;
    let doubted = !estimate.passes();
    let found = estimate.diagnostics.map(|d| d.findings).unwrap_or_default();
    let said = found.into_iter();
    let name = |f: &FaultKind| f.name().to_owned();
    let said = said.map(|f| Said {
        names: std::iter::once(&f.fault).chain(&f.or).map(name).collect(),
        text: f.text,
    });
    Ok((said.collect(), doubted))
}

/// Adds twenty sigma in a random direction to three of a hundred gyro samples.
fn spoil(table: &mut Table, study: &Study, trial: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(study.seed ^ 0x5eed);
    rng.set_stream(trial);
    let gyro = study.sensors.iter().find(|s| s.kind == SensorKind::Gyro);
    let Some(covariance) = gyro.and_then(|s| s.noise_covariance) else {
        return;
    };
    let size = OUTLIER * covariance[(0, 0)].sqrt();
    let samples = table.channel("omega_x").map_or(0, |c| c.values.len());
    for k in 0..samples {
        if rng.random::<f64>() >= 0.03 {
            continue;
        }
        let part = || 2.0 * rng.random::<f64>() - 1.0;
        let way = Vector3::from_iterator(std::iter::repeat_with(part).take(3));
        let error = way.normalize() * size;
        for (axis, name) in ["omega_x", "omega_y", "omega_z"].iter().enumerate() {
            let own = table.channels.iter_mut().find(|c| c.name == *name);
            if let Some(x) = own.and_then(|c| c.values.get_mut(k)) {
                *x += error[axis];
            }
        }
    }
}
