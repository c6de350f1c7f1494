//! Fills the report data in addition to `estimate.json`: curves, vehicle geometry, truth, command line.

use super::placed::placed;
use crate::identify::Identified;
use crate::simulate::true_mass;
use indexmap::IndexMap;
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_formats::{
    REPORT_DATA, ReportData, Segment, TrueBodyFile, TrueNumbers, TruthFile, Vehicle, read_truth,
};
use poinsot_identify::{BodyEstimate, Prediction};
use poinsot_spatial::MassProperties;
use poinsot_telemetry::Source;
use std::path::Path;

/// Largest number of firings kept per segment.
const FIRINGS: usize = 2000;

/// Report data of a result, in addition to `estimate.json`.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// let data = report::report_data(&identified, &["poinsot".to_owned()]);
/// assert_eq!((data.vehicle.bodies.len(), data.segments.len()), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn report_data(identified: &Identified, command: &[String]) -> ReportData {
    let found = true_file(identified);
    let truth_note = match &found {
        Err(why) => format!("truth.json beside the telemetry is not used: {why}"),
        Ok(Some(file)) if file.files.is_empty() => {
            "Unchecked: truth.json does not name its telemetry".to_owned()
        }
        Ok(_) => String::new(),
    };
    let truth = found.ok().flatten();
    ReportData {
        schema: REPORT_DATA.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        command: command.to_vec(),
        files: IndexMap::new(),
        inputs: identified
            .inputs
            .iter()
            .flatten()
            .map(|f| f.sha256.clone())
            .collect(),
        vehicle: vehicle(identified),
        segments: identified
            .predictions
            .iter()
            .cloned()
            .map(segment)
            .collect(),
        costs: identified.estimate.costs.clone(),
        truth: truth.map(|file| true_numbers(identified, file)),
        truth_note,
    }
}

/// A `truth.json` of a simulation next to the first telemetry file.
///
/// # Errors
/// It is damaged, or that of other telemetry.
fn true_file(identified: &Identified) -> Result<Option<TruthFile>, String> {
    let first = identified.inputs.first().and_then(|files| files.first());
    let beside = |first: &Source| Some(Path::new(&first.path).parent()?.join("truth.json"));
    let Some(path) = first.and_then(beside).filter(|path| path.is_file()) else {
        return Ok(None);
    };
    let file = read_truth(&path).map_err(|e| e.to_string())?;
    let mut inputs = identified.inputs.iter().flatten();
    match file.files.first() {
        Some((name, sum)) if !inputs.any(|input| input.sha256 == *sum) => {
            Err(format!("it is that of another {name}"))
        }
        _ => Ok(Some(file)),
    }
}

fn true_numbers(identified: &Identified, file: TruthFile) -> TrueNumbers {
    let given = file.system.into_iter().next();
    TrueNumbers {
        system: given.or_else(|| true_system(identified, &file.bodies)),
        bodies: file.bodies,
    }
}

/// The composite of the true bodies at the estimated joint positions; `None` if a true body is unknown.
fn true_system(
    identified: &Identified,
    bodies: &IndexMap<String, TrueBodyFile>,
) -> Option<TrueBodyFile> {
    let (_, position) = identified.estimate.system.as_ref()?;
    let tree = Tree::new(&identified.model);
    if position.len() != tree.dof() {
        return None;
    }
    let kinematics = Kinematics::at(&tree, position);
    let model = identified.model.bodies.iter();
    let parameters = model.map(|b| {
        let numbers = bodies.get(&b.name)?.mass.map(|n| n.value);
        Some(MassProperties::from_array(&numbers).parameters())
    });
    let whole = composite(&parameters.collect::<Option<Vec<_>>>()?, &kinematics);
    let whole = whole.mass_properties()?;
    Some(TrueBodyFile::of(true_mass(&whole)))
}

fn vehicle(identified: &Identified) -> Vehicle {
    let model = &identified.model;
    let tree = Tree::new(model);
    let mut kinematics = Kinematics::new(&tree);
    let predicted = identified.predictions.first().map(|p| {
        let first = p
            .joints
            .iter()
            .filter_map(|row| row.values.first().copied());
        first.collect::<Vec<f64>>()
    });
    let estimated = identified.estimate.system.as_ref();
    let position = estimated.map(|(_, q)| q.clone()).or(predicted);
    if let Some(q) = position.filter(|q| q.len() == tree.dof()) {
        kinematics.place(&tree, &q);
    }
    let bodies = identified.estimate.bodies.iter();
    placed(model, &kinematics, bodies.map(|b| (best(b), b.asked)))
}

/// Estimates, and nominal numbers where there are none.
fn best(b: &BodyEstimate) -> MassProperties {
    MassProperties::from_array(&b.numbers().map(|n| n.value.unwrap_or(n.nominal)))
}

/// A prediction with as many digits as its curves show.
fn segment(mut p: Prediction) -> Segment {
    p.channels.retain(|c| c.samples > 0);
    for c in p.channels.iter_mut().chain([&mut p.momentum]) {
        times(&mut c.time_s);
        let curves = [&mut c.measured, &mut c.predicted, &mut c.residual];
        let rows = curves.into_iter().chain([&mut c.autocorrelation]);
        rounded(rows.flatten().flatten());
    }
    times(&mut p.time_s);
    rounded(p.omega_rad_s.iter_mut().flatten());
    rounded(p.q_xyzw.iter_mut().flatten());
    let rows = p.joints.iter_mut().chain(&mut p.wheels).chain(&mut p.modes);
    rounded(rows.flat_map(|row| &mut row.values));
    p.firings.truncate(FIRINGS);
    p
}

/// Times rounded to the nanosecond, which still separates samples.
fn times(row: &mut [f64]) {
    for t in row {
        *t = format!("{t:.9}").parse().unwrap_or(*t);
    }
}

/// Rounds to nine digits: enough for a plot, at a third of the bytes.
fn rounded<'a>(all: impl Iterator<Item = &'a mut f64>) {
    for x in all {
        *x = format!("{x:.8e}").parse().unwrap_or(*x);
    }
}
