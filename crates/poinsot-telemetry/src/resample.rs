//! Resamples a channel; never across a gap or beyond its ends.

use crate::median::median_step;
use crate::{Channel, rotation};

/// Steps above this multiple of the median step are gaps.
pub const GAP: f64 = 3.0;

/// Position of a time in a time base.
enum TimePosition {
    /// At this sample.
    On(usize),
    /// Between this sample and the next.
    After(usize),
}

/// A time base with its tolerances.
struct Base<'a> {
    time_s: &'a [f64],
    /// Times this close to a sample count as equal, s.
    tolerance: f64,
    /// Steps longer than this are gaps, s.
    max_gap: f64,
}

impl<'a> Base<'a> {
    fn new(time_s: &'a [f64], max_gap_s: Option<f64>) -> Self {
        let step = median_step(time_s).unwrap_or(0.0);
        Self {
            time_s,
            tolerance: (1e-6 * step).max(1e-9),
            max_gap: max_gap_s.unwrap_or(GAP * step),
        }
    }

    fn locate(&self, t: f64) -> Option<TimePosition> {
        let next = self.time_s.partition_point(|&x| x < t);
        let near = |k: usize| {
            self.time_s
                .get(k)
                .is_some_and(|x| (x - t).abs() <= self.tolerance)
        };
        if near(next) {
            return Some(TimePosition::On(next));
        }
        let before = next.checked_sub(1)?;
        if near(before) {
            return Some(TimePosition::On(before));
        }
        let (a, b) = (self.time_s.get(before)?, self.time_s.get(next)?);
        (b - a <= self.max_gap).then_some(TimePosition::After(before))
    }
}

/// The channel at each of `times_s`: its sample, or linear interpolation between neighbours (error `h^2 |x''| / 8`).
///
/// Times within 1e-9 s or 1e-6 of the median step of a sample count as equal. `None` beyond the ends and in gaps
/// longer than `max_gap_s` (default 3 median steps). Values are in SI and the axes of the channel.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// let angle = channel("joint1_rad", "rad", &[0.0, 1.0, 2.0, 9.0], &[0.0, 2.0, 4.0, 5.0]);
/// // Between samples, in the gap, and beyond the end.
/// assert_eq!(resample(&angle, &[0.5, 5.0, 10.0], None), [Some(1.0), None, None]);
/// ```
pub fn resample(channel: &Channel, times_s: &[f64], max_gap_s: Option<f64>) -> Vec<Option<f64>> {
    interpolated(channel, &[], times_s, max_gap_s)
}

/// Like [`resample`], with cubic Hermite interpolation of values and measured derivatives (error `h^4 |x''''| / 384`).
/// Linear where the derivative has no sample.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// // t^3 with its rate 3 t^2: a cubic is reproduced.
/// let angle = channel("joint1_rad", "rad", &[0.0, 1.0, 2.0], &[0.0, 1.0, 8.0]);
/// let rate = channel("joint1_rad_s", "rad/s", &[0.0, 1.0, 2.0], &[0.0, 3.0, 12.0]);
/// assert_eq!(resample_hermite(&angle, &rate, &[1.5]), [Some(3.375)]);
/// ```
pub fn resample_hermite(
    channel: &Channel,
    derivative: &Channel,
    times_s: &[f64],
) -> Vec<Option<f64>> {
    let slopes = resample(derivative, &channel.time_s, None);
    interpolated(channel, &slopes, times_s, None)
}

/// By a cubic where both neighbours have a slope, linear elsewhere.
fn interpolated(
    channel: &Channel,
    slopes: &[Option<f64>],
    times_s: &[f64],
    max_gap_s: Option<f64>,
) -> Vec<Option<f64>> {
    let base = Base::new(&channel.time_s, max_gap_s);
    let slope = |k: usize| slopes.get(k).copied().flatten();
    let at = |&t: &f64| match base.locate(t)? {
        TimePosition::On(k) => channel.values.get(k).copied(),
        TimePosition::After(k) => {
            let (t0, t1) = (base.time_s.get(k)?, base.time_s.get(k + 1)?);
            let (x0, x1) = (*channel.values.get(k)?, *channel.values.get(k + 1)?);
            let (h, u) = (t1 - t0, (t - t0) / (t1 - t0));
            match (slope(k), slope(k + 1)) {
                (Some(d0), Some(d1)) => Some(hermite(x0, x1, h * d0, h * d1, u)),
                _ => Some(x0 + (x1 - x0) * (t - t0) / h),
            }
        }
    };
    times_s.iter().map(at).collect()
}

/// Attitude at each of `times_s`, unit quaternions `[x, y, z, w]`, Hamilton, body to inertial.
///
/// `attitude` holds the channels q_x, q_y, q_z, q_w on one time base. Without `omega_body` (rad/s, body axes), the
/// shortest rotation at constant rate (error of order `h^2`). With it, a cubic in the rotation vector that matches the
/// body rates at both ends (order `h^4`). `None` as in [`resample`], and everywhere if the four channels have
/// different times.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// // Between two samples of a steady turn the attitude is exact.
/// let t = 0.25;
/// let [q] = resample_attitude(attitude.each_ref(), None, &[t])[..] else { unreachable!() };
/// let [x, .., w] = q.unwrap();
/// assert!((w - (0.5 * speed * t).cos()).abs() < 1.0e-14);
/// assert!((x - rate[0] / speed * (0.5 * speed * t).sin()).abs() < 1.0e-14);
/// ```
pub fn resample_attitude(
    attitude: [&Channel; 4],
    omega_body: Option<[&Channel; 3]>,
    times_s: &[f64],
) -> Vec<Option<[f64; 4]>> {
    let [x, y, z, w] = attitude;
    if [y, z, w].iter().any(|c| c.time_s != x.time_s) {
        return vec![None; times_s.len()];
    }
    let base = Base::new(&x.time_s, None);
    let rates = omega_body.map(|o| o.map(|c| resample(c, &x.time_s, None)));
    let q = |k: usize| {
        Some([
            *x.values.get(k)?,
            *y.values.get(k)?,
            *z.values.get(k)?,
            *w.values.get(k)?,
        ])
    };
    let rate = |k: usize| -> Option<[f64; 3]> {
        let [a, b, c] = rates.as_ref()?;
        Some([(*a.get(k)?)?, (*b.get(k)?)?, (*c.get(k)?)?])
    };
    let at = |&t: &f64| match base.locate(t)? {
        TimePosition::On(k) => q(k),
        TimePosition::After(k) => {
            let (t0, t1) = (base.time_s.get(k)?, base.time_s.get(k + 1)?);
            let (h, u) = (t1 - t0, (t - t0) / (t1 - t0));
            let q0 = q(k)?;
            let turn = rotation::turn_between(q0, q(k + 1)?);
            let phi = match (rate(k), rate(k + 1)) {
                (Some(w0), Some(w1)) => {
                    let d1 = rotation::rotation_vector_rate(turn, w1);
                    let mut phi = [0.0; 3];
                    for ((phi, turn), (d0, d1)) in
                        phi.iter_mut().zip(turn).zip(w0.into_iter().zip(d1))
                    {
                        *phi = hermite(0.0, turn, h * d0, h * d1, u);
                    }
                    phi
                }
                _ => turn.map(|c| c * u),
            };
            Some(rotation::turned(q0, phi))
        }
    };
    times_s.iter().map(at).collect()
}

/// Cubic on `u` in 0..1 with end values `x0`, `x1` and end slopes `d0`, `d1` (per unit of `u`).
#[inline]
fn hermite(x0: f64, x1: f64, d0: f64, d1: f64, u: f64) -> f64 {
    let dx = x1 - x0;
    let c2 = 3.0 * dx - 2.0 * d0 - d1;
    let c3 = d0 + d1 - 2.0 * dx;
    x0 + u * (d0 + u * (c2 + u * c3))
}
