//! Converts `estimate.json` to a vehicle for simulation.

use super::Mover;
use crate::error::{Error, cannot_simulate};
use poinsot_dynamics::Tree;
use poinsot_dynamics::propagation::ModeNumber;
use poinsot_files::Place;
use poinsot_formats::{
    Address, BarycentricFile, EstimateFile, NumberFile, address, all_known, unknown_name,
};
use poinsot_identify::{CompletedVehicle, Completion, DeterminedCombination, complete};
use poinsot_model::{FlexibleMode, Mode, ModeEstimate, Model, SpringNumber};
use poinsot_spatial::InertialParameters;
use std::path::{Path, PathBuf};

/// Relative tolerance between nominal numbers of model and estimate.
const SAME: f64 = 1.0e-9;

/// An estimated vehicle, with the completion of undetermined numbers.
#[derive(Debug, Clone)]
pub struct EstimatedVehicle {
    /// The vehicle.
    pub mover: Mover,
    /// Completion of undetermined numbers; `None` if all are determined.
    pub completion: Option<Completion>,
}

/// Reads `estimate.json` (or its folder) to simulate its vehicle; also its path.
///
/// # Errors
/// The file cannot be read, or is no estimate.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-vehicle-{}", std::process::id()));
/// write_estimate(&out, &identified)?;
/// let (path, read) = validate::read_estimate(&out)?;
/// let vehicle = validate::of_estimate(&read, &model, &path)?;
/// // Every number is determined: nothing was completed.
/// assert!(read.covariance_trustworthy && vehicle.completion.is_none());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_estimate(path: &Path) -> Result<(PathBuf, EstimateFile), Error> {
    // A file that is no estimate is a fault of the comparison (E0701), not of a report.
    poinsot_formats::read_estimate(path).map_err(|mut faults| {
        for fault in faults.list.iter_mut().filter(|f| f.code == "E0601") {
            let (report, simulated) = (
                "no report or export can be made of this",
                "this estimate cannot be simulated",
            );
            fault.code = "E0701";
            fault.problem = fault.problem.replacen(report, simulated, 1);
        }
        faults
    })
}

/// The vehicle of an estimate; `model` is the model of the identification, and errors name the estimate `path`.
///
/// # Errors
/// The estimate belongs to another model, or has no determined numbers.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// let vehicle = validate::of_estimate(&estimate_file(&identified), &model, "estimate.json".as_ref())?;
/// assert!((vehicle.mover.bodies[0].I_BBo_B[(2, 2)] - 2.5).abs() < 1.0e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn of_estimate(
    read: &EstimateFile,
    model: &Model,
    path: &Path,
) -> Result<EstimatedVehicle, Error> {
    if read.is_withheld() {
        let status = &read.status;
        let problem = format!("its status is {status}: it has no numbers to predict with");
        let advice = "give an estimate with status converged or partial";
        return Err(cannot_simulate(path, problem, advice));
    }
    same_model(read, model, path)?;
    let model = &with_modes(model, read);
    let (vehicle, completion) = match whole(read, model) {
        Some(vehicle) => (vehicle, None),
        None => completed(read, model, path)?,
    };
    Ok(EstimatedVehicle {
        mover: Mover::of_estimate(model, &vehicle),
        completion,
    })
}

/// The model with the modes and springs of an estimate, also modes that it found, as known.
fn with_modes(model: &Model, read: &EstimateFile) -> Model {
    let mut model = model.clone();
    let names = read.nuisance.keys().map(|key| Address::parse(key));
    for found in names.filter(|a| a.quantity() == "frequency_Hz") {
        if !model.modes.iter().any(|m| m.name == found.owner()) {
            model.modes.push(FlexibleMode {
                name: found.owner().to_owned(),
                mode: Mode::default(),
                estimate: ModeEstimate::default(),
            });
        }
    }
    for own in &mut model.modes {
        own.estimate = ModeEstimate::default();
        for number in ModeNumber::groups().into_iter().flatten() {
            if let Some(found) = nuisance(read, &own.name, number.name(), number.unit()) {
                own.mode.set(*number, found);
            }
        }
    }
    for joint in &mut model.joints {
        let slides = joint.slides();
        let Some(spring) = &mut joint.spring_damper else {
            continue;
        };
        joint.spring_unknown.clear();
        for number in SpringNumber::ALL {
            if let Some(found) = nuisance(read, &joint.name, number.name(), number.unit(slides)) {
                *number.of(spring) = found;
            }
        }
    }
    model
}

/// The value of a number of a part, if the estimate has one.
fn nuisance(read: &EstimateFile, part: &str, number: &str, unit: &str) -> Option<f64> {
    let number = address(&format!("{part}.{number}"), unit);
    read.nuisance.get(&number)?.value
}

/// Checks that bodies and nominal numbers are those of the model.
fn same_model(read: &EstimateFile, model: &Model, file: &Path) -> Result<(), Error> {
    let refuse = |problem: String| {
        let advice = "give the model that the estimate was made with (--model)";
        Err(cannot_simulate(file, problem, advice))
    };
    let (found, own) = (read.bodies.len(), model.bodies.len());
    if found != own {
        return refuse(format!("it has {found} bodies, the model {own}"));
    }
    for body in &model.bodies {
        let name = &body.name;
        let Some(found) = read.bodies.get(name) else {
            return refuse(format!("it has no body \"{name}\""));
        };
        let own = body.nominal.parameters().to_array();
        // Every number in the file has a nominal value.
        let theirs = ten(&found.barycentric, |n| Some(n.nominal));
        let theirs = theirs.map_or([f64::NAN; 10], |p| p.to_array());
        let scale = own.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut pairs = own.iter().zip(&theirs);
        if pairs.any(|(a, b)| (a - b).abs() > SAME * scale) {
            return refuse(format!(
                "its nominal numbers of body \"{name}\" are not those of the model"
            ));
        }
    }
    Ok(())
}

/// The vehicle, if the estimate determines every number of every body.
fn whole(read: &EstimateFile, model: &Model) -> Option<CompletedVehicle> {
    let bodies = model.bodies.iter();
    let bodies = bodies.map(|b| ten(&read.bodies.get(&b.name)?.barycentric, |n| n.value));
    let wheels = model.wheels.iter().enumerate().filter(|(_, w)| w.estimate);
    let spin_inertia = wheels.map(|(k, w)| Some((k, nuisance(read, &w.name, "spin_inertia", "")?)));
    let thrusters = model.thrusters.iter().enumerate();
    let thrusters = thrusters.filter(|(_, t)| t.scale != poinsot_model::Nuisance::Known);
    let thrust_factor =
        thrusters.map(|(k, t)| Some((k, 1.0 + nuisance(read, &t.name, "scale", "")?)));
    Some(CompletedVehicle {
        bodies: bodies.collect::<Option<Vec<_>>>()?,
        spin_inertia: spin_inertia.collect::<Option<Vec<_>>>()?,
        thrust_factor: thrust_factor.collect::<Option<Vec<_>>>()?,
    })
}

fn completed(
    read: &EstimateFile,
    model: &Model,
    file: &Path,
) -> Result<(CompletedVehicle, Option<Completion>), Error> {
    let combinations = read.identifiability.identifiable.iter().map(|c| {
        let coefficients = c.coefficients.iter();
        Some(DeterminedCombination {
            text: String::new(),
            coefficients: coefficients
                .map(|(name, x)| (unknown_name(name), *x))
                .collect(),
            unit: "",
            value: c.value?,
            sigma: 0.0,
        })
    });
    let determined: Option<Vec<DeterminedCombination>> = combinations.collect();
    let determined = determined.ok_or_else(|| {
        let problem = "some of its combinations are withheld, so it cannot predict";
        cannot_simulate(file, problem, "give an estimate from more data")
    })?;
    let rank = read.identifiability.rank;
    let completion = complete(model, &Tree::new(model), &determined, rank);
    let completion = completion.map_err(|mut faults| {
        let list = faults.list.iter_mut();
        list.for_each(|f| f.place = Place::file(file));
        faults
    })?;
    Ok((completion.vehicle(), Some(completion)))
}

fn ten(b: &BarycentricFile, of: impl Fn(&NumberFile) -> Option<f64>) -> Option<InertialParameters> {
    all_known(b.map(of)).map(|numbers| InertialParameters::from_array(&numbers))
}
