//! Conversion of a cell to SI.

use crate::number::{self, Cell, InvalidNumber};
use crate::{ColumnMap, Overlap, Unit};
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

    /// Size of a step of the column, SI.
    pub(crate) fn size(&self, step: f64) -> f64 {
        match self {
            Self::Unit(unit) | Self::Pulse(unit, _) => unit.to_si(step).abs(),
            Self::Linear(factor, _) | Self::Flag(factor) => (factor * step).abs(),
        }
    }

    /// The force of a flag's text; `None` where it is no flag.
    fn flag(&self, text: &[u8]) -> Option<Result<Cell, InvalidNumber>> {
        let Self::Flag(force) = self else { return None };
        let force = |on| if on { *force } else { 0.0 };
        let cell = |on: Option<bool>| on.map_or(Cell::Empty, |on| Cell::Number(force(on)));
        Some(number::flag(text).map(cell))
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

/// From the cells of a column to samples in SI.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Transform {
    pub conversion: Conversion,
    /// Cells without a sample, as text and as a number.
    invalid: Vec<(String, Option<f64>)>,
    signed_range: Option<f64>,
    /// Where the samples begin anew, SI.
    pub wraps_at: Option<f64>,
    pub increments: bool,
    /// How late the times of the samples are, s.
    pub late_s: f64,
    /// How late thrust begins and ends, s.
    pub valve_late_s: [f64; 2],
    pub overlap: Option<Overlap>,
}

impl From<Conversion> for Transform {
    fn from(conversion: Conversion) -> Self {
        Self::of(&ColumnMap::default(), conversion)
    }
}

impl Transform {
    /// What a map declares of a column beside its conversion.
    pub fn of(map: &ColumnMap, conversion: Conversion) -> Self {
        let invalid = map.invalid.iter();
        Self {
            conversion,
            invalid: invalid.map(|t| (t.clone(), t.parse().ok())).collect(),
            signed_range: map.signed_range,
            wraps_at: map.wraps_at.map(|step| conversion.size(step)),
            increments: map.increments,
            late_s: map.late_s.unwrap_or(0.0),
            valve_late_s: [map.opens_late_s, map.closes_late_s].map(|s| s.unwrap_or(0.0)),
            overlap: map.overlap,
        }
    }

    /// Parses and converts the text of a cell.
    pub fn cell(&self, text: &[u8]) -> Result<Cell, InvalidNumber> {
        let is_text = |(own, _): &(String, _)| own.as_bytes() == text.trim_ascii();
        if self.invalid.iter().any(is_text) {
            return Ok(Cell::Empty);
        }
        let flag = self.conversion.flag(text);
        flag.unwrap_or_else(|| number::parse(text).map(|cell| self.number(cell)))
    }

    /// Converts a parsed cell.
    pub fn number(&self, cell: Cell) -> Cell {
        let Cell::Number(x) = cell else { return cell };
        if self.invalid.iter().any(|(_, own)| *own == Some(x)) {
            return Cell::Empty;
        }
        let own = match self.signed_range {
            Some(range) if x >= 0.5 * range => x - range,
            _ => x,
        };
        self.conversion.number(Cell::Number(own))
    }

    /// Continues samples across the places where they begin anew.
    pub fn continue_across_jumps(&self, values: &mut [f64]) {
        let Some(period) = self.wraps_at else { return };
        let mut before = f64::NAN;
        for x in values.iter_mut().filter(|x| !x.is_nan()) {
            let turns = ((*x - before) / period).round();
            if turns.abs() >= 1.0 {
                *x -= turns * period;
            }
            before = *x;
        }
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
        let Ok(Cell::Number(angle)) = Transform::from(degrees).cell(b"3") else {
            panic!()
        };
        assert!((angle + 6.5_f64.to_radians()).abs() < 1e-15);
        let encoder = ColumnMap {
            counts_per_revolution: Some(4096.0),
            ..ColumnMap::default()
        };
        assert_eq!(
            Transform::from(Conversion::of(&encoder, None)).cell(b"1024"),
            Ok(Cell::Number(TAU / 4.0))
        );
    }

    #[test]
    fn exact_flags_are_the_nominal_force() {
        let map = ColumnMap {
            nominal_N: Some(0.9),
            ..ColumnMap::default()
        };
        let flag = Transform::from(Conversion::of(&map, None));
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
