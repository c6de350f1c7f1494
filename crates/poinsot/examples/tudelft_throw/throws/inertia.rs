//! The inertia tensor of one body from its throws, by the library's linear method.

use super::recording::Recording;
use super::{Fault, Settings};
use nalgebra::Matrix3;
use poinsot::bind::bind;
use poinsot_dynamics::Tree;
use poinsot_identify::{TENSOR, linear};
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::{Channel, Source, Table};
use std::sync::Arc;

/// Error of the momentum balance within one window, sigma, N m s: about equal to the residuals.
const MOMENTUM_SIGMA: f64 = 1.0e-5;

/// Central inertia over the wheel's spin inertia J, body axes, locked rotor.
///
/// Every window of every throw is a segment with its own momentum; the body is common. The second pass uses weights
/// from the first result.
pub fn inertia_over_J(
    model: &Model,
    throws: &[&Recording],
    settings: &Settings,
) -> Result<Matrix3<f64>, Fault> {
    let tables: Vec<Table> = throws.iter().flat_map(|t| windows(t, settings)).collect();
    let mut model = model.clone();
    for _ in 0..2 {
        weigh_torque(&mut model)?;
        let answer = identify(&model, &tables)?;
        model.bodies[0].nominal.I_BBcm_B = answer;
    }
    Ok(model.bodies[0].nominal.I_BBcm_B / model.wheels[0].spin_inertia)
}

/// Declares the gyro noise for which the error of `I w` is equal about every axis. A throw is disturbed by torques
/// (drag, vibration of the wheel), far above the white noise of the gyro.
fn weigh_torque(model: &mut Model) -> Result<(), Fault> {
    let inverse = model.bodies[0]
        .nominal
        .I_BBcm_B
        .try_inverse()
        .ok_or("singular inertia")?;
    let covariance = inverse * inverse.transpose() * MOMENTUM_SIGMA.powi(2);
    for sensor in model
        .sensors
        .iter_mut()
        .filter(|s| s.kind == SensorKind::Gyro)
    {
        sensor.noise_covariance = Some(covariance);
    }
    Ok(())
}

fn identify(model: &Model, tables: &[Table]) -> Result<Matrix3<f64>, Fault> {
    let tree = Tree::new(model);
    let bound = bind(model, &tree, tables)?;
    let estimate = linear(&bound.problem(model, &tree))?;
    let mut tensor = Matrix3::zeros();
    for ((i, j), number) in TENSOR.iter().zip(&estimate.bodies[0].inertia) {
        let value = number.value.ok_or("an inertia entry is not identifiable")?;
        tensor[(*i, *j)] = value;
        tensor[(*j, *i)] = value;
    }
    Ok(tensor)
}

/// Divides a throw into windows that overlap by half.
///
/// The momentum is assumed constant within a window; drag may change it between windows.
fn windows(throw: &Recording, settings: &Settings) -> Vec<Table> {
    let length = ((settings.window_s * throw.rate_hz) as usize).clamp(2, throw.time_s.len());
    (0..=throw.time_s.len() - length)
        .step_by((length / 2).max(1))
        .map(|from| table(throw, from, from + length))
        .collect()
}

/// The samples of a part of a throw.
pub fn table(throw: &Recording, from: usize, to: usize) -> Table {
    let time_s: Arc<[f64]> = throw.time_s[from..to].into();
    let channel = |name: &str, frame: &str, values: Vec<f64>| Channel {
        name: name.to_owned(),
        sensor: String::new(),
        unit: "rad/s".to_owned(),
        frame: frame.to_owned(),
        time_s: Arc::clone(&time_s),
        values,
    };
    let rate = |k: usize| throw.w_NB_B[from..to].iter().map(|w| w[k]).collect();
    Table {
        channels: vec![
            channel("omega_x", "body", rate(0)),
            channel("omega_y", "body", rate(1)),
            channel("omega_z", "body", rate(2)),
            channel("wheel_rad_s", "", throw.wheel_rad_s[from..to].to_vec()),
        ],
        sources: vec![Source {
            path: format!("{} from {:.3} s", throw.name, throw.time_s[from]),
            sha256: String::new(),
            rows: to - from,
            time_s: [throw.time_s[from], throw.time_s[to - 1]],
        }],
        ..Table::default()
    }
}
