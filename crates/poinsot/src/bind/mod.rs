//! Binds a table of channels to a model: names become indices, and samples get one time base.
//!
//! Every assumption and repair is reported; an unknown name is an error.

mod attitude_start;
mod channels;
mod checks;
mod cut;
mod driven_wheels;
mod free_fall;
mod held;
mod input_errors;
mod motion;
mod noise;
mod observe;
mod orbit;
mod sensors;

pub use channels::{mountings, spin_inertias, wanted_channels};
pub(crate) use cut::cut_at;
pub use motion::acceleration_channels;
pub(crate) use {
    held::{silent, to_map},
    noise::scalar,
    sensors::covariance,
};

use crate::channel_names::position;
use crate::error::Error;
use channels::Channels;
use driven_wheels::DrivenWheels;
use noise::declared_noise;
use poinsot_dynamics::Tree;
use poinsot_files::{Place, counted, list};
use poinsot_identify::{Noise, Problem, Samples, Segment};
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::Table;
use sensors::BaseSensors;
use std::collections::HashSet;

/// Default one-sigma accuracy in natural units that counts as identified (docs/reference/interface.md).
pub(crate) const RELATIVE_ACCURACY: f64 = 1.0;

/// The input of an estimator.
pub struct Bound {
    /// Segments in the order given.
    pub segments: Vec<Segment>,
    /// Number of segments of each table.
    pub pieces: Vec<usize>,
    /// Declared noise.
    pub noise: Noise,
    /// Assumptions and repairs.
    pub repairs: Vec<String>,
    /// Largest fraction of samples dropped from a segment.
    pub dropped: f64,
    /// The model without the springs of joints that are measured, where there are any.
    own: Option<Model>,
}

impl Bound {
    /// The problem of these data for the model and tree to which they were bound, with the default accuracy.
    pub fn problem<'a>(&'a self, model: &'a Model, tree: &'a Tree) -> Problem<'a> {
        Problem {
            model: self.own.as_ref().unwrap_or(model),
            tree,
            segments: &self.segments,
            noise: &self.noise,
            relative_accuracy: RELATIVE_ACCURACY,
            pace: None,
        }
    }
}

/// The model without the springs of joints that a column measures, where there are any.
fn without_springs(model: &Model, tables: &[Table], told: &mut Vec<String>) -> Option<Model> {
    let mut own = None;
    let joints = model.joints.iter().enumerate();
    for (k, joint) in joints.filter(|(_, j)| j.is_passive()) {
        let position = position(joint);
        if tables.iter().any(|t| t.channel(&position).is_some()) {
            let joint = &mut own.get_or_insert_with(|| model.clone()).joints[k];
            joint.spring_damper = None;
            joint.spring_unknown.clear();
            told.push(format!(
                "assumed: {} moves as '{position}' says, and its spring_damper has no effect",
                joint.name
            ));
        }
    }
    own
}

/// Unknown bodies whose nominal tensor is not physical.
fn not_physical(model: &Model) -> Vec<String> {
    let bodies = model.bodies.iter();
    let told = bodies.filter_map(|b| {
        let given = b.given?;
        let moments = list(&given.principal().0);
        Some(format!(
            "assumed: the nominal tensor of {} is not physical (principal moments {moments} kg m2); the fit starts from the nearest one that is",
            b.name
        ))
    });
    told.collect()
}

/// Binds the tables of all segments to the model.
///
/// # Errors
/// A required channel or noise is missing.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// let table = simulate::simulate_case(&case, &model)?.table;
/// let tree = poinsot_dynamics::Tree::new(&model);
/// let bound = bind::bind(&model, &tree, &[table])?;
/// // One segment without gaps: 10 s at 5 Hz.
/// assert_eq!((bound.segments.len(), bound.segments[0].samples.time_s.len()), (1, 51));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn bind(model: &Model, tree: &Tree, tables: &[Table]) -> Result<Bound, Error> {
    let mut repairs = not_physical(model);
    let own = without_springs(model, tables, &mut repairs);
    let model = own.as_ref().unwrap_or(model);
    let tables = free_fall::relative(model, tables, &mut repairs)?;
    let tables = tables.as_ref();
    let leading = BaseSensors::new(model, tables);
    checks::check_sensors(&leading, tables, &mut repairs)?;
    let of_wheel = |k| scalar(model, SensorKind::WheelSpeed, k);
    let tachometers: Vec<f64> = (0..model.wheels.len()).map(of_wheel).collect();
    let driven = DrivenWheels::new(model, tables, &tachometers);
    repairs.extend(driven.told(model));
    let mut segments = Vec::with_capacity(tables.len());
    let mut pieces = Vec::with_capacity(tables.len());
    let mut dropped: f64 = 0.0;
    for table in tables {
        let label = file_label(table);
        let channels = Channels {
            model,
            tree,
            table,
            label: &label,
            leading: &leading,
            driven: &driven,
        };
        let (own, lost) = bind_table(&channels, &mut repairs)?;
        dropped = dropped.max(lost);
        pieces.push(own.len());
        segments.extend(own);
    }
    let mut noise = declared_noise(tree, tables, &leading, &mut repairs)?;
    for (wheel, variance) in noise.wheel_speed.iter_mut().enumerate() {
        *variance += driven.added(wheel, *variance);
    }
    let mut told = HashSet::new();
    repairs.retain(|text| told.insert(text.clone()));
    Ok(Bound {
        segments,
        pieces,
        noise,
        repairs,
        dropped,
        own,
    })
}

/// Binds measurements to a model and solves their problem.
pub(crate) fn solve<T>(
    model: &Model,
    tables: &[Table],
    relative_accuracy: f64,
    by: impl FnOnce(&Problem) -> Result<T, Error>,
) -> Result<T, Error> {
    let tree = Tree::new(model);
    let bound = bind(model, &tree, tables)?;
    by(&Problem {
        relative_accuracy,
        ..bound.problem(model, &tree)
    })
}

/// Name of a segment in messages: its file names.
pub(crate) fn file_label(table: &Table) -> String {
    let names: Vec<&str> = table.sources.iter().map(|s| s.path.as_str()).collect();
    names.join(",")
}

/// The segments of a table, cut at the gaps of its inputs, and the fraction of samples dropped.
fn bind_table(
    channels: &Channels,
    repairs: &mut Vec<String>,
) -> Result<(Vec<Segment>, f64), Error> {
    let label = channels.label;
    checks::check_plausible(channels)?;
    let rates = channels.base_rates()?;
    checks::needs_attitude(channels)?;
    orbit::check_orbit(channels, repairs)?;
    held::held(channels, repairs)?;
    let whole = rates.time_s();
    let (pieces, gaps) = cut::pieces(channels, whole);
    let mut segments = Vec::with_capacity(pieces.len());
    let (mut kept, mut most) = (0, 0);
    for table in &pieces {
        let own = Channels { table, ..*channels };
        let (segment, found) = bind_piece(&own, repairs)?;
        most = most.max(found);
        if let Some(segment) = segment {
            kept += found;
            segments.push(segment);
        }
    }
    if segments.is_empty() {
        let problem = format!(
            "{} with all required channels at one time, but 2 are required",
            counted(most, "sample")
        );
        let advice = "give a longer record, or files whose times overlap";
        return Err(Error::one("E0303", Place::label(label), problem, advice));
    }
    let lost = whole.len() - kept;
    if lost > 0 {
        repairs.push(format!(
            "{label}: {lost} of {} {} samples left out: another channel has no sample within 3 of its steps",
            whole.len(),
            if rates.are_measured() { "gyro" } else { "attitude" }
        ));
    }
    if !gaps.is_empty() {
        repairs.push(told_gaps(label, &gaps, segments.len()));
    }
    if pieces.len() > 1 {
        for segment in &mut segments {
            let t = &segment.samples.time_s;
            let (from, to) = (t.first().unwrap_or(&0.0), t.last().unwrap_or(&0.0));
            segment.label = format!("{label}, {from:.6} to {to:.6} s");
        }
    }
    Ok((segments, lost as f64 / whole.len() as f64))
}

/// Number of gaps listed individually.
const SHOWN: usize = 3;

fn told_gaps(label: &str, gaps: &[(f64, f64)], pieces: usize) -> String {
    let shown = gaps.iter().take(SHOWN);
    let mut words: Vec<String> = shown.map(|(a, b)| format!("{a:.6} to {b:.6} s")).collect();
    if gaps.len() > SHOWN {
        words.push(format!("{} more", gaps.len() - SHOWN));
    }
    format!(
        "{label}: gaps in the wheel, joint or thruster samples ({}): split into {pieces} segments, each with its own initial state",
        words.join(", ")
    )
}

/// One piece, and the number of its complete gyro samples; no segment with fewer than two.
fn bind_piece(
    channels: &Channels,
    repairs: &mut Vec<String>,
) -> Result<(Option<Segment>, usize), Error> {
    let Ok(rates) = channels.base_rates() else {
        return Ok((None, 0));
    };
    let times = rates.time_s();
    let aligned = motion::align(channels, &rates, repairs)?;
    let complete: Vec<usize> = (0..times.len()).filter(|&k| aligned.complete(k)).collect();
    if complete.len() < 2 {
        return Ok((None, complete.len()));
    }
    let samples: Samples = aligned.take(&complete);
    drop(aligned);
    let firings = observe::firings(channels, &samples);
    let observations = observe::observe(channels, &samples, &firings);
    let accelerations = motion::accelerations(channels, &samples);
    let segment = Segment {
        label: channels.label.to_owned(),
        samples,
        observations,
        firings,
        accelerations,
    };
    Ok((Some(segment), complete.len()))
}
