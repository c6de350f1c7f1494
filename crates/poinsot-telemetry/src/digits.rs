//! Numbers in messages.

/// `x` with at most `digits` significant digits and no trailing zeros. Exponents only for tiny or huge values: 0, 1.5,
/// 0.0004113, 2e-7.
///
/// ```
/// use poinsot_telemetry::rounded;
///
/// assert_eq!(rounded(0.000_411_31, 4), "0.0004113");
/// assert_eq!(rounded(2.0e-7, 4), "2e-7");
/// ```
pub fn rounded(x: f64, digits: usize) -> String {
    let text = format!("{x:.*e}", digits.saturating_sub(1));
    let x: f64 = text.parse().unwrap_or(x);
    match x.is_finite() && x.abs() >= 1.0e6 {
        true => format!("{x:e}"),
        false => as_read(x),
    }
}

/// Shortest text that reads back to `x`: 0.2, -9999, 1e30.
///
/// ```
/// use poinsot_telemetry::as_read;
///
/// assert_eq!(as_read(-9999.0), "-9999");
/// assert_eq!(as_read(1.0e30), "1e30");
/// ```
pub fn as_read(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if size.is_finite() && (size >= 1.0e16 || (size > 0.0 && size < 1.0e-4)) => {
            format!("{x:e}")
        }
        _ => x.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_numbers_read_as_a_person_writes_them() {
        for (x, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.5, "1.5"),
            (2.0e-7, "2e-7"),
            (2.314_814_814_814_801e-6, "2.315e-6"),
            (9.978_1e-4, "0.0009978"),
            (0.999_96, "1"),
            (123_456.7, "123500"),
            (1.0e8, "1e8"),
            (1.0e30, "1e30"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(rounded(x, 4), text);
        }
        assert_eq!(as_read(0.019_125_926_762_316_378), "0.019125926762316378");
        assert_eq!(as_read(-9999.0), "-9999");
        assert_eq!(as_read(1.0e300), "1e300");
    }
}
