//! The time derivative of a channel from local polynomials, and its integral.

use crate::median::median_step;
use crate::{Channel, Dimension, GAP, classify};

/// Degree of the local polynomial.
const DEGREE: usize = 4;

/// The derivative of a channel at its own samples.
///
/// It is the slope of the quartic fitted by least squares to the `2 half_width + 1` samples around each sample. At the
/// ends of a run there are fewer samples, on one side. A gap ([`GAP`]) ends a run. `half_width = 2` passes through all
/// five samples: error `h^4 |x^(5)| / 30` at even steps, noise gain `0.95 / h`. A wider window keeps the order and
/// lowers the noise as `half_width^-1.5`. A sample without neighbours gets no derivative. The result has the standard
/// name and unit if they exist (`joint1_rad` to `joint1_rad_s`, `omega_x` to `domega_x`), otherwise `d/dt <name>`.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// // 2 t + t^2 has the rate 2 + 2 t.
/// let time_s: Vec<f64> = (0..9).map(f64::from).collect();
/// let values: Vec<f64> = time_s.iter().map(|t| t * (2.0 + t)).collect();
/// let rate = differentiate(&channel("joint1_rad", "rad", &time_s, &values), 2);
/// assert_eq!((rate.name.as_str(), rate.unit.as_str()), ("joint1_rad_s", "rad/s"));
/// assert!((rate.values[4] - 10.0).abs() < 1.0e-12);
/// ```
pub fn differentiate(channel: &Channel, half_width: usize) -> Channel {
    let max_gap = GAP * median_step(&channel.time_s).unwrap_or(0.0);
    let mut time_s = Vec::with_capacity(channel.values.len());
    let mut values = Vec::with_capacity(channel.values.len());
    let mut start = 0;
    while start < channel.values.len() {
        let end = run_end(&channel.time_s, start, max_gap);
        let times = channel.time_s.get(start..end).unwrap_or_default();
        let samples = channel.values.get(start..end).unwrap_or_default();
        let width = (2 * half_width.max(1) + 1).min(times.len());
        for (k, &at) in times.iter().enumerate() {
            let first = k.saturating_sub(half_width.max(1)).min(times.len() - width);
            let window = first..first + width;
            if let (Some(t), Some(x)) = (times.get(window.clone()), samples.get(window))
                && let Some(slope) = slope(t, x, at)
            {
                time_s.push(at);
                values.push(slope);
            }
        }
        start = end;
    }
    let (name, unit) = derivative_name(channel);
    let shared = time_s.len() == channel.time_s.len();
    Channel {
        name,
        sensor: channel.sensor.clone(),
        unit,
        frame: channel.frame.clone(),
        time_s: if shared {
            channel.time_s.clone()
        } else {
            time_s.into()
        },
        values,
    }
}

/// The time integral of a channel by the trapezoid rule, from its first sample to each.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// let rate = channel("joint1_rad_s", "rad/s", &[0.0, 1.0, 3.0], &[0.0, 2.0, 4.0]);
/// assert_eq!(integral(&rate).values, [0.0, 1.0, 7.0]);
/// ```
pub fn integral(channel: &Channel) -> Channel {
    let mut sum = 0.0;
    let means = channel.values.windows(2).zip(channel.time_s.windows(2));
    let steps = means.map(|(x, t)| 0.5 * (t[1] - t[0]) * (x[0] + x[1]));
    let rest = steps.map(|step| {
        sum += step;
        sum
    });
    let values: Vec<f64> = std::iter::once(0.0).chain(rest).collect();
    Channel {
        values,
        ..channel.clone()
    }
}

/// End index (exclusive) of the run that starts at `start`.
fn run_end(time_s: &[f64], start: usize, max_gap: f64) -> usize {
    let rest = time_s.get(start..).unwrap_or_default();
    rest.windows(2)
        .position(|t| t[1] - t[0] > max_gap)
        .map_or(time_s.len(), |k| start + k + 1)
}

/// Slope at `at` of the polynomial of degree 4 (or less for few samples) fitted to the samples. Polynomials orthogonal
/// on the sample times (Forsythe 1957) avoid normal equations.
fn slope(times: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let n = times.len();
    let scale = (times.last()? - times.first()?) / 2.0;
    if n < 2 || scale <= 0.0 {
        return None;
    }
    let x: Vec<f64> = times.iter().map(|t| (t - at) / scale).collect();
    let mut before = vec![0.0; n];
    let mut here = vec![1.0; n];
    // Value and slope at `at` of the last two orthogonal polynomials.
    let (mut p_before, mut d_before, mut p, mut d) = (0.0, 0.0, 1.0, 0.0);
    let mut norm_before = 1.0;
    let mut b = 0.0;
    let mut slope = 0.0;
    for degree in 0..=DEGREE.min(n - 1) {
        let norm: f64 = here.iter().map(|p| p * p).sum();
        let along: f64 = here.iter().zip(values).map(|(p, y)| p * y).sum();
        slope += along / norm * d;
        if degree > 0 {
            b = norm / norm_before;
        }
        let a = here.iter().zip(&x).map(|(p, x)| x * p * p).sum::<f64>() / norm;
        let (p_next, d_next) = (-a * p - b * p_before, p - a * d - b * d_before);
        for ((old, new), x) in before.iter_mut().zip(&mut here).zip(&x) {
            let next = (x - a) * *new - b * *old;
            *old = *new;
            *new = next;
        }
        (p_before, d_before, p, d) = (p, d, p_next, d_next);
        norm_before = norm;
    }
    Some(slope / scale)
}

fn derivative_name(channel: &Channel) -> (String, String) {
    let rate = |d: Dimension| match d {
        Dimension::Angle => Some(Dimension::AngularVelocity),
        Dimension::AngularVelocity => Some(Dimension::AngularAcceleration),
        Dimension::Length => Some(Dimension::Velocity),
        Dimension::Velocity => Some(Dimension::Acceleration),
        _ => None,
    };
    let name = channel.name.as_str();
    let standard = if let Some(axis) = name.strip_prefix("omega_") {
        Some(format!("domega_{axis}"))
    } else if let Some(axis) = name.strip_prefix("r_").filter(|a| a.len() == 1) {
        Some(format!("v_{axis}"))
    } else {
        [
            ("_rad_s", "_rad_s2"),
            ("_m_s", "_m_s2"),
            ("_rad", "_rad_s"),
            ("_m", "_m_s"),
        ]
        .iter()
        .find_map(|(old, new)| name.strip_suffix(old).map(|stem| format!("{stem}{new}")))
    };
    let dimension = classify(name).and_then(|c| rate(c.dimension));
    match (standard, dimension) {
        (Some(name), Some(d)) => (name, d.si().to_owned()),
        (_, Some(d)) => (format!("d/dt {name}"), d.si().to_owned()),
        _ => (format!("d/dt {name}"), format!("({})/s", channel.unit)),
    }
}
