//! Shipped experiments in which mistakes are planted.

use poinsot::Error;
use poinsot::case::read_case;
use poinsot::simulate::SimulateError;
use poinsot::trials::Study;
use poinsot_model::{Origin, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::Table;
use std::path::Path;

pub struct Vehicle {
    pub name: &'static str,
    pub study: Study,
}

impl Vehicle {
    /// Times of all records.
    pub fn rows(&self) -> usize {
        let of_table = |table: &Table| table.channels.iter().map(|c| c.values.len()).max();
        self.study.exact.iter().filter_map(of_table).sum()
    }
}

/// Name and case of each.
const CASES: [(&str, &str); 8] = [
    ("satellite", "data/cases/faults.toml"),
    (
        "two-link arm",
        "crates/poinsot/examples/faults/cases/two_link_arm.toml",
    ),
    (
        "low orbit",
        "crates/poinsot/examples/faults/cases/low_orbit.toml",
    ),
    ("STSAT-3", "data/cases/stsat3_three_slews.toml"),
    ("pyramid", "data/cases/pyramid.toml"),
    ("tug", "data/cases/tug_thrusters.toml"),
    ("cubesat", "data/cases/cubesat.toml"),
    ("grasped target", "data/cases/xu2017_table13.toml"),
];

/// Highest sample rate of a record, Hz: the satellites are simulated at up to 50.
const RATE_HZ: f64 = 10.0;

/// All vehicles, with nominal errors of a few percent and known numbers within the uncertainty of a drawing.
pub fn vehicles() -> Result<Vec<Vehicle>, Error> {
    CASES.into_iter().map(vehicle).collect()
}

fn vehicle((name, path): (&'static str, &str)) -> Result<Vehicle, Error> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut case = read_case(&root.join(path)).map_err(SimulateError::from)?;
    case.rate_hz = case.rate_hz.min(RATE_HZ);
    let truth = read_model(&case.model)?;
    let mut model = truth.clone().with_usual_uncertainty(Origin::Cad);
    for body in model.bodies.iter_mut().filter(|b| b.estimate.any()) {
        if body.estimate.inertia {
            body.nominal.I_BBcm_B *= 0.93;
        }
        if body.estimate.mass {
            body.nominal.mass *= 1.05;
        }
        if body.estimate.com {
            body.nominal.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
        }
    }
    let study = Study::of_case(&case, &truth, model)?;
    Ok(Vehicle { name, study })
}
