//! Identifiable combinations in their readable form: one parameter plus multiples of those that are not distinguishable
//! from it (the base parameters of Gautier and Khalil 1990, found numerically).

use faer::Mat;

/// One combination of unknowns: coefficients in the unknowns' own units.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// Index and coefficient of each unknown; the leading one has coefficient 1.
    pub terms: Vec<(usize, f64)>,
}

impl Combination {
    fn led_by(lead: usize, others: impl Iterator<Item = (usize, f64)>) -> Self {
        let lead = std::iter::once((lead, 1.0));
        Self {
            terms: lead.chain(others).collect(),
        }
    }

    /// Gradient over all unknowns.
    pub fn gradient(&self, unknowns: usize) -> Vec<f64> {
        let mut g = vec![0.0; unknowns];
        for (at, coefficient) in &self.terms {
            g[*at] = *coefficient;
        }
        g
    }

    /// Value at a vector of unknowns.
    pub fn value(&self, x: &[f64]) -> f64 {
        self.terms.iter().map(|(at, c)| c * x[*at]).sum()
    }
}

/// The determined and the unobservable combinations of a problem.
#[derive(Debug, Clone)]
pub struct Combinations {
    /// One per identified direction: its value is constant along every unobservable direction.
    pub determined: Vec<Combination>,
    /// A basis of the unobservable directions.
    pub open: Vec<Combination>,
}

/// Coefficients below this share of a unit in natural units are rounding of the null space.
const DROP: f64 = 1.0e-9;

/// Splits the unknowns by an orthonormal basis of the unobservable directions (n x d, natural units).
///
/// Gaussian elimination with full pivoting turns the basis into one where each unobservable direction has one parameter
/// that no other has. The remaining parameters, corrected by these, are determined. `weight` above one favours an
/// unknown as such a parameter.
///
/// ```
/// use poinsot_identify::split;
///
/// // Two unknowns of which only the sum is observable: the open direction is their difference.
/// let r = 0.5_f64.sqrt();
/// let open = faer::mat![[r], [-r]];
/// let found = split(&open, &[1.0, 1.0], &[1.0, 1.0]);
/// assert_eq!((found.determined.len(), found.open.len()), (1, 1));
/// assert!((found.determined[0].value(&[2.0, 3.0]) - found.determined[0].value(&[3.0, 2.0])).abs() < 1.0e-12);
/// ```
pub fn split(open: &Mat<f64>, natural: &[f64], weight: &[f64]) -> Combinations {
    let (n, d) = (open.nrows(), open.ncols());
    let mut basis = open.clone();
    let mut pivots: Vec<usize> = Vec::with_capacity(d);
    for k in 0..d {
        let Some((row, column)) = largest(&basis, &pivots, k, weight) else {
            break;
        };
        for i in 0..n {
            let held = basis[(i, k)];
            basis[(i, k)] = basis[(i, column)];
            basis[(i, column)] = held;
        }
        let pivot = basis[(row, k)];
        for i in 0..n {
            basis[(i, k)] /= pivot;
        }
        for other in (0..d).filter(|o| *o != k) {
            let factor = basis[(row, other)];
            for i in 0..n {
                let step = factor * basis[(i, k)];
                basis[(i, other)] -= step;
            }
        }
        pivots.push(row);
    }
    let share = |i: usize, (k, p): (usize, &usize)| {
        let own = basis[(i, k)];
        (own.abs() > DROP).then(|| own * natural[i] / natural[*p])
    };
    let determined = (0..n).filter(|i| !pivots.contains(i)).map(|i| {
        let others = pivots.iter().enumerate();
        let others = others.filter_map(|(k, p)| Some((*p, -share(i, (k, p))?)));
        Combination::led_by(i, others)
    });
    let open = pivots.iter().enumerate().map(|(k, p)| {
        let others = (0..n).filter(|i| i != p);
        Combination::led_by(*p, others.filter_map(|i| Some((i, share(i, (k, p))?))))
    });
    Combinations {
        determined: determined.collect(),
        open: open.collect(),
    }
}

fn largest(
    basis: &Mat<f64>,
    taken: &[usize],
    from: usize,
    weight: &[f64],
) -> Option<(usize, usize)> {
    let mut best = (0.0, None);
    for column in from..basis.ncols() {
        for row in (0..basis.nrows()).filter(|r| !taken.contains(r)) {
            let size = basis[(row, column)].abs() * weight[row];
            if size > best.0 {
                best = (size, Some((row, column)));
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_determined_combinations_do_not_see_the_open_direction() {
        // Only x0 + x1 and x2 are determined: the unobservable direction is (1, -1, 0)/sqrt 2.
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let open = Mat::from_fn(3, 1, |i, _| [h, -h, 0.0][i]);
        let natural = [2.0, 0.5, 1.0];
        let c = split(&open, &natural, &[1.0; 3]);
        assert_eq!(c.determined.len(), 2);
        for combination in &c.determined {
            let step: f64 = combination
                .terms
                .iter()
                .map(|(i, a)| a * natural[*i] * open[(*i, 0)])
                .sum();
            assert!(step.abs() < 1e-15);
        }
    }
}
