//! Fills the report data in addition to `estimate.json`: curves, vehicle geometry, truth, command line.

use super::placed::placed;
use crate::channel_names::joint_unit;
use crate::identify::Identified;
use crate::simulate::true_mass;
use indexmap::IndexMap;
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_formats::{
    Channel, MassFile, REPORT_DATA, ReportData, Row, Segment, TrueBodyFile, TrueNumberFile,
    TrueNumbers, Vehicle, read_truth,
};
use poinsot_identify::{BodyEstimate, PredictedChannel, Prediction};
use poinsot_model::JointKind;
use poinsot_spatial::{MassProperties, Matrix3};
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
    ReportData {
        schema: REPORT_DATA.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        command: command.to_vec(),
        estimate: String::new(),
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
            .map(|p| segment(identified, p))
            .collect(),
        truth: truth(identified),
    }
}

/// A `truth.json` of a simulation next to the first telemetry file.
fn truth(identified: &Identified) -> Option<TrueNumbers> {
    let first = Path::new(&identified.inputs.first()?.first()?.path);
    if !first.is_file() {
        return None;
    }
    let file = read_truth(&first.parent()?.join("truth.json")).ok()?;
    let given = file.system.into_iter().next();
    Some(TrueNumbers {
        system: given.or_else(|| true_system(identified, &file.bodies)),
        bodies: file.bodies,
    })
}

/// The composite of the true bodies at the estimated joint positions; `None` if a true body is unknown.
fn true_system(
    identified: &Identified,
    bodies: &IndexMap<String, TrueBodyFile>,
) -> Option<TrueBodyFile> {
    let (_, position) = identified.estimate.system.as_ref()?;
    let tree = Tree::new(&identified.model);
    let mut kinematics = Kinematics::new(&tree);
    if position.len() != tree.dof() {
        return None;
    }
    kinematics.place(&tree, position);
    let model = identified.model.bodies.iter();
    let parameters = model.map(|b| Some(properties(&bodies.get(&b.name)?.mass).parameters()));
    let whole = composite(&parameters.collect::<Option<Vec<_>>>()?, &kinematics);
    (whole.mass > 0.0).then(|| TrueBodyFile::of(true_mass(&whole.mass_properties())))
}

fn properties(truth: &MassFile<TrueNumberFile>) -> MassProperties {
    let rows = truth.inertia_kg_m2.rows(|n| n.value);
    MassProperties {
        mass: truth.mass_kg.value,
        p_BoBcm_B: truth.com_m.map(|n| n.value).into(),
        I_BBcm_B: Matrix3::from_fn(|i, j| rows[i][j]),
    }
}

fn vehicle(identified: &Identified) -> Vehicle {
    let model = &identified.model;
    let tree = Tree::new(model);
    let mut kinematics = Kinematics::new(&tree);
    let predicted = identified.predictions.first().map(|p| {
        let first = p
            .joint_position
            .iter()
            .filter_map(|row| row.first().copied());
        first.collect::<Vec<f64>>()
    });
    let position = match &identified.estimate.system {
        Some((_, position)) => Some(position.clone()),
        None => predicted,
    };
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

fn segment(identified: &Identified, p: &Prediction) -> Segment {
    let model = &identified.model;
    let moving = model.joints.iter().filter(|j| j.kind != JointKind::Fixed);
    Segment {
        label: p.label.clone(),
        channels: p
            .channels
            .iter()
            .filter(|c| c.samples > 0)
            .map(channel)
            .collect(),
        momentum: channel(&p.momentum),
        time_s: times(&p.motion.time_s),
        omega_rad_s: p.motion.w_NB_B.iter().map(|w| w.map(round)).collect(),
        q_xyzw: p.motion.q_NB_xyzw.iter().map(|q| q.map(round)).collect(),
        joints: moving
            .zip(&p.joint_position)
            .map(|(j, values)| Row {
                name: j.name.clone(),
                unit: joint_unit(j).to_owned(),
                values: rounded(values),
            })
            .collect(),
        wheels: model
            .wheels
            .iter()
            .zip(&p.wheel_speed)
            .map(|(w, values)| Row {
                name: w.name.clone(),
                unit: "rad/s".to_owned(),
                values: rounded(values),
            })
            .collect(),
        firings: p
            .firings
            .iter()
            .take(FIRINGS)
            .filter_map(|f| {
                let thruster = model.thrusters.get(f.thruster)?;
                Some((thruster.name.clone(), f.start_s, f.end_s, f.force))
            })
            .collect(),
    }
}

fn channel(c: &PredictedChannel) -> Channel {
    let rows = |all: &[Vec<f64>]| all.iter().map(|row| rounded(row)).collect();
    Channel {
        name: c.name.to_owned(),
        unit: c.unit.to_owned(),
        residual_unit: c.residual_unit.to_owned(),
        components: c.components.iter().map(|s| (*s).to_owned()).collect(),
        samples: c.samples,
        time_s: times(&c.time_s),
        measured: rows(&c.measured),
        predicted: rows(&c.predicted),
        residual: rows(&c.residual),
        histogram: c.histogram.clone(),
        autocorrelation: rows(&c.autocorrelation),
    }
}

/// Times rounded to the nanosecond, which still separates samples.
fn times(row: &[f64]) -> Vec<f64> {
    let nanosecond = |t: &f64| format!("{t:.9}").parse().unwrap_or(*t);
    row.iter().map(nanosecond).collect()
}

fn rounded(row: &[f64]) -> Vec<f64> {
    row.iter().copied().map(round).collect()
}

/// Rounds to nine digits: enough for a plot, at a third of the bytes.
fn round(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}
