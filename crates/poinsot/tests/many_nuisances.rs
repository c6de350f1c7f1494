//! Fits with many numbers of the instruments free, straight from nominal values.
#![allow(clippy::unwrap_used, non_snake_case)]

#[path = "points/mod.rs"]
mod points;
mod vehicle;

use nalgebra::{Matrix3, UnitQuaternion};
use poinsot_dynamics::StartVelocity;
use poinsot_identify::{Status, TENSOR};
use poinsot_model::{EstimateSet, Nuisance, Sensor, SensorKind};
use poinsot_spatial::Vector3;
use points::{add_point, with_point};
use vehicle::*;

/// A thrown box: nothing but a gyro, an accelerometer and a tachometer, whose scale, axes, biases and lags are unknown as
/// are the wheel's axis and the drag. What comes back, how many iterations it took, and the largest error of the inertia
/// relative to its trace.
fn thrown(size: f64, seed: u64, posed: bool) -> (Status, usize, f64) {
    let mut dice = Dice::new(seed);
    let place = Vector3::new(0.4, -0.3, 0.6);
    let at = (SensorKind::Accelerometer, 0, place);
    let mut model = with_point(with_wheels(tree(3, "")), at, 1.0e-4);
    for s in &mut model.sensors {
        s.noise_covariance = Some(Matrix3::identity() * 1.0e-8);
    }
    let mut truth = model.clone();
    for wheel in &mut truth.wheels {
        let tilt = UnitQuaternion::from_scaled_axis(dice.vector(size));
        wheel.axis_B = tilt * wheel.axis_B;
    }
    let mut flight = Flight {
        rate_hz: 20.0,
        ..moving(&truth, 6)
    };
    if let StartVelocity::Twist { w_NB_B, .. } = &mut flight.start.velocity {
        *w_NB_B *= 4.0;
    }
    let mut table = fly(&truth, &flight);
    add_point(&mut table, &truth, &flight, at);
    let mut table = rotation_only(table);
    if !posed {
        table = without(table, &["q_"]);
    }
    let (scale, bias) = (dice.vector(size), dice.vector(0.1 * size));
    let e = dice.vector(size);
    let error = Matrix3::new(scale.x, e.z, e.y, e.z, scale.y, e.x, e.y, e.x, scale.z);
    let axes = ["omega_x", "omega_y", "omega_z"];
    for k in 0..channel(&mut table, "omega_x").values.len() {
        let w = Vector3::from(axes.map(|n| channel(&mut table, n).values[k]));
        let read = w + error * w + bias;
        for (axis, name) in axes.into_iter().enumerate() {
            channel(&mut table, name).values[k] = read[axis];
        }
    }
    let bias = dice.vector(size);
    for (k, name) in ["acc_x", "acc_y", "acc_z"].into_iter().enumerate() {
        let values = &mut channel(&mut table, name).values;
        values.iter_mut().for_each(|x| *x += bias[k]);
    }
    let mut asked = off_nominal(&model, (3.0 * size).min(0.8));
    asked.bodies[0].estimate = EstimateSet {
        mass: false,
        ..EstimateSet::ALL
    };
    for wheel in &mut asked.wheels {
        wheel.misalignment = Nuisance::Estimate;
    }
    asked.sensors.push(Sensor {
        of: vec![0, 1, 2],
        lag: Nuisance::Estimate,
        ..sensor(SensorKind::WheelSpeed, 1.0e-9)
    });
    for s in &mut asked.sensors {
        match s.kind {
            SensorKind::Gyro => {
                s.bias = Nuisance::Estimate;
                s.scale = Nuisance::Estimate;
                s.nonorthogonality = Nuisance::Estimate;
                s.lag = Nuisance::Estimate;
            }
            SensorKind::Accelerometer => {
                s.bias = Nuisance::Estimate;
                s.scale = Nuisance::Estimate;
                s.misalignment = Nuisance::Estimate;
                s.lag = Nuisance::Estimate;
            }
            _ => {}
        }
    }
    asked.environment.disturbance_torque = Nuisance::Estimate;
    asked.environment.drag_torque = Nuisance::Estimate;
    let answer = ask(&asked, vec![table], "auto");
    let body = &answer.estimate.bodies[0];
    let I = truth.bodies[0].nominal.I_BBcm_B;
    let mut worst = 0.0_f64;
    for (n, element) in body.inertia.iter().zip(TENSOR) {
        worst = worst.max(
            n.value
                .map_or(f64::INFINITY, |x| (x - I[element]).abs() / I.trace()),
        );
    }
    println!(
        "{size} {seed}: {:?} {} {worst:.1e} {:?}",
        answer.estimate.status, answer.estimate.iterations, answer.estimate.warnings
    );
    (answer.estimate.status, answer.estimate.iterations, worst)
}

#[test]
fn exact_many_nuisances_come_back_from_nominal_numbers() {
    for size in [0.4, 0.7] {
        for seed in 0..5 {
            thrown(size, seed, true);
            thrown(size, seed, false);
        }
    }
}
