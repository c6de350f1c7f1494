//! Parses one cell of text to a number; errors name common mistakes.

use crate::error::{number, shown};
use poinsot_files::{Faults, Place};
use std::borrow::Cow;

/// Units of a decimal number in one.
const UNITS: i128 = 1_000_000_000_000_000_000;

/// Content of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// No sample.
    Empty,
    /// The text NaN: no sample.
    NotANumber,
}

impl Cell {
    /// The number, if there is one.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(x),
            Self::Empty | Self::NotANumber => None,
        }
    }

    /// The number; NaN for no sample.
    pub fn or_nan(self) -> f64 {
        self.value().unwrap_or(f64::NAN)
    }
}

/// A cell as its source stores it: text, or already a number.
#[derive(Debug, Clone, Copy)]
pub(crate) enum RawCell<'a> {
    Empty,
    Text(&'a [u8]),
    /// A number; NaN is an empty cell.
    Number(f64),
    /// A count of parts, so many to one: exact, where a double is not.
    Parts(i64, i64),
}

impl<'a> RawCell<'a> {
    /// The cell without blanks around it.
    pub fn trimmed(self) -> Self {
        match self {
            Self::Text(text) if text.trim_ascii().is_empty() => Self::Empty,
            Self::Text(text) => Self::Text(text.trim_ascii()),
            Self::Number(x) if x.is_nan() => Self::Empty,
            other => other,
        }
    }

    /// The nearest double of a number or a whole count.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(x),
            Self::Parts(count, 1) => Some(count as f64),
            _ => None,
        }
    }

    /// Text that reads back to the same number.
    pub fn text(self) -> Cow<'a, [u8]> {
        match self {
            Self::Empty => Cow::Borrowed(b""),
            Self::Text(text) => Cow::Borrowed(text),
            Self::Number(x) if x.is_nan() => Cow::Borrowed(b""),
            Self::Number(x) => Cow::Owned(x.to_string().into_bytes()),
            Self::Parts(count, 1) => Cow::Owned(count.to_string().into_bytes()),
            Self::Parts(count, of) => Cow::Owned(fraction(count, of).into_bytes()),
        }
    }

    /// The exact number in units of 1e-18; `None` if invalid or out of range.
    pub fn decimal(self) -> Option<i128> {
        match self {
            Self::Parts(count, of) => Some(i128::from(count) * (UNITS / i128::from(of))),
            other => decimal(&other.text()),
        }
    }
}

/// A count of parts as an exact decimal.
fn fraction(count: i64, of: i64) -> String {
    let sign = if count < 0 { "-" } else { "" };
    let (count, of) = (count.unsigned_abs(), of.unsigned_abs());
    let digits = of.ilog10() as usize;
    format!("{sign}{}.{:0digits$}", count / of, count % of)
}

/// Why a cell is not a number, and the remedy if known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InvalidNumber(pub &'static str, pub Option<&'static str>);

impl InvalidNumber {
    /// The fault of a cell. A time must not be empty, so other advice is given.
    pub(crate) fn fault(self, place: Place, cell: &[u8], is_time: bool) -> Faults {
        let Self(problem, advice) = self;
        let advice = advice.unwrap_or(match is_time {
            true => "write the time, or leave the row out",
            false => "write a number, or leave the cell empty where there is no sample",
        });
        number(place, shown(cell), problem, advice)
    }
}

/// Reads a cell. A finite text that overflows is an error, not infinity.
///
/// # Errors
/// The fault and its remedy.
pub(crate) fn parse(cell: &[u8]) -> Result<Cell, InvalidNumber> {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Ok(Cell::Empty);
    }
    if cell.eq_ignore_ascii_case(b"nan") {
        return Ok(Cell::NotANumber);
    }
    let parsed = std::str::from_utf8(cell).ok().map(str::parse::<f64>);
    match parsed {
        Some(Ok(x)) if x.is_finite() => Ok(Cell::Number(x)),
        Some(Ok(_)) if cell.iter().any(u8::is_ascii_digit) => Err(InvalidNumber(
            "is too large for a double",
            Some("correct the number"),
        )),
        Some(Ok(_)) => Err(InvalidNumber("is infinite", None)),
        _ => Err(cause(cell)),
    }
}

/// A number whose decimal comma is a point; other text as it is.
pub(crate) fn with_point(cell: &[u8], decimal_comma: bool) -> Cow<'_, [u8]> {
    let of_number = |b: &u8| b.is_ascii_digit() || b"+-.,eE \t".contains(b);
    match decimal_comma && cell.contains(&b',') && cell.iter().all(of_number) {
        true => Cow::Owned(
            cell.iter()
                .map(|b| if *b == b',' { b'.' } else { *b })
                .collect(),
        ),
        false => Cow::Borrowed(cell),
    }
}

/// A decimal number in units of 1e-18, truncated; `None` if invalid or out of range.
pub(crate) fn decimal(cell: &[u8]) -> Option<i128> {
    let text = std::str::from_utf8(cell).ok()?;
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let negative = mantissa.starts_with('-');
    let digits = mantissa.trim_start_matches(['+', '-']);
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let (mut sum, mut count) = (0_i128, 0);
    // Decimal places kept, down to 1e-18.
    let places = (18 + exponent).clamp(-40, 60);
    for byte in whole.bytes().chain(fraction.bytes()) {
        if !byte.is_ascii_digit() {
            return None;
        }
        if count < whole.len() as i32 + places {
            sum = sum.checked_mul(10)?.checked_add(i128::from(byte - b'0'))?;
            count += 1;
        }
    }
    let missing = whole.len() as i32 + places - count;
    if missing < 0 {
        return Some(0);
    }
    let scaled = sum.checked_mul(10_i128.checked_pow(u32::try_from(missing).ok()?)?)?;
    Some(if negative { -scaled } else { scaled })
}

pub(crate) fn flag(cell: &[u8]) -> Result<Option<bool>, InvalidNumber> {
    const ON: [&str; 5] = ["1", "on", "true", "open", "1.0"];
    const OFF: [&str; 5] = ["0", "off", "false", "closed", "0.0"];
    let cell = cell.trim_ascii();
    let is = |word: &&str| cell.eq_ignore_ascii_case(word.as_bytes());
    match (ON.iter().any(is), OFF.iter().any(is)) {
        _ if cell.is_empty() || is(&"nan") => Ok(None),
        (false, false) => Err(InvalidNumber(
            "is no flag",
            Some("write 0 or 1, or map the column with a unit in place of nominal_N"),
        )),
        (on, _) => Ok(Some(on)),
    }
}

/// The likely reason why a text is not a number.
fn cause(cell: &[u8]) -> InvalidNumber {
    let Ok(text) = std::str::from_utf8(cell) else {
        return InvalidNumber("is not UTF-8 text", Some("save the file as UTF-8"));
    };
    let lower = text.to_lowercase();
    let digits = text.chars().any(|c| c.is_ascii_digit());
    let (what, remedy) = if text.contains('\u{2212}') {
        ("has a typographic minus (U+2212)", "write the ASCII '-'")
    } else if digits && text.contains(',') {
        (
            "has a decimal comma",
            "write [telemetry] decimal = \",\" where all numbers have one, or write a point",
        )
    } else if text.len() > 9 && text.contains(':') && text.contains(['-', '/', 'T']) {
        (
            "is a date",
            "map it by [telemetry] time = { column = \"...\", format = \"iso8601\" }",
        )
    } else if digits && text.contains('_') {
        ("has '_' between digits", "leave it out")
    } else if lower.starts_with("0x") || lower.starts_with("-0x") {
        ("is hexadecimal", "write a decimal number")
    } else if digits && lower.contains('d') {
        ("has a Fortran exponent", "write 'e'")
    } else {
        return InvalidNumber("is not a number", None);
    };
    InvalidNumber(what, Some(remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_numbers_in_every_legal_spelling() {
        for (text, value) in [
            ("1.5", 1.5),
            (" -2e-3\t", -2e-3),
            ("+.5", 0.5),
            ("007", 7.0),
            ("1e-400", 0.0),
            ("1.7976931348623157e308", f64::MAX),
            ("5e-324", 5e-324),
        ] {
            assert_eq!(parse(text.as_bytes()), Ok(Cell::Number(value)), "{text}");
        }
        assert_eq!(parse(b"  "), Ok(Cell::Empty));
        assert_eq!(parse(b"NaN"), Ok(Cell::NotANumber));
    }

    #[test]
    fn exact_decimals_lose_nothing() {
        const E18: i128 = 1_000_000_000_000_000_000;
        for (text, value) in [
            ("1773512340.2", Some(1_773_512_340 * E18 + E18 / 5)),
            ("1.7735123402e9", Some(1_773_512_340 * E18 + E18 / 5)),
            ("-0.000000000000000001", Some(-1)),
            ("12e-3", Some(12 * E18 / 1000)),
            ("+.5", Some(E18 / 2)),
            ("1e-30", Some(0)),
            ("1e40", None),
            ("nan", None),
        ] {
            assert_eq!(decimal(text.as_bytes()), value, "{text}");
        }
    }

    #[test]
    fn exact_a_stored_number_is_that_of_its_text() {
        for count in [0, 1, -1, 1_773_512_340_100_000_000, i64::MAX, i64::MIN] {
            for of in [1, 1_000, 1_000_000, 1_000_000_000] {
                let cell = RawCell::Parts(count, of);
                let text = cell.text();
                assert_eq!(cell.decimal(), decimal(&text), "{count} of {of}");
                let number = cell.number().map(Cell::Number);
                assert!(number.is_none_or(|x| parse(&text) == Ok(x)), "{count}");
            }
        }
        assert_eq!(*RawCell::Parts(-1, 1_000).text(), *b"-0.001");
        assert_eq!(*RawCell::Number(f64::NAN).text(), *b"");
    }

    #[test]
    fn unit_each_fault_names_its_cause() {
        for (text, word) in [
            ("1,5", "decimal comma"),
            ("\u{2212}1.5", "typographic minus"),
            ("1e400", "too large"),
            ("-inf", "infinite"),
            ("1_000", "'_'"),
            ("0x10", "hexadecimal"),
            ("1d-3", "Fortran"),
            ("#N/A", "leave the cell empty"),
            (
                "abc",
                "is not a number; write a number, or leave the cell empty",
            ),
        ] {
            let why = parse(text.as_bytes()).unwrap_err();
            let why = why.fault(Place::default(), b"", false).to_string();
            assert!(why.contains(word), "{text}: {why}");
        }
        assert!(parse(b"1\xb0").unwrap_err().0.contains("UTF-8"));
        let time = parse(b"null").unwrap_err();
        let time = time.fault(Place::default(), b"null", true);
        assert!(time.list[0].advice.ends_with("leave the row out"));
    }
}
