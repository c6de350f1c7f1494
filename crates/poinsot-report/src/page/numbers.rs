//! Number formats: significant digits only, a plain minus sign, no sign on zero.

use poinsot_figures::{number_with_sigma, significant};
use poinsot_formats::HALF_WIDTH_95;

/// Value with the decimals of its sigma.
pub(super) fn value(value: Option<f64>, sigma: Option<f64>) -> String {
    match value {
        Some(_) => unsigned_zero(number_with_sigma(value, sigma).0),
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
    let text = unsigned_zero(number_with_sigma(Some(gap), sigma).0);
    if text.starts_with('-') || gap <= 0.0 || is_zero(&text) {
        text
    } else {
        format!("+{text}")
    }
}

/// A number without trailing zeros.
pub(super) fn plain(x: f64) -> String {
    trimmed(significant(x, 9))
}

/// A number to five figures.
pub(super) fn short(x: f64) -> String {
    trimmed(significant(x, 5))
}

/// A nominal value without unnecessary digits; composites have as many as a double holds.
pub(super) fn brief(x: f64) -> String {
    let all = plain(x);
    if all.len() <= 9 {
        all
    } else {
        significant(x, 6)
    }
}

fn trimmed(text: String) -> String {
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Removes the sign of a number that rounds to zero.
fn unsigned_zero(text: String) -> String {
    if is_zero(&text) {
        return text.replace('-', "");
    }
    text
}

fn is_zero(text: &str) -> bool {
    let mantissa = text.split('e').next().unwrap_or(text);
    !mantissa.chars().any(|c| c.is_ascii_digit() && c != '0')
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
