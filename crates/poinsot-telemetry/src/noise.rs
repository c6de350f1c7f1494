//! How noisy a channel is, seen from its own samples.

use crate::Channel;
use crate::median::{median, median_step};
use serde::Serialize;

/// The white noise seen in a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseLevel {
    /// One sigma per sample in the channel's unit; zero for a constant channel.
    pub sigma: f64,
    /// Third differences it rests on.
    pub differences: usize,
    /// Whether all samples are equal.
    pub constant: bool,
    /// Step between neighbouring values where all values are multiples of one step: the least significant bit,
    /// or the last digit written.
    pub quantum: Option<f64>,
    /// Whether more than half of the third differences vanish: the noise lies below the quantum. `sigma` is then
    /// that of the quantisation, quantum over the root of 12, or zero where the channel only switches levels.
    pub below_quantum: bool,
}

/// Estimates white noise from third differences `x0 - 3 x1 + 3 x2 - x3`, whose variance is 20 sigma^2.
///
/// The median of their magnitudes over 0.6745 is their sigma whatever a few outliers do. Motion that is not a
/// parabola over four samples adds to it: an upper bound where the sampling is slow. Four samples in a row with
/// steps within a tenth of each other are used. `None` where there are none.
pub fn noise_level(channel: &Channel) -> Option<NoiseLevel> {
    let step = median_step(&channel.time_s)?;
    let even = |w: &&[f64]| {
        w.iter()
            .zip(w.iter().skip(1))
            .all(|(a, b)| ((b - a) / step - 1.0).abs() < 0.1)
    };
    let third = |w: &[f64]| match w {
        [a, b, c, d] => (a - d) - 3.0 * (b - c),
        _ => 0.0,
    };
    let mut magnitudes: Vec<f64> = channel
        .time_s
        .windows(4)
        .zip(channel.values.windows(4))
        .filter(|(t, _)| even(t))
        .map(|(_, x)| third(x).abs())
        .collect();
    let constant = is_constant(&channel.values);
    let largest = channel.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let differences = magnitudes.len();
    let middle = median(&mut magnitudes)?;
    let quantum = quantum(&channel.values);
    // A difference of a few units in the last place of the largest value is a zero that was rounded.
    let vanishes = middle <= 16.0 * f64::EPSILON * largest;
    let below_quantum = vanishes && !constant;
    let sigma = if vanishes {
        quantum.map_or(0.0, |q| q / 12.0_f64.sqrt())
    } else {
        middle / 0.6745 / 20.0_f64.sqrt()
    };
    Some(NoiseLevel {
        sigma,
        differences,
        constant,
        quantum,
        below_quantum,
    })
}

pub(crate) fn is_constant(values: &[f64]) -> bool {
    values
        .first()
        .is_none_or(|first| values.iter().all(|x| x == first))
}

/// The step of which all differences between values are multiples, if there is one.
pub(crate) fn quantum(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let largest = sorted.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let round_off = 16.0 * f64::EPSILON * largest;
    let steps: Vec<f64> = sorted
        .iter()
        .zip(sorted.iter().skip(1))
        .map(|(a, b)| b - a)
        .filter(|d| *d > round_off)
        .collect();
    let smallest = steps.iter().copied().min_by(f64::total_cmp)?;
    // Two or three values always share a step; more are needed to call it one.
    if steps.len() < 8 || smallest < 1e3 * round_off {
        return None;
    }
    let slack = (2.0 * round_off / smallest).max(1e-6);
    let multiples = steps.iter().all(|d| {
        let n = d / smallest;
        (n - n.round()).abs() <= slack * n.max(1.0) && slack * n < 0.25
    });
    multiples.then_some(smallest)
}
