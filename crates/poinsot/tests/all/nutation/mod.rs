//! Test problem: a rigid bus with stored momentum, with nutation faster than its rotation.
//!
//! Bus of 15, 18 and 20 kg m2 with three wheels (`data/cases/rigid_bus.toml`), one of which stores the momentum h.
//! Records are made by `simulate`, whose integrator controls its error. Motor torques are constant between whole
//! seconds and wheel speeds are exact, so only the propagation of the estimator can cause errors.
#![allow(dead_code)]

use poinsot::case::parse_case;
use poinsot::trials::Study;
use poinsot_model::{Model, SensorKind, parse_model};
use std::path::Path;

const BUS: &str = include_str!("../../../../../data/cases/rigid_bus.toml");

/// One setting of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Momentum stored in wheel 1, N m s.
    pub stored_N_m_s: f64,
    /// Samples per second of every sensor.
    pub rate_hz: f64,
}

/// Every setting of the table.
pub fn table() -> Vec<Cell> {
    let of = |stored_N_m_s: f64, rate_hz: f64| Cell {
        stored_N_m_s,
        rate_hz,
    };
    let mut cells: Vec<Cell> = [0.0, 3.0, 6.0, 9.0, 18.0]
        .into_iter()
        .flat_map(|h| [1.0, 2.0, 10.0].map(|rate| of(h, rate)))
        .collect();
    cells.push(of(60.0, 10.0));
    cells
}

/// The bus; tachometers are exact.
pub fn bus() -> Model {
    let mut model = parse_model(BUS, "rigid_bus.toml").unwrap();
    model.sensors.retain(|s| s.kind != SensorKind::WheelSpeed);
    model
}

fn case(cell: Cell, spin_inertia: f64) -> String {
    let Cell {
        stored_N_m_s,
        rate_hz,
    } = cell;
    let speed = stored_N_m_s / spin_inertia;
    format!(
        r#"
schema = "poinsot.case/1"
model = "rigid_bus.toml"
duration_s = 200.0

[initial]
omega_rad_s = [0.01, -0.02, 0.015]

[[wheel_motion]]
wheel = "wheel1"
initial_speed_rad_s = {speed:?}
time_s = [0.0, 12.0, 24.0, 120.0, 130.0, 140.0]
torque_N_m = [0.05, -0.05, 0, -0.04, 0.04, 0]
interpolation = "constant"

[[wheel_motion]]
wheel = "wheel2"
time_s = [40.0, 53.0, 66.0, 120.0, 131.0, 142.0]
torque_N_m = [0.05, -0.05, 0, 0.03, -0.03, 0]
interpolation = "constant"

[[wheel_motion]]
wheel = "wheel3"
time_s = [80.0, 91.0, 102.0, 150.0, 163.0, 176.0]
torque_N_m = [0.06, -0.06, 0, 0.05, -0.05, 0]
interpolation = "constant"

[output]
rate_hz = {rate_hz:?}
seed = 3
"#
    )
}

/// The experiment of one setting.
pub fn study(cell: Cell) -> Study {
    study_of(cell, bus())
}

/// The experiment of one setting with another bus.
pub fn study_of(cell: Cell, bus: Model) -> Study {
    let text = case(cell, bus.wheels[0].spin_inertia);
    let case = parse_case(Path::new("nutation.toml"), text).unwrap();
    Study {
        diagnose: false,
        ..Study::of_case(&case, &bus, bus.clone()).unwrap()
    }
}
