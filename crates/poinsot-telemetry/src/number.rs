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

/// Reads a cell. A finite text that overflows is an error, not infinity.
///
/// # Errors
/// What is wrong and what to do, to follow the value in an error line.
pub(crate) fn parse(cell: &[u8]) -> Result<Cell, &'static str> {
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
        Some(Ok(_)) if cell.iter().any(u8::is_ascii_digit) => {
            Err("is too large for a double; correct the number")
        }
        Some(Ok(_)) => Err("is infinite; leave the cell empty where there is no sample"),
        _ => Err(cause(cell)),
    }
}

/// The likely reason why a text is not a number.
fn cause(cell: &[u8]) -> &'static str {
    let Ok(text) = std::str::from_utf8(cell) else {
        return "is not UTF-8 text; save the file as UTF-8";
    };
    let lower = text.to_lowercase();
    let digits = text.chars().any(|c| c.is_ascii_digit());
    if text.contains('\u{2212}') {
        "has a typographic minus (U+2212); write the ASCII '-'"
    } else if digits && text.contains(',') {
        "has a decimal comma; write a point"
    } else if digits && text.contains('_') {
        "has '_' between digits; leave it out"
    } else if lower.starts_with("0x") || lower.starts_with("-0x") {
        "is hexadecimal; write a decimal number"
    } else if digits && lower.contains('d') {
        "has a Fortran exponent; write 'e'"
    } else if matches!(
        lower.as_str(),
        "null" | "-" | "--" | "#n/a" | "n/a" | "na" | "none"
    ) {
        "is not a number; leave the cell empty where there is no sample"
    } else {
        "is not a number"
    }
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
            ("abc", "is not a number"),
        ] {
            let why = parse(text.as_bytes()).unwrap_err();
            assert!(why.contains(word), "{text}: {why}");
        }
        assert!(parse(b"1\xb0").unwrap_err().contains("UTF-8"));
    }
}
