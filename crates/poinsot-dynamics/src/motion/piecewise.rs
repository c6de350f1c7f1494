//! Piecewise polynomials of time, for joint plans, wheel speeds and motor torques.

/// Why nodes define no profile.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NodeError {
    /// No node at all.
    #[error("needs at least one node")]
    Empty,
    /// As many times as values are needed.
    #[error("{times} times but {values} values")]
    Length {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A time or value is NaN or infinite.
    #[error("node {0} is not finite")]
    NotFinite(usize),
    /// Times must increase strictly.
    #[error("time of node {0} is not after that of the previous node")]
    NotIncreasing(usize),
}

/// Value with its first two derivatives with respect to time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First derivative, per second.
    pub rate: f64,
    /// Second derivative, per second squared.
    pub acceleration: f64,
}

/// A function of time that is a polynomial between nodes and constant outside them. Default: zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PiecewisePolynomial {
    nodes: Vec<f64>,
    /// Ascending coefficients in `s = (t - t_i) / (t_{i+1} - t_i)`.
    pieces: Vec<[f64; 6]>,
    before: f64,
    after: f64,
}

impl PiecewisePolynomial {
    /// A constant without nodes.
    pub fn constant(value: f64) -> Self {
        Self {
            before: value,
            after: value,
            ..Self::default()
        }
    }

    /// Rest-to-rest quintics, `y_i + dy (10 s^3 - 15 s^4 + 6 s^5)`: rate and acceleration vanish at
    /// every node.
    ///
    /// # Errors
    /// Nodes that define no profile.
    pub fn quintic_rest(times: &[f64], values: &[f64]) -> Result<Self, NodeError> {
        Self::from_pieces(times, values, |_, y0, y1| {
            let d = y1 - y0;
            [y0, 0.0, 0.0, 10.0 * d, -15.0 * d, 6.0 * d]
        })
    }

    /// The cubic spline through the nodes with zero rate at both ends (de Boor 1978, ch. IV).
    ///
    /// # Errors
    /// Nodes that define no profile.
    pub fn cubic_clamped(times: &[f64], values: &[f64]) -> Result<Self, NodeError> {
        check(times, values)?;
        let slope = clamped_slopes(times, values);
        Self::from_pieces(times, values, |i, y0, y1| {
            let h = times[i + 1] - times[i];
            let (d, m0, m1) = (y1 - y0, h * slope[i], h * slope[i + 1]);
            // Hermite form in s.
            [y0, m0, 3.0 * d - 2.0 * m0 - m1, m0 + m1 - 2.0 * d, 0.0, 0.0]
        })
    }

    /// Straight lines between the nodes.
    ///
    /// # Errors
    /// Nodes that define no profile.
    pub fn linear(times: &[f64], values: &[f64]) -> Result<Self, NodeError> {
        Self::from_pieces(times, values, |_, y0, y1| [y0, y1 - y0, 0.0, 0.0, 0.0, 0.0])
    }

    /// Each value from its node to the next; the last to the end.
    ///
    /// # Errors
    /// Nodes that define no profile.
    pub fn steps(times: &[f64], values: &[f64]) -> Result<Self, NodeError> {
        Self::from_pieces(times, values, |_, y0, _| [y0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// The same profile with another constant before the first node.
    pub fn starting_from(mut self, before: f64) -> Self {
        self.before = before;
        self
    }

    /// This profile and then another; the last value is held until the other begins.
    ///
    /// # Errors
    /// The other begins before this one has ended.
    pub fn then(mut self, next: &Self) -> Result<Self, NodeError> {
        let (Some(&end), Some(&begin)) = (self.nodes.last(), next.nodes.first()) else {
            return Ok(if self.nodes.is_empty() {
                next.clone()
            } else {
                self
            });
        };
        if begin < end {
            return Err(NodeError::NotIncreasing(self.nodes.len()));
        }
        if begin > end {
            self.nodes.push(begin);
            self.pieces.push([self.after, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
        self.nodes.extend(&next.nodes[1..]);
        self.pieces.extend(&next.pieces);
        self.after = next.after;
        Ok(self)
    }

    /// Values before the first and after the last node.
    pub fn ends(&self) -> (f64, f64) {
        (self.before, self.after)
    }

    /// The times at which some derivative jumps: integration restarts there.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Value and derivatives at `t`, on the piece that holds `within`.
    ///
    /// At a node `within` decides between the limit from the left and from the right.
    #[inline]
    pub fn at(&self, t: f64, within: f64) -> Jet {
        let i = self.nodes.partition_point(|node| *node <= within);
        let hold = |value| Jet {
            value,
            ..Jet::default()
        };
        if i == 0 {
            return hold(self.before);
        }
        let (Some(c), Some(end)) = (self.pieces.get(i - 1), self.nodes.get(i)) else {
            return hold(self.after);
        };
        let h = end - self.nodes[i - 1];
        let s = (t - self.nodes[i - 1]) / h;
        let value = c.iter().rev().fold(0.0, |y, c| y * s + c);
        let rate = c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])));
        let curvature = 2.0 * c[2] + s * (6.0 * c[3] + s * (12.0 * c[4] + s * 20.0 * c[5]));
        Jet {
            value,
            rate: rate / h,
            acceleration: curvature / (h * h),
        }
    }

    fn from_pieces(
        times: &[f64],
        values: &[f64],
        piece: impl Fn(usize, f64, f64) -> [f64; 6],
    ) -> Result<Self, NodeError> {
        check(times, values)?;
        let pieces = values
            .windows(2)
            .enumerate()
            .map(|(i, y)| piece(i, y[0], y[1]))
            .collect();
        Ok(Self {
            nodes: times.to_vec(),
            pieces,
            before: values[0],
            after: values[values.len() - 1],
        })
    }
}

fn check(times: &[f64], values: &[f64]) -> Result<(), NodeError> {
    if times.is_empty() {
        return Err(NodeError::Empty);
    }
    if times.len() != values.len() {
        return Err(NodeError::Length {
            times: times.len(),
            values: values.len(),
        });
    }
    let finite = |(t, y): (&f64, &f64)| t.is_finite() && y.is_finite();
    if let Some(i) = times.iter().zip(values).position(|pair| !finite(pair)) {
        return Err(NodeError::NotFinite(i));
    }
    match times.windows(2).position(|t| t[1] <= t[0]) {
        Some(i) => Err(NodeError::NotIncreasing(i + 1)),
        None => Ok(()),
    }
}

/// Rates at the nodes of the clamped spline: the second derivative is continuous inside,
/// `h_i m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_{i-1} m_{i+1} = 3 (h_i d_{i-1} + h_{i-1} d_i)`,
/// with `m_0 = m_n = 0`; one sweep down, one up (Thomas).
fn clamped_slopes(t: &[f64], y: &[f64]) -> Vec<f64> {
    let n = t.len();
    let (mut upper, mut slope) = (vec![0.0; n], vec![0.0; n]);
    for i in 1..n.saturating_sub(1) {
        let (h0, h1) = (t[i] - t[i - 1], t[i + 1] - t[i]);
        let (d0, d1) = ((y[i] - y[i - 1]) / h0, (y[i + 1] - y[i]) / h1);
        let pivot = 2.0 * (h0 + h1) - h1 * upper[i - 1];
        upper[i] = h0 / pivot;
        slope[i] = (3.0 * (h1 * d0 + h0 * d1) - h1 * slope[i - 1]) / pivot;
    }
    for i in (1..n.saturating_sub(1)).rev() {
        slope[i] -= upper[i] * slope[i + 1];
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: [f64; 4] = [0.0, 1.0, 3.0, 3.5];
    const Y: [f64; 4] = [1.0, -2.0, 0.5, 4.0];

    fn profiles() -> [PiecewisePolynomial; 3] {
        [
            PiecewisePolynomial::quintic_rest(&T, &Y).unwrap(),
            PiecewisePolynomial::cubic_clamped(&T, &Y).unwrap(),
            PiecewisePolynomial::linear(&T, &Y).unwrap(),
        ]
    }

    #[test]
    fn exact_profiles_pass_through_their_nodes_from_both_sides() {
        for p in profiles() {
            for i in 0..4 {
                for side in [-0.1, 0.1] {
                    assert!((p.at(T[i], T[i] + side).value - Y[i]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn exact_quintic_rests_at_nodes_and_spline_is_twice_differentiable() {
        let [quintic, cubic, _] = profiles();
        for t in T {
            for side in [-0.1, 0.1] {
                let jet = quintic.at(t, t + side);
                assert!(jet.rate.abs() < 1e-13 && jet.acceleration.abs() < 1e-12);
            }
        }
        for t in [1.0, 3.0] {
            let (left, right) = (cubic.at(t, t - 0.1), cubic.at(t, t + 0.1));
            assert!((left.rate - right.rate).abs() < 1e-13);
            assert!((left.acceleration - right.acceleration).abs() < 1e-12);
        }
        assert!(cubic.at(0.0, 0.1).rate.abs() < 1e-15);
        assert!(cubic.at(3.5, 3.4).rate.abs() < 1e-13);
    }

    #[test]
    fn exact_clamped_spline_of_a_symmetric_bump() {
        // Through (0,0), (1,1), (2,0) with zero end rates: 3 s^2 - 2 s^3 and its mirror.
        let p = PiecewisePolynomial::cubic_clamped(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]).unwrap();
        for t in [0.25_f64, 0.5, 0.9] {
            let y = t * t * (3.0 - 2.0 * t);
            assert!((p.at(t, t).value - y).abs() < 1e-15);
            assert!((p.at(2.0 - t, 2.0 - t).value - y).abs() < 1e-15);
        }
    }

    #[test]
    fn unit_derivatives_agree_with_differences() {
        let h = 1e-5;
        for p in profiles() {
            for t in [0.3, 1.7, 3.2] {
                let (a, b, c) = (p.at(t - h, t), p.at(t, t), p.at(t + h, t));
                assert!(((c.value - a.value) / (2.0 * h) - b.rate).abs() < 1e-6);
                assert!(((c.rate - a.rate) / (2.0 * h) - b.acceleration).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn exact_two_profiles_follow_each_other_with_a_rest_between() {
        let [quintic, cubic, _] = profiles();
        let later: Vec<f64> = T.iter().map(|t| t + 5.0).collect();
        let second = PiecewisePolynomial::cubic_clamped(&later, &Y).unwrap();
        let both = quintic.clone().then(&second).unwrap();
        for k in 0..200 {
            let t = -0.5 + 0.05 * f64::from(k);
            let one = match t {
                t if t < 4.0 => quintic.at(t, t),
                t if t < 5.0 => quintic.at(9.0, 9.0),
                t => cubic.at(t - 5.0, t - 5.0),
            };
            let jet = both.at(t, t);
            assert!((jet.value - one.value).abs() < 1e-12, "{t}");
            assert!((jet.rate - one.rate).abs() < 1e-11, "{t}");
        }
        assert_eq!(both.ends(), (Y[0], Y[3]));
        // One that begins at once needs no node of its own.
        let at_once: Vec<f64> = T.iter().map(|t| t + T[3]).collect();
        let second = PiecewisePolynomial::linear(&at_once, &Y).unwrap();
        assert_eq!(cubic.clone().then(&second).unwrap().nodes().len(), 7);
        assert_eq!(second.then(&cubic), Err(NodeError::NotIncreasing(4)));
    }

    #[test]
    fn unit_steps_hold_and_bad_nodes_are_named() {
        let p = PiecewisePolynomial::steps(&T, &Y)
            .unwrap()
            .starting_from(0.0);
        assert_eq!(p.at(-1.0, -1.0).value, 0.0);
        assert_eq!(p.at(1.0, 1.5).value, -2.0);
        assert_eq!(p.at(1.0, 0.5).value, 1.0);
        assert_eq!(p.at(9.0, 9.0).value, 4.0);
        let bad = PiecewisePolynomial::linear(&[0.0, 0.0], &[1.0, 2.0]);
        assert_eq!(bad, Err(NodeError::NotIncreasing(1)));
        let bad = PiecewisePolynomial::linear(&[0.0, f64::NAN], &[1.0, 2.0]);
        assert_eq!(bad, Err(NodeError::NotFinite(1)));
    }
}
