//! Numbers as a reader wants them.

use poinsot_report::{number_with_sigma, significant};

/// Half width of a 95 % interval, sigmas.
pub(super) const NINETY_FIVE: f64 = 1.959964;

/// The minus sign of print.
pub(super) fn minus(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut before = ' ';
    for c in text.chars() {
        // A sign, not the sign of an exponent.
        let sign = c == '-' && (out.is_empty() || !before.is_alphabetic());
        out.push(if sign { '\u{2212}' } else { c });
        before = c;
    }
    out
}

/// Value with the decimals its sigma deserves.
pub(super) fn value(value: Option<f64>, sigma: Option<f64>) -> String {
    match value {
        Some(_) => unsigned_zero(minus(&number_with_sigma(value, sigma).0)),
        None => "not identifiable".to_owned(),
    }
}

/// Half width of the 95 % interval, two figures.
pub(super) fn plus_minus(sigma: Option<f64>) -> String {
    match sigma {
        Some(s) if s > 0.0 => format!("± {}", significant(NINETY_FIVE * s, 2)),
        _ => String::new(),
    }
}

/// Both ends of the 95 % interval.
pub(super) fn interval(value: Option<f64>, sigma: Option<f64>) -> String {
    let (Some(v), Some(s)) = (value, sigma) else {
        return String::new();
    };
    if !(s > 0.0 && s.is_finite()) {
        return String::new();
    }
    let end = |x: f64| minus(&number_with_sigma(Some(x), Some(s)).0);
    format!(
        "{} … {}",
        end(v - NINETY_FIVE * s),
        end(v + NINETY_FIVE * s)
    )
}

/// A difference in sigmas.
pub(super) fn in_sigmas(difference: f64, sigma: Option<f64>) -> String {
    match sigma {
        Some(s) if s > 0.0 => {
            let z = difference / s;
            // Rounded to zero it has no sign.
            let z = if z.abs() < 0.05 { 0.0 } else { z };
            if z.abs() < 1000.0 {
                minus(&format!("{z:+.1}"))
            } else {
                minus(&format!("{z:+.0}"))
            }
        }
        _ => String::new(),
    }
}

/// A difference in percent of a reference.
pub(super) fn percent(difference: f64, reference: f64) -> String {
    if reference == 0.0 {
        return String::new();
    }
    let share = 100.0 * difference / reference.abs();
    if share.abs() < 1.0e4 {
        minus(&format!("{share:+.3} %"))
    } else {
        String::new()
    }
}

/// A number as given, without the zeros that say nothing.
pub(super) fn plain(x: f64) -> String {
    trimmed(significant(x, 9))
}

/// A number to five figures.
pub(super) fn short(x: f64) -> String {
    trimmed(significant(x, 5))
}

fn trimmed(text: String) -> String {
    let short = match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text.as_str(),
    };
    minus(short)
}

/// A rounded number that shows only zeros has no sign.
fn unsigned_zero(text: String) -> String {
    if text.chars().any(|c| c.is_ascii_digit() && c != '0') {
        return text;
    }
    text.replace('\u{2212}', "")
}
