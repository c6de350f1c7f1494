//! Weighed masses, and inertia from geometry: `truth.json`.

use nalgebra::Matrix3;
use serde_json::Value;
use std::path::Path;

/// A body with known mass and inertia.
#[derive(Debug, Clone)]
pub struct Known {
    /// Name, equal to its group of throws.
    pub name: String,
    /// Mass, kg.
    pub mass: f64,
    /// Inertia about its mass centre in its own axes, kg m2.
    pub I_cm: Matrix3<f64>,
}

/// The file.
pub struct Truth {
    /// Mass of the measuring box, kg.
    pub box_mass: f64,
    /// The homogeneous block that sets the scale.
    pub proof_body: Known,
    /// The objects to be identified, lightest first.
    pub objects: Vec<Known>,
}

pub fn read_truth(folder: &Path) -> Truth {
    let text = std::fs::read_to_string(folder.join("truth.json")).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    let objects = file["objects"].as_object().unwrap();
    let mut objects: Vec<Known> = objects
        .iter()
        .map(|(name, value)| known(name, value))
        .collect();
    objects.sort_by(|a, b| a.mass.total_cmp(&b.mass));
    Truth {
        box_mass: file["device_mass_kg"].as_f64().unwrap(),
        proof_body: known("proof_body", &file["proof_body"]),
        objects,
    }
}

fn known(name: &str, value: &Value) -> Known {
    Known {
        name: name.to_owned(),
        mass: value["mass_kg"].as_f64().unwrap(),
        I_cm: Matrix3::from_fn(|i, j| value["I_com_kgm2"][i][j].as_f64().unwrap()),
    }
}
