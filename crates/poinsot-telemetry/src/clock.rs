//! Converts the time of a row to seconds since the origin of the segment.

use crate::error::{Refused, refuse};
use crate::instant::{ATTO, Calendar, NO_YEAR, in_years};
use crate::number::{self, Cell, InvalidNumber, RawCell};
use crate::{Dimension, Origin, Scale, TimeFormat, TimeMap, Unit, parse_unit};

/// Larger times count from the origin of the segment; at this value a double resolves 2e-9 s.
pub(crate) const COUNTED_S: f64 = 1e7;
/// Seconds of a week.
const WEEK_S: i128 = 604_800;

/// Epoch of numeric times.
#[derive(Debug, Clone, PartialEq)]
enum TimeOrigin {
    /// An unknown epoch.
    Own,
    /// 1970 January 1, with 86,400 s to every day.
    Unix,
    /// A given instant.
    At(i128),
}

/// Converts the times of one file.
#[derive(Debug, Clone)]
pub(crate) struct Clock {
    format: TimeFormat,
    pub(crate) unit: Unit,
    since: TimeOrigin,
    calendar: Calendar,
    /// Common origin of all files, set by the first row.
    pub(crate) origin: Option<Origin>,
}

/// The clock described by a map; otherwise the faulty key.
pub(crate) fn check_time(map: &TimeMap) -> Result<Clock, Refused> {
    let scale = map.scale;
    let counts = map.format == TimeFormat::Number;
    let unit = map.unit.as_deref().unwrap_or("s");
    let unit = match parse_unit(unit) {
        Ok(unit) if unit.dimension == Dimension::Time => unit,
        _ => {
            let remedy = format!("use one of: {}", crate::unit::list(Dimension::Time));
            return refuse("unit", format!("unit '{unit}' is not a time"), remedy);
        }
    };
    let weeks = map.format == TimeFormat::GpsWeek;
    if map.week.is_some() != weeks {
        let problem = "a column of weeks and the format \"gps_week\" belong together";
        return refuse("week", problem, "write both, or neither");
    }
    if (map.unit.is_some() && !counts && !weeks) || (map.epoch.is_some() && !counts) {
        let key = if map.epoch.is_some() { "epoch" } else { "unit" };
        let remedy = "remove it, or write format = \"number\"";
        return refuse(key, "a date has no unit and no epoch", remedy);
    }
    if scale.is_some() && ((counts && map.epoch.is_none()) || weeks) {
        let problem = match weeks {
            true => "GPS weeks are in GPS time",
            false => "numbers without an epoch have no scale",
        };
        return refuse("scale", problem, "remove it, or add epoch");
    }
    let mut calendar = Calendar::new(scale.unwrap_or(Scale::Utc));
    let since = match map.epoch.as_deref() {
        None => TimeOrigin::Own,
        Some("unix") if scale.is_none_or(|s| s == Scale::Utc) => TimeOrigin::Unix,
        Some("gps") if scale.is_none_or(|s| s == Scale::Gps) => {
            calendar = Calendar::new(Scale::Gps);
            TimeOrigin::At(gps_epoch())
        }
        Some("unix" | "gps") => {
            let problem = "\"unix\" counts in UTC, \"gps\" in GPS time";
            return refuse("scale", problem, "remove the scale");
        }
        Some(date) => match calendar.instant(date.as_bytes(), false) {
            Ok(at) => TimeOrigin::At(at),
            Err(why) => {
                let remedy = "use \"unix\", \"gps\", or a date and time";
                return refuse("epoch", format!("the epoch {}", why.0), remedy);
            }
        },
    };
    if weeks {
        calendar = Calendar::new(Scale::Gps);
    }
    Ok(Clock {
        format: map.format,
        since,
        calendar,
        ..Clock::own(unit)
    })
}

/// 1980 January 6, 0 h GPS time, which is 19 s behind TAI.
fn gps_epoch() -> i128 {
    let epoch = Calendar::new(Scale::Gps).instant(b"1980-01-06T00:00:00", false);
    epoch.unwrap_or_default()
}

impl Clock {
    /// The clock for numbers with an unknown epoch.
    pub(crate) fn own(unit: Unit) -> Self {
        Self {
            format: TimeFormat::Number,
            unit,
            since: TimeOrigin::Own,
            calendar: Calendar::new(Scale::Utc),
            origin: None,
        }
    }

    /// The clock for a column of timestamps, converted to seconds since 1970 UTC.
    #[cfg(feature = "parquet")]
    pub(crate) fn instants(self) -> Self {
        let Ok(mut unix) = check_time(&TimeMap {
            epoch: Some("unix".to_owned()),
            ..TimeMap::default()
        }) else {
            return self;
        };
        unix.origin = self.origin;
        unix
    }

    /// Time of the row, s since the origin, which the first row sets.
    pub(crate) fn seconds(
        &mut self,
        cell: RawCell,
        week: Option<RawCell>,
    ) -> Result<Cell, InvalidNumber> {
        let cell = cell.trimmed();
        if let RawCell::Empty = cell {
            return Ok(Cell::Empty);
        }
        if self.format == TimeFormat::Number && self.since == TimeOrigin::Own {
            return self.own_seconds(cell);
        }
        let mut counted = 0;
        let at = match self.format {
            TimeFormat::Number => {
                counted = self.count(cell)?;
                match self.since {
                    TimeOrigin::Unix => self.calendar.unix(counted)?,
                    TimeOrigin::At(epoch) => epoch + counted,
                    TimeOrigin::Own => counted,
                }
            }
            TimeFormat::GpsWeek => {
                let week = week.unwrap_or(RawCell::Empty).trimmed().decimal();
                let week = week.filter(|w| w % ATTO == 0 && (0..100_000 * ATTO).contains(w));
                let week = week.ok_or(InvalidNumber(
                    "has a GPS week that is not a whole number",
                    Some("correct the row"),
                ))?;
                counted = week * WEEK_S + self.count(cell)?;
                gps_epoch() + counted
            }
            TimeFormat::Iso8601 => self.calendar.instant(&cell.text(), false)?,
            TimeFormat::DayOfYear => self.calendar.instant(&cell.text(), true)?,
        };
        if !in_years(at) {
            return Err(NO_YEAR);
        }
        let scale = Some(self.calendar.scale());
        let origin = *self.origin.get_or_insert(Origin {
            at,
            count: counted,
            scale,
        });
        if origin.scale.is_none() {
            return Err(InvalidNumber(
                "is a date, and files before it count from an unknown epoch",
                Some("name their epoch in [telemetry] time"),
            ));
        }
        Ok(Cell::Number(origin.seconds_to(at)))
    }

    /// Seconds of a small number with an unknown epoch; `None` if its decimals matter.
    fn small(&mut self, number: f64) -> Option<f64> {
        let seconds = self.unit.to_si(number);
        let own = self.origin.is_none_or(|o| o == Origin::OWN);
        if !own || seconds.is_nan() || seconds.abs() >= COUNTED_S {
            return None;
        }
        self.origin = Some(Origin::OWN);
        Some(seconds)
    }

    /// Number with an unknown epoch; a small number is kept unchanged.
    fn own_seconds(&mut self, cell: RawCell) -> Result<Cell, InvalidNumber> {
        if let Some(seconds) = cell.number().and_then(|x| self.small(x)) {
            return Ok(Cell::Number(seconds));
        }
        let plain = number::parse(&cell.text())?;
        let Cell::Number(x) = plain else {
            return Ok(plain);
        };
        let seconds = self.unit.to_si(x);
        let origin = match self.origin {
            Some(origin) => origin,
            None if seconds.abs() < COUNTED_S => Origin::OWN,
            None => {
                let at = self.count(cell).unwrap_or_default();
                Origin {
                    at,
                    count: at,
                    scale: None,
                }
            }
        };
        self.origin = Some(origin);
        if origin.scale.is_some() {
            return Err(InvalidNumber(
                "counts from an unknown epoch, and files before it have dates",
                Some("name its epoch in [telemetry] time"),
            ));
        }
        if origin == Origin::OWN {
            return Ok(Cell::Number(seconds));
        }
        match self.count(cell) {
            Ok(at) => Ok(Cell::Number(origin.seconds_to(at))),
            Err(_) => Ok(Cell::Number(seconds - origin.own_zero_s())),
        }
    }

    /// Attoseconds of a number in the unit of the column.
    fn count(&self, cell: RawCell) -> Result<i128, InvalidNumber> {
        if !matches!(cell, RawCell::Parts(..)) {
            number::parse(&cell.text())?;
        }
        let (factor, divisor) = (self.unit.factor as i128, self.unit.divisor as i128);
        let exact = cell.decimal().and_then(|x| x.checked_mul(factor));
        exact.map(|x| x / divisor).ok_or(InvalidNumber(
            "is too large for a time",
            Some("correct the number or its unit"),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(cell: &str) -> RawCell<'_> {
        RawCell::Text(cell.as_bytes())
    }

    fn seconds(map: &TimeMap, cells: &[&str]) -> Vec<f64> {
        let mut clock = check_time(map).unwrap();
        let mut of = |cell: &&str| match clock.seconds(text(cell), Some(text("2409"))) {
            Ok(Cell::Number(x)) => x,
            other => panic!("{cell}: {other:?}"),
        };
        cells.iter().map(&mut of).collect()
    }

    #[test]
    fn regress_years_that_no_record_has_are_refused() {
        for (epoch, time, fits) in [
            ("gps", "1.4e9", true),
            // The year 11, and milliseconds read as seconds: the year 58,000.
            ("gps", "-6.2e10", false),
            ("gps", "1.77e12", false),
            ("2026-03-14T00:00:00", "100", true),
            ("2026-03-14T00:00:00", "-6.213e10", false),
            ("2026-03-14T00:00:00", "1.77e12", false),
            ("unix", "1.77e12", false),
        ] {
            let map = TimeMap {
                epoch: Some(epoch.to_owned()),
                ..TimeMap::default()
            };
            let read = check_time(&map).unwrap().seconds(text(time), None);
            assert_eq!(read.is_ok(), fits, "{epoch} {time}: {read:?}");
        }
    }

    #[test]
    fn exact_the_same_times_in_every_form() {
        let map = |format, unit: &str, epoch: &str| TimeMap {
            format,
            unit: Some(unit.to_owned()).filter(|u| !u.is_empty()),
            epoch: Some(epoch.to_owned()).filter(|e| !e.is_empty()),
            week: (format == TimeFormat::GpsWeek).then(|| "week".to_owned()),
            ..TimeMap::default()
        };
        let wanted = [0.0, 0.2, 0.4, 1.000_000_001];
        use TimeFormat::*;
        for (map, cells) in [
            (map(Number, "s", ""), ["0", "0.2", "0.4", "1.000000001"]),
            (
                map(Number, "s", ""),
                [
                    "1773512340.1",
                    "1773512340.3",
                    "1773512340.5",
                    "1.773512341100000001e9",
                ],
            ),
            (
                map(Number, "s", "unix"),
                [
                    "1773512340.1",
                    "1773512340.3",
                    "1773512340.5",
                    "1773512341.100000001",
                ],
            ),
            (
                map(Number, "ns", "unix"),
                [
                    "1773512340100000000",
                    "1773512340300000000",
                    "1773512340500000000",
                    "1773512341100000001",
                ],
            ),
            (
                map(Number, "ms", "gps"),
                [
                    "1457547558100",
                    "1457547558300",
                    "1457547558500",
                    "1457547559100.000001",
                ],
            ),
            (
                map(GpsWeek, "s", ""),
                ["584358.1", "584358.3", "584358.5", "584359.100000001"],
            ),
            (
                map(Iso8601, "", ""),
                [
                    "2026-03-14T18:19:00.1",
                    "2026-03-14T18:19:00.3Z",
                    "2026-03-14T18:19:00.5",
                    "2026-03-14T18:19:01.100000001",
                ],
            ),
            (
                map(DayOfYear, "", ""),
                [
                    "2026-073T18:19:00.1",
                    "2026-073T18:19:00.3",
                    "2026-073T18:19:00.5",
                    "2026-073T18:19:01.100000001",
                ],
            ),
        ] {
            assert_eq!(seconds(&map, &cells), wanted, "{map:?}");
        }
    }

    #[test]
    fn unit_dates_and_counts_do_not_mix() {
        let mut clock = Clock::own(parse_unit("s").unwrap());
        clock.origin = Some(Origin {
            at: 0,
            count: 0,
            scale: Some(Scale::Utc),
        });
        assert!(
            clock
                .seconds(text("1.0"), None)
                .unwrap_err()
                .1
                .is_some_and(|advice| advice.contains("name its epoch"))
        );
        let wrong = TimeMap {
            epoch: Some("tomorrow".into()),
            ..TimeMap::default()
        };
        assert_eq!(check_time(&wrong).unwrap_err().key, "epoch");
    }
}
