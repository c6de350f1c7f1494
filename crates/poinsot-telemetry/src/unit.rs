//! Units in headers and maps, with their factors to SI.

use poinsot_files::{Faults, Place};
use serde::Serialize;
use std::f64::consts::PI;

/// Dimension of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Dimension {
    /// A pure number; SI `1`.
    One,
    /// Time; SI `s`.
    Time,
    /// Angle; SI `rad`.
    Angle,
    /// Angular velocity; SI `rad/s`.
    AngularVelocity,
    /// Angular acceleration; SI `rad/s2`.
    AngularAcceleration,
    /// Length; SI `m`.
    Length,
    /// Velocity; SI `m/s`.
    Velocity,
    /// Acceleration or specific force; SI `m/s2`.
    Acceleration,
    /// Force; SI `N`.
    Force,
    /// Torque; SI `N m`.
    Torque,
    /// Linear impulse; SI `N s`.
    Impulse,
    /// Angular momentum of a wheel, in place of its speed; SI `N m s`.
    AngularMomentum,
}

impl Dimension {
    /// The SI unit, for example `rad/s`: the first of its dimension in the table.
    pub fn si(self) -> &'static str {
        let first = TABLE.iter().find(|row| row.1 == self);
        first.map_or("1", |row| row.0)
    }

    /// Name, for example `angular velocity`.
    pub fn words(self) -> &'static str {
        match self {
            Self::One => "pure number",
            Self::Time => "time",
            Self::Angle => "angle",
            Self::AngularVelocity => "angular velocity",
            Self::AngularAcceleration => "angular acceleration",
            Self::Length => "length",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Force => "force",
            Self::Torque => "torque",
            Self::Impulse => "impulse",
            Self::AngularMomentum => "angular momentum",
        }
    }
}

/// A known unit. A value `x` is `x * factor / divisor` in SI. A decimal prefix is in the divisor, so that `1 ms` is
/// the double nearest to 0.001.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Unit {
    /// Printed symbol, for example `deg/s`.
    pub symbol: &'static str,
    /// Dimension.
    pub dimension: Dimension,
    /// Factor.
    pub factor: f64,
    /// Divisor.
    pub divisor: f64,
}

impl Unit {
    fn of(&(symbol, dimension, factor, divisor, _): &Row) -> Self {
        Self {
            symbol,
            dimension,
            factor,
            divisor,
        }
    }

    /// The value in SI.
    #[inline]
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor / self.divisor
    }

    /// The unit that is so many times this one.
    ///
    /// ```
    /// let rate = poinsot_telemetry::parse_unit("rad/s")?;
    /// assert_eq!(rate.times(std::f64::consts::PI / 30.0).unwrap().symbol, "rpm");
    /// # Ok::<(), poinsot_files::Faults>(())
    /// ```
    pub fn times(&self, factor: f64) -> Option<Self> {
        let wanted = factor * self.to_si(1.0);
        let mut alike = units().filter(|other| other.dimension == self.dimension);
        alike.find(|other| (other.to_si(1.0) / wanted - 1.0).abs() < SAME)
    }
}

/// Relative difference of two factors that are one unit.
const SAME: f64 = 1.0e-9;

const DEG: f64 = PI / 180.0;
/// Standard gravity, m/s2 (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Symbol, dimension, factor, divisor, and other spellings (compared after [`plain`]).
type Row = (&'static str, Dimension, f64, f64, &'static [&'static str]);

#[rustfmt::skip]
const TABLE: &[Row] = &[
    ("1", Dimension::One, 1.0, 1.0, &["-", "none", "dimensionless"]),
    ("%", Dimension::One, 1.0, 100.0, &["percent"]),
    ("s", Dimension::Time, 1.0, 1.0, &["sec", "second", "seconds"]),
    ("ms", Dimension::Time, 1.0, 1e3, &["msec", "millisecond", "milliseconds"]),
    ("us", Dimension::Time, 1.0, 1e6, &["usec", "microsecond", "microseconds"]),
    ("ns", Dimension::Time, 1.0, 1e9, &["nsec", "nanosecond", "nanoseconds"]),
    ("min", Dimension::Time, 60.0, 1.0, &["minute", "minutes"]),
    ("h", Dimension::Time, 3600.0, 1.0, &["hr", "hour", "hours"]),
    ("d", Dimension::Time, 86400.0, 1.0, &["day", "days"]),
    ("rad", Dimension::Angle, 1.0, 1.0, &["radian", "radians"]),
    ("mrad", Dimension::Angle, 1.0, 1e3, &[]),
    ("urad", Dimension::Angle, 1.0, 1e6, &[]),
    ("deg", Dimension::Angle, DEG, 1.0, &["degree", "degrees", "\u{b0}"]),
    ("arcmin", Dimension::Angle, DEG, 60.0, &[]),
    ("arcsec", Dimension::Angle, DEG, 3600.0, &["asec"]),
    ("rev", Dimension::Angle, 2.0 * PI, 1.0, &["turn", "turns"]),
    ("rad/s", Dimension::AngularVelocity, 1.0, 1.0, &["rads-1", "rad/sec"]),
    ("mrad/s", Dimension::AngularVelocity, 1.0, 1e3, &["mrad/sec"]),
    ("deg/s", Dimension::AngularVelocity, DEG, 1.0, &["dps", "\u{b0}/s", "deg/sec", "degs-1"]),
    ("mdeg/s", Dimension::AngularVelocity, DEG, 1e3, &["mdps"]),
    ("deg/h", Dimension::AngularVelocity, DEG, 3600.0, &["deg/hr", "\u{b0}/h"]),
    ("arcsec/s", Dimension::AngularVelocity, DEG, 3600.0, &["arcsec/sec"]),
    ("rpm", Dimension::AngularVelocity, 2.0 * PI, 60.0, &["RPM", "rev/min", "1/min", "r/min"]),
    ("rev/s", Dimension::AngularVelocity, 2.0 * PI, 1.0, &["rps"]),
    ("rad/s2", Dimension::AngularAcceleration, 1.0, 1.0, &["rads-2", "rad/s/s", "rad/sec2"]),
    ("deg/s2", Dimension::AngularAcceleration, DEG, 1.0, &["degs-2", "deg/s/s", "deg/sec2"]),
    ("m", Dimension::Length, 1.0, 1.0, &["metre", "meter", "metres", "meters"]),
    ("cm", Dimension::Length, 1.0, 1e2, &[]),
    ("mm", Dimension::Length, 1.0, 1e3, &[]),
    ("um", Dimension::Length, 1.0, 1e6, &[]),
    ("km", Dimension::Length, 1e3, 1.0, &[]),
    ("m/s", Dimension::Velocity, 1.0, 1.0, &["ms-1", "m/sec"]),
    ("cm/s", Dimension::Velocity, 1.0, 1e2, &["cm/sec"]),
    ("mm/s", Dimension::Velocity, 1.0, 1e3, &["mm/sec"]),
    ("km/s", Dimension::Velocity, 1e3, 1.0, &["km/sec"]),
    ("m/s2", Dimension::Acceleration, 1.0, 1.0, &["ms-2", "m/s/s", "m/sec2"]),
    ("mm/s2", Dimension::Acceleration, 1.0, 1e3, &[]),
    ("km/s2", Dimension::Acceleration, 1e3, 1.0, &[]),
    ("g", Dimension::Acceleration, STANDARD_GRAVITY, 1.0, &["g0", "gee"]),
    ("mg", Dimension::Acceleration, STANDARD_GRAVITY, 1e3, &[]),
    ("ug", Dimension::Acceleration, STANDARD_GRAVITY, 1e6, &[]),
    ("N", Dimension::Force, 1.0, 1.0, &["newton", "newtons"]),
    ("mN", Dimension::Force, 1.0, 1e3, &[]),
    ("uN", Dimension::Force, 1.0, 1e6, &[]),
    ("kN", Dimension::Force, 1e3, 1.0, &[]),
    ("N m", Dimension::Torque, 1.0, 1.0, &["Nm"]),
    ("mN m", Dimension::Torque, 1.0, 1e3, &["mNm"]),
    ("uN m", Dimension::Torque, 1.0, 1e6, &["uNm"]),
    ("N s", Dimension::Impulse, 1.0, 1.0, &["Ns"]),
    ("mN s", Dimension::Impulse, 1.0, 1e3, &["mNs"]),
    ("N m s", Dimension::AngularMomentum, 1.0, 1.0, &["Nms", "kgm2/s"]),
    ("mN m s", Dimension::AngularMomentum, 1.0, 1e3, &["mNms"]),
];

/// Normalised spelling: without blanks, `^`, `*`, middle dots and one `.`; `²` is `2`, `µ` is `u`.
fn plain(text: &str) -> String {
    text.chars()
        .filter_map(|c| match c {
            ' ' | '\t' | '^' | '*' | '.' | '\u{b7}' | '\u{22c5}' => None,
            '\u{b2}' => Some('2'),
            '\u{b5}' | '\u{3bc}' => Some('u'),
            c => Some(c),
        })
        .collect()
}

/// Parses a unit: blanks, `^`, `*` and `.` are ignored (`m/s^2`, `N*m`, `N m`), case is not.
///
/// # Errors
/// E0211 names the nearest known unit.
///
/// ```
/// use poinsot_telemetry::parse_unit;
///
/// assert!((parse_unit("rpm")?.to_si(30.0) - std::f64::consts::PI).abs() < 1.0e-14);
/// assert_eq!(parse_unit("m/s^2")?.symbol, "m/s2");
/// assert!(parse_unit("furlong").is_err());
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn parse_unit(text: &str) -> Result<Unit, Faults> {
    let wanted = plain(text);
    TABLE
        .iter()
        .find(|row| plain(row.0) == wanted || row.4.contains(&wanted.as_str()))
        .map(Unit::of)
        .ok_or_else(|| {
            let nearest = nearest_unit(text, None);
            let problem = format!("unit '{text}' is not known");
            let advice = format!("did you mean '{nearest}'? `poinsot units` lists all");
            Faults::one("E0211", Place::default(), problem, advice)
        })
}

/// Every known unit, in the order of the table.
///
/// ```
/// use poinsot_telemetry::{Dimension, units};
///
/// let mut of_time = units().filter(|unit| unit.dimension == Dimension::Time);
/// assert!(of_time.any(|unit| unit.symbol == "ms" && unit.to_si(1.0) == 0.001));
/// ```
pub fn units() -> impl Iterator<Item = Unit> {
    TABLE.iter().map(Unit::of)
}

/// The units of a dimension, separated by commas.
pub(crate) fn list(dimension: Dimension) -> String {
    let fitting = TABLE.iter().filter(|row| row.1 == dimension);
    fitting.map(|row| row.0).collect::<Vec<_>>().join(", ")
}

/// The unit with the fewest edits, of this dimension if given; a printed symbol precedes an alias at the same
/// distance.
pub(crate) fn nearest_unit(text: &str, dimension: Option<Dimension>) -> &'static str {
    let wanted = plain(text).to_lowercase();
    let fitting = TABLE
        .iter()
        .filter(|row| dimension.is_none_or(|d| d == row.1));
    let spellings = fitting.flat_map(|row| {
        let aliases = row.4.iter().map(move |alias| (row.0, *alias, 1));
        std::iter::once((row.0, row.0, 0)).chain(aliases)
    });
    spellings
        .min_by_key(|(_, spelling, alias)| {
            2 * strsim::damerau_levenshtein(&wanted, &plain(spelling).to_lowercase()) + alias
        })
        .map_or("1", |best| best.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_factors_of_si() {
        for (text, value, si) in [
            ("deg/s", 180.0, PI),
            ("rpm", 60.0, 2.0 * PI),
            ("m/s^2", 1.0, 1.0),
            ("mN*m", 7.0, 0.007),
            ("N\u{b7}m", 3.0, 3.0),
            ("arcsec", 3600.0 * 180.0, PI),
            ("\u{b5}s", 3.0, 3e-6),
            ("deg/h", 3600.0, DEG),
            ("mg", 1000.0, 9.80665),
            ("ms", 7.0, 0.007),
            ("km/s", 7.5, 7500.0),
            (" rad / s ", 2.0, 2.0),
        ] {
            let unit = parse_unit(text).unwrap();
            assert!((unit.to_si(value) - si).abs() <= 2e-16 * si, "{text}");
        }
    }

    #[test]
    fn unit_capitals_distinguish_prefixes() {
        assert_eq!(parse_unit("mN").unwrap().divisor, 1e3);
        assert!(parse_unit("MN").is_err());
        assert_eq!(parse_unit("ms").unwrap().dimension, Dimension::Time);
    }

    #[test]
    fn unit_an_unknown_unit_names_the_nearest() {
        assert_eq!(
            parse_unit("degs/s").unwrap_err().to_string(),
            "E0211 unit 'degs/s' is not known; did you mean 'deg/s'? `poinsot units` lists all"
        );
        assert_eq!(
            parse_unit("radians/s").unwrap_err().to_string(),
            "E0211 unit 'radians/s' is not known; did you mean 'rad'? `poinsot units` lists all"
        );
        assert_eq!(
            nearest_unit("radians/s", Some(Dimension::AngularVelocity)),
            "rad/s"
        );
    }

    #[test]
    fn prop_every_spelling_is_unique() {
        let mut seen = std::collections::HashMap::new();
        for row in TABLE {
            for spelling in std::iter::once(&row.0).chain(row.4) {
                let other = seen.insert(plain(spelling), row.0);
                assert!(other.is_none_or(|o| o == row.0), "{spelling}: {other:?}");
            }
        }
        assert!(TABLE.len() >= 40);
    }
}
