//! From `estimate.json` to a vehicle that can be moved.

use super::{Mover, ValidateError};
use crate::error::Error;
use crate::report::LARGEST_RESULT;
use poinsot_dynamics::Tree;
use poinsot_files::{InputError, read_text};
use poinsot_identify::{CompletedVehicle, Completion, DeterminedCombination, Estimate, complete};
use poinsot_model::Model;
use poinsot_spatial::InertialParameters;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Largest relative difference between a nominal number of the model and of the estimate.
const SAME: f64 = 1.0e-9;

/// An estimate as a vehicle, with how it was made whole where it leaves numbers open.
#[derive(Debug, Clone)]
pub struct EstimatedVehicle {
    /// The vehicle.
    pub mover: Mover,
    /// How open numbers were completed; `None` where the estimate gives every number.
    pub completion: Option<Completion>,
    /// Status of the estimate.
    pub status: String,
    /// Whether its covariance is trustworthy.
    pub trustworthy: bool,
}

/// What is read of an estimate.
#[derive(Debug, Deserialize)]
struct EstimateFile {
    schema: String,
    status: String,
    covariance_trustworthy: bool,
    bodies: BTreeMap<String, Body>,
    nuisance: BTreeMap<String, Scalar>,
    identifiability: Identifiability,
}

#[derive(Debug, Deserialize)]
struct Body {
    barycentric: Barycentric,
}

#[derive(Debug, Deserialize)]
#[allow(non_snake_case)]
struct Barycentric {
    m_kg: Scalar,
    mc_kg_m: Triple,
    I_BBo_kg_m2: Tensor,
}

#[derive(Debug, Deserialize)]
struct Scalar {
    value: Option<f64>,
    nominal: f64,
}

#[derive(Debug, Deserialize)]
struct Triple {
    value: [Option<f64>; 3],
    nominal: [f64; 3],
}

#[derive(Debug, Deserialize)]
struct Tensor {
    value: Elements<Option<f64>>,
    nominal: Elements<f64>,
}

/// In the order of the ten parameters.
#[derive(Debug, Deserialize)]
struct Elements<T> {
    xx: T,
    xy: T,
    yy: T,
    xz: T,
    yz: T,
    zz: T,
}

#[derive(Debug, Deserialize)]
struct Identifiability {
    rank: usize,
    identifiable: Vec<Determined>,
}

#[derive(Debug, Deserialize)]
struct Determined {
    coefficients: BTreeMap<String, f64>,
    value: Option<f64>,
}

/// Reads `estimate.json` (or the folder that holds it) as a vehicle of the model that it was made with.
///
/// # Errors
/// It cannot be read, is no estimate of this model, or holds nothing to predict with.
pub fn read_estimate(path: &Path, model: &Model) -> Result<EstimatedVehicle, Error> {
    let file = match path.is_dir() {
        true => path.join("estimate.json"),
        false => path.to_owned(),
    };
    let refuse = |why: String| ValidateError::Estimate {
        path: file.clone(),
        why,
    };
    let text = read_text(&file, LARGEST_RESULT).map_err(|error| match error {
        InputError::System(source) => Error::Io {
            path: file.clone(),
            what: "cannot be read",
            source,
        },
        other => refuse(format!("{other}; give the folder of identify --out")).into(),
    })?;
    let read: EstimateFile = serde_json::from_str(&text)
        .map_err(|e| refuse(format!("{e}; give an estimate.json as identify writes it")))?;
    if read.schema != "poinsot.estimate/1" {
        let why = format!(
            "its schema is \"{}\", not poinsot.estimate/1; give the folder of identify --out",
            read.schema
        );
        return Err(refuse(why).into());
    }
    if read.status == "rejected" || read.status == "iteration_limit" {
        let why = format!(
            "its status is {}: it holds no numbers to predict with; give an estimate that is converged or partial",
            read.status
        );
        return Err(refuse(why).into());
    }
    same_model(&read, model).map_err(refuse)?;
    let vehicle = match whole(&read, model) {
        Some(vehicle) => Ok((vehicle, None)),
        None => completed(&read, model),
    };
    let (vehicle, completion) = vehicle.map_err(refuse)?;
    Ok(EstimatedVehicle {
        mover: Mover::of_estimate(model, &vehicle),
        completion,
        status: read.status,
        trustworthy: read.covariance_trustworthy,
    })
}

/// The same of an estimate in memory.
///
/// # Errors
/// The estimate holds nothing to predict with.
pub fn of_estimate(estimate: &Estimate, model: &Model) -> Result<EstimatedVehicle, Error> {
    let completion = complete(
        model,
        &Tree::new(model),
        &estimate.identifiability.determined,
    );
    let completion = completion.map_err(|e| ValidateError::Estimate {
        path: PathBuf::from("estimate"),
        why: e.to_string(),
    })?;
    Ok(EstimatedVehicle {
        mover: Mover::of_estimate(model, &completion.vehicle()),
        completion: Some(completion),
        status: estimate.status.name().to_owned(),
        trustworthy: estimate.covariance_trustworthy,
    })
}

/// Bodies and nominal numbers must be those of the model.
fn same_model(read: &EstimateFile, model: &Model) -> Result<(), String> {
    if read.bodies.len() != model.bodies.len() {
        return Err(format!(
            "it has {} bodies, the model {}; give the model that the estimate was made with (--model)",
            read.bodies.len(),
            model.bodies.len()
        ));
    }
    for body in &model.bodies {
        let Some(found) = read.bodies.get(&body.name) else {
            return Err(format!(
                "it has no body \"{}\"; give the model that the estimate was made with (--model)",
                body.name
            ));
        };
        let own = body.nominal.parameters().to_array();
        let theirs = found.barycentric.nominal();
        let scale = own.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        if own
            .iter()
            .zip(&theirs)
            .any(|(a, b)| (a - b).abs() > SAME * scale)
        {
            return Err(format!(
                "its nominal numbers of body \"{}\" are not those of the model; give the model that the estimate was made with (--model)",
                body.name
            ));
        }
    }
    Ok(())
}

/// Every number of every body, where the estimate gives them all.
fn whole(read: &EstimateFile, model: &Model) -> Option<CompletedVehicle> {
    let bodies = model.bodies.iter();
    let bodies = bodies.map(|b| read.bodies.get(&b.name)?.barycentric.values());
    let spin = |name: &str| read.nuisance.get(&format!("{name}.spin_inertia_kg_m2"));
    let wheels = model.wheels.iter().enumerate().filter(|(_, w)| w.estimate);
    let spin_inertia = wheels.map(|(k, w)| Some((k, spin(&w.name)?.value?)));
    let scale = |name: &str| read.nuisance.get(&format!("{name}.scale"));
    let thrusters = model.thrusters.iter().enumerate();
    let thrusters = thrusters.filter(|(_, t)| t.scale != poinsot_model::Nuisance::Known);
    let thrust_factor = thrusters.map(|(k, t)| Some((k, 1.0 + scale(&t.name)?.value?)));
    Some(CompletedVehicle {
        bodies: bodies.collect::<Option<Vec<_>>>()?,
        spin_inertia: spin_inertia.collect::<Option<Vec<_>>>()?,
        thrust_factor: thrust_factor.collect::<Option<Vec<_>>>()?,
    })
}

fn completed(
    read: &EstimateFile,
    model: &Model,
) -> Result<(CompletedVehicle, Option<Completion>), String> {
    let combinations = read.identifiability.identifiable.iter();
    let determined: Option<Vec<DeterminedCombination>> = combinations
        .map(|c| {
            Some(DeterminedCombination {
                text: String::new(),
                coefficients: c.coefficients.clone().into_iter().collect(),
                unit: "",
                value: c.value?,
                sigma: 0.0,
            })
        })
        .collect();
    let determined = determined.filter(|d| d.len() == read.identifiability.rank);
    let determined =
        determined.ok_or("it withholds some of its combinations: nothing to predict with; give an estimate of more data")?;
    let completion = complete(model, &Tree::new(model), &determined).map_err(|e| e.to_string())?;
    Ok((completion.vehicle(), Some(completion)))
}

impl Barycentric {
    fn nominal(&self) -> [f64; 10] {
        let ([x, y, z], t) = (self.mc_kg_m.nominal, &self.I_BBo_kg_m2.nominal);
        [
            self.m_kg.nominal,
            x,
            y,
            z,
            t.xx,
            t.xy,
            t.yy,
            t.xz,
            t.yz,
            t.zz,
        ]
    }

    fn values(&self) -> Option<InertialParameters> {
        let ([x, y, z], t) = (self.mc_kg_m.value, &self.I_BBo_kg_m2.value);
        let all = [self.m_kg.value, x, y, z, t.xx, t.xy, t.yy, t.xz, t.yz, t.zz];
        let mut found = [0.0; 10];
        for (own, value) in found.iter_mut().zip(all) {
            *own = value?;
        }
        Some(InertialParameters::from_array(&found))
    }
}
