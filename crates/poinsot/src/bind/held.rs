//! Joints, wheels and thrusters without a column: the model says that they stand still, or the record is refused.

use super::channels::{Channels, JointColumns};
use super::driven_wheels::speed_column;
use poinsot_files::{Fault, Faults, Place};
use poinsot_model::JointKind;
use poinsot_telemetry::{Channel, noise_level};

/// Likeness of two names from which one is told beside the other.
const ALIKE: f64 = 0.85;
/// Most unused columns that are told.
const TOLD: usize = 8;
/// Size of a rate, in its own noise, above which a joint moves.
const MOVES: f64 = 6.0;
/// Words in the name of a column that holds no position, and of one that holds no speed either.
const OF_RATES: [&str; 7] = ["vel", "rate", "speed", "rpm", "dot", "_s", "omega"];
const OF_EFFORTS: [&str; 5] = ["torque", "effort", "current", "volt", "temp"];

/// Every joint, wheel and thruster without a column, with what the model says of it.
///
/// # Errors
/// The model does not say what one of them does, or a rate contradicts it.
pub(super) fn held(channels: &Channels, repairs: &mut Vec<String>) -> Result<(), Faults> {
    let model = channels.model;
    let mut faults = Vec::new();
    let mut one = |said: Result<Option<String>, Faults>| match said {
        Ok(words) => {
            let words = words.into_iter();
            repairs.extend(words.map(|w| format!("{}: {w}", channels.label)));
        }
        Err(missing) => faults.extend(missing.list),
    };
    let joints = channels.joints();
    joints.for_each(|columns| one(joint(channels, &columns)));
    for (wheel, speed) in model.wheels.iter().zip(channels.tachometers()) {
        let name = speed_column(&wheel.name);
        let still = wheel.at_rest.then_some("at rest (at_rest)");
        let declare = "at_rest = true where it stands still";
        let of = (wheel.name.as_str(), name.as_str(), &OF_EFFORTS[..]);
        one(unless_read(
            speed.is_some(),
            channels,
            of,
            still.ok_or(declare),
        ));
    }
    for thruster in &model.thrusters {
        let name = format!("{}_N", thruster.name);
        let still = thruster.never_fires.then_some("off (never_fires)");
        let declare = "never_fires = true where it is off";
        let of = (thruster.name.as_str(), name.as_str(), &[][..]);
        let read = channels.find(None, &name).is_some();
        one(unless_read(read, channels, of, still.ok_or(declare)));
    }
    Faults::none_or(faults, ())
}

/// What is said of a wheel or thruster without a channel: what the model declares, or what would declare it.
fn unless_read(
    is_read: bool,
    channels: &Channels,
    of: (&str, &str, &[&str]),
    declared: Result<&str, &str>,
) -> Result<Option<String>, Faults> {
    let (subject, name, _) = of;
    match declared {
        _ if is_read => Ok(None),
        Ok(still) => Ok(Some(format!(
            "no channel '{name}': assumed: {subject} {still}"
        ))),
        Err(declare) => Err(nothing_says(channels, of, declare).into()),
    }
}

fn joint(channels: &Channels, columns: &JointColumns) -> Result<Option<String>, Faults> {
    let joint = &channels.model.joints[columns.at];
    let (name, rate_name) = (&columns.position_name, &columns.rate_name);
    if columns.position.is_some() {
        return Ok(None);
    }
    let no_position: Vec<&str> = OF_RATES.iter().chain(&OF_EFFORTS).copied().collect();
    let advice = match joint.kind {
        JointKind::Prismatic => "locked_at_m where it is locked",
        _ => "locked_at_rad where it is locked",
    };
    let of = (joint.name.as_str(), name.as_str(), &no_position[..]);
    let mut fault = nothing_says(channels, of, advice);
    let moves = columns.rate.is_some_and(moves);
    match (joint.declared_at(), moves) {
        (Some((position, key)), false) => Ok(Some(format!(
            "no channel '{name}': assumed: {} locked at {position} ({key})",
            joint.name
        ))),
        (_, true) => {
            fault.problem =
                format!("no channel '{name}', but '{rate_name}' says that the joint moves");
            Err(fault.into())
        }
        (None, false) => Err(fault.into()),
    }
}

/// Whether a rate is above its own noise.
fn moves(rate: &Channel) -> bool {
    let noise = noise_level(rate).map_or(0.0, |level| level.sigma);
    rate.values.iter().any(|x| x.abs() > MOVES * noise)
}

/// E0301 of a joint, wheel or thruster, of which `name` is the missing channel; `other` words are in no column of it.
fn nothing_says(
    channels: &Channels,
    (subject, name, other): (&str, &str, &[&str]),
    declare: &str,
) -> Fault {
    let unused = &channels.table.ignored;
    let plain = |text: &str| text.to_lowercase();
    let likeness = |column: &str| {
        let column = plain(column);
        let own = column.contains(&plain(subject));
        let alike = strsim::jaro_winkler(&column, &plain(name));
        let rest = column.replace(&plain(subject), "");
        let fits = !other.iter().any(|word| rest.contains(word));
        (fits && (own || alike > ALIKE)).then(|| alike + f64::from(u8::from(own)))
    };
    let near = unused.iter().filter_map(|c| Some((likeness(c)?, c)));
    let unit = poinsot_telemetry::classify(name).map_or("", |c| c.dimension.si());
    let map = match near.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, column)) => format!(
            "map the unused column '{column}' by [telemetry.columns] {name} = {{ column = \"{column}\", unit = \"{unit}\" }}, with its own unit"
        ),
        None if unused.is_empty() => "add the column".to_owned(),
        None => {
            let told: Vec<&str> = unused.iter().take(TOLD).map(String::as_str).collect();
            format!("add or map its column (unused: {})", told.join(", "))
        }
    };
    let problem = format!("no channel '{name}', and the model does not say what {subject} does");
    let advice = format!("{map}; or write {declare}");
    Fault::new("E0301", Place::label(channels.label), problem, advice)
}
