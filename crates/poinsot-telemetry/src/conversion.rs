//! Conversion of a cell to SI.

use crate::number::{self, Cell, InvalidNumber};
use crate::{ColumnMap, Unit};
use std::f64::consts::TAU;

/// Rule that converts a cell to SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Conversion {
    /// A number in a unit.
    Unit(Unit),
    /// `factor * x + offset`, the factor and the offset in SI.
    Linear(f64, f64),
    /// A flag, and the value if it is on.
    Flag(f64),
    /// Duration of a pulse of this force, in a unit.
    Pulse(Unit, f64),
}

impl Conversion {
    /// The conversion declared in a column map.
    pub(crate) fn of(map: &ColumnMap, unit: Option<Unit>) -> Self {
        if let Some(force) = map.nominal_N {
            return unit.map_or(Self::Flag(force), |unit| Self::Pulse(unit, force));
        }
        let sign = map.sign.unwrap_or(1.0);
        let scale = map.scale.unwrap_or(1.0);
        let offset = map.offset.unwrap_or(0.0);
        match (unit, map.counts_per_revolution) {
            (_, Some(counts)) => {
                Self::Linear(sign * scale * TAU / counts, sign * offset * TAU / counts)
            }
            (Some(unit), None) if sign == 1.0 && scale == 1.0 && offset == 0.0 => Self::Unit(unit),
            (Some(unit), None) => Self::Linear(unit.to_si(sign * scale), unit.to_si(sign * offset)),
            (None, None) => Self::Linear(sign * scale, sign * offset),
        }
    }

    /// Parses and converts the text of a cell.
    pub(crate) fn cell(&self, text: &[u8]) -> Result<Cell, InvalidNumber> {
        match self {
            Self::Flag(force) => Ok(match number::flag(text)? {
                Some(on) => Cell::Number(if on { *force } else { 0.0 }),
                None => Cell::Empty,
            }),
            _ => number::parse(text).map(|cell| self.number(cell)),
        }
    }

    /// Converts a parsed cell.
    pub(crate) fn number(&self, cell: Cell) -> Cell {
        let Cell::Number(x) = cell else { return cell };
        Cell::Number(match self {
            Self::Unit(unit) | Self::Pulse(unit, _) => unit.to_si(x),
            Self::Linear(factor, offset) => factor * x + offset,
            Self::Flag(force) => force * x,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_unit;

    #[test]
    fn exact_sign_scale_and_offset() {
        let map = ColumnMap {
            sign: Some(-1.0),
            scale: Some(2.0),
            offset: Some(0.5),
            ..ColumnMap::default()
        };
        let degrees = Conversion::of(&map, parse_unit("deg").ok());
        // -(2 * 3 + 0.5) deg.
        let Ok(Cell::Number(angle)) = degrees.cell(b"3") else {
            panic!()
        };
        assert!((angle + 6.5_f64.to_radians()).abs() < 1e-15);
        let encoder = ColumnMap {
            counts_per_revolution: Some(4096.0),
            ..ColumnMap::default()
        };
        assert_eq!(
            Conversion::of(&encoder, None).cell(b"1024"),
            Ok(Cell::Number(TAU / 4.0))
        );
    }

    #[test]
    fn exact_flags_are_the_nominal_force() {
        let map = ColumnMap {
            nominal_N: Some(0.9),
            ..ColumnMap::default()
        };
        let flag = Conversion::of(&map, None);
        for (text, force) in [("1", 0.9), ("ON", 0.9), ("0", 0.0), ("closed", 0.0)] {
            assert_eq!(
                flag.cell(text.as_bytes()),
                Ok(Cell::Number(force)),
                "{text}"
            );
        }
        assert_eq!(flag.cell(b""), Ok(Cell::Empty));
        assert!(flag.cell(b"0.37").is_err());
    }
}
