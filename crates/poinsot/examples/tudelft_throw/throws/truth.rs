//! Weighed masses, and inertia from geometry: `truth.json`.

use super::Fault;
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

pub fn read_truth(folder: &Path) -> Result<Truth, Fault> {
    let file: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json"))?)?;
    let objects = file["objects"].as_object();
    let objects = objects.ok_or("truth.json: objects are missing")?;
    let mut objects: Vec<Known> = objects
        .iter()
        .map(|(name, value)| known(name, value))
        .collect::<Result<_, _>>()?;
    objects.sort_by(|a, b| a.mass.total_cmp(&b.mass));
    Ok(Truth {
        box_mass: number(&file["device_mass_kg"])?,
        proof_body: known("proof_body", &file["proof_body"])?,
        objects,
    })
}

fn known(name: &str, value: &Value) -> Result<Known, Fault> {
    let mut I_cm = Matrix3::zeros();
    for i in 0..3 {
        for j in 0..3 {
            I_cm[(i, j)] = number(&value["I_com_kgm2"][i][j])?;
        }
    }
    Ok(Known {
        name: name.to_owned(),
        mass: number(&value["mass_kg"])?,
        I_cm,
    })
}

fn number(value: &Value) -> Result<f64, Fault> {
    value
        .as_f64()
        .ok_or_else(|| format!("truth.json: a number is missing: {value}").into())
}
