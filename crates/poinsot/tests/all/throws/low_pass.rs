//! Zero-phase low-pass filter: a Butterworth filter of second order, run forwards and backwards.

/// One second-order section `(b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2)`.
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// Passes each signal below `cut_off_hz` without delay; samples at the even rate `rate_hz`.
///
/// The gain of both runs together is `1 / (1 + (f / cut_off)^4)`. The ends are extended by point reflection over three
/// periods of the cut-off, and each run starts in steady state.
pub fn low_pass(signal: &[f64], rate_hz: f64, cut_off_hz: f64) -> Vec<f64> {
    let section = butterworth(cut_off_hz / rate_hz);
    let wanted = (3.0 * rate_hz / cut_off_hz) as usize;
    let pad = wanted.min(signal.len().saturating_sub(1));
    let mut long = continued(signal, pad);
    for _ in 0..2 {
        run(&section, &mut long);
        long.reverse();
    }
    long[pad..pad + signal.len()].to_vec()
}

/// Bilinear transform of the Butterworth low-pass; `ratio` = cut-off over sampling rate.
fn butterworth(ratio: f64) -> Section {
    let k = (std::f64::consts::PI * ratio).tan();
    let norm = 1.0 / (1.0 + std::f64::consts::SQRT_2 * k + k * k);
    let b0 = k * k * norm;
    Section {
        b: [b0, 2.0 * b0, b0],
        a: [
            2.0 * (k * k - 1.0) * norm,
            (1.0 - std::f64::consts::SQRT_2 * k + k * k) * norm,
        ],
    }
}

/// The signal extended by `pad` samples at each end by point reflection.
fn continued(signal: &[f64], pad: usize) -> Vec<f64> {
    let (Some(first), Some(last)) = (signal.first(), signal.last()) else {
        return Vec::new();
    };
    let before = signal[1..=pad].iter().rev().map(|x| 2.0 * first - x);
    let after = signal[signal.len() - 1 - pad..signal.len() - 1]
        .iter()
        .rev()
        .map(|x| 2.0 * last - x);
    before.chain(signal.iter().copied()).chain(after).collect()
}

/// One run in place (transposed direct form II), from the steady state of the first sample.
fn run(section: &Section, signal: &mut [f64]) {
    let (b, a) = (section.b, section.a);
    let first = signal.first().copied().unwrap_or(0.0);
    let mut s2 = (b[2] - a[1]) * first;
    let mut s1 = (b[1] - a[0]) * first + s2;
    for x in signal {
        let y = b[0] * *x + s1;
        s1 = b[1] * *x - a[0] * y + s2;
        s2 = b[2] * *x - a[1] * y;
        *x = y;
    }
}
