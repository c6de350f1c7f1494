//! Exact instants: dates and counts become attoseconds of TAI, then seconds since a first sample.

use crate::number::InvalidNumber;
use hifitime::{Duration, Epoch, TimeScale, Unit, is_gregorian_valid};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt;

/// Attoseconds in a second.
pub(crate) const ATTO: i128 = 1_000_000_000_000_000_000;
/// Attoseconds in a nanosecond.
const ATTO_OF_NANO: i128 = 1_000_000_000;
/// Seconds in a day that has no leap second.
const DAY: i64 = 86_400;
/// Other years are mistakes, or have unknown leap seconds.
const YEARS: std::ops::RangeInclusive<i64> = 1972..=2199;

/// A time scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "UPPERCASE")]
#[schemars(rename = "TimeScaleFile")]
pub enum Scale {
    /// Coordinated universal time, with leap seconds.
    Utc,
    /// International atomic time.
    Tai,
    /// GPS time: TAI - 19 s.
    Gps,
    /// Terrestrial time: TAI + 32.184 s.
    Tt,
}

impl Scale {
    /// All scales with their names.
    pub const ALL: [(&'static str, Self); 4] = [
        ("UTC", Self::Utc),
        ("TAI", Self::Tai),
        ("GPS", Self::Gps),
        ("TT", Self::Tt),
    ];

    /// Name of the scale.
    pub fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, scale)| *scale == self);
        found.map_or("UTC", |(name, _)| name)
    }

    fn library(self) -> TimeScale {
        match self {
            Self::Utc => TimeScale::UTC,
            Self::Tai => TimeScale::TAI,
            Self::Gps => TimeScale::GPST,
            Self::Tt => TimeScale::TT,
        }
    }
}

/// Earth rotation in turns at 2000 January 1.5, and its rate in turns per day.
const TURNS: [f64; 2] = [0.779_057_273_264_0, 1.002_737_811_911_354_5];
/// Rate of the Earth rotation angle, rad/s.
pub(crate) const EARTH_RATE: f64 = TURNS[1] * TAU / DAY as f64;

/// Origin of the times of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Attoseconds of TAI since 1900 if the scale is known, otherwise of the files' own count.
    pub(crate) at: i128,
    /// Attoseconds of the first file's own count there; zero where it has dates.
    pub(crate) count: i128,
    /// Scale of the files' dates; `None` if they count seconds from an unknown epoch.
    pub(crate) scale: Option<Scale>,
}

impl Origin {
    /// Zero of the files' own count.
    pub(crate) const OWN: Self = Self {
        at: 0,
        count: 0,
        scale: None,
    };

    /// The instant of a date and time of day in a named scale, in the format of [`Self::date`].
    pub fn of_date(date: &str, scale: &str) -> Option<Self> {
        let (_, scale) = Scale::ALL.into_iter().find(|(name, _)| *name == scale)?;
        let at = Calendar::new(scale).instant(date.as_bytes(), false).ok()?;
        let scale = Some(scale);
        Some(Self {
            at,
            count: 0,
            scale,
        })
    }

    /// Seconds from this instant to `other`.
    pub fn until(&self, other: &Self) -> f64 {
        self.seconds_to(other.at)
    }

    /// Seconds from the origin to an instant, correctly rounded.
    pub(crate) fn seconds_to(&self, at: i128) -> f64 {
        let count = at - self.at;
        // A double holds this many nanoseconds exactly, and rounds the quotient of two such numbers correctly.
        const EXACT: i128 = ATTO_OF_NANO << f64::MANTISSA_DIGITS;
        if count.abs() <= EXACT && count % ATTO_OF_NANO == 0 {
            return (count / ATTO_OF_NANO) as f64 / 1e9;
        }
        format!("{count}e-18").parse().unwrap_or(f64::NAN)
    }

    /// Offset from a time of the table to the file's own count, s; zero for dates.
    pub fn own_zero_s(&self) -> f64 {
        match self.scale {
            Some(_) => 0.0,
            None => Self::OWN.seconds_to(self.at),
        }
    }

    /// A time in seconds of the files' own count, for example Unix seconds, as seconds since the origin; files with
    /// dates count from the origin.
    ///
    /// ```
    /// let dates = poinsot_telemetry::Origin::of_date("2026-03-14T18:19:18", "UTC");
    /// assert_eq!(dates.map(|origin| origin.since_origin_s(12.5)), Some(12.5));
    /// ```
    pub fn since_origin_s(&self, own_s: f64) -> f64 {
        own_s - self.count as f64 / ATTO as f64
    }

    /// Date, time and scale; `None` if unknown.
    pub fn date(&self) -> Option<String> {
        let scale = self.scale?;
        let (year, month, day, h, m, s, nanos) = epoch(self.at).to_gregorian(scale.library());
        let fraction = format!(".{nanos:09}");
        let fraction = fraction.trim_end_matches('0').trim_end_matches('.');
        let text = format!("{year:04}-{month:02}-{day:02}T{h:02}:{m:02}:{s:02}{fraction}");
        Some(format!("{text} {}", scale.name()))
    }

    /// Earth rotation angle, rad, `later_s` seconds after the origin (IERS Conventions 2010, eq. 5.15). UTC is used
    /// for UT1.
    pub(crate) fn earth_rotation(&self, later_s: f64) -> f64 {
        let days = epoch(self.at).to_jde_utc_days() - 2_451_545.0 + later_s / DAY as f64;
        // Whole days are whole turns of the integer part of the rate.
        let turns = TURNS[0] + days.fract() + (TURNS[1] - 1.0) * days;
        turns.fract() * TAU
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.date() {
            Some(date) => f.write_str(&date),
            None => write!(
                f,
                "{} s of the files' own count",
                poinsot_files::as_read(self.own_zero_s())
            ),
        }
    }
}

fn epoch(at: i128) -> Epoch {
    Epoch::from_tai_duration(Duration::from_total_nanoseconds(
        at.div_euclid(ATTO_OF_NANO),
    ))
}

/// Days since 1970 January 1 (Howard Hinnant, `days_from_civil`).
fn day_number(year: i64, month: i64, day: i64) -> i64 {
    let year = year - i64::from(month <= 2);
    let era = year.div_euclid(400);
    let of_era = year.rem_euclid(400);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// Midnights of a scale; the last one is cached because most rows are on one day.
#[derive(Debug, Clone)]
pub(crate) struct Calendar {
    scale: Scale,
    last: Option<(i64, i128)>,
}

const NO_DATE: InvalidNumber = InvalidNumber(
    "is not a date and time",
    Some("write for example 2026-03-14T18:19:00.25"),
);

pub(crate) const NO_YEAR: InvalidNumber = InvalidNumber(
    "is no time between 1972 and 2199",
    Some("correct the unit or the epoch in [telemetry] time"),
);

/// Whether an instant is in the years of the calendar.
pub(crate) fn in_years(at: i128) -> bool {
    let begin = |year| {
        let days = day_number(year, 1, 1) - day_number(1900, 1, 1);
        i128::from(days * DAY) * ATTO
    };
    (begin(*YEARS.start())..begin(YEARS.end() + 1)).contains(&at)
}

impl Calendar {
    pub(crate) fn new(scale: Scale) -> Self {
        Self { scale, last: None }
    }

    pub(crate) fn scale(&self) -> Scale {
        self.scale
    }

    /// The instant at which a day starts.
    fn midnight(&mut self, day: i64) -> Option<i128> {
        if let Some((_, at)) = self.last.filter(|(known, _)| *known == day) {
            return Some(at);
        }
        let (first, last) = (YEARS.start(), YEARS.end() + 1);
        if !(day_number(*first, 1, 1)..day_number(last, 1, 1)).contains(&day) {
            return None;
        }
        let scale = self.scale.library();
        let first = Epoch::from_gregorian_at_midnight(1970, 1, 1, scale);
        let begin = Epoch::from_duration(first.duration + Unit::Day * day, scale);
        let at = begin.to_tai_duration().total_nanoseconds() * 1_000_000_000;
        self.last = Some((day, at));
        Some(at)
    }

    /// The instant of a Unix time, in which every day has 86,400 s.
    pub(crate) fn unix(&mut self, atto: i128) -> Result<i128, InvalidNumber> {
        let day = atto.div_euclid(ATTO * i128::from(DAY));
        let rest = atto.rem_euclid(ATTO * i128::from(DAY));
        let midnight = i64::try_from(day).ok().and_then(|day| self.midnight(day));
        midnight.map(|at| at + rest).ok_or(NO_YEAR)
    }

    /// The instant of a text: date, `T` or blank, time of day, and optional zone.
    pub(crate) fn instant(&mut self, text: &[u8], ordinal: bool) -> Result<i128, InvalidNumber> {
        let mut rest = text;
        let year = digits(&mut rest, 4)?;
        one_of(&mut rest, b"-/:")?;
        let day = if ordinal {
            let of_year = digits(&mut rest, 3)?;
            let whole = day_number(year + 1, 1, 1) - day_number(year, 1, 1);
            if !(1..=whole).contains(&of_year) {
                return Err(InvalidNumber(
                    "has no such day of the year",
                    Some("correct it"),
                ));
            }
            day_number(year, 1, 1) + of_year - 1
        } else {
            let month = digits(&mut rest, 2)?;
            one_of(&mut rest, b"-/:")?;
            let of_month = digits(&mut rest, 2)?;
            if !is_gregorian_valid(year as i32, month as u8, of_month as u8, 0, 0, 0, 0) {
                return Err(InvalidNumber(
                    "has no such day of the month",
                    Some("correct it"),
                ));
            }
            day_number(year, month, of_month)
        };
        if !YEARS.contains(&year) {
            return Err(NO_YEAR);
        }
        one_of(&mut rest, b"T t:/")?;
        let hour = digits(&mut rest, 2)?;
        one_of(&mut rest, b":")?;
        let minute = digits(&mut rest, 2)?;
        one_of(&mut rest, b":")?;
        let second = digits(&mut rest, 2)?;
        let fraction = fraction(&mut rest);
        let zone_minutes = zone(rest)?;
        if hour > 23 || minute > 59 || second > 60 {
            return Err(InvalidNumber("has no such time of day", Some("correct it")));
        }
        if zone_minutes != 0 && self.scale != Scale::Utc {
            return Err(InvalidNumber(
                "has a zone, and only UTC has zones",
                Some("leave the zone out, or write scale = \"UTC\" in [telemetry] time"),
            ));
        }
        let shifted = hour * 3600 + minute * 60 + second - 60 * zone_minutes;
        let (mut day, mut of_day) = (day + shifted.div_euclid(DAY), shifted.rem_euclid(DAY));
        if second == 60 {
            // The leap second is the last second of a UTC day.
            (day, of_day) = (day - 1, of_day + DAY);
            let lasts = self.midnight(day).zip(self.midnight(day + 1));
            let leap = i128::from(DAY + 1) * ATTO;
            if of_day != DAY || lasts.is_none_or(|(a, b)| b - a != leap) {
                return Err(InvalidNumber(
                    "has second 60, and there is no leap second then",
                    Some("correct the time"),
                ));
            }
        }
        let midnight = self.midnight(day).ok_or(NO_DATE)?;
        Ok(midnight + i128::from(of_day) * ATTO + fraction)
    }
}

/// Parses `n` digits at the start of the text.
fn digits(text: &mut &[u8], n: usize) -> Result<i64, InvalidNumber> {
    let (head, rest) = text.split_at_checked(n).ok_or(NO_DATE)?;
    *text = rest;
    head.iter().try_fold(0, |sum, byte| match byte {
        b'0'..=b'9' => Ok(10 * sum + i64::from(byte - b'0')),
        _ => Err(NO_DATE),
    })
}

fn one_of(text: &mut &[u8], separators: &[u8]) -> Result<(), InvalidNumber> {
    let (first, rest) = text.split_first().ok_or(NO_DATE)?;
    *text = rest;
    separators.contains(first).then_some(()).ok_or(NO_DATE)
}

/// Attoseconds after a point or comma; zero if absent.
fn fraction(text: &mut &[u8]) -> i128 {
    let Some((b'.' | b',', mut rest)) = text.split_first() else {
        return 0;
    };
    let (mut sum, mut unit) = (0, ATTO);
    while let Some((byte @ b'0'..=b'9', after)) = rest.split_first() {
        unit /= 10;
        sum += unit * i128::from(byte - b'0');
        rest = after;
    }
    *text = rest;
    sum
}

/// Minutes east of UTC: `Z`, empty, `+01:00`, `+0100`, `+01`.
fn zone(text: &[u8]) -> Result<i64, InvalidNumber> {
    let (sign, mut rest) = match text.split_first() {
        None | Some((b'Z' | b'z', [])) => return Ok(0),
        Some((b'+', rest)) => (1, rest),
        Some((b'-', rest)) => (-1, rest),
        _ => return Err(NO_DATE),
    };
    let hours = digits(&mut rest, 2)?;
    let minutes = match rest {
        [] => 0,
        _ => {
            rest = rest.strip_prefix(b":").unwrap_or(rest);
            digits(&mut rest, 2)?
        }
    };
    match rest {
        [] if hours < 24 && minutes < 60 => Ok(sign * (60 * hours + minutes)),
        _ => Err(NO_DATE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(scale: Scale, text: &str) -> i128 {
        Calendar::new(scale)
            .instant(text.as_bytes(), false)
            .unwrap()
    }

    #[test]
    fn exact_one_instant_in_every_scale_and_zone() {
        // GPS - UTC = 18 s, TAI - UTC = 37 s, TT - UTC = 69.184 s in 2026 (IERS Bulletin C).
        let utc = at(Scale::Utc, "2026-03-14T18:19:00.25Z");
        for (scale, text) in [
            (Scale::Utc, "2026-03-14 18:19:00.250"),
            (Scale::Utc, "2026-03-15T03:49:00.25+09:30"),
            (Scale::Utc, "2026/03/14T16:19:00.25-0200"),
            (Scale::Gps, "2026-03-14T18:19:18.25"),
            (Scale::Tai, "2026-03-14T18:19:37.25"),
            (Scale::Tt, "2026-03-14T18:20:09.434"),
        ] {
            assert_eq!(at(scale, text), utc, "{text}");
        }
        let ordinal = Calendar::new(Scale::Utc).instant(b"2026:073:18:19:00.25", true);
        assert_eq!(ordinal, Ok(utc));
        let unix = Calendar::new(Scale::Utc).unix(1_773_512_340 * ATTO + ATTO / 4);
        assert_eq!(unix, Ok(utc));
        let origin = Origin {
            at: utc,
            count: 0,
            scale: Some(Scale::Gps),
        };
        assert_eq!(origin.to_string(), "2026-03-14T18:19:18.25 GPS");
    }

    #[test]
    fn exact_the_leap_second_of_2016_is_one_second() {
        let second = |text| at(Scale::Utc, text);
        let before = second("2016-12-31T23:59:59");
        assert_eq!(second("2016-12-31T23:59:60") - before, ATTO);
        assert_eq!(second("2017-01-01T00:00:00") - before, 2 * ATTO);
        assert_eq!(second("2017-01-01T08:59:60.5+09:00") - before, 3 * ATTO / 2);
        for text in ["2026-03-14T23:59:60", "2016-12-31T22:59:60"] {
            let refused = Calendar::new(Scale::Utc).instant(text.as_bytes(), false);
            let why = refused.unwrap_err().0;
            assert!(why.contains("no leap second"), "{why}");
        }
    }

    #[test]
    fn exact_seconds_since_an_origin_are_the_nearest_doubles() {
        let origin = Origin {
            at: 1_773_512_340 * ATTO,
            count: 1_773_512_340 * ATTO,
            scale: None,
        };
        assert_eq!(origin.since_origin_s(1_773_512_342.5), 2.5);
        assert_eq!(origin.seconds_to(1_773_512_340 * ATTO + ATTO / 5), 0.2);
        assert_eq!(origin.own_zero_s(), 1_773_512_340.0);
    }

    /// The text is read by the standard library, correctly rounded.
    #[test]
    fn exact_seconds_are_those_of_the_decimal_text() {
        const EXACT: i128 = ATTO_OF_NANO << 53;
        for count in [
            0,
            1,
            ATTO_OF_NANO,
            ATTO_OF_NANO + 1,
            123_456_789 * ATTO,
            EXACT,
        ] {
            for count in (-3..=3).flat_map(|k| [count + k, count + k * ATTO_OF_NANO]) {
                for count in [count, -count] {
                    let text = format!("{count}e-18").parse();
                    assert_eq!(text, Ok(Origin::OWN.seconds_to(count)), "{count}");
                }
            }
        }
    }

    #[test]
    fn exact_earth_rotation_at_a_known_instant() {
        // SOFA, iauEra00: ERA(JD 2454388.5) = 0.4022837240028158102 rad; 2007 October 15, 0 h.
        let origin = Origin {
            at: at(Scale::Utc, "2007-10-15T00:00:00"),
            count: 0,
            scale: Some(Scale::Utc),
        };
        assert!((origin.earth_rotation(0.0) - 0.402_283_724_002_815_8).abs() < 1e-9);
        let sidereal_day_s = 86_164.098_903_691;
        let turn = origin.earth_rotation(sidereal_day_s) - origin.earth_rotation(0.0);
        assert!(turn.abs() < 1e-9, "{turn}");
    }

    #[test]
    fn unit_what_is_no_date() {
        for text in [
            "",
            "2026",
            "14/03/2026 18:19:00",
            "2026-02-29T00:00:00",
            "2026-03-14T24:00:00",
            "2026-03-14T18:19",
            "1026-03-14T18:19:00",
        ] {
            let read = Calendar::new(Scale::Utc).instant(text.as_bytes(), false);
            assert!(read.is_err(), "{text}");
        }
        let read = Calendar::new(Scale::Gps).instant(b"2026-03-14T18:19:00+01:00", false);
        assert!(read.is_err());
    }
}
