//! What columns measure, by their names: words of a small vocabulary, component, unit. Never applied without a question or
//! a test where the name leaves a choice.

mod name;
mod words;

use crate::{Dimension, Unit, classify, full_name};
use name::Name;
use serde::Deserialize;
use words::{Rule, Word, vocabulary};

/// Most columns of a header that are looked at: their groups are compared with one another.
const MOST: usize = 4000;

/// Letters and words of flight mechanics, body rates and Euler angles. Alone, each means something else.
const TRIOS: [([&str; 3], [&str; 3]); 2] = [
    (["p", "q", "r"], ["omega_x", "omega_y", "omega_z"]),
    (["phi", "theta", "psi"], ["roll", "pitch", "yaw"]),
];

/// What a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
pub enum Kind {
    /// Time of the row.
    Time,
    /// Component of a quaternion.
    Quaternion,
    /// Euler angle.
    Euler,
    /// Modified Rodrigues parameter.
    Rodrigues,
    /// Angular velocity.
    Rate,
    /// Angular acceleration.
    AngularAcceleration,
    /// Specific force.
    SpecificForce,
    /// Position in inertial axes.
    Position,
    /// Velocity in inertial axes.
    Velocity,
    /// Magnetic field.
    Field,
    /// Direction of the sun.
    Sun,
    /// Speed of a wheel.
    WheelSpeed,
    /// Torque of a wheel's motor.
    WheelTorque,
    /// Angle of a joint.
    JointAngle,
    /// Rate of a joint.
    JointRate,
    /// Displacement of a prismatic joint.
    JointPlace,
    /// Rate of a prismatic joint.
    JointSpeed,
    /// Force of a thruster.
    Thrust,
    /// State of a thruster.
    Firing,
    /// Duration of a pulse of a thruster.
    Pulse,
}

impl Kind {
    fn rule(self) -> Option<&'static Rule> {
        vocabulary().rules.iter().find(|rule| rule.kind == self)
    }

    /// Prefix of the names of a vector; `None` for scalars.
    fn vector(self) -> Option<&'static str> {
        let rule = self.rule().filter(|rule| rule.suffix == ".");
        rule.map(|rule| rule.stem)
    }

    /// The dimension of its values; `None` where any will do.
    pub fn dimension(self) -> Option<Dimension> {
        self.rule()?.dimension
    }
}

/// A column that is recognised.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Index in the header.
    pub column: usize,
    /// What it measures.
    pub kind: Kind,
    /// The standard channel; of an attitude that is no quaternion with named components, its kind and component.
    pub channel: String,
    /// The unit, where the name or the units row has one that fits.
    pub unit: Option<Unit>,
    /// Words of the name that say whose it is.
    pub owner: Vec<String>,
    /// Whether the name says which component it is, or there is only one.
    pub named: bool,
    component: usize,
    rank: usize,
}

/// The columns of one attitude.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundAttitude {
    /// Sensor; empty if there is only one.
    pub sensor: String,
    /// Quaternion, Euler angles or Rodrigues parameters.
    pub kind: Kind,
    /// The columns, in the order of the form: of Euler angles yaw, pitch, roll.
    pub columns: Vec<usize>,
    /// Whether the names say which component each is. Numbered ones of a quaternion are listed in their order.
    pub named: bool,
}

/// What the names of a header say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recognition {
    /// Columns of one channel each, with those that bear a standard name; attitudes are in `attitudes` too.
    pub channels: Vec<Found>,
    /// Complete attitudes.
    pub attitudes: Vec<FoundAttitude>,
}

/// Recognises the columns of a header; `units` are those of the units row.
///
/// ```
/// use poinsot_telemetry::{Kind, recognise};
///
/// let header = ["Time_ms", "BodyRateX_dps", "RW_A_rpm", "ST_qw", "Mode"].map(str::to_owned);
/// let found = recognise(&header, &[]).channels;
/// let channels: Vec<&str> = found.iter().map(|f| f.channel.as_str()).collect();
/// assert_eq!(channels, ["time_s", "omega_x", "wheel_a_rad_s", "q_w"]);
/// assert_eq!(found[2].unit.unwrap().symbol, "rpm");
/// ```
pub fn recognise(header: &[String], units: &[Option<Unit>]) -> Recognition {
    let below = |k: usize| units.get(k).copied().flatten();
    let spelled = with_trios(header.get(..MOST).unwrap_or(header));
    let columns = spelled.iter().enumerate();
    let mut groups: Vec<Vec<Found>> = Vec::new();
    for one in columns.filter_map(|(k, column)| found(k, column, below(k))) {
        let same = |g: &&mut Vec<Found>| {
            g.first()
                .is_some_and(|f| (f.kind, &f.owner) == (one.kind, &one.owner))
        };
        let is_vector = one.kind.vector().is_some();
        match groups.iter_mut().filter(|_| is_vector).find(same) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    groups.retain_mut(|group| complete(group));
    keep_measured(&mut groups);
    name_sensors(&mut groups);
    let attitudes = groups.iter().filter_map(|g| attitude(g)).collect();
    let mut channels: Vec<Found> = groups.into_iter().flatten().collect();
    channels.sort_by_key(|f| f.column);
    keep_unique(header, &mut channels);
    Recognition {
        channels,
        attitudes,
    }
}

/// The header with letters and words of flight mechanics spelled out where all three stand in names that have nothing else
/// different.
fn with_trios(header: &[String]) -> Vec<String> {
    let mut names = header.to_vec();
    for (tokens, words) in TRIOS {
        let parts = tokens.map(|token| {
            let all = header.iter().enumerate();
            let all = all.filter_map(|(k, name)| Some((k, around(name, token)?)));
            all.collect::<Vec<_>>()
        });
        for (_, rest) in &parts[0] {
            let own = |all: &Vec<(usize, _)>| -> Vec<usize> {
                let same = all.iter().filter(|(_, other)| other == rest);
                same.map(|(k, _)| *k).collect()
            };
            if let [[x], [y], [z]] = parts.each_ref().map(own).each_ref().map(Vec::as_slice) {
                for (k, word) in [x, y, z].into_iter().zip(words) {
                    names[*k] = format!("{}{word}{}", rest.0, rest.1);
                }
            }
        }
    }
    names
}

/// What stands around a token of a name without component and number.
fn around<'n>(name: &'n str, token: &str) -> Option<(&'n str, &'n str)> {
    let lower = name.to_ascii_lowercase();
    let (head, tail) = lower.match_indices(token).find_map(|(at, _)| {
        let (head, tail) = (name.get(..at)?, name.get(at + token.len()..)?);
        let inside =
            head.ends_with(char::is_alphanumeric) || tail.starts_with(char::is_alphanumeric);
        (!inside).then_some((head, tail))
    })?;
    let rest = Name::of(&format!("{head}_{tail}"), None);
    (rest.axis.is_none() && rest.number.is_none()).then_some((head, tail))
}

fn found(column: usize, text: &str, below: Option<Unit>) -> Option<Found> {
    let name = Name::of(text, below);
    let unit = name.unit.map(|unit| unit.dimension);
    let rule = vocabulary()
        .rules
        .iter()
        .find(|rule| rule.fits(&name.words, unit))?;
    let component = name.component().or(name.number);
    let channel = match rule.suffix {
        "." => format!("{}_{}", rule.stem, axis(component?)),
        suffix if rule.kind == Kind::Time => format!("{}{suffix}", rule.stem),
        suffix if name.index.starts_with(|c: char| c.is_alphabetic()) => {
            format!("{}_{}{suffix}", rule.stem, name.index)
        }
        suffix => format!("{}{}{suffix}", rule.stem, name.index),
    };
    // A standard name stays, but for one such as wx_rad_s, which would be a wheel or a joint, or rw1_N_m_s, which would be a speed.
    let is_scalar = rule.suffix != "." && !name.is_momentum();
    let stays = |own: &crate::ChannelName| !own.frame.is_empty() || is_scalar;
    if classify(text).as_ref().is_some_and(stays) && channel != text {
        return None;
    }
    let fits = |unit: &Unit| rule.dimension.is_none_or(|d| d == unit.dimension);
    Some(Found {
        column,
        kind: rule.kind,
        channel,
        unit: name.unit.filter(fits),
        component: component.unwrap_or_default(),
        named: rule.suffix != "." || name.component().is_some(),
        rank: rank(&name, rule.kind),
        owner: name.owner,
    })
}

/// The name of a component; empty for a number that is none.
fn axis(component: usize) -> &'static str {
    ["x", "y", "z", "w"]
        .get(component)
        .copied()
        .unwrap_or_default()
}

/// A measurement comes first, then an estimate or a momentum in place of a speed, then a command; of times the one with the fewest words, a letter last.
fn rank(name: &Name, kind: Kind) -> usize {
    let letter = usize::from(name.owner.concat().len() == 1);
    match kind {
        Kind::Time => 2 * name.owner.len() + letter,
        _ if name.has(Word::Command) => 2,
        _ => usize::from(name.has(Word::Estimate) || name.is_momentum()),
    }
}

/// Whether the components of a vector are named by letters, or numbered from 0 or 1 without a gap; renumbers them.
fn complete(group: &mut [Found]) -> bool {
    let Some(prefix) = group.first().and_then(|f| f.kind.vector()) else {
        return true;
    };
    let width = crate::channel_name::components(prefix).len();
    let mut numbers: Vec<usize> = group
        .iter()
        .filter(|f| !f.named)
        .map(|f| f.component)
        .collect();
    numbers.sort_unstable();
    let named = group.len() - numbers.len();
    let wanted = match (numbers.len(), named) {
        // Three of an attitude may be angles: a quaternion has its scalar.
        (0, 3) if width == 4 => return group.iter().any(|f| f.component == 3),
        (0, _) => return named <= width,
        // q1 q2 q3 beside a scalar with a name.
        (3, 1) if prefix == "q" => 3,
        (_, 0) => width,
        _ => return false,
    };
    let first = numbers.first().copied().unwrap_or_default();
    if first > 1 || numbers.iter().copied().ne(first..first + wanted) {
        return false;
    }
    for one in group.iter_mut().filter(|f| !f.named) {
        one.component -= first;
        one.named = wanted == 3;
    }
    true
}

/// Leaves out estimates and commands beside a measurement of the same kind and component.
fn keep_measured(groups: &mut Vec<Vec<Found>>) {
    let key = |f: &Found| (f.kind, f.kind.vector().is_none().then(|| f.channel.clone()));
    let ranks: Vec<_> = groups
        .iter()
        .filter_map(|g| g.first().map(|f| (key(f), f.rank)))
        .collect();
    groups.retain(|group| {
        let Some(own) = group.first() else {
            return false;
        };
        let wanted = key(own);
        let same = ranks.iter().filter(|(k, _)| *k == wanted);
        same.map(|(_, rank)| *rank).min() == Some(own.rank)
    });
}

/// Writes the channels of vectors, with the name of a sensor where a kind has several.
fn name_sensors(groups: &mut [Vec<Found>]) {
    let kinds: Vec<Kind> = groups
        .iter()
        .filter_map(|g| Some(g.first()?.kind))
        .collect();
    let attitude = |k: &Kind| matches!(k, Kind::Quaternion | Kind::Euler | Kind::Rodrigues);
    for one in groups.iter_mut().flatten() {
        let Some(prefix) = one.kind.vector() else {
            continue;
        };
        let alike = |k: &&Kind| **k == one.kind || (attitude(k) && attitude(&one.kind));
        let sensor = match (one.kind, kinds.iter().filter(alike).count()) {
            (Kind::Field, 1) => "magnetometer".to_owned(),
            (Kind::Sun, 1) => "sun_sensor".to_owned(),
            (_, 1) => String::new(),
            _ => one.owner.join("_"),
        };
        let stem = match one.kind {
            Kind::Field | Kind::Sun => "direction",
            _ => prefix,
        };
        one.channel = full_name(&sensor, &format!("{stem}_{}", axis(one.component)));
    }
}

fn attitude(group: &[Found]) -> Option<FoundAttitude> {
    let kind = group.first()?.kind;
    let order: &[usize] = match kind {
        Kind::Quaternion => &[0, 1, 2, 3],
        Kind::Rodrigues => &[0, 1, 2],
        Kind::Euler => &[2, 1, 0],
        _ => return None,
    };
    let of = |k: &usize| group.iter().find(|f| f.component == *k).map(|f| f.column);
    let columns = order.iter().map(of).collect::<Option<_>>()?;
    let sensor = group
        .first()?
        .channel
        .rsplit_once('.')
        .map_or("", |(sensor, _)| sensor);
    Some(FoundAttitude {
        sensor: sensor.to_owned(),
        kind,
        columns,
        named: group.iter().all(|f| f.named),
    })
}

/// Leaves out columns that claim one channel: no name says which of them it is.
fn keep_unique(header: &[String], channels: &mut Vec<Found>) {
    let names: Vec<String> = channels.iter().map(|f| f.channel.clone()).collect();
    channels.retain(|f| {
        let own = header.get(f.column) == Some(&f.channel);
        let other = header.contains(&f.channel) && !own;
        !other && names.iter().filter(|n| **n == f.channel).count() == 1
    });
}
