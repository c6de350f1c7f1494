//! Numbers as text: in a message, and with the figures that their sigma supports.

/// Half-width of a stated 95 % interval in sigmas: the normal quantile of 0.975.
pub const HALF_WIDTH_95: f64 = 1.959_963_984_540_054;
/// Largest number of decimals, the precision of a double.
const MOST: i32 = 12;
/// Decimals of the first figure of a double.
const DOUBLE: i32 = 15;
/// Size from which a number and its sigma are written in powers of ten.
const PLAIN: f64 = 1.0e7;
/// Significant digits of a number in a message.
const SHORT: usize = 6;

/// `x` in a message, with at most six significant digits.
///
/// ```
/// assert_eq!(poinsot_files::short(123_456.7), "123457");
/// ```
pub fn short(x: f64) -> String {
    rounded(x, SHORT)
}

/// Several numbers in a message, separated by commas.
///
/// ```
/// assert_eq!(poinsot_files::list(&[0.0, -2.5]), "0, -2.5");
/// ```
pub fn list(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().copied().map(short).collect();
    texts.join(", ")
}

/// `x` with at most `digits` significant digits and no trailing zeros, for a message. Exponents only for tiny or huge
/// values: 0, 1.5, 0.0004113, 2e-7.
///
/// ```
/// use poinsot_files::rounded;
///
/// assert_eq!(rounded(0.000_411_31, 4), "0.0004113");
/// assert_eq!(rounded(2.0e-7, 4), "2e-7");
/// ```
pub fn rounded(x: f64, digits: usize) -> String {
    let x = to_digits(x, digits);
    match x.is_finite() && x.abs() >= 1.0e6 {
        true => format!("{x:e}"),
        false => as_read(x),
    }
}

/// `x` rounded to significant digits.
///
/// ```
/// assert_eq!(poinsot_files::to_digits(0.019_27, 3), 0.0193);
/// ```
pub fn to_digits(x: f64, digits: usize) -> f64 {
    let text = format!("{x:.*e}", digits.saturating_sub(1));
    text.parse().unwrap_or(x)
}

/// Shortest text that reads back to `x`: 0.2, -9999, 1e30.
///
/// ```
/// use poinsot_files::as_read;
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

/// A number with this many significant figures, without exponent if that is short.
///
/// ```
/// use poinsot_files::significant;
///
/// assert_eq!((significant(1234.5, 3), significant(0.012345, 3)), ("1234".to_owned(), "0.0123".to_owned()));
/// ```
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

/// Value and sigma as text: the sigma with two figures, the value rounded to the same place; powers of ten where that is
/// shorter.
///
/// ```
/// use poinsot_files::number_with_sigma;
///
/// let (value, sigma) = number_with_sigma(Some(312.41567), Some(0.0213));
/// assert_eq!((value.as_str(), sigma.as_str()), ("312.416", "0.021"));
/// let (value, sigma) = number_with_sigma(Some(31_241.567), Some(2130.0));
/// assert_eq!((value.as_str(), sigma.as_str()), ("31200", "2100"));
/// assert_eq!(number_with_sigma(None, None).0, "not identifiable");
/// ```
pub fn number_with_sigma(value: Option<f64>, sigma: Option<f64>) -> (String, String) {
    match (value, sigma) {
        (Some(v), Some(s)) if s > 0.0 && s.is_finite() => {
            // The exponent behind rounding: 0.0996 is 0.10.
            let s = to_digits(s, 2);
            let place = exponent(s) - 1;
            let plain = -MOST <= place && v.abs().max(s) < PLAIN;
            let value = match plain {
                true => at_place(v, place),
                false => with_exponent(v, place),
            };
            let sigma = match plain && place >= -5 {
                true => at_place(s, place),
                false => format!("{s:.1e}"),
            };
            (value, sigma)
        }
        (Some(v), _) => (significant(v, 8), String::new()),
        (None, _) => ("not identifiable".to_owned(), String::new()),
    }
}

/// `x` rounded to a power of ten.
fn at_place(x: f64, place: i32) -> String {
    let decimals = (-place).max(0) as usize;
    let unit = 10.0_f64.powi(place.max(0));
    let x = match place > 0 {
        true => (x / unit).round() * unit,
        false => x,
    };
    unsigned_zero(format!("{x:.decimals$}"))
}

/// The same in powers of ten, as far as a double goes.
fn with_exponent(x: f64, place: i32) -> String {
    let units = (x / 10.0_f64.powi(place)).round();
    let x = match units.abs() < 10.0_f64.powi(DOUBLE) {
        true => format!("{units:.0}e{place}").parse().unwrap_or(x),
        false => x,
    };
    if x == 0.0 {
        return "0".to_owned();
    }
    let decimals = (exponent(x) - place).clamp(0, DOUBLE) as usize;
    format!("{x:.decimals$e}")
}

/// The power of ten of a number's first figure.
fn exponent(x: f64) -> i32 {
    let text = format!("{x:e}");
    let power = text
        .split_once('e')
        .and_then(|(_, power)| power.parse().ok());
    power.unwrap_or(0)
}

/// A count with its noun; the plural ends in `s`, or in `ies` for a consonant and `y`.
///
/// ```
/// use poinsot_files::counted;
///
/// assert_eq!([counted(1_u64, "cell"), counted(2_u64, "cell")], ["1 cell", "2 cells"]);
/// assert_eq!([counted(0_usize, "body"), counted(3_usize, "key")], ["0 bodies", "3 keys"]);
/// ```
pub fn counted<N: std::fmt::Display + PartialEq + From<u8>>(n: N, noun: &str) -> String {
    let stem = noun.strip_suffix('y');
    match stem.filter(|stem| !stem.ends_with(['a', 'e', 'o', 'u'])) {
        _ if n == N::from(1) => format!("{n} {noun}"),
        Some(stem) => format!("{n} {stem}ies"),
        None => format!("{n} {noun}s"),
    }
}

/// A probability as text: two decimals, or two significant figures below 0.01, so that none reads as zero.
///
/// ```
/// use poinsot_files::probability;
///
/// assert_eq!((probability(0.5), probability(0.0012)), ("0.50".to_owned(), "0.0012".to_owned()));
/// ```
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
    use proptest::prelude::*;

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
        assert_eq!(short(2.3968449810713143e-5), "2.39684e-5");
        assert_eq!(list(&[-2.5, 123456.7]), "-2.5, 123457");
        assert_eq!(as_read(0.019_125_926_762_316_378), "0.019125926762316378");
        assert_eq!(as_read(-9999.0), "-9999");
        assert_eq!(as_read(1.0e300), "1e300");
    }

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
    fn unit_large_sigmas_end_where_small_ones_do() {
        for (v, s, value, sigma) in [
            (1_234_567.0, 1234.0, "1234600", "1200"),
            (-49.0, 123.0, "-50", "120"),
            (-4.0, 123.0, "0", "120"),
            (0.5, 99.6, "0", "100"),
            (0.012_34, 0.0996, "0.01", "0.10"),
            (1.234_567_8e9, 4.56e5, "1.23457e9", "4.6e5"),
            (9.999_96e8, 1.2e6, "1.0000e9", "1.2e6"),
            (2.5e-14, 1.0e-15, "2.50e-14", "1.0e-15"),
            (-3.0e8, 4.4e10, "0", "4.4e10"),
        ] {
            let found = number_with_sigma(Some(v), Some(s));
            assert_eq!(found, (value.to_owned(), sigma.to_owned()), "{v} {s}");
        }
    }

    /// Sizes over forty powers of ten.
    fn sizes() -> impl Strategy<Value = f64> {
        (1.0..10.0_f64, -20..20_i32).prop_map(|(x, power)| x * 10.0_f64.powi(power))
    }

    proptest! {
        /// Two figures of sigma, and the value to the nearest unit of the second one.
        #[test]
        fn prop_a_value_ends_at_the_second_figure_of_its_sigma(
            size in sizes(), s in sizes(), minus: bool
        ) {
            let v = if minus { -size } else { size };
            let (value, sigma) = number_with_sigma(Some(v), Some(s));
            let read: f64 = sigma.parse().unwrap();
            prop_assert!((read / s - 1.0).abs() < 0.0501, "{s}: {sigma}");
            let mantissa = sigma.split('e').next().unwrap_or_default();
            let figures = mantissa.replace('.', "");
            let figures = figures.trim_start_matches('0').trim_end_matches('0');
            prop_assert!(figures.len() <= 2, "{s}: {sigma}");
            // The unit of the second figure, of the sigma as printed.
            let power = format!("{read:e}").split_once('e').unwrap().1.parse::<i32>().unwrap();
            let unit = 10.0_f64.powi(power - 1);
            let near: f64 = value.parse().unwrap();
            let off = (near - v).abs();
            prop_assert!(off <= 0.500_001 * unit + 1.0e-15 * size, "{v} +- {s}: {value}");
            let units = near / unit;
            let whole = (units - units.round()).abs();
            prop_assert!(whole < 1.0e-6_f64.max(1.0e-15 * units.abs()), "{v} +- {s}: {value}");
            prop_assert!(value.len() <= 24, "{value}");
        }
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
