//! Number formats: significant digits only, a plain minus sign, no sign on zero.

use poinsot_files::{number_with_sigma, rounded, short, significant};
use poinsot_formats::HALF_WIDTH_95;

/// Value with the decimals of its sigma.
pub(super) fn value(value: Option<f64>, sigma: Option<f64>) -> String {
    match value {
        Some(_) => number_with_sigma(value, sigma).0,
        None => "not determined".to_owned(),
    }
}

/// Half width of the 95 % interval; `None` without sigma.
pub(super) fn half_width(sigma: Option<f64>) -> Option<f64> {
    let sigma = sigma.filter(|s| *s > 0.0 && s.is_finite())?;
    Some(ninety_five() * sigma)
}

/// Half width of a 95 % interval in sigmas.
pub(super) fn ninety_five() -> f64 {
    HALF_WIDTH_95
}

/// Half width of the 95 % interval, two figures.
pub(super) fn plus_minus(sigma: Option<f64>) -> String {
    half_width(sigma).map_or_else(String::new, |half| {
        format!("\u{b1}{}", significant(half, 2))
    })
}

/// A signed difference, with the digits of its sigma.
pub(super) fn difference(gap: f64, sigma: Option<f64>) -> String {
    let text = number_with_sigma(Some(gap), sigma).0;
    match gap > 0.0 && text.contains(|c: char| ('1'..='9').contains(&c)) {
        true => format!("+{text}"),
        false => text,
    }
}

/// A nominal value without unnecessary digits; composites have as many as a double holds.
pub(super) fn brief(x: f64) -> String {
    let all = rounded(x, 9);
    if all.len() <= 9 { all } else { short(x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_zero_has_no_sign_and_a_gain_has_one() {
        assert_eq!(difference(-0.001, Some(0.16)), "0.00");
        assert_eq!(difference(0.001, Some(0.16)), "0.00");
        assert_eq!(difference(1.5, Some(0.16)), "+1.50");
        assert_eq!(value(Some(-1.0e-9), Some(0.1)), "0.00");
        assert_eq!(value(Some(-1.25), Some(0.1)), "-1.25");
    }
}
