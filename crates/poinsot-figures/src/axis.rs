//! Axis ticks and the power of ten in the unit.

/// Round numbers within a range, about `wanted` of them.
pub(crate) fn ticks(from: f64, to: f64, wanted: usize) -> Vec<f64> {
    let span = to - from;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    let step = round_step(span / wanted.max(1) as f64);
    let first = (from / step).ceil() as i64;
    let last = (to / step).floor() as i64;
    (first..=last.min(first.saturating_add(50)))
        .map(|k| k as f64 * step)
        .collect()
}

/// 1, 2 or 5 times a power of ten, nearest to `raw`.
fn round_step(raw: f64) -> f64 {
    let power = 10.0_f64.powf(raw.log10().floor());
    let factor = raw / power;
    let round = match factor {
        f if f < 1.5 => 1.0,
        f if f < 3.5 => 2.0,
        f if f < 7.5 => 5.0,
        _ => 10.0,
    };
    round * power
}

/// Text of a tick, with the decimals that the step needs.
pub(crate) fn tick_text(tick: f64, all: &[f64]) -> String {
    let step = match all {
        [a, b, ..] => (b - a).abs(),
        _ => tick.abs().max(1.0),
    };
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    let tick = if tick.abs() < 1.0e-9 * step {
        0.0
    } else {
        tick
    };
    format!("{tick:.decimals$}")
}

/// Exponent of ten, a multiple of three, that scales numbers of this size near one.
pub(crate) fn exponent(size: f64) -> i32 {
    if !(size > 0.0 && size.is_finite()) || (0.01..1.0e4).contains(&size) {
        return 0;
    }
    3 * (size.log10() / 3.0).floor() as i32
}

/// Unit with a power of ten.
pub(crate) fn unit_text(unit: &str, exponent: i32) -> String {
    let unit = match unit {
        "1" => "",
        "kg m2" => "kg m²",
        other => other,
    };
    if exponent == 0 {
        return unit.to_owned();
    }
    format!("10{} {unit}", superscript(exponent))
        .trim_end()
        .to_owned()
}

/// An exponent as raised digits.
pub(crate) fn superscript(exponent: i32) -> String {
    let raised = |c: char| {
        let digit = c.to_digit(10).map(|d| d as usize);
        let raised = digit.and_then(|d| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(d));
        raised.unwrap_or('⁻')
    };
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_ticks_are_round() {
        let t = ticks(-0.3, 1.1, 5);
        assert_eq!(t.len(), 7);
        assert_eq!(tick_text(t[0], &t), "-0.2");
        assert_eq!(ticks(0.0, 480.0, 6), [0.0, 100.0, 200.0, 300.0, 400.0]);
        assert!(ticks(1.0, 1.0, 5).is_empty());
    }

    #[test]
    fn unit_powers_of_ten() {
        assert_eq!(exponent(3.0e-5), -6);
        assert_eq!(exponent(25.0), 0);
        assert_eq!(unit_text("rad/s", -6), "10⁻⁶ rad/s");
        assert_eq!(superscript(-15), "⁻¹⁵");
    }
}
