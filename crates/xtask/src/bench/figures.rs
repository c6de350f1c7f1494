//! Figures that benchmarks print, and ratios of them.

use std::fmt::Write as _;

/// Lines of `name,value,unit`.
#[derive(Default)]
pub struct Figures(Vec<(String, f64, String)>);

impl Figures {
    /// Prints lines and keeps their figures.
    pub fn show(&mut self, lines: &str) {
        print!("{lines}");
        for line in lines.lines() {
            let mut parts = line.split(',');
            let (name, value, unit) = (parts.next(), parts.next(), parts.next());
            let value = value.and_then(|value| value.parse().ok());
            if let (Some(name), Some(value), Some(unit)) = (name, value, unit) {
                self.0.push((name.to_owned(), value, unit.to_owned()));
            }
        }
    }

    fn named<'a>(&'a self, name: &'a str, unit: &'a str) -> impl Iterator<Item = f64> + 'a {
        let figures = self
            .0
            .iter()
            .filter(move |figure| figure.0 == name && figure.2 == unit);
        figures.map(|figure| figure.1)
    }

    /// Largest value under a name.
    pub fn most(&self, name: &str, unit: &str) -> Option<f64> {
        self.named(name, unit).max_by(f64::total_cmp)
    }

    /// Least value under a name.
    pub fn least(&self, name: &str, unit: &str) -> Option<f64> {
        self.named(name, unit).min_by(f64::total_cmp)
    }
}

/// A number with three significant digits.
pub fn significant(value: f64) -> String {
    const DIGITS: i32 = 3;
    let exact = format!("{value:.2e}");
    let Some((digits, exponent)) = exact.split_once('e') else {
        return exact;
    };
    let exponent: i32 = exponent.parse().unwrap_or_default();
    // Fixed below a thousand and above a ten-thousandth.
    if (-4..DIGITS).contains(&exponent) {
        let places = usize::try_from(DIGITS - 1 - exponent).unwrap_or_default();
        return without_zeros(&format!("{value:.places$}")).to_owned();
    }
    let mut out = without_zeros(digits).to_owned();
    let sign = if exponent < 0 { '-' } else { '+' };
    let _ = write!(out, "e{sign}{:02}", exponent.abs());
    out
}

fn without_zeros(digits: &str) -> &str {
    match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_three_digits_are_printed() {
        let cases = [
            (0.1234567, "0.123"),
            (12.0, "12"),
            (999.6, "1e+03"),
            (1234.0, "1.23e+03"),
            (0.00012345, "0.000123"),
            (0.0000120, "1.2e-05"),
        ];
        for (value, text) in cases {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn unit_least_and_most_are_found_by_name_and_unit() {
        let mut figures = Figures::default();
        figures.show("name,value,unit\na,3,ns\na,2.5,ns\na,1,us\nb,9,ns\n");
        assert_eq!(
            (figures.least("a", "ns"), figures.most("a", "ns")),
            (Some(2.5), Some(3.0))
        );
        assert_eq!(figures.least("c", "ns"), None);
    }
}
