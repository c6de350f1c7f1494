//! Numbers in messages: six significant digits, no noise.

/// `x` with at most six significant digits.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let magnitude = x.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        let text = format!("{x:.5e}");
        return match text.split_once('e') {
            Some((digits, exponent)) => format!("{}e{exponent}", trim(digits)),
            None => text,
        };
    }
    let places = (5.0 - magnitude).clamp(0.0, 9.0) as usize;
    trim(&format!("{x:.places$}")).to_owned()
}

/// Several numbers, separated by commas.
pub(crate) fn list(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().map(|x| short(*x)).collect();
    texts.join(", ")
}

fn trim(digits: &str) -> &str {
    if digits.contains('.') {
        digits.trim_end_matches('0').trim_end_matches('.')
    } else {
        digits
    }
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
    }
}
