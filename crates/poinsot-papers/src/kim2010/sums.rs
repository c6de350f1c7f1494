//! The sums that all estimators use, and the estimators (2)-(16).

use crate::samples::add_smallest;
use crate::study::statistics::largest;
use faer::Mat;
use poinsot_files::{Faults, Place};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Order of the six elements, as in the paper's tables.
pub const ELEMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
/// Names of the six elements.
pub const NAMES: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Singular values of `G` below this fraction of the largest are round-off.
const ROUND_OFF: f64 = 1.0e-10;
/// Assumption on the rates at the first sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StartRate {
    /// Zero, as the paper assumes after (7): the noise of the first sample has no effect.
    #[default]
    Rest,
    /// As measured: `I w(0)` remains in (7).
    Measured,
}

/// One segment of telemetry on common times.
#[derive(Debug, Clone, Copy)]
pub struct Manoeuvre<'a> {
    /// Attitude of the body.
    pub R_NB: &'a [UnitQuaternion],
    /// Angular velocity in B, rad/s.
    pub w_NB_B: &'a [Vector3],
    /// Momentum of the wheels relative to the body `C I_rw omega_rw`, in B, N m s.
    pub h_W_B: &'a [Vector3],
    /// Rates at the first sample.
    pub start: StartRate,
}

/// Result of one estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The nine elements before pairs are averaged (16).
    pub elements: Matrix3,
    /// The six numbers of the paper's tables: pairs averaged, except for the batch fit, which prints the elements xy,
    /// yz, zx.
    pub printed: [f64; 6],
}

/// Momentum of wheels relative to their body, `C I_rw omega_rw`, N m s.
///
/// `axes` are the columns of C (unit vectors in B), one per wheel; `spin_inertia` in kg m2, `speed` in
/// rad/s relative to the body.
///
/// ```
/// use poinsot_papers::kim2010::wheel_momentum;
/// use poinsot_spatial::Vector3;
///
/// let h = wheel_momentum(&[Vector3::x(), Vector3::z()], &[0.01, 0.02], &[100.0, 50.0]);
/// assert_eq!(h, Vector3::new(1.0, 0.0, 1.0));
/// ```
pub fn wheel_momentum(axes: &[Vector3], spin_inertia: &[f64], speed: &[f64]) -> Vector3 {
    let wheels = axes.iter().zip(spin_inertia).zip(speed);
    wheels.map(|((a, js), speed)| a * (js * speed)).sum()
}

/// The sums over any number of manoeuvres.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sums {
    /// `sum w w^T`.
    pub G: Matrix3,
    /// `sum Q w^T`.
    pub K: Matrix3,
    /// `sum (M e_i w_0j) w^T` for each element (i, j) of I: the start momentum `M I w_0`.
    start: [[Matrix3; 3]; 3],
    /// Number of samples.
    pub samples: usize,
}

impl Sums {
    /// Sums over manoeuvres.
    ///
    /// # Errors
    /// The estimators would divide by zero.
    pub fn of(manoeuvres: &[Manoeuvre]) -> Result<Self, Faults> {
        let mut sums = Self::default();
        for manoeuvre in manoeuvres {
            sums.add(manoeuvre)?;
        }
        sums.checked()
    }

    /// Wraps the sums `sum w w^T` and `sum Q w^T` of a record that starts at rest.
    ///
    /// # Errors
    /// The estimators would divide by zero.
    pub fn at_rest(G: Matrix3, K: Matrix3, samples: usize) -> Result<Self, Faults> {
        let sums = Self {
            G,
            K,
            samples,
            ..Self::default()
        };
        sums.checked()
    }

    fn add(&mut self, m: &Manoeuvre) -> Result<(), Faults> {
        let n = m.R_NB.len();
        if m.w_NB_B.len() != n || m.h_W_B.len() != n {
            let what = "attitude, rates and wheel momentum have different numbers of samples";
            return Err(refused("E0420", what, "give one of each per time"));
        }
        let (Some(R_0), Some(h_0), Some(w_0)) = (m.R_NB.first(), m.h_W_B.first(), m.w_NB_B.first())
        else {
            return Ok(());
        };
        // The nine sums of `start` follow from `sum M_k e_i w_k^T` for the three i.
        let mut turned = [Matrix3::zeros(); 3];
        for ((R, w), h) in m.R_NB.iter().zip(m.w_NB_B).zip(m.h_W_B) {
            let M = (R.inverse() * R_0).to_rotation_matrix().into_inner();
            let Q = M * h_0 - h;
            self.G += w * w.transpose();
            self.K += Q * w.transpose();
            for (i, sum) in turned.iter_mut().enumerate() {
                *sum += M.column(i) * w.transpose();
            }
        }
        if m.start == StartRate::Measured {
            for (row, sum) in self.start.iter_mut().zip(&turned) {
                for (part, w) in row.iter_mut().zip(w_0.iter()) {
                    *part += sum * *w;
                }
            }
        }
        self.samples += n;
        Ok(())
    }

    fn checked(self) -> Result<Self, Faults> {
        if self.samples < 3 {
            let problem = "fewer than three samples";
            return Err(refused("E0421", problem, "give a longer record"));
        }
        if self.G.iter().chain(&self.K).any(|x| !x.is_finite()) {
            return Err(not_finite());
        }
        for (k, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
            if self.G[(k, k)] <= f64::MIN_POSITIVE {
                let what = format!(
                    "the body never turns about its {axis} axis, and (14) divides by the rate about it"
                );
                let advice = "use a manoeuvre that turns about all three axes";
                return Err(refused("E0422", &what, advice));
            }
        }
        if self.K == Matrix3::zeros() {
            let what = "the wheel momentum never changes: Q = 0 (8), and the scale of the inertia is undetermined";
            return Err(refused("E0423", what, "check the wheel columns"));
        }
        Ok(self)
    }

    /// `E(I)` as defined above: residual of (11) correlated with the rates.
    pub fn residual(&self, I: &Matrix3) -> Matrix3 {
        let mut E = self.K - I * self.G;
        for (i, row) in self.start.iter().enumerate() {
            for (j, part) in row.iter().enumerate() {
                E += part * I[(i, j)];
            }
        }
        E
    }

    /// Solves for the listed elements from as many equations of `E(I) = 0`; others stay as in `given`. Dependent
    /// equations give the smallest change from `given`. Returns the rank too.
    fn solve(
        &self,
        elements: &[(usize, usize)],
        given: &Matrix3,
    ) -> Result<(Matrix3, usize), Faults> {
        let n = elements.len();
        let at_given = self.residual(given);
        let mut A = Mat::<f64>::zeros(n, n);
        for (column, &element) in elements.iter().enumerate() {
            let mut moved = *given;
            moved[element] += 1.0;
            let change = at_given - self.residual(&moved);
            for (row, &equation) in elements.iter().enumerate() {
                A[(row, column)] = change[equation];
            }
        }
        let [rest, mut found] =
            [&at_given, given].map(|m| elements.iter().map(|e| m[*e]).collect::<Vec<_>>());
        let rank = add_smallest(&A, &rest, ROUND_OFF, &mut found).ok_or_else(not_finite)?;
        let mut I = *given;
        for (&element, value) in elements.iter().zip(found) {
            I[element] = value;
        }
        Ok((I, rank))
    }

    /// The nine-element fit (2)-(4), and its rank, which is nine for rotation about three independent axes. For lower
    /// rank `H^T H` in (3) is singular, and the minimum-norm solution is returned.
    ///
    /// # Errors
    /// Not finite.
    pub fn batch(&self) -> Result<(Answer, usize), Faults> {
        let all: Vec<(usize, usize)> = (0..9).map(|k| (k / 3, k % 3)).collect();
        let (elements, rank) = self.solve(&all, &Matrix3::zeros())?;
        let printed = ELEMENTS.map(|e| elements[e]);
        Ok((Answer { elements, printed }, rank))
    }

    /// Moments of inertia (14), products neglected. With initial rates, the three equations share `I w_0`.
    fn moments(&self, products: &Matrix3) -> Result<Matrix3, Faults> {
        let (I, rank) = self.solve(&ELEMENTS[..3], products)?;
        if rank < 3 {
            return Err(not_finite());
        }
        Ok(I)
    }

    /// Each element separately (8)-(10): the equations of a one-axis manoeuvre, applied to any manoeuvre.
    ///
    /// # Errors
    /// Not finite.
    pub fn conventional(&self) -> Result<Answer, Faults> {
        let mut I = self.moments(&Matrix3::zeros())?;
        let start = self.residual(&diagonal(&I)) + diagonal(&I) * self.G;
        for (i, j) in PRODUCTS {
            I[(i, j)] = start[(i, j)] / self.G[(j, j)];
        }
        Ok(averaged(I))
    }

    /// Products from the moments only: (14), (15), (16).
    ///
    /// # Errors
    /// Not finite.
    pub fn suggested(&self) -> Result<Answer, Faults> {
        let I = self.moments(&Matrix3::zeros())?;
        Ok(averaged(self.products(&I)))
    }

    /// (15) with the elements of `I` on the right-hand side.
    fn products(&self, I: &Matrix3) -> Matrix3 {
        let E = self.residual(I);
        let mut found = *I;
        for (i, j) in PRODUCTS {
            found[(i, j)] += E[(i, j)] / self.G[(j, j)];
        }
        found
    }

    /// "Considering pre-estimate": every product uses the other product of its row from (15), all at once. `I_xz`
    /// remains as in (15b), the paper's example of a product that uses no other.
    ///
    /// The paper does not state this interpretation. It reproduces the printed column from the sums fixed by the other
    /// columns of Table 2 (`docs/methods/kim2010.md`).
    ///
    /// # Errors
    /// Not finite.
    pub fn pre_estimate(&self) -> Result<Answer, Faults> {
        let moments = self.moments(&Matrix3::zeros())?;
        let first = self.products(&moments);
        let mut I = first;
        for (i, j) in PRODUCTS.into_iter().filter(|e| *e != (0, 2)) {
            let mut given = moments;
            let other = (i, 3 - i - j);
            given[other] = first[other];
            I[(i, j)] = self.residual(&given)[(i, j)] / self.G[(j, j)];
        }
        Ok(averaged(I))
    }
}

fn refused(code: &'static str, problem: &str, advice: &str) -> Faults {
    Faults::one(code, Place::default().key("kim2010"), problem, advice)
}

pub(super) fn not_finite() -> Faults {
    let what = "the telemetry holds numbers that are not finite or overflow";
    refused("E0424", what, "check units and magnitudes")
}

/// Off-diagonal elements in the order of (15).
const PRODUCTS: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

fn diagonal(I: &Matrix3) -> Matrix3 {
    Matrix3::from_diagonal(&I.diagonal())
}

/// Pairs of products averaged (16).
fn averaged(elements: Matrix3) -> Answer {
    let printed = ELEMENTS.map(|(i, j)| 0.5 * (elements[(i, j)] + elements[(j, i)]));
    Answer { elements, printed }
}

/// The tensor of six numbers in the order of [`ELEMENTS`].
///
/// ```
/// use poinsot_papers::kim2010::symmetric;
///
/// // In the order of the paper: xx, yy, zz, xy, yz, zx.
/// let I = symmetric(&[1.0, 2.0, 3.0, 0.1, 0.2, 0.3]);
/// assert_eq!((I[(0, 2)], I[(2, 1)]), (0.3, 0.2));
/// ```
pub fn symmetric(x: &[f64; 6]) -> Matrix3 {
    let mut I = Matrix3::zeros();
    for ((i, j), value) in ELEMENTS.into_iter().zip(x) {
        I[(i, j)] = *value;
        I[(j, i)] = *value;
    }
    I
}

/// Largest number of sweeps.
const SWEEPS: usize = 100_000;
/// Change of an element in one sweep, relative to the largest, at which the iteration has converged.
const SETTLED: f64 = 1.0e-13;

/// Result of the iteration and its convergence.
#[derive(Debug, Clone, PartialEq)]
pub struct Iterated {
    /// Values after the last sweep.
    pub answer: Answer,
    /// Whether it converged.
    pub converged: bool,
    /// Number of sweeps.
    pub sweeps: usize,
    /// Spectral radius of one sweep: below one it converges from any start.
    pub spectral_radius: f64,
    /// Number of independent directions of fixed points.
    pub free_directions: usize,
}

impl Sums {
    /// One sweep: (14), (15), (16), each with the elements of the previous sweep on the right-hand side. From zero,
    /// the first sweep is [`Self::suggested`].
    fn sweep(&self, x: &[f64; 6]) -> Result<[f64; 6], Faults> {
        let I = self.moments(&symmetric(x))?;
        Ok(averaged(self.products(&I)).printed)
    }

    /// Repeats (14)-(16) from zero to convergence.
    ///
    /// A sweep is affine, `x <- B x + b`: B gives its fixed points and rate.
    ///
    /// # Errors
    /// Not finite.
    pub fn iterated(&self) -> Result<Iterated, Faults> {
        let b = self.sweep(&[0.0; 6])?;
        let mut B = [[0.0; 6]; 6];
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            for (row, (moved, b)) in B.iter_mut().zip(self.sweep(&unit)?.into_iter().zip(b)) {
                row[j] = moved - b;
            }
        }
        let (mut x, mut sweeps, mut converged) = (b, 1, false);
        while sweeps < SWEEPS && !converged {
            let next: [f64; 6] = std::array::from_fn(|i| {
                b[i] + B[i].iter().zip(&x).map(|(a, x)| a * x).sum::<f64>()
            });
            let size = largest(next.iter().map(|x| x.abs()));
            if !size.is_finite() {
                break;
            }
            let change = largest(next.iter().zip(&x).map(|(a, b)| (a - b).abs()));
            converged = change <= SETTLED * size;
            x = next;
            sweeps += 1;
        }
        let matrix = Mat::from_fn(6, 6, |i, j| B[i][j]);
        let eigenvalues = matrix.eigenvalues().map_err(|_| not_finite())?;
        // Fixed points solve `A x = b`.
        let A = Mat::from_fn(6, 6, |i, j| f64::from(u8::from(i == j)) - B[i][j]);
        let rank = add_smallest(&A, &b, ROUND_OFF, &mut [0.0; 6]).ok_or_else(not_finite)?;
        Ok(Iterated {
            answer: Answer {
                elements: symmetric(&x),
                printed: x,
            },
            converged,
            sweeps,
            spectral_radius: largest(eigenvalues.iter().map(|z| z.re.hypot(z.im))),
            free_directions: 6 - rank,
        })
    }
}
