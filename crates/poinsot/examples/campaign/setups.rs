//! The experiments that are repeated: shipped exact records and cases, each with its truth.

use poinsot::Error;
use poinsot::case::read_case;
use poinsot::identify::read_options;
use poinsot::trials::Study;
use poinsot_model::{Model, SensorKind, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table, read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An experiment with its name.
pub struct Setup {
    pub name: &'static str,
    pub about: &'static str,
    pub study: Study,
}

/// Names of all set-ups.
pub const NAMES: [&str; 5] = [
    "ma_traj1",
    "ma_traj2",
    "stsat3_multiaxis",
    "xu_target",
    "tug_thrusters",
];

/// Constant bias of every gyro whose bias is asked for, rad/s.
const GYRO_BIAS: [f64; 3] = [2.0e-5, -1.5e-5, 1.0e-5];

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

/// The set-up with this name at every `stride`-th sample; `None` for an unknown name.
pub fn setup(name: &str, stride: usize) -> Option<Result<Setup, Error>> {
    let name = *NAMES.iter().find(|n| **n == name)?;
    let built = match name {
        "ma_traj1" => ma(name, "traj1", stride),
        "ma_traj2" => ma(name, "traj2b", stride),
        "stsat3_multiaxis" => stsat3(name, stride),
        "xu_target" => xu_target(name, stride),
        _ => tug(name, stride),
    };
    Some(built)
}

fn ma(name: &'static str, run: &str, stride: usize) -> Result<Setup, Error> {
    let study = of_record(
        "ma2008/model_noisy.toml",
        "cases/ma2008_truth.toml",
        &format!("ma2008/{run}/telemetry.parquet"),
        stride,
    )?;
    let about = match run {
        "traj1" => "Ma 2008 trajectory 1: unknown cube, known six-joint arm, spin 5 deg/s about z",
        _ => "Ma 2008 trajectory 2: arm up and back, spin 5 deg/s about z",
    };
    Ok(Setup { name, about, study })
}

/// No tachometer's step is known to the last digit, and no slew repeats to it: see docs/validation/campaign.md.
const TACHOMETER_STEP: f64 = 1.0e-3;

fn stsat3(name: &'static str, stride: usize) -> Result<Setup, Error> {
    let mut study = of_record(
        "stsat3/model.toml",
        "cases/stsat3_truth.toml",
        "stsat3/multiaxis/telemetry.parquet",
        stride,
    )?;
    study.step_spread = TACHOMETER_STEP;
    let about = "STSAT-3: one body, three wheels with rounded tachometers, six slews";
    Ok(Setup { name, about, study })
}

fn xu_target(name: &'static str, stride: usize) -> Result<Setup, Error> {
    let about = "Xu 2017: six joints move at once, the grasped target is unknown, the rest known";
    let study = of_case("cases/xu2017_target_all_joints.toml", stride, |body| {
        body.nominal.mass *= 1.05;
        body.nominal.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
        body.nominal.I_BBcm_B *= 1.08;
    })?;
    Ok(Setup { name, about, study })
}

fn tug(name: &'static str, stride: usize) -> Result<Setup, Error> {
    let about = "one rigid body with twelve thrusters, star tracker at 2 Hz, gyro bias";
    let study = of_case("cases/tug_thrusters.toml", stride, |body| {
        body.nominal.mass *= 1.05;
        body.nominal.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
        body.nominal.I_BBcm_B *= 0.93;
    })?;
    Ok(Setup { name, about, study })
}

fn of_record(model: &str, truth: &str, record: &str, stride: usize) -> Result<Study, Error> {
    let model = read_model(examples().join(model))?;
    let truth = read_model(examples().join(truth))?;
    let options = read_options(&model, &model.telemetry, false, false);
    let exact = thinned(read(&[examples().join(record)], &options)?, stride);
    let biases = gyro_biases(&model);
    let mut study = Study::of_tables(vec![exact], &truth, model);
    study.biases = biases;
    Ok(study)
}

fn gyro_biases(model: &Model) -> Vec<Option<Vec<f64>>> {
    let biased = |s: &poinsot_model::Sensor| {
        s.kind == SensorKind::Gyro && s.bias != poinsot_model::Nuisance::Known
    };
    let of = |s| biased(s).then(|| GYRO_BIAS.to_vec());
    model.sensors.iter().map(of).collect()
}

/// Every `stride`-th sample of each channel.
fn thinned(mut table: Table, stride: usize) -> Table {
    let thin = |c: &Channel| Channel {
        time_s: Arc::from_iter(c.time_s.iter().copied().step_by(stride)),
        values: c.values.iter().copied().step_by(stride).collect(),
        ..c.clone()
    };
    table.channels = table.channels.iter().map(thin).collect();
    table
}

fn of_case(
    case: &str,
    stride: usize,
    nominal: impl Fn(&mut poinsot_model::Body),
) -> Result<Study, Error> {
    let mut case =
        read_case(&examples().join(case)).map_err(poinsot::simulate::SimulateError::from)?;
    case.rate_hz /= stride as f64;
    let truth = read_model(&case.model)?;
    let mut model = truth.clone();
    model
        .bodies
        .iter_mut()
        .filter(|b| b.estimate.any())
        .for_each(nominal);
    Study::of_case(&case, &truth, model)
}
