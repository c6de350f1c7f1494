//! Fits with many unknown sensor errors, directly from nominal values.

use crate::vehicle;

use nalgebra::{Matrix3, UnitQuaternion};
use poinsot_identify::Status;
use poinsot_model::{Nuisance, SensorKind};
use poinsot_spatial::{Vector3, skew};
use vehicle::*;

/// Gyro bias, scale and misalignment, all wheel axes, two of three thrusters and the body are wrong. Returns status,
/// iterations, and the largest error of the body.
fn fitted(size: f64, seed: u64) -> (Status, usize, f64) {
    let mut dice = Dice::new(seed);
    let mut model = with_thrusters(with_wheels(known_arm(13)));
    model.sensors = sensors(1.0e-5);
    let mut truth = model.clone();
    for wheel in &mut truth.wheels {
        let tilt = UnitQuaternion::from_scaled_axis(dice.vector(size));
        wheel.axis_B = tilt * wheel.axis_B;
    }
    let flight = Flight {
        rate_hz: 20.0,
        ..moving(&truth, 6)
    };
    let mut table = fly(&truth, &flight);
    let (scale, turn, bias) = (
        dice.vector(size),
        dice.vector(size),
        dice.vector(0.1 * size),
    );
    let error = Matrix3::from_diagonal(&scale) + skew(&turn);
    let axes = ["omega_x", "omega_y", "omega_z"];
    for k in 0..channel(&mut table, "omega_x").values.len() {
        let w = Vector3::from(axes.map(|n| channel(&mut table, n).values[k]));
        let read = w + error * w + bias;
        for (axis, name) in axes.into_iter().enumerate() {
            channel(&mut table, name).values[k] = read[axis];
        }
    }
    for name in ["thr2_N", "thr3_N"] {
        let factor = 1.0 / (1.0 + dice.between(-size, size));
        channel(&mut table, name)
            .values
            .iter_mut()
            .for_each(|x| *x *= factor);
    }
    let mut asked = off_nominal(&model, (3.0 * size).min(0.6));
    for wheel in &mut asked.wheels {
        wheel.misalignment = Nuisance::Estimate;
    }
    for thruster in &mut asked.thrusters[1..] {
        thruster.scale = Nuisance::Estimate;
    }
    for s in asked
        .sensors
        .iter_mut()
        .filter(|s| s.kind == SensorKind::Gyro)
    {
        s.bias = Nuisance::Estimate;
        s.scale = Nuisance::Estimate;
        s.misalignment = Nuisance::Estimate;
        s.lag = Nuisance::Estimate;
    }
    let answer = ask(&asked, vec![table], "auto");
    let numbers = answer.estimate.bodies[0]
        .inertia
        .iter()
        .all(|n| n.value.is_some());
    let error = if numbers {
        worst_error(&answer, &truth, 0)
    } else {
        f64::NAN
    };
    (answer.estimate.status, answer.estimate.iterations, error)
}

#[test]
fn exact_many_nuisances_come_back_from_nominal_numbers() {
    // Measured: two iterations, 2e-8.
    for seed in 0..2 {
        let (status, iterations, error) = fitted(0.4, seed);
        assert_eq!(status, Status::Converged);
        assert!(iterations < 10 && error < 1.0e-6, "{iterations} {error:e}");
    }
}
