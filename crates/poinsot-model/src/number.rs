//! Numbers in messages.

/// `x` with at most six significant digits.
pub(crate) fn short(x: f64) -> String {
    rounded(x, 6)
}

/// `x` with at most `digits` significant digits and no trailing zeros. Exponents only for tiny or huge values: 0, 1.5,
/// 0.0004113, 2e-7.
///
/// ```
/// use poinsot_model::rounded;
///
/// assert_eq!(rounded(0.000_411_31, 4), "0.0004113");
/// assert_eq!(rounded(2.0e-7, 4), "2e-7");
/// ```
pub fn rounded(x: f64, digits: usize) -> String {
    let text = format!("{x:.*e}", digits.saturating_sub(1));
    let x: f64 = text.parse().unwrap_or(x);
    match x.abs() {
        0.0 => "0".to_owned(),
        size if size.is_finite() && !(1.0e-4..1.0e6).contains(&size) => format!("{x:e}"),
        _ => x.to_string(),
    }
}

/// Several numbers, separated by commas.
pub(crate) fn list(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().map(|x| short(*x)).collect();
    texts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_short_numbers_keep_six_digits() {
        assert_eq!(short(0.0), "0");
        assert_eq!(short(1.0), "1");
        assert_eq!(short(-2.500), "-2.5");
        assert_eq!(short(123456.7), "123457");
        assert_eq!(short(4.113e-4), "0.0004113");
        assert_eq!(short(2.3968449810713143e-5), "2.39684e-5");
        assert_eq!(short(1.0e30), "1e30");
        assert_eq!(short(f64::NAN), "NaN");
        assert_eq!(rounded(-0.0, 4), "0");
        assert_eq!(rounded(-1.000_01, 4), "-1");
        assert_eq!(rounded(2.0e-7, 4), "2e-7");
    }
}
