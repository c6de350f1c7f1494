//! A smoothing spline of fifth degree through noisy joint or wheel samples.
//!
//! The third derivative is modelled as white noise, whose intensity maximises the likelihood of the samples. The curve
//! is the posterior mean, a quintic spline (Wahba 1978, Wecker and Ansley 1983). With the state `[q, q', q'']` it is
//! computed by a Kalman filter and the smoother of de Jong 1989 (Durbin and Koopman 2012, section 4.4). The result is
//! linear in the samples, on any grid. Only ratios of noise are used, its size is fitted: noise-free samples are
//! interpolated for any declared noise.

use nalgebra::{Matrix3, RowVector3, Vector3};

/// Largest number of samples for fitting the intensity; longer records use parts.
const JUDGED: usize = 20_000;
const STRETCHES: usize = 20;
/// Decades of the intensity that are tried, relative to the noise of a sample.
const DECADES: std::ops::RangeInclusive<i32> = -16..=12;
/// Variances whose product is within the range of numbers.
const FACTORS: usize = 4;
/// Size of the unknown initial state, relative to noise and intensity.
const DIFFUSE: f64 = 1.0e8;

/// One sample: value and variance.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// Time, s.
    pub time_s: f64,
    /// Measured value and its variance.
    pub value: Option<(f64, f64)>,
    /// Measured rate of change and its variance.
    pub slope: Option<(f64, f64)>,
}

/// A curve with two continuous derivatives; beyond its ends it is a parabola.
///
/// ```
/// use poinsot_solve::smooth_curve::{Reading, SmoothCurve};
///
/// // Samples of a sine: the second derivative is minus the sine.
/// let sample = |k: u32| {
///     let time_s = 0.1 * f64::from(k);
///     Reading { time_s, value: Some((time_s.sin(), 1.0e-12)), slope: None }
/// };
/// let curve = SmoothCurve::new(&(0..100).map(sample).collect::<Vec<_>>()).unwrap();
/// let at = curve.at(5.05);
/// assert!((at[0] - 5.05_f64.sin()).abs() < 1.0e-6);
/// assert!((at[1] - 5.05_f64.cos()).abs() < 1.0e-4);
/// assert!((at[2] + 5.05_f64.sin()).abs() < 1.0e-2);
/// ```
#[derive(Debug, Clone, Default)]
pub struct SmoothCurve {
    time_s: Vec<f64>,
    /// Value and first two derivatives at these times.
    state: Vec<Vector3<f64>>,
}

impl SmoothCurve {
    /// `None` with fewer than four samples, or if none changes.
    pub fn new(readings: &[Reading]) -> Option<Self> {
        let unit = Unit::of(readings)?;
        let scaled: Vec<Reading> = readings.iter().map(|r| unit.scaled(r)).collect();
        let intensity = most_likely(&scaled)?;
        let states = smoothed(&scaled, intensity)?;
        let h = unit.time;
        let state = states.iter().map(|s| {
            let own = Vector3::new(s[0], s[1] / h, s[2] / (h * h));
            own + Vector3::new(unit.origin, 0.0, 0.0)
        });
        Some(Self {
            time_s: readings.iter().map(|r| r.time_s).collect(),
            state: state.collect(),
        })
    }

    /// Value, first and second derivative at a time.
    pub fn at(&self, t: f64) -> Vector3<f64> {
        let after = self.time_s.partition_point(|x| *x <= t);
        let (Some(first), Some(last)) = (self.state.first(), self.state.last()) else {
            return Vector3::zeros();
        };
        if after == 0 {
            return moved(first, t - self.time_s[0]);
        }
        if after == self.time_s.len() {
            return moved(last, t - self.time_s[after - 1]);
        }
        let (from, to) = (self.time_s[after - 1], self.time_s[after]);
        quintic(
            &self.state[after - 1],
            &self.state[after],
            to - from,
            t - from,
        )
    }
}

/// A state after a time, without jerk.
fn moved(s: &Vector3<f64>, t: f64) -> Vector3<f64> {
    Vector3::new(s[0] + t * (s[1] + 0.5 * t * s[2]), s[1] + t * s[2], s[2])
}

/// Quintic between two states separated by h, with its derivatives, at t after the first.
fn quintic(a: &Vector3<f64>, b: &Vector3<f64>, h: f64, t: f64) -> Vector3<f64> {
    // Error of the parabola of the first state at the second, divided by powers of h.
    let gap = b - moved(a, h);
    let (d0, d1, d2) = (gap[0], gap[1] * h, gap[2] * h * h);
    let c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2;
    let c4 = -15.0 * d0 + 7.0 * d1 - d2;
    let c5 = 6.0 * d0 - 3.0 * d1 + 0.5 * d2;
    let u = t / h;
    moved(a, t)
        + Vector3::new(
            u * u * u * (c3 + u * (c4 + u * c5)),
            u * u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)) / h,
            u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5)) / (h * h),
        )
}

/// Units in which time step and noise are of order one.
struct Unit {
    time: f64,
    start: f64,
    origin: f64,
    variance: f64,
}

impl Unit {
    fn of(readings: &[Reading]) -> Option<Self> {
        let first = readings.first()?;
        let mut steps: Vec<f64> = readings
            .windows(2)
            .map(|w| w[1].time_s - w[0].time_s)
            .collect();
        steps.sort_by(f64::total_cmp);
        let time = steps.get(steps.len() / 2).copied()?;
        let values = || readings.iter().filter_map(|r| r.value.map(|v| v.0));
        let slopes = || readings.iter().filter_map(|r| r.slope.map(|v| v.0));
        let origin = values().next().unwrap_or(0.0);
        let moves = values().any(|v| v != origin) || slopes().any(|s| s != 0.0);
        let variance = first
            .value
            .map(|v| v.1)
            .or(first.slope.map(|s| s.1 * time * time));
        let variance = variance.filter(|v| *v > 0.0)?;
        (moves && readings.len() >= 4 && time > 0.0).then_some(Self {
            time,
            start: first.time_s,
            origin,
            variance,
        })
    }

    fn scaled(&self, r: &Reading) -> Reading {
        let h = self.time;
        Reading {
            time_s: (r.time_s - self.start) / h,
            value: r.value.map(|(x, v)| (x - self.origin, v / self.variance)),
            slope: r.slope.map(|(x, v)| (x * h, v * h * h / self.variance)),
        }
    }
}

/// Filter update by one scalar sample: normalised innovation, its variance, gain, and measured component.
#[derive(Clone, Copy)]
struct Update {
    innovation: f64,
    variance: f64,
    gain: Vector3<f64>,
    /// Whether the slope was measured; otherwise the value.
    slope: bool,
}

/// Prediction of the state at one sample, before its update.
#[derive(Clone, Copy)]
struct Predicted {
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
}

fn transition(h: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, h, 0.5 * h * h, 0.0, 1.0, h, 0.0, 0.0, 1.0)
}

/// `F P F^T` with the [`transition`] F over a time.
fn carried(P: &Matrix3<f64>, h: f64) -> Matrix3<f64> {
    let g = 0.5 * h * h;
    let row = |i: usize| {
        let (b, c) = (P[(1, i)] + h * P[(2, i)], P[(2, i)]);
        [P[(0, i)] + h * P[(1, i)] + g * c, b, c]
    };
    let [x, y, z] = [0, 1, 2].map(row);
    // Rows of F P; P is symmetric.
    let (aa, ab, ac) = (x[0] + h * y[0] + g * z[0], y[0] + h * z[0], z[0]);
    let (bb, bc, cc) = (y[1] + h * z[1], z[1], z[2]);
    Matrix3::new(aa, ab, ac, ab, bb, bc, ac, bc, cc)
}

/// Covariance added by white jerk of unit intensity over a time.
fn added(h: f64) -> Matrix3<f64> {
    let (h2, h3) = (h * h, h * h * h);
    let (a, b, c, d) = (h3 * h2 / 20.0, h2 * h2 / 8.0, h3 / 6.0, h3 / 3.0);
    Matrix3::new(a, b, c, b, d, 0.5 * h2, c, 0.5 * h2, h)
}

/// The filter over samples; `each` receives every prediction and the following updates.
fn filter(
    readings: &[Reading],
    intensity: f64,
    mut predictions: impl FnMut(Predicted),
    mut updates: impl FnMut(Update),
) {
    let (Some(first), size) = (readings.first(), DIFFUSE * (1.0 + intensity)) else {
        return;
    };
    // The angle of a wheel is not measured: it starts at zero.
    let angle = if first.value.is_some() { size } else { 0.0 };
    let mut state = Vector3::new(
        first.value.map_or(0.0, |v| v.0),
        first.slope.map_or(0.0, |s| s.0),
        0.0,
    );
    let mut P = Matrix3::from_diagonal(&Vector3::new(angle, size, size));
    let mut before = first.time_s;
    for r in readings {
        let h = r.time_s - before;
        if h > 0.0 {
            state = moved(&state, h);
            P = carried(&P, h) + added(h) * intensity;
        }
        before = r.time_s;
        predictions(Predicted {
            state,
            covariance: P,
        });
        for (component, read) in [(0, r.value), (1, r.slope)] {
            let Some((value, noise)) = read else { continue };
            let column: Vector3<f64> = P.column(component).into();
            let variance = column[component] + noise;
            let gain = column / variance;
            let innovation = value - state[component];
            state += gain * innovation;
            // Joseph form: it stays positive for almost exact samples.
            let less = P - gain * column.transpose();
            let column: Vector3<f64> = less.column(component).into();
            P = less - column * gain.transpose() + gain * gain.transpose() * noise;
            updates(Update {
                innovation,
                variance,
                gain,
                slope: component == 1,
            });
        }
    }
}

/// `-2 ln` of the likelihood of an intensity, with fitted noise size.
fn deviance(stretches: &[&[Reading]], intensity: f64) -> f64 {
    let (mut sum, mut log_det, mut count) = (0.0, 0.0, 0.0);
    // A logarithm takes as long as the rest of a sample: one serves for a few.
    let (mut product, mut factors) = (1.0, 0);
    for readings in stretches {
        let mut seen = 0;
        filter(
            readings,
            intensity,
            |_| {},
            |u| {
                // The first three determine the initial state.
                seen += 1;
                if seen > 3 {
                    sum += u.innovation * u.innovation / u.variance;
                    product *= u.variance;
                    factors += 1;
                    if factors == FACTORS {
                        log_det += f64::ln(product);
                        (product, factors) = (1.0, 0);
                    }
                    count += 1.0;
                }
            },
        );
    }
    log_det += f64::ln(product);
    count * (sum / count).max(f64::MIN_POSITIVE).ln() + log_det
}

/// The intensity of highest likelihood: by decades, then between them.
fn most_likely(readings: &[Reading]) -> Option<f64> {
    let n = readings.len();
    let stretches: Vec<&[Reading]> = if n <= JUDGED {
        vec![readings]
    } else {
        let length = JUDGED / STRETCHES;
        (0..STRETCHES)
            .filter_map(|k| {
                let from = k * (n - length) / (STRETCHES - 1);
                readings.get(from..from + length)
            })
            .collect()
    };
    let of = |decade: f64| deviance(&stretches, 10.0_f64.powf(decade));
    let mut best = (0.0, f64::INFINITY);
    for decade in DECADES.step_by(4) {
        let d = of(f64::from(decade));
        if d < best.1 {
            best = (f64::from(decade), d);
        }
    }
    for step in [2.0, 1.0, 0.5, 0.25, 0.125] {
        for decade in [best.0 - step, best.0 + step] {
            let d = of(decade);
            if d < best.1 {
                best = (decade, d);
            }
        }
    }
    best.1.is_finite().then(|| 10.0_f64.powf(best.0))
}

/// States at all samples, from all samples.
fn smoothed(readings: &[Reading], intensity: f64) -> Option<Vec<Vector3<f64>>> {
    let mut predicted: Vec<Predicted> = Vec::with_capacity(readings.len());
    let measured = |r: &Reading| usize::from(r.value.is_some()) + usize::from(r.slope.is_some());
    let mut updates = Vec::with_capacity(readings.iter().map(measured).sum());
    filter(
        readings,
        intensity,
        |p| predicted.push(p),
        |u| updates.push(u),
    );
    let mut r = Vector3::zeros();
    let mut after = None;
    for (own, reading) in predicted.iter_mut().zip(readings).rev() {
        if let Some(next) = after.replace(reading.time_s) {
            r = transition(next - reading.time_s).transpose() * r;
        }
        for _ in 0..measured(reading) {
            let u: Update = updates.pop()?;
            let mut read = RowVector3::zeros();
            read[usize::from(u.slope)] = 1.0;
            let left = Matrix3::identity() - u.gain * read;
            r = read.transpose() * (u.innovation / u.variance) + left.transpose() * r;
        }
        own.state += own.covariance * r;
    }
    drop(updates);
    let states: Vec<Vector3<f64>> = predicted.iter().map(|p| p.state).collect();
    let finite = states.iter().all(|s| s.iter().all(|x| x.is_finite()));
    finite.then_some(states)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Pseudo-random numbers, approximately normal (Irwin-Hall).
    fn noise(k: usize) -> f64 {
        let one =
            |i: usize| ((i as f64 * 12.9898 + k as f64 * 78.233).sin() * 43_758.545_3).fract();
        (0..12).map(|i| one(i).abs()).sum::<f64>() - 6.0
    }

    /// Positions every second, rates every third time, on an uneven grid.
    fn readings(error: f64) -> Vec<Reading> {
        let time = |k: usize| 0.2 * k as f64 + 0.05 * (k as f64 * 1.7).sin();
        let of = |k: usize| {
            let t = time(k);
            let value = (t.sin() + error * noise(k), 1.0e-4);
            let slope = (t.cos() + 2.0 * error * noise(k + 1000), 4.0e-4);
            Reading {
                time_s: t,
                value: k.is_multiple_of(2).then_some(value),
                slope: k.is_multiple_of(3).then_some(slope),
            }
        };
        (0..60).map(of).collect()
    }

    #[test]
    fn exact_a_carried_covariance_is_that_of_the_transition() {
        let A = Matrix3::new(2.0, 0.3, -0.1, 0.0, 1.5, 0.4, 0.0, 0.0, 0.7);
        let P = A.transpose() * A;
        let F = transition(0.37);
        assert!((carried(&P, 0.37) - F * P * F.transpose()).amax() < 1.0e-14);
    }

    /// The same least-squares problem solved in one piece: samples, and jerk between them, each weighted by its noise.
    #[test]
    fn exact_smoothed_states_are_the_least_squares_of_all_readings() {
        let list = readings(0.01);
        let (n, intensity) = (list.len(), 3.0e-2);
        let mut A = DMatrix::zeros(3 * n, 3 * n);
        let mut b = DVector::zeros(3 * n);
        for (k, r) in list.iter().enumerate() {
            for (component, read) in [(0, r.value), (1, r.slope)] {
                if let Some((value, variance)) = read {
                    A[(3 * k + component, 3 * k + component)] += 1.0 / variance;
                    b[3 * k + component] += value / variance;
                }
            }
            if let Some(next) = list.get(k + 1) {
                let h = next.time_s - r.time_s;
                let weight = (added(h) * intensity).try_inverse().unwrap();
                let mut miss = nalgebra::SMatrix::<f64, 3, 6>::zeros();
                miss.fixed_view_mut::<3, 3>(0, 0).copy_from(&-transition(h));
                miss.fixed_view_mut::<3, 3>(0, 3)
                    .copy_from(&Matrix3::identity());
                let mut block = A.view_mut((3 * k, 3 * k), (6, 6));
                block += miss.transpose() * weight * miss;
            }
        }
        let whole = A.cholesky().unwrap().solve(&b);
        let states = smoothed(&list, intensity).unwrap();
        for (k, s) in states.iter().enumerate() {
            for i in 0..3 {
                // The diffuse initial variance is 1e8, not infinite.
                let gap = (s[i] - whole[3 * k + i]).abs();
                assert!(gap < 1.0e-6, "{k} {i}: {gap:e}");
            }
        }
    }

    #[test]
    fn exact_readings_without_noise_are_interpolated_with_their_derivatives() {
        let curve = SmoothCurve::new(&readings(0.0)).unwrap();
        for k in 0..100 {
            let t = 1.0 + 0.093 * f64::from(k);
            let s = curve.at(t);
            let gaps = [s[0] - t.sin(), s[1] - t.cos(), s[2] + t.sin()].map(f64::abs);
            // Measured: 2e-5, 1.6e-4 and 1.2e-3.
            assert!(
                gaps[0] < 6.0e-5 && gaps[1] < 5.0e-4 && gaps[2] < 4.0e-3,
                "{gaps:?}"
            );
        }
    }

    /// The curve and its derivatives are consistent and continuous over knots and ends.
    #[test]
    fn exact_derivatives_are_the_slopes_of_the_curve() {
        let curve = SmoothCurve::new(&readings(0.01)).unwrap();
        let h = 1.0e-4;
        for k in 0..400 {
            let t = -0.5 + 0.0331 * f64::from(k);
            let [a, s, b] = [t - h, t, t + h].map(|t| curve.at(t));
            for i in 0..2 {
                let slope = (b[i] - a[i]) / (2.0 * h);
                assert!(
                    (slope - s[i + 1]).abs() < 1.0e-5,
                    "{t} {i}: {slope} {}",
                    s[i + 1]
                );
            }
        }
    }

    /// The second derivative of a noisy motion has a small fraction of the error of finite differences.
    #[test]
    fn stat_noise_is_smoothed_as_far_as_the_motion_allows() {
        let (h, sigma) = (0.05, 1.0e-3);
        let of = |k: usize| Reading {
            time_s: h * k as f64,
            value: Some(((h * k as f64).sin() + sigma * noise(k), 1.0)),
            slope: None,
        };
        let list: Vec<Reading> = (0..1000).map(of).collect();
        let curve = SmoothCurve::new(&list).unwrap();
        let inner = 50..950;
        let count = inner.len() as f64;
        let square = |k: usize| (curve.at(list[k].time_s)[2] + list[k].time_s.sin()).powi(2);
        let rms = (inner.map(square).sum::<f64>() / count).sqrt();
        let by_differences = 6.0_f64.sqrt() * sigma / (h * h);
        // Measured: 0.01 of 1.0 rad/s2.
        println!("{rms} {by_differences}");
        assert!(rms < 0.03 * by_differences);
    }

    #[test]
    fn unit_what_tells_nothing_has_no_curve() {
        let still = |k: u32| Reading {
            time_s: f64::from(k),
            value: Some((0.3, 1.0)),
            slope: Some((0.0, 1.0)),
        };
        let still: Vec<Reading> = (0..10).map(still).collect();
        assert!(SmoothCurve::new(&still).is_none());
        assert!(SmoothCurve::new(&readings(0.0)[..3]).is_none());
        assert!(SmoothCurve::new(&[]).is_none());
    }
}
