//! Joint motions prescribed in time, evaluated independently of the simulator.

/// A planned coordinate with its first two derivatives (rad or m, per s, per s2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanSample {
    /// Position.
    pub position: f64,
    /// Rate.
    pub rate: f64,
    /// Acceleration.
    pub acceleration: f64,
}

impl PlanSample {
    fn at_rest(position: f64) -> Self {
        Self {
            position,
            rate: 0.0,
            acceleration: 0.0,
        }
    }
}

fn check(times: &[f64], positions: &[f64]) {
    let rising = times.windows(2).all(|w| w[0] < w[1]);
    assert!(
        times.len() >= 2 && times.len() == positions.len() && rising,
        "knots need at least two rising times and as many positions"
    );
}

/// The interval that contains `t`; `None` before the first and after the last knot.
fn interval(times: &[f64], t: f64) -> Option<usize> {
    if t == times[times.len() - 1] {
        return Some(times.len() - 2);
    }
    times.windows(2).position(|w| w[0] <= t && t < w[1])
}

fn held(times: &[f64], positions: &[f64], t: f64) -> PlanSample {
    let end = if t < times[0] { 0 } else { positions.len() - 1 };
    PlanSample::at_rest(positions[end])
}

/// Quintic from rest to rest between neighbouring knots: rate and acceleration vanish at every knot;
/// held before the first and after the last.
///
/// # Panics
/// Fewer than two knots, times that do not increase, or lengths that differ.
pub fn quintic_rest(times: &[f64], positions: &[f64], t: f64) -> PlanSample {
    check(times, positions);
    let Some(k) = interval(times, t) else {
        return held(times, positions, t);
    };
    let span = times[k + 1] - times[k];
    let step = positions[k + 1] - positions[k];
    let s = (t - times[k]) / span;
    PlanSample {
        position: positions[k] + step * (10.0 * s.powi(3) - 15.0 * s.powi(4) + 6.0 * s.powi(5)),
        rate: step / span * 30.0 * s.powi(2) * (1.0 - s).powi(2),
        acceleration: step / span.powi(2) * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    }
}

/// A cubic spline with given end rates ("clamped"), twice continuously differentiable.
#[derive(Debug, Clone, PartialEq)]
pub struct ClampedSpline {
    times: Vec<f64>,
    positions: Vec<f64>,
    /// Accelerations at the knots.
    curvatures: Vec<f64>,
}

impl ClampedSpline {
    /// The spline through the knots with the rates `end_rates` at its first and last knot.
    ///
    /// The accelerations at the knots solve the tridiagonal system
    /// `h_{k-1} c_{k-1} + 2 (h_{k-1} + h_k) c_k + h_k c_{k+1} = 6 (s_k - s_{k-1})`, with `h` the spans and `s` the
    /// secants, where the end rates replace the secants outside (de Boor 1978, ch. IV).
    ///
    /// # Panics
    /// Fewer than two knots, times that do not increase, or lengths that differ.
    pub fn new(times: &[f64], positions: &[f64], end_rates: [f64; 2]) -> Self {
        check(times, positions);
        let n = times.len();
        let span: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        let mut slopes = vec![end_rates[0]];
        slopes.extend((0..n - 1).map(|k| (positions[k + 1] - positions[k]) / span[k]));
        slopes.push(end_rates[1]);
        let before = |k: usize| if k == 0 { 0.0 } else { span[k - 1] };
        let after = |k: usize| if k + 1 == n { 0.0 } else { span[k] };
        // Thomas's elimination, then back substitution.
        let (mut diagonal, mut right) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..n {
            diagonal[k] = 2.0 * (before(k) + after(k));
            right[k] = 6.0 * (slopes[k + 1] - slopes[k]);
            if k > 0 {
                let factor = before(k) / diagonal[k - 1];
                diagonal[k] -= factor * before(k);
                right[k] -= factor * right[k - 1];
            }
        }
        let mut curvatures = vec![0.0; n];
        for k in (0..n).rev() {
            let next = if k + 1 < n { curvatures[k + 1] } else { 0.0 };
            curvatures[k] = (right[k] - after(k) * next) / diagonal[k];
        }
        Self {
            times: times.to_vec(),
            positions: positions.to_vec(),
            curvatures,
        }
    }

    /// The spline at `t`; at rest at its end positions outside the knots.
    pub fn at(&self, t: f64) -> PlanSample {
        let Some(k) = interval(&self.times, t) else {
            return held(&self.times, &self.positions, t);
        };
        let h = self.times[k + 1] - self.times[k];
        let (left, right) = (t - self.times[k], self.times[k + 1] - t);
        let (c0, c1) = (self.curvatures[k], self.curvatures[k + 1]);
        let a = self.positions[k] / h - c0 * h / 6.0;
        let b = self.positions[k + 1] / h - c1 * h / 6.0;
        PlanSample {
            position: (c0 * right.powi(3) + c1 * left.powi(3)) / (6.0 * h) + a * right + b * left,
            rate: (c1 * left.powi(2) - c0 * right.powi(2)) / (2.0 * h) - a + b,
            acceleration: (c0 * right + c1 * left) / h,
        }
    }
}

/// `offset + sum_k (sine_k sin(k w t) + cosine_k cos(k w t))`, k from 1, `w` in rad/s.
///
/// `terms` holds `[sine_k, cosine_k]`.
pub fn fourier(offset: f64, base_rad_s: f64, terms: &[[f64; 2]], t: f64) -> PlanSample {
    let mut sample = PlanSample::at_rest(offset);
    for (k, [sine, cosine]) in terms.iter().enumerate() {
        let w = base_rad_s * (k as f64 + 1.0);
        let (s, c) = (w * t).sin_cos();
        sample.position += sine * s + cosine * c;
        sample.rate += w * (sine * c - cosine * s);
        sample.acceleration -= w * w * (sine * s + cosine * c);
    }
    sample
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: [f64; 5] = [0.0, 1.5, 2.0, 4.0, 7.0];
    const POSITIONS: [f64; 5] = [0.3, -0.4, 1.1, 0.2, 0.9];

    fn close(found: PlanSample, expected: [f64; 3], tolerance: f64) {
        let found = [found.position, found.rate, found.acceleration];
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < tolerance, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn xval_scipy_clamped_spline_at_rest() {
        let spline = ClampedSpline::new(&TIMES, &POSITIONS, [0.0, 0.0]);
        for (t, expected) in [
            (0.0, [0.3, 0.0, -4.784857723577235]),
            (
                0.7,
                [-0.39636214995483265, -1.3097090108401077, 1.042831978319783],
            ),
            (1.5, [-0.4, 2.1886432926829267, 7.703048780487801]),
            (
                1.9,
                [0.806413414634146, 3.130204268292684, -2.9952439024390145],
            ),
            (
                2.6,
                [1.8338384146341462, -0.023765243902439726, -3.39923780487805],
            ),
            (
                3.999,
                [0.2010750341253793, -1.075982254192076, 1.8949961890243907],
            ),
            (
                5.5,
                [0.14721798780487794, 0.618521341463415, 0.35802845528455296],
            ),
            (7.0, [0.9, 0.0, -1.1827235772357723]),
        ] {
            close(spline.at(t), expected, 2e-14);
        }
    }

    #[test]
    fn xval_scipy_clamped_spline_with_end_rates() {
        let spline = ClampedSpline::new(&TIMES, &POSITIONS, [0.25, -0.7]);
        for (t, expected) in [
            (0.0, [0.3, 0.25, -5.410772357723578]),
            (
                0.7,
                [
                    -0.34125943992773267,
                    -1.3544844173441737,
                    0.8265311653116525,
                ],
            ),
            (1.5, [-0.4, 2.158079268292683, 7.954878048780486]),
            (
                1.9,
                [0.8060414634146338, 3.138176829268293, -3.0543902439024357],
            ),
            (
                2.6,
                [
                    1.8155914634146344,
                    -0.07027439024390314,
                    -3.4112804878048792,
                ],
            ),
            (
                3.999,
                [0.20093462494435688, -0.9357126379573186, 2.1740564024390245],
            ),
            (
                5.5,
                [0.46242378048780486, 0.7583841463414636, 0.07784552845528481],
            ),
            (7.0, [0.9, -0.7, -2.022357723577236]),
        ] {
            close(spline.at(t), expected, 2e-14);
        }
    }

    #[test]
    fn exact_two_knots_make_the_cubic_from_rest_to_rest() {
        let spline = ClampedSpline::new(&[1.0, 3.0], &[0.0, 8.0], [0.0, 0.0]);
        // 3 s^2 - 2 s^3 at s = 1/4.
        close(spline.at(1.5), [1.25, 4.5, 6.0], 1e-14);
        close(spline.at(0.0), [0.0; 3], 0.0 + f64::MIN_POSITIVE);
        close(spline.at(9.0), [8.0, 0.0, 0.0], f64::MIN_POSITIVE);
    }

    #[test]
    fn exact_quintic_middle_and_knots() {
        let at = |t| quintic_rest(&[1.0, 3.0, 4.0], &[0.0, 8.0, 7.0], t);
        close(at(2.0), [4.0, 7.5, 0.0], 1e-14);
        close(at(3.0), [8.0, 0.0, 0.0], 1e-14);
        close(at(4.0), [7.0, 0.0, 0.0], 1e-14);
        close(at(5.0), [7.0, 0.0, 0.0], 1e-14);
        // s = 1/4: 10/64 - 15/256 + 6/1024, 30/16 9/16, 60 3/32.
        close(
            at(1.5),
            [8.0 * 106.0 / 1024.0, 4.0 * 270.0 / 256.0, 2.0 * 5.625],
            1e-14,
        );
    }

    #[test]
    fn exact_fourier_by_hand() {
        let sample = fourier(1.0, 2.0, &[[0.5, 0.0], [0.0, 0.25]], 0.0);
        close(sample, [1.25, 1.0, -4.0], 1e-15);
    }

    #[test]
    fn unit_bad_knots_are_refused() {
        for (times, positions) in [
            (vec![0.0], vec![0.0]),
            (vec![0.0, 0.0], vec![0.0, 1.0]),
            (vec![0.0, 1.0], vec![0.0]),
            (vec![0.0, f64::NAN], vec![0.0, 1.0]),
        ] {
            let refused = std::panic::catch_unwind(|| check(&times, &positions));
            assert!(refused.is_err(), "{times:?}");
        }
    }
}
