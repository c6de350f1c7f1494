//! Linear limits of the unknowns of a minimax program.

/// One linear limit: `low <= sum_j a_j x_j <= high`.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    /// Index and factor of each unknown.
    pub a: Vec<(usize, f64)>,
    /// Lowest value; may be infinite.
    pub low: f64,
    /// Highest value; may be infinite.
    pub high: f64,
}

/// All linear limits together.
///
/// ```
/// use poinsot_solve::{Polytope, Side};
///
/// // 0 <= x_0 <= 1 and x_0 + x_1 <= 3.
/// let sides = vec![
///     Side { a: vec![(0, 1.0)], low: 0.0, high: 1.0 },
///     Side { a: vec![(0, 1.0), (1, 1.0)], low: f64::NEG_INFINITY, high: 3.0 },
/// ];
/// let polytope = Polytope { sides };
/// assert!(polytope.holds(&[0.5, 2.0], 0.0) && !polytope.holds(&[2.0, 0.0], 0.0));
/// // From (0, 0) along (1, 4) the second side is reached first.
/// assert_eq!(polytope.reach(&[0.0, 0.0], &[1.0, 4.0]), 0.6);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polytope {
    /// Sides, in any order.
    pub sides: Vec<Side>,
}

impl Side {
    /// `sum_j a_j x_j`.
    pub fn at(&self, x: &[f64]) -> f64 {
        self.a.iter().map(|(j, a)| a * x[*j]).sum()
    }

    /// The largest `alpha >= 0` with `x + alpha d` within this side.
    fn reach(&self, x: &[f64], d: &[f64]) -> f64 {
        let (value, slope) = (self.at(x), self.at(d));
        let room = match slope {
            s if s > 0.0 => (self.high - value) / s,
            s if s < 0.0 => (self.low - value) / s,
            _ => f64::INFINITY,
        };
        room.max(0.0)
    }
}

impl Polytope {
    /// The largest `alpha >= 0` with `x + alpha d` within all sides; `x` is inside.
    pub fn reach(&self, x: &[f64], d: &[f64]) -> f64 {
        let reaches = self.sides.iter().map(|s| s.reach(x, d));
        reaches.fold(f64::INFINITY, f64::min)
    }

    /// Whether `x` is inside, with tolerance `slack` in units of the sides.
    pub fn holds(&self, x: &[f64], slack: f64) -> bool {
        let inside = |s: &Side| {
            let value = s.at(x);
            value >= s.low - slack && value <= s.high + slack
        };
        self.sides.iter().all(inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_the_reach_of_a_ray_ends_on_the_nearest_side() {
        let side = |a: &[(usize, f64)], low, high| Side {
            a: a.to_vec(),
            low,
            high,
        };
        let polytope = Polytope {
            sides: vec![
                side(&[(0, 1.0)], -1.0, 2.0),
                side(&[(0, 1.0), (1, 1.0)], f64::NEG_INFINITY, 3.0),
            ],
        };
        assert_eq!(polytope.reach(&[0.0, 0.0], &[1.0, 0.0]), 2.0);
        assert_eq!(polytope.reach(&[0.0, 0.0], &[1.0, 2.0]), 1.0);
        assert_eq!(polytope.reach(&[0.0, 0.0], &[-2.0, 1.0]), 0.5);
        assert!(polytope.holds(&[2.0, 1.0], 0.0) && !polytope.holds(&[2.0, 1.1], 1.0e-9));
    }
}
