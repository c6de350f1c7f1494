//! What puts channels right that are read by another convention than declared, as a change of the map.

use crate::{
    AttitudeColumn, AttitudeMap, Axes, ColumnMap, FileMap, OrbitalMap, Order, Sense, TelemetryMap,
    TimeFormat, TimeMap, Turned, classify, parse_unit,
};
use poinsot_files::to_digits;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// Factors that put an angle or its rate right that is read in another unit: degrees, rpm, revolutions, radians mapped as degrees.
pub const UNIT_FACTORS: [f64; 4] = [PI / 180.0, PI / 30.0, TAU, 180.0 / PI];
/// Significant digits of a number that is written into a map.
const DIGITS: usize = 9;

/// A line of a map that declares a change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// The channel, `attitude` or `time`.
    pub key: String,
    /// The whole line.
    pub text: String,
    /// The keys in which it differs from what the map said, or from a column with a standard name.
    pub changed: String,
}

impl Line {
    fn of(key: &str, before: &impl Serialize, after: &impl Serialize) -> Self {
        let before = toml::Table::try_from(before).unwrap_or_default();
        let new = toml::Table::try_from(after).unwrap_or_default();
        let changed = new
            .iter()
            .filter(|(key, value)| before.get(*key) != Some(*value));
        let changed: Vec<String> = changed
            .map(|(key, value)| format!("{key} = {value}"))
            .collect();
        Self {
            key: key.to_owned(),
            text: match key {
                "attitude" => format!("attitude = [{}]", inline(after)),
                _ => line(key, after),
            },
            changed: changed.join(", "),
        }
    }
}

/// What is done to the numbers of channels, in SI and in the axes in which they are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// Times this: a unit, a sign, a ratio of gears.
    Factor(f64),
    /// Plus this, in the SI unit: another zero.
    Offset(f64),
    /// The first half of the channels has the columns of the second half, and the reverse.
    Exchanged,
    /// Components of a vector in the axes of the body from those that are read.
    Axes(Axes),
    /// Order and sense of a quaternion.
    Attitude(Order, Sense),
    /// Increments since the sample before, not rates.
    Increments,
    /// This means that there is no sample, in the SI unit.
    Invalid(f64),
    /// The values begin anew at this, in the SI unit.
    WrapsAt(f64),
    /// The values count modulo this, in the SI unit, and the upper half are the negative ones.
    SignedRange(f64),
    /// Times of all channels, times this.
    Clock(f64),
    /// The thrust ends later than commanded by this, s.
    ClosesLate(f64),
    /// The times of the samples are late by this, s.
    Late(f64),
    /// Vectors are in other axes, from which the attitude turns them.
    Turned(Turned),
    /// Attitudes are relative to orbital axes, which turn at this rate, rad/s; whether the rates are too.
    OrbitalAxes(f64, bool),
}

/// A change of channels, which lines of a map declare.
#[derive(Debug, Clone, PartialEq)]
pub struct Repair {
    /// Full names, for example `imu2.omega_x`; of a vector x, y and z, of an attitude its first.
    pub channels: Vec<String>,
    /// What is done to them.
    pub change: Change,
}

impl Repair {
    /// A repair of one channel.
    pub fn of(channel: &str, change: Change) -> Self {
        Self {
            channels: vec![channel.to_owned()],
            change,
        }
    }

    /// Declares the change in a map; returns the lines that it has from now on. `None` where no line of a map declares it: the map
    /// may then be changed in part.
    ///
    /// ```
    /// use poinsot_telemetry::{Change, Repair, TelemetryMap};
    ///
    /// let mut map = TelemetryMap::default();
    /// let lines = Repair::of("elbow_rad", Change::Factor(-1.0)).declare(&mut map).unwrap();
    /// assert_eq!(lines[0].text, r#"elbow_rad = { column = "elbow_rad", sign = -1.0, unit = "rad" }"#);
    /// assert_eq!(lines[0].changed, "sign = -1.0");
    /// assert_eq!(map.all.columns[0].sign, Some(-1.0));
    /// ```
    pub fn declare(&self, map: &mut TelemetryMap) -> Option<Vec<Line>> {
        match self.change {
            Change::Attitude(order, sense) => {
                self.declare_attitude(map, |attitude| reordered(attitude, order, sense))
            }
            Change::Late(late_s) if self.is_attitude() => self.declare_attitude(map, |attitude| {
                attitude.late_s = later(attitude.late_s, late_s);
                Some(())
            }),
            Change::Clock(factor) => declare_clock(map, factor),
            Change::OrbitalAxes(rate_rad_s, rates) => {
                let rate_rad_s = to_digits(rate_rad_s, DIGITS);
                let frame = OrbitalMap { rate_rad_s, rates };
                let line = Line::of("orbital_frame", &TelemetryMap::default(), &frame);
                map.orbital_frame
                    .replace(frame)
                    .is_none()
                    .then(|| vec![line])
            }
            Change::Turned(turned) => {
                let key = turned.key().to_owned();
                let text = format!("{key} = true");
                let line = Line {
                    key,
                    changed: text.clone(),
                    text,
                };
                (!std::mem::replace(turned.declared(map), true)).then(|| vec![line])
            }
            _ => self.declare_columns(map),
        }
    }

    fn declare_columns(&self, map: &mut TelemetryMap) -> Option<Vec<Line>> {
        let has_units = map.all.layout.units_row == Some(true);
        let mapped: Vec<ColumnMap> = maps(map).flat_map(|m| m.columns.clone()).collect();
        let before = self.channels.iter().map(|channel| {
            let known = mapped.iter().find(|c| c.channel == *channel).cloned();
            known.or_else(|| standard(channel, has_units))
        });
        let before = before.collect::<Option<Vec<_>>>()?;
        let after = self.changed(&before)?;
        for new in &after {
            let all = maps(map).flat_map(|m| &mut m.columns);
            let own: Vec<&mut ColumnMap> = all.filter(|c| c.channel == new.channel).collect();
            match own.is_empty() {
                true => map.all.columns.push(new.clone()),
                false => own.into_iter().for_each(|c| *c = new.clone()),
            }
        }
        let pairs = before.iter().zip(&after);
        let lines = pairs.map(|(before, after)| Line::of(&after.channel, before, after));
        Some(lines.filter(|line| !line.changed.is_empty()).collect())
    }

    /// The columns of the channels after the change.
    fn changed(&self, before: &[ColumnMap]) -> Option<Vec<ColumnMap>> {
        let all = before.len();
        let from = |k: usize| match self.change {
            Change::Exchanged => Some(((k + all / 2) % all, Change::Factor(1.0))),
            Change::Axes(axes) => {
                let sign = f64::from(*axes.sign.get(k)?);
                Some((*axes.axis.get(k)?, Change::Factor(sign)))
            }
            change => Some((k, change)),
        };
        let columns = before.iter().enumerate().map(|(k, own)| {
            let (from, change) = from(k)?;
            let column = ColumnMap {
                channel: own.channel.clone(),
                ..before.get(from)?.clone()
            };
            changed(&column, change)
        });
        columns.collect()
    }

    fn is_attitude(&self) -> bool {
        let first = self.channels.first().and_then(|channel| classify(channel));
        first.is_some_and(|name| matches!(name.vector(), Some(("q", _))))
    }

    fn declare_attitude(
        &self,
        map: &mut TelemetryMap,
        change: impl Fn(&mut AttitudeMap) -> Option<()>,
    ) -> Option<Vec<Line>> {
        let first = self.channels.first()?;
        let sensor = first.rsplit_once('.').map_or("", |(sensor, _)| sensor);
        let is_own = |a: &AttitudeMap| a.sensor == sensor && !a.relative;
        if !maps(map).any(|m| m.attitude.iter().any(is_own)) {
            let mut standard = AttitudeMap {
                sensor: sensor.to_owned(),
                ..AttitudeMap::default()
            };
            standard.quaternion = Some(standard.names().map(AttitudeColumn::Name).into());
            map.all.attitude.push(standard);
        }
        let mut lines = Vec::new();
        let own = maps(map).flat_map(|m| &mut m.attitude);
        for attitude in own.filter(|a| is_own(a)) {
            let before = attitude.clone();
            change(attitude)?;
            lines.push(Line::of("attitude", &before, attitude));
        }
        Some(lines)
    }
}

/// Another order and sense of a quaternion than declared; `None` where it has that order already.
fn reordered(attitude: &mut AttitudeMap, order: Order, sense: Sense) -> Option<()> {
    if order == Order::Wxyz {
        let last = attitude.order.unwrap_or(Order::Xyzw) == Order::Xyzw;
        attitude.quaternion.as_ref().filter(|_| last)?;
        attitude.order = Some(order);
    }
    if sense == Sense::InertialToBody {
        attitude.sense = Some(match attitude.sense() {
            Sense::BodyToInertial => Sense::InertialToBody,
            Sense::InertialToBody => Sense::BodyToInertial,
        });
    }
    Some(())
}

/// A delay that is longer by this, s.
fn later(known_s: Option<f64>, by_s: f64) -> Option<f64> {
    Some(to_digits(known_s.unwrap_or(0.0) + by_s, DIGITS))
}

/// The mistake of a unit that a factor puts right; `None` where the factor is none of units.
///
/// ```
/// use poinsot_telemetry::{UNIT_FACTORS, unit_mistake};
///
/// assert_eq!(unit_mistake("rad/s", UNIT_FACTORS[1]).unwrap(), "rpm used as rad/s");
/// assert_eq!(unit_mistake("rad", UNIT_FACTORS[3]).unwrap(), "rad mapped as deg");
/// ```
pub fn unit_mistake(si: &str, factor: f64) -> Option<String> {
    let read = parse_unit(si).ok()?;
    let used = read
        .times(factor)
        .map(|own| format!("{} used as {si}", own.symbol));
    let mapped = || {
        Some(format!(
            "{si} mapped as {}",
            read.times(1.0 / factor)?.symbol
        ))
    };
    used.or_else(mapped)
}

/// The map of all files, and those of some.
fn maps(map: &mut TelemetryMap) -> impl Iterator<Item = &mut FileMap> {
    let files = map.files.iter_mut().map(|file| &mut file.map);
    std::iter::once(&mut map.all).chain(files)
}

/// The column with the name of a channel, in SI or in the unit of the row that names them.
fn standard(channel: &str, has_units: bool) -> Option<ColumnMap> {
    let unit = classify(channel)?.dimension.si();
    let mut own = ColumnMap::new(channel, channel, unit);
    own.unit = own.unit.filter(|_| !has_units);
    Some(own)
}

/// A column whose values are changed, each alone; `None` where its unit has to be known and is not.
fn changed(own: &ColumnMap, change: Change) -> Option<ColumnMap> {
    let mut new = own.clone();
    let unit = own.unit.as_deref().and_then(|unit| parse_unit(unit).ok());
    let of_count = own.counts_per_revolution.map(|counts| TAU / counts);
    // One of the numbers of the column, before scale and sign, in SI.
    let one = || of_count.or_else(|| Some(unit?.to_si(1.0)));
    let read = |x: f64| Some(to_digits(x / (one()? * own.scale.unwrap_or(1.0)), DIGITS));
    match change {
        Change::Factor(x) => match unit.and_then(|unit| unit.times(x)) {
            Some(other) => new.unit = Some(other.symbol.to_owned()),
            None => {
                let factor = to_digits(x.abs(), DIGITS);
                if x < 0.0 {
                    new.sign = Some(-own.sign.unwrap_or(1.0));
                }
                if factor != 1.0 {
                    new.scale = Some(factor * own.scale.unwrap_or(1.0));
                    new.offset = own.offset.map(|offset| factor * offset);
                }
            }
        },
        Change::Offset(x) => {
            let by = own.sign.unwrap_or(1.0) * x / one()?;
            new.offset = Some(to_digits(own.offset.unwrap_or(0.0) + by, DIGITS));
        }
        Change::Increments => {
            let whole = unit?.symbol.strip_suffix("/s").map(parse_unit)?.ok()?;
            new.unit = Some(whole.symbol.to_owned());
            new.increments = true;
        }
        Change::Invalid(x) if own.offset.or(own.sign).is_none() => {
            new.invalid.push(read(x)?.to_string());
        }
        Change::WrapsAt(x) => new.wraps_at = Some(read(x)?),
        Change::SignedRange(x) => new.signed_range = Some(read(x)?),
        Change::ClosesLate(x) => new.closes_late_s = later(own.closes_late_s, x),
        Change::Late(x) => new.late_s = later(own.late_s, x),
        _ => return None,
    }
    Some(new)
}

fn declare_clock(map: &mut TelemetryMap, factor: f64) -> Option<Vec<Line>> {
    if !maps(map).any(|m| m.time.is_some()) {
        map.all.time = Some(TimeMap {
            column: "time_s".to_owned(),
            ..TimeMap::default()
        });
    }
    let mut lines = Vec::new();
    for time in maps(map).filter_map(|m| m.time.as_mut()) {
        let before = time.clone();
        let unit = parse_unit(time.unit.as_deref().unwrap_or("s")).ok()?;
        let other = unit.times(factor);
        let other = other.filter(|_| time.format == TimeFormat::Number)?;
        time.unit = Some(other.symbol.to_owned());
        lines.push(Line::of("time", &before, time));
    }
    Some(lines)
}

/// A line of a map: a key and a table.
pub(crate) fn line(key: &str, of: &impl Serialize) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    match key.chars().all(bare) {
        true => format!("{key} = {}", inline(of)),
        false => format!("{} = {}", toml::Value::from(key), inline(of)),
    }
}

fn inline(of: &impl Serialize) -> String {
    let table = toml::Value::try_from(of);
    table.map_or_else(|_| String::new(), |table| table.to_string())
}
