//! Numbers as text with the significant figures that their sigma supports.

/// Largest number of decimals, the precision of a double.
const MOST: i32 = 12;

/// A number with this many significant figures, without exponent if that is short.
pub fn significant(x: f64, figures: i32) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !x.is_finite() {
        return x.to_string();
    }
    let magnitude = x.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        let decimals = (figures - 1).clamp(0, MOST) as usize;
        return format!("{x:.decimals$e}");
    }
    let decimals = (figures - 1 - magnitude).clamp(0, MOST) as usize;
    format!("{x:.decimals$}")
}

/// Value and sigma as text: the sigma with two figures, the value down to the same place.
pub fn number_with_sigma(value: Option<f64>, sigma: Option<f64>) -> (String, String) {
    match (value, sigma) {
        (Some(v), Some(s)) if s > 0.0 && s.is_finite() => {
            let place = s.log10().floor() as i32 - 1;
            if (-MOST..=0).contains(&place) {
                let decimals = place.unsigned_abs() as usize;
                let sigma = if place < -5 {
                    format!("{s:.1e}")
                } else {
                    format!("{s:.decimals$}")
                };
                (unsigned_zero(format!("{v:.decimals$}")), sigma)
            } else {
                (significant(v, 8), format!("{s:.1e}"))
            }
        }
        (Some(v), _) => (significant(v, 8), String::new()),
        (None, _) => ("not identifiable".to_owned(), String::new()),
    }
}

/// A probability as text: two decimals, or two significant figures below 0.01, so that none reads as zero.
pub fn probability(p: f64) -> String {
    if p >= 0.01 {
        format!("{p:.2}")
    } else {
        significant(p, 2)
    }
}

/// Removes the sign of a value that rounds to zero.
fn unsigned_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| c == '0' || c == '.') => zero.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_value_stops_where_sigma_stops() {
        assert_eq!(
            number_with_sigma(Some(13.91612345), Some(0.0123)),
            ("13.916".to_owned(), "0.012".to_owned())
        );
        assert_eq!(
            number_with_sigma(Some(1000.0), Some(3.0e-8)),
            ("1000.000000000".to_owned(), "3.0e-8".to_owned())
        );
    }

    #[test]
    fn unit_a_value_that_rounds_to_zero_has_no_sign() {
        let (value, _) = number_with_sigma(Some(-0.0004), Some(0.12));
        assert_eq!(value, "0.00");
        let (value, _) = number_with_sigma(Some(-0.04), Some(0.12));
        assert_eq!(value, "-0.04");
    }

    #[test]
    fn unit_no_small_probability_reads_as_zero() {
        assert_eq!(probability(0.654), "0.65");
        assert_eq!(probability(0.0026), "0.0026");
        assert_eq!(probability(3.21e-9), "3.2e-9");
        assert_eq!(probability(0.0), "0");
    }

    #[test]
    fn unit_significant_figures() {
        assert_eq!(significant(0.000123456, 3), "0.000123");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(4.113e-9, 4), "4.113e-9");
        assert_eq!(significant(-1234.5678, 6), "-1234.57");
    }
}
