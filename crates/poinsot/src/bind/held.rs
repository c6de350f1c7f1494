//! Joints, wheels and thrusters without a column: the model says that they stand still, or the record is refused.

use super::channels::Channels;
use super::driven_wheels::speed_column;
use super::file_label;
use crate::channel_names::{joint_channels, joint_unit};
use poinsot_files::{Fault, Faults, Place};
use poinsot_model::{Joint, Model};
use poinsot_telemetry::{Channel, Table, classify, noise_level};

/// Likeness of two names from which one is told beside the other.
const ALIKE: f64 = 0.85;
/// Most unused columns that are told.
const TOLD: usize = 8;
/// Size of a rate, in its own noise, above which a joint moves.
const MOVES: f64 = 6.0;
/// Words in the name of a column that holds no position, and of one that holds no speed either.
const OF_RATES: [&str; 7] = ["vel", "rate", "speed", "rpm", "dot", "_s", "omega"];
const OF_EFFORTS: [&str; 5] = ["torque", "effort", "current", "volt", "temp"];

/// A joint, wheel or thruster without a channel.
pub(crate) struct Silent<'a> {
    pub subject: &'a str,
    pub channel: String,
    /// What the model says of it.
    pub said: Option<String>,
    /// What would say it.
    declare: String,
    /// Words that are in no column of it.
    other: Vec<&'static str>,
    /// The rate that says that it moves.
    moves: Option<String>,
}

/// Every joint, wheel and thruster without a column, with what the model says of it.
///
/// # Errors
/// The model does not say what one of them does, or a rate contradicts it.
pub(super) fn held(channels: &Channels, repairs: &mut Vec<String>) -> Result<(), Faults> {
    let mut faults = Vec::new();
    let (model, joints) = (channels.model, &channels.tree.coordinates);
    for part in silent(model, channels.table, joints, true) {
        match (&part.said, &part.moves) {
            (Some(said), None) => repairs.push(format!(
                "{}: no channel '{}': assumed: {} {said}",
                channels.label, part.channel, part.subject
            )),
            _ => faults.push(part.fault(channels.table)),
        }
    }
    Faults::none_or(faults, ())
}

/// Those of some joints, and of all wheels and thrusters, that have no column; `springs`: whether springs may move joints.
pub(crate) fn silent<'a>(
    model: &'a Model,
    table: &'a Table,
    joints: &'a [usize],
    springs: bool,
) -> impl Iterator<Item = Silent<'a>> {
    let joints = joints.iter().map(|at| &model.joints[*at]);
    let joints = joints.map(move |joint| of_joint(joint, table, springs));
    let wheels = model.wheels.iter().map(|wheel| Silent {
        subject: &wheel.name,
        channel: speed_column(&wheel.name),
        said: wheel.at_rest.then(|| "at rest (at_rest)".to_owned()),
        declare: "at_rest = true where it stands still".to_owned(),
        other: OF_EFFORTS.to_vec(),
        moves: None,
    });
    let thrusters = model.thrusters.iter().map(|thruster| Silent {
        subject: &thruster.name,
        channel: format!("{}_N", thruster.name),
        said: (thruster.never_fires).then(|| "off (never_fires)".to_owned()),
        declare: "never_fires = true where it is off".to_owned(),
        other: Vec::new(),
        moves: None,
    });
    let all = joints.chain(wheels).chain(thrusters);
    all.filter(|own| table.sensor_channel("", &own.channel).is_none())
}

fn of_joint<'a>(joint: &'a Joint, table: &Table, springs: bool) -> Silent<'a> {
    let [position, rate, ..] = joint_channels(joint);
    let key = format!("locked_at_{}", joint_unit(joint));
    let said = match joint.locked_at {
        Some(at) => Some(format!("locked at {at} ({key})")),
        None => joint
            .is_passive()
            .then(|| "moved by its spring (spring_damper)".to_owned()),
    };
    let moving = table.sensor_channel("", &rate).is_some_and(moves);
    let spring = match springs {
        true => ", spring_damper where a spring moves it",
        false => "",
    };
    Silent {
        subject: &joint.name,
        channel: position,
        said,
        declare: format!("{key} where it is locked{spring}"),
        other: [&OF_RATES[..], &OF_EFFORTS].concat(),
        moves: moving.then_some(rate),
    }
}

/// Whether a rate is above its own noise.
fn moves(rate: &Channel) -> bool {
    let noise = noise_level(rate).map_or(0.0, |level| level.sigma);
    rate.values.iter().any(|x| x.abs() > MOVES * noise)
}

impl Silent<'_> {
    /// E0301, with the unused column that is most like it.
    pub fn fault(&self, table: &Table) -> Fault {
        let (subject, name) = (self.subject, self.channel.as_str());
        let unused = &table.ignored;
        let [plain_subject, plain_name] = [subject, name].map(str::to_lowercase);
        let likeness = |column: &str| {
            let column = column.to_lowercase();
            let own = column.contains(&plain_subject);
            let alike = strsim::jaro_winkler(&column, &plain_name);
            let rest = column.replace(&plain_subject, "");
            let fits = !self.other.iter().any(|word| rest.contains(word));
            (fits && (own || alike > ALIKE)).then(|| alike + f64::from(u8::from(own)))
        };
        let near = unused.iter().filter_map(|c| Some((likeness(c)?, c)));
        let map = match near.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, column)) => format!(
                "map the unused column '{column}' by [telemetry.columns] {}, with its own unit",
                line(name, column)
            ),
            None => to_map(name, unused),
        };
        // What the files say of a channel that they could have had.
        let names = |said: &&String| said.split([' ', ',', ':', ';', '\'']).any(|w| w == name);
        let said = table.repairs.iter().find(names);
        let said = said.map_or(String::new(), |said| format!(" ({said})"));
        let problem = match &self.moves {
            Some(rate) => format!("no channel '{name}', but '{rate}' says that the joint moves"),
            None => {
                format!("no channel '{name}', and the model does not say what {subject} does{said}")
            }
        };
        let advice = format!("{map}; or write {}", self.declare);
        Fault::new("E0301", Place::label(&file_label(table)), problem, advice)
    }
}

/// The lines of a map for channels without a column, whose names have blanks between them. No component of another vector is meant.
pub(crate) fn to_map(names: &str, unused: &[String]) -> String {
    let other = |column: &&str| classify(column).is_some_and(|of| of.vector().is_some());
    let told = unused.iter().map(String::as_str).filter(|c| !other(c));
    let told: Vec<&str> = told.take(TOLD).collect();
    let column = match told[..] {
        [] => return "add the column".to_owned(),
        [only] if !names.contains(' ') => only,
        _ => "...",
    };
    let lines: Vec<String> = names.split(' ').map(|name| line(name, column)).collect();
    let (lines, told) = (lines.join(", "), told.join(", "));
    format!("map it by [telemetry.columns] {lines}, with its own unit (unused: {told})")
}

/// The line of a map, with the unit of SI.
fn line(name: &str, column: &str) -> String {
    let unit = classify(name).map_or("", |c| c.dimension.si());
    format!("{name} = {{ column = \"{column}\", unit = \"{unit}\" }}")
}
