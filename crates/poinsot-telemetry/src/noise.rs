//! Estimates the noise of a channel from its samples.

use crate::Channel;
use crate::median::{median, median_step, sigma_of};
use serde::Serialize;

/// First order of differences; it removes a parabola.
const FIRST_ORDER: usize = 3;
/// Last order: a wave of 8 samples is reduced to 1e-4, and an outlier affects 13 differences.
const LAST_ORDER: usize = 12;
/// Relative tolerance of equal sampling steps.
const EVEN: f64 = 0.1;
/// Efficiency of the median of magnitudes relative to the mean square, for normal numbers (Huber 1981, sec. 5.1).
const MEDIAN_EFFICIENCY: f64 = 0.37;
/// Differences below this multiple of the largest value are round-off.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Number of steps between neighbouring values beyond which they have to be whole: round-off may hide any part of one.
const FAR: f64 = 2.5e5;

/// White noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseLevel {
    /// One sigma per sample in the channel's unit; zero for a constant channel.
    pub sigma: f64,
    /// Standard error of `sigma`, relative.
    pub relative_error: f64,
    /// Whether the estimate may include motion: it still decreases at the last order.
    pub upper_bound: bool,
    /// Whether all samples are equal.
    pub constant: bool,
    /// Step of which all values are multiples: the least significant bit, or the last digit written. Where more than half of the third
    /// differences vanish, `sigma` is quantum / sqrt(12), or zero if the channel only switches levels.
    pub quantum: Option<f64>,
}

/// Estimates white noise from differences of the samples.
///
/// The variance of the differences of order `d` of white noise is `C(2d, d) sigma^2`. Motion of angular frequency `w`
/// is reduced to about `sin^d(w h / 2)` of its amplitude, where `h` is the step. The order is raised from 3 to 12
/// while the estimate decreases by more than its standard error. Sigma is the median magnitude over 0.6745, which is
/// robust against outliers. Only consecutive samples whose steps differ by less than 10 % are used; `None` if there
/// are not four.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// // A slow wave with uniform noise of half width 0.01: sigma = 0.01 / sqrt(3).
/// let time_s: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
/// let mut state = 1_u32;
/// let mut uniform = || {
///     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
///     f64::from(state) / f64::from(u32::MAX) - 0.5
/// };
/// let values: Vec<f64> = time_s.iter().map(|t| (0.5 * t).sin() + 0.02 * uniform()).collect();
/// let noise = noise_level(&channel("joint1_rad", "rad", &time_s, &values)).unwrap();
/// assert!((noise.sigma / (0.01 / 3.0_f64.sqrt()) - 1.0).abs() < 0.2);
/// ```
pub fn noise_level(channel: &Channel) -> Option<NoiseLevel> {
    let step = median_step(&channel.time_s)?;
    let mut differences = Differences::new(channel, step);
    let constant = is_constant(&channel.values);
    let largest = channel.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    while differences.order < FIRST_ORDER {
        differences.raise();
    }
    let (middle, count) = differences.middle()?;
    let quantum = quantum(&channel.values);
    let vanishes = middle <= ROUND_OFF * largest;
    let mut level = NoiseLevel {
        sigma: sigma(middle, FIRST_ORDER),
        relative_error: relative_error(count, FIRST_ORDER),
        upper_bound: true,
        constant,
        quantum,
    };
    if vanishes {
        level.sigma = quantum.map_or(0.0, |q| q / 12.0_f64.sqrt());
        level.upper_bound = false;
        return Some(level);
    }
    while differences.order < LAST_ORDER {
        differences.raise();
        let order = differences.order;
        let Some((middle, count)) = differences.middle() else {
            break;
        };
        let (next, error) = (sigma(middle, order), relative_error(count, order));
        level.upper_bound = next < level.sigma * (1.0 - error);
        if !level.upper_bound || next <= ROUND_OFF * largest {
            break;
        }
        (level.sigma, level.relative_error) = (next, error);
    }
    Some(level)
}

/// Differences of a channel, order by order.
struct Differences {
    order: usize,
    /// Differences, each with a flag for equal steps.
    values: Vec<(f64, bool)>,
}

impl Differences {
    fn new(channel: &Channel, step: f64) -> Self {
        let times = channel.time_s.iter();
        let even = times.clone().skip(1).zip(times);
        let even = even.map(|(b, a)| ((b - a) / step - 1.0).abs() < EVEN);
        let values = channel.values.iter();
        let steps = values.clone().skip(1).zip(values).map(|(b, a)| b - a);
        Self {
            order: 1,
            values: steps.zip(even).collect(),
        }
    }

    fn raise(&mut self) {
        self.order += 1;
        let before = self.values.iter();
        let pairs = before.clone().zip(before.skip(1));
        let next = pairs.map(|((a, first), (b, second))| (b - a, *first && *second));
        self.values = next.collect();
    }

    /// Median magnitude, and the number of differences.
    fn middle(&self) -> Option<(f64, usize)> {
        let whole = self.values.iter().filter(|v| v.1);
        let mut magnitudes: Vec<f64> = whole.map(|v| v.0.abs()).collect();
        let count = magnitudes.len();
        Some((median(&mut magnitudes)?, count))
    }
}

/// `C(2n, n)`, the sum of squares of the binomial coefficients of order n.
fn central_binomial(n: usize) -> f64 {
    (1..=n).map(|k| (n + k) as f64 / k as f64).product()
}

fn sigma(middle: f64, order: usize) -> f64 {
    sigma_of(middle) / central_binomial(order).sqrt()
}

/// Neighbouring differences are correlated: the sum of the squared correlations is `C(4d, 2d) / C(2d, d)^2`.
fn relative_error(count: usize, order: usize) -> f64 {
    let correlated = central_binomial(2 * order) / central_binomial(order).powi(2);
    (correlated / (2.0 * count as f64 * MEDIAN_EFFICIENCY)).sqrt()
}

pub(crate) fn is_constant(values: &[f64]) -> bool {
    values
        .first()
        .is_none_or(|first| values.iter().all(|x| x == first))
}

/// The common step of all values, if any.
pub(crate) fn quantum(values: &[f64]) -> Option<f64> {
    let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = |n: f64| if n < FAR { 1.0e-6 * n.max(1.0) } else { 0.0 };
    let round_off = ROUND_OFF * largest;
    // Two or three values always have a common step.
    common_step(values, 8, round_off, off).filter(|step| *step > 1.0e3 * round_off)
}

/// The step of which the differences of all values are multiples: the least of those above `floor`, which are at least so many, where
/// each of the others is `n` of it within `off(n)` steps. In the unit of the values.
///
/// ```
/// use poinsot_telemetry::common_step;
///
/// assert_eq!(common_step(&[0.5, 2.0, 1.25], 2, 0.0, |_| 0.01), Some(0.75));
/// assert_eq!(common_step(&[0.5, 2.0, 1.0], 2, 0.0, |_| 0.01), Some(0.5));
/// assert_eq!(common_step(&[0.5, 2.0, 0.9], 2, 0.0, |_| 0.01), None);
/// ```
pub fn common_step(
    values: &[f64],
    fewest: usize,
    floor: f64,
    off: impl Fn(f64) -> f64,
) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let gaps = sorted.iter().zip(sorted.iter().skip(1)).map(|(a, b)| b - a);
    let gaps: Vec<f64> = gaps.filter(|gap| *gap > floor).collect();
    let step = gaps.iter().copied().min_by(f64::total_cmp)?;
    let multiple = |gap: &f64| (gap / step - (gap / step).round()).abs() <= off(gap / step);
    (gaps.len() >= fewest && gaps.iter().all(multiple)).then_some(step)
}
