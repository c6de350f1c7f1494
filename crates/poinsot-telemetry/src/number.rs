//! One cell of text to one number, and what people write that is none.

/// What a cell holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// Nothing: no sample.
    Empty,
    /// The text NaN: no sample, but someone wrote it.
    NotANumber,
}

/// Why a cell is no number, and how to write what was meant; `None` where nobody knows what that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoNumber(&'static str, Option<&'static str>);

impl NoNumber {
    /// To follow the value in an error line. A row without time means nothing, so a time cannot be left empty.
    pub(crate) fn text(self, is_time: bool) -> String {
        let Self(what, remedy) = self;
        let remedy = remedy.unwrap_or(match is_time {
            true => "write the time, or leave the row out",
            false => "write a number, or leave the cell empty where there is no sample",
        });
        format!("{what}; {remedy}")
    }
}

/// Reads a cell. A finite text that overflows is an error, not infinity.
///
/// # Errors
/// What is wrong and what to do.
pub(crate) fn parse(cell: &[u8]) -> Result<Cell, NoNumber> {
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
        Some(Ok(_)) if cell.iter().any(u8::is_ascii_digit) => Err(NoNumber(
            "is too large for a double",
            Some("correct the number"),
        )),
        Some(Ok(_)) => Err(NoNumber("is infinite", None)),
        _ => Err(cause(cell)),
    }
}

/// The likely reason why a text is not a number.
fn cause(cell: &[u8]) -> NoNumber {
    let Ok(text) = std::str::from_utf8(cell) else {
        return NoNumber("is not UTF-8 text", Some("save the file as UTF-8"));
    };
    let lower = text.to_lowercase();
    let digits = text.chars().any(|c| c.is_ascii_digit());
    let (what, remedy) = if text.contains('\u{2212}') {
        ("has a typographic minus (U+2212)", "write the ASCII '-'")
    } else if digits && text.contains(',') {
        ("has a decimal comma", "write a point")
    } else if digits && text.contains('_') {
        ("has '_' between digits", "leave it out")
    } else if lower.starts_with("0x") || lower.starts_with("-0x") {
        ("is hexadecimal", "write a decimal number")
    } else if digits && lower.contains('d') {
        ("has a Fortran exponent", "write 'e'")
    } else {
        return NoNumber("is not a number", None);
    };
    NoNumber(what, Some(remedy))
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
            let why = parse(text.as_bytes()).unwrap_err().text(false);
            assert!(why.contains(word), "{text}: {why}");
        }
        assert!(parse(b"1\xb0").unwrap_err().text(false).contains("UTF-8"));
        assert!(
            parse(b"null")
                .unwrap_err()
                .text(true)
                .ends_with("leave the row out")
        );
    }
}
