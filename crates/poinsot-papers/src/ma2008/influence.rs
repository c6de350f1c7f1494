//! What declared noise does to both steps, to first order.
//!
//! With `T = [A | -b]` the perturbed rows give `A dx = -dT (x, 1)`, so every noise source j of sample k
//! moves the answer by `dx = -(A^T A)^-1 Abar_k^T e_kj`, `e_kj = dT_kj (x, 1)`. `Abar_k` is `A_k`, but in
//! option 2 the first sample of a segment stands in every row of it: `Abar_0 = -sum A_k`. Step 2 inherits
//! the error of step 1 through `C = d(B y + g)/dx`. `dT_kj` is half the difference of the rows at plus
//! and minus one sigma.

use super::solve::{Step, decompose};
use super::{Given, Raw, Vehicle, angular_known, angular_rows, linear_known, linear_rows};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use poinsot_spatial::{UnitQuaternion, Vector3};

/// One independent error of one sample, one sigma.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Of the angular velocity, in B, rad/s.
    Rate(Vector3),
    /// Of the velocity, in N, m/s.
    Velocity(Vector3),
    /// Of the change of velocity since the sample before, in N, m/s: it stays in all later samples.
    VelocityStep(Vector3),
    /// Of the attitude, a small rotation in B, rad.
    Attitude(Vector3),
    /// Of a joint's position, rad or m.
    JointPosition(usize, f64),
    /// Of a joint's rate.
    JointRate(usize, f64),
    /// Of a wheel's speed, rad/s.
    WheelSpeed(usize, f64),
}

impl Source {
    fn moved(&self, raw: &Raw, sign: f64) -> Raw {
        let mut raw = raw.clone();
        let push = |list: &mut Vec<f64>, k: usize, s: f64| {
            if let Some(x) = list.get_mut(k) {
                *x += sign * s;
            }
        };
        match *self {
            Self::Rate(s) => raw.w_NB_B += s * sign,
            Self::Velocity(s) | Self::VelocityStep(s) => raw.v_NBo_N += s * sign,
            Self::Attitude(s) => raw.R_NB *= UnitQuaternion::from_scaled_axis(s * sign),
            Self::JointPosition(k, s) => push(&mut raw.q, k, s),
            Self::JointRate(k, s) => push(&mut raw.rates, k, s),
            Self::WheelSpeed(k, s) => push(&mut raw.wheel_speed, k, s),
        }
        raw
    }
}

/// A solved step as directions in natural units.
#[derive(Debug, Clone)]
pub struct Directions<const N: usize> {
    /// Natural unit of each unknown.
    pub natural: [f64; N],
    /// Singular values, descending.
    pub singular: [f64; N],
    /// Directions, one column each.
    pub V: SMatrix<f64, N, N>,
    /// Where each shows in the rotated right-hand side.
    pub U: SMatrix<f64, N, N>,
    /// Which of them may be used.
    pub usable: [bool; N],
}

impl<const N: usize> Directions<N> {
    /// Directions of a step; those below `round_off` are not usable. `None` where numbers overflow.
    pub fn new(step: &Step<N>, natural: [f64; N], round_off: f64) -> Option<Self> {
        let (singular, V, U) = decompose(&step.triangle, &natural)?;
        let floor = (32.0 * N as f64 * f64::EPSILON * singular[0]).max(round_off);
        Some(Self {
            natural,
            usable: singular.map(|s| s > floor),
            singular,
            V,
            U,
        })
    }

    /// Error along each direction for the normal-equation right-hand side `A^T e`.
    pub(super) fn along(&self, normal: &SVector<f64, N>) -> SVector<f64, N> {
        let scaled = SVector::<f64, N>::from_fn(|i, _| normal[i] * self.natural[i]);
        SVector::from_fn(|j, _| {
            if self.usable[j] {
                -self.V.column(j).dot(&scaled) / (self.singular[j] * self.singular[j])
            } else {
                0.0
            }
        })
    }

    /// A move along the directions in the units of the unknowns.
    pub fn in_units(&self, along: &SVector<f64, N>) -> SVector<f64, N> {
        let z = self.V * along;
        SVector::from_fn(|i, _| z[i] * self.natural[i])
    }

    /// Least-squares solution that leaves `nominal` only along usable directions.
    pub fn solve(&self, step: &Step<N>, nominal: &SVector<f64, N>) -> SVector<f64, N> {
        let rest = step.rotated - step.triangle * nominal;
        let along = SVector::<f64, N>::from_fn(|j, _| {
            if self.usable[j] {
                self.U.column(j).dot(&rest) / self.singular[j]
            } else {
                0.0
            }
        });
        nominal + self.in_units(&along)
    }
}

/// First-order effect of the declared noise on one step.
#[derive(Debug, Clone)]
pub struct StepNoise<const N: usize> {
    /// `E[dA^T dA]` of what the data really show of the noise.
    pub regressor: SMatrix<f64, N, N>,
    /// `E[dA^T e]` of the same: the right-hand side of the bias.
    pub bias: SVector<f64, N>,
    /// `E ||dA||_F^2` of the declared noise.
    pub epsilon_A: f64,
    /// `E ||db||^2`.
    pub epsilon_b: f64,
    /// `E ||e||^2`: what the declared noise leaves as residual, degrees of freedom apart.
    pub residual: f64,
}

impl<const N: usize> StepNoise<N> {
    fn new() -> Self {
        Self {
            regressor: SMatrix::zeros(),
            bias: SVector::zeros(),
            epsilon_A: 0.0,
            epsilon_b: 0.0,
            residual: 0.0,
        }
    }

    fn add<const W: usize>(
        &mut self,
        dT: &SMatrix<f64, 3, W>,
        e: &Vector3,
        weight: f64,
        seen: f64,
    ) {
        let dA = dT.fixed_columns::<N>(0);
        self.regressor += dA.transpose() * dA * (weight * seen);
        self.bias += dA.transpose() * e * (weight * seen);
        self.epsilon_A += weight * dA.norm_squared();
        self.epsilon_b += weight * dT.column(N).norm_squared();
        self.residual += weight * e.norm_squared();
    }
}

/// First-order effect of the declared noise on both steps and on the momentum of each segment.
#[derive(Debug, Clone)]
pub struct Influence {
    /// Covariance of `[directions of step 1 (4), of step 2 (6), P (3) and H (3) of every segment]`.
    pub covariance: DMatrix<f64>,
    /// Step 1.
    pub linear: StepNoise<4>,
    /// Step 2.
    pub angular: StepNoise<6>,
    /// Mean momentum of every segment in N: linear, angular about the system mass centre.
    pub momentum: Vec<(Vector3, Vector3)>,
    /// `B^T C` over all rows: how an error of step 1 enters step 2.
    pub coupling: SMatrix<f64, 6, 4>,
    /// What the error of step 1 adds to `E ||e||^2` of step 2.
    pub inherited: f64,
    /// `E ||C dx||^2`: size of the right-hand side of step 2 that the error of step 1 moves.
    pub passed_on: f64,
}

/// Both solved steps as the influence needs them.
pub struct Solution<'a> {
    /// Step 1.
    pub x: SVector<f64, 4>,
    /// Its directions.
    pub linear: &'a Directions<4>,
    /// Step 2, where step 1 is complete.
    pub angular: Option<(SVector<f64, 6>, &'a Directions<6>)>,
}

/// The question: data of every segment, what is known, noise sources with the share of their variance
/// that the data show.
pub struct Setting<'a> {
    /// Segments.
    pub segments: &'a [Vec<Raw>],
    /// Momentum as far as it is known (option 1 of each step).
    pub known: Given,
    /// Noise sources of one sample.
    pub sources: &'a [(Source, f64)],
}

/// Samples per segment whose noise is followed; others count by weight.
const FOLLOWED: usize = 400;

/// Follows every noise source through both steps.
pub fn influence(vehicle: &mut Vehicle, setting: &Setting, solution: &Solution) -> Influence {
    let arm_mass = vehicle.arm_mass();
    let x1 = SVector::<f64, 5>::from_iterator(solution.x.iter().copied().chain([1.0]));
    let y = solution.angular.map_or_else(SVector::zeros, |(y, _)| y);
    let y1 = SVector::<f64, 7>::from_iterator(y.iter().copied().chain([1.0]));
    let m_S = arm_mass / solution.x[0];
    let steps = AtSolution {
        arm_mass,
        x: solution.x,
        y1,
    };
    let known = setting.known;
    let reference1 = known.p_C_N.map(|p| linear_known(&p, arm_mass));
    let reference2 = known.h_C_N.map(|h| angular_known(&h));
    let two = solution.angular.is_some();

    // First pass: sums over samples that the first sample and the momentum need.
    let mut K = SMatrix::<f64, 6, 4>::zeros();
    let mut inherited = SMatrix::<f64, 4, 4>::zeros();
    let mut per_segment = Vec::with_capacity(setting.segments.len());
    for segment in setting.segments {
        let mut sum = SegmentSums::default();
        let mut first = None;
        for raw in segment {
            let reading = vehicle.reading(raw);
            let t1 = linear_rows(&reading);
            let (t2, c) = if two {
                (steps.angular(&reading), steps.slope(&reading))
            } else {
                (SMatrix::zeros(), SMatrix::zeros())
            };
            let (r1, r2, rc) = *first.get_or_insert((
                reference1.unwrap_or(t1),
                reference2.unwrap_or(t2),
                if known.h_C_N.is_some() {
                    SMatrix::zeros()
                } else {
                    c
                },
            ));
            let (a, b) = (
                (t1 - r1).fixed_columns::<4>(0).into_owned(),
                (t2 - r2).fixed_columns::<6>(0).into_owned(),
            );
            K += b.transpose() * (c - rc);
            inherited += (c - rc).transpose() * (c - rc);
            sum.A += a;
            sum.before.push(sum.A - a);
            sum.B += b;
            sum.t1 += t1;
            sum.t2 += t2;
            sum.C += c;
            sum.own_C += c - rc;
        }
        sum.first = first;
        sum.count = segment.len() as f64;
        per_segment.push(sum);
    }

    // Second pass: every source of every followed sample.
    let size = 10 + 6 * setting.segments.len();
    let mut out = Influence {
        covariance: DMatrix::zeros(size, size),
        linear: StepNoise::new(),
        angular: StepNoise::new(),
        momentum: per_segment
            .iter()
            .map(|s| (s.t1 * x1 * (m_S / s.count), s.t2 * y1 / s.count))
            .collect(),
        coupling: K,
        inherited: 0.0,
        passed_on: 0.0,
    };
    let mut effect = DVector::<f64>::zeros(size);
    for (at, (segment, sums)) in setting.segments.iter().zip(&per_segment).enumerate() {
        let Some((r1, r2, rc)) = sums.first else {
            continue;
        };
        let stride = segment.len().div_ceil(FOLLOWED).max(1);
        let followed = (segment.len().saturating_sub(1)).div_ceil(stride).max(1) as f64;
        for (k, raw) in segment.iter().enumerate() {
            let opens = k == 0;
            if !opens && (k - 1) % stride != 0 {
                continue;
            }
            let weight = if opens {
                1.0
            } else {
                (sums.count - 1.0) / followed
            };
            let reading = vehicle.reading(raw);
            // In option 2 the first sample stands in all rows of its segment.
            let in_all = [known.p_C_N, known.h_C_N].map(|k| opens && k.is_none());
            let A = match in_all[0] {
                true => -sums.A,
                false => (linear_rows(&reading) - r1)
                    .fixed_columns::<4>(0)
                    .into_owned(),
            };
            let (B, C) = match (in_all[1], two) {
                (true, _) => (-sums.B, -sums.own_C),
                (false, true) => (
                    (steps.angular(&reading) - r2)
                        .fixed_columns::<6>(0)
                        .into_owned(),
                    steps.slope(&reading) - rc,
                ),
                (false, false) => (SMatrix::zeros(), SMatrix::zeros()),
            };
            let in_rows = in_all.map(|all| if all { sums.count - 1.0 } else { weight });
            // An error of the change of velocity stands in the rows of all later samples.
            let later = sums.A - sums.before[k];
            let rows_later = sums.count - k as f64;
            for (source, seen) in setting.sources {
                let stays = matches!(source, Source::VelocityStep(_));
                if stays && opens {
                    continue;
                }
                let (A, in_linear, samples) = match stays {
                    true => (later, weight * rows_later, rows_later),
                    false => (A, in_rows[0], 1.0),
                };
                let plus = vehicle.reading(&source.moved(raw, 1.0));
                let minus = vehicle.reading(&source.moved(raw, -1.0));
                let d1 = (linear_rows(&plus) - linear_rows(&minus)) * 0.5;
                let e1 = d1 * x1;
                out.linear.add(&d1, &e1, in_linear, *seen);
                let c1 = solution.linear.along(&(A.transpose() * e1));
                let dx = solution.linear.in_units(&c1);
                effect.fill(0.0);
                effect.fixed_rows_mut::<4>(0).copy_from(&c1);
                let dm = -m_S / solution.x[0] * dx[0];
                let mut dy = SVector::<f64, 6>::zeros();
                let mut own_h = Vector3::zeros();
                if let Some((_, angular)) = solution.angular {
                    let d2 = (steps.angular(&plus) - steps.angular(&minus)) * 0.5;
                    let e2 = d2 * y1;
                    out.angular.add(&d2, &e2, in_rows[1], *seen);
                    let c2 = angular.along(&(B.transpose() * e2 + K * dx));
                    effect.fixed_rows_mut::<6>(4).copy_from(&c2);
                    dy = angular.in_units(&c2);
                    let passed_on = dx.dot(&(inherited * dx));
                    out.passed_on += weight * passed_on;
                    out.inherited += weight * (2.0 * e2.dot(&(C * dx)) + passed_on);
                    own_h = e2;
                }
                for (other, s) in per_segment.iter().enumerate() {
                    let own = f64::from(u8::from(other == at)) * samples / s.count;
                    let P = out.momentum[other].0;
                    let dP = (s.t1.fixed_columns::<4>(0) * dx / s.count + e1 * own) * m_S
                        + P * (dm / m_S);
                    let dH = (s.C * dx + s.t2.fixed_columns::<6>(0) * dy) / s.count + own_h * own;
                    effect.fixed_rows_mut::<3>(10 + 6 * other).copy_from(&dP);
                    effect.fixed_rows_mut::<3>(13 + 6 * other).copy_from(&dH);
                }
                out.covariance.ger(weight, &effect, &effect, 1.0);
            }
        }
    }
    out
}

#[derive(Default)]
struct SegmentSums {
    A: SMatrix<f64, 3, 4>,
    /// Sum of `A` before each sample.
    before: Vec<SMatrix<f64, 3, 4>>,
    B: SMatrix<f64, 3, 6>,
    C: SMatrix<f64, 3, 4>,
    own_C: SMatrix<f64, 3, 4>,
    t1: SMatrix<f64, 3, 5>,
    t2: SMatrix<f64, 3, 7>,
    first: Option<(SMatrix<f64, 3, 5>, SMatrix<f64, 3, 7>, SMatrix<f64, 3, 4>)>,
    count: f64,
}

/// Rows of step 2 at the answer of step 1, and their slope over it.
struct AtSolution {
    arm_mass: f64,
    x: SVector<f64, 4>,
    y1: SVector<f64, 7>,
}

impl AtSolution {
    fn angular(&self, reading: &super::Reading) -> super::AngularRows {
        self.angular_at(reading, &self.x)
    }

    fn angular_at(&self, reading: &super::Reading, x: &SVector<f64, 4>) -> super::AngularRows {
        angular_rows(
            reading,
            self.arm_mass / x[0],
            &x.fixed_rows::<3>(1).into_owned(),
        )
    }

    /// `C = d(B y + g)/dx` by central differences; exact but for the last digits, `g` is nearly quadratic.
    fn slope(&self, reading: &super::Reading) -> SMatrix<f64, 3, 4> {
        let mut C = SMatrix::<f64, 3, 4>::zeros();
        for j in 0..4 {
            let h = if j == 0 { 1.0e-4 * self.x[0] } else { 1.0e-4 };
            let at = |sign: f64| {
                let mut x = self.x;
                x[j] += sign * h;
                self.angular_at(reading, &x) * self.y1
            };
            C.set_column(j, &((at(1.0) - at(-1.0)) / (2.0 * h)));
        }
        C
    }
}
