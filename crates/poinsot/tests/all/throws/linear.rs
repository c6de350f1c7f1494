//! One body from its throws by the library's linear method: filtered samples in windows.

use super::chain::{Bodies, Body, Covariance, Found, identify, symmetric};
use super::device::Lever;
use super::recording::Recording;
use super::{Fault, Throws};
use nalgebra::Matrix3;
use poinsot::bind::bind;
use poinsot_dynamics::Tree;
use poinsot_identify::linear;
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::Table;
use std::path::Path;

/// Error of the momentum balance within one window, sigma, N m s: about equal to the residuals.
const MOMENTUM_SIGMA: f64 = 1.0e-5;
/// Length of the windows within which momentum is constant, s.
const WINDOW_S: f64 = 0.05;

/// Objects from the throws in a folder.
pub fn evaluate(folder: &Path) -> Result<Found, Fault> {
    let throws = Throws::read(folder, true);
    identify(&throws, |_, own| {
        let each = own.iter().map(|t| body(&throws.model, &[t]));
        Ok(Bodies {
            each: each.collect::<Result<_, _>>()?,
            together: body(&throws.model, &own.iter().collect::<Vec<_>>())?,
            scatter: 1.0,
        })
    })
}

/// Every window of every throw is a segment with its own momentum; the body is common. The second pass uses weights from
/// the first result.
fn body(model: &Model, throws: &[&Recording]) -> Result<Body, Fault> {
    let tables: Vec<Table> = throws.iter().flat_map(|t| windows(t)).collect();
    let mut model = model.clone();
    for _ in 0..2 {
        weigh_torque(&mut model)?;
        model.bodies[0].nominal.I_BBcm_B = inertia(&model, &tables)?;
    }
    let mut lever = Lever::default();
    for throw in throws {
        lever.follow(throw, &throw.w_NB_B);
    }
    let p = lever.p_Sc_B(&Default::default());
    Ok(Body {
        I: model.bodies[0].nominal.I_BBcm_B / model.wheels[0].spin_inertia,
        p: p.ok_or("the accelerometer does not show the mass centre")?,
        I_cov: Covariance::zeros(),
        p_cov: Matrix3::zeros(),
    })
}

/// Declares the gyro noise for which the error of `I w` is equal about every axis. A throw is disturbed by torques
/// (drag, vibration of the wheel), far above the white noise of the gyro.
fn weigh_torque(model: &mut Model) -> Result<(), Fault> {
    let tensor = model.bodies[0].nominal.I_BBcm_B;
    let inverse = tensor.try_inverse().ok_or("singular inertia")?;
    let covariance = inverse * inverse.transpose() * MOMENTUM_SIGMA.powi(2);
    let all = model.sensors.iter_mut();
    for sensor in all.filter(|s| s.kind == SensorKind::Gyro) {
        sensor.noise_covariance = Some(covariance);
    }
    Ok(())
}

fn inertia(model: &Model, tables: &[Table]) -> Result<Matrix3<f64>, Fault> {
    let tree = Tree::new(model);
    let bound = bind(model, &tree, tables)?;
    let estimate = linear(&bound.problem(model, &tree))?;
    let numbers = &estimate.bodies[0].inertia;
    if numbers.iter().any(|n| n.value.is_none()) {
        return Err("an inertia entry is not identifiable".into());
    }
    Ok(symmetric(std::array::from_fn(|k| {
        numbers[k].value.unwrap_or(0.0)
    })))
}

/// Divides a throw into windows that overlap by half.
///
/// The momentum is assumed constant within a window; drag may change it between windows.
fn windows(throw: &Recording) -> Vec<Table> {
    let length = ((WINDOW_S * throw.rate_hz) as usize).clamp(2, throw.time_s.len());
    (0..=throw.time_s.len() - length)
        .step_by((length / 2).max(1))
        .map(|from| throw.table(from, from + length))
        .collect()
}
