//! The command `units`: units of a telemetry map.

use poinsot_formats::{UNITS, UnitFile, UnitsFile};
use poinsot_telemetry::units;

/// All units as a file.
///
/// ```
/// let units = poinsot::units_file().units;
/// assert!(units.iter().any(|unit| unit.symbol == "deg/s" && unit.si == "rad/s"));
/// ```
pub fn units_file() -> UnitsFile {
    let unit = |u: poinsot_telemetry::Unit| UnitFile {
        symbol: u.symbol.to_owned(),
        dimension: u.dimension.words().replace(' ', "_"),
        factor: u.factor,
        divisor: u.divisor,
        si: u.dimension.si().to_owned(),
    };
    UnitsFile {
        schema: UNITS.to_owned(),
        units: units().map(unit).collect(),
    }
}
