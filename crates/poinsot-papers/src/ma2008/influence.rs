//! First-order effect of the declared noise on both steps.
//!
//! With `T = [A | -b]` the perturbed rows give `A dx = -dT (x, 1)`. Noise source j of sample k therefore changes the
//! solution by `dx = -(A^T A)^-1 Abar_k^T e_kj`, `e_kj = dT_kj (x, 1)`. `Abar_k` is `A_k`, except for the first sample
//! of a segment in option 2, which is in every row: `Abar_0 = -sum A_k`. The error of step 1 enters step 2 through
//! `C = d(B y + g)/dx`. `dT_kj` is computed by central differences of one sigma.

use super::arm::{Raw, Reading, Vehicle};
use super::equations::{Given, angular_known, angular_rows, linear_known, linear_rows, put};
use super::solve::Solution;
use nalgebra::{DMatrix, DVector, SMatrix, SVector, SymmetricEigen};
use poinsot_identify::Noise;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// One independent error of one sample, one sigma.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Angular velocity, in B, rad/s.
    Rate(Vector3),
    /// Velocity, in N, m/s.
    Velocity(Vector3),
    /// Change of velocity since the previous sample, in N, m/s; it remains in all later samples.
    VelocityStep(Vector3),
    /// Attitude: a small rotation in B, rad.
    Attitude(Vector3),
    /// Position of a joint, rad or m.
    JointPosition(usize, f64),
    /// Rate of a joint.
    JointRate(usize, f64),
    /// Speed of a wheel, rad/s.
    WheelSpeed(usize, f64),
}

impl Source {
    pub(super) fn moved(&self, raw: &Raw, sign: f64) -> Raw {
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

/// Independent one-sigma errors of one sample, with the fraction of their variance present in the data.
///
/// `velocity`: whether the segment measures velocity. `step`: covariance of velocity increments, whose noise is
/// assumed to be fully present.
pub(super) fn sources(noise: &Noise, velocity: bool, step: Option<Matrix3>) -> Vec<(Source, f64)> {
    let mut out = Vec::new();
    let mut axes = |covariance: &Matrix3, seen: f64, source: fn(Vector3) -> Source| {
        let e = SymmetricEigen::new(*covariance);
        let own = (0..3).filter(|&k| e.eigenvalues[k] > 0.0);
        let axis = |k: usize| e.eigenvectors.column(k) * e.eigenvalues[k].sqrt();
        out.extend(own.map(|k| (source(axis(k)), seen)));
    };
    let v = noise.seen_velocity;
    axes(&noise.gyro, noise.seen_gyro, Source::Rate);
    if velocity {
        axes(&noise.velocity, v, Source::Velocity);
    }
    axes(&noise.attitude, v, Source::Attitude);
    axes(&step.unwrap_or_default(), 1.0, Source::VelocityStep);
    let mut scalars = |variances: &[f64], source: fn(usize, f64) -> Source| {
        let own = variances.iter().enumerate().filter(|(_, v)| **v > 0.0);
        out.extend(own.map(|(k, v)| (source(k, v.sqrt()), noise.seen_joint_rate)));
    };
    scalars(&noise.joint_position, Source::JointPosition);
    scalars(&noise.joint_rate, Source::JointRate);
    scalars(&noise.wheel_speed, Source::WheelSpeed);
    out
}

/// First-order effect of the declared noise on one step.
#[derive(Debug, Clone)]
pub struct StepNoise<const N: usize> {
    /// `E[dA^T dA]` of the noise that is present in the data.
    pub regressor: SMatrix<f64, N, N>,
    /// `E[dA^T e]` of that noise: the right-hand side of the bias.
    pub bias: SVector<f64, N>,
    /// `E ||dA||_F^2` of the declared noise.
    pub epsilon_A: f64,
    /// `E ||db||^2`.
    pub epsilon_b: f64,
    /// `E ||e||^2`: expected residual under the declared noise, before degrees of freedom.
    pub residual: f64,
}

impl<const N: usize> Default for StepNoise<N> {
    fn default() -> Self {
        Self {
            regressor: SMatrix::zeros(),
            bias: SVector::zeros(),
            epsilon_A: 0.0,
            epsilon_b: 0.0,
            residual: 0.0,
        }
    }
}

impl<const N: usize> StepNoise<N> {
    /// Adds an error `dT` of rows with this weight, and its effect `e`.
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
#[derive(Debug, Clone, Default)]
pub struct Influence {
    /// Covariance of `[directions of step 1 (4), of step 2 (6), P (3) and H (3) of every segment]`.
    pub covariance: DMatrix<f64>,
    /// Step 1.
    pub linear: StepNoise<4>,
    /// Step 2.
    pub angular: StepNoise<6>,
    /// Mean momentum of every segment in N: linear, angular about the system mass centre.
    pub momentum: Vec<(Vector3, Vector3)>,
    /// `B^T C` over all rows: effect of an error of step 1 on step 2.
    pub coupling: SMatrix<f64, 6, 4>,
    /// Contribution of the error of step 1 to `E ||e||^2` of step 2.
    pub inherited: f64,
    /// `E ||C dx||^2`: effect of the error of step 1 on the right-hand side of step 2.
    pub passed_on: f64,
}

/// Input: data of every segment, known momentum, and noise sources with the fraction of their variance present in the
/// data.
pub struct Setting<'a> {
    /// Segments.
    pub segments: &'a [Vec<Raw>],
    /// Known momentum (option 1 of each step).
    pub known: Given,
    /// Noise sources of one sample.
    pub sources: &'a [(Source, f64)],
}

/// Samples per segment whose noise is propagated; others are included by weight.
const FOLLOWED: usize = 400;

/// Propagates every noise source through both steps.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
#[doc = include_str!("../../doc/influence.txt")]
/// // Twice the noise of the gyro gives four times the covariance.
/// let mut covariance = |sigma: f64| {
///     let sources = [(NoiseSource::Rate(Vector3::x() * sigma), 0.0)];
///     let setting = Setting { segments: std::slice::from_ref(&segment), known: Given::default(), sources: &sources };
///     influence(&mut vehicle, &setting, &solution).covariance[(0, 0)]
/// };
/// assert!((covariance(2.0e-4) / covariance(1.0e-4) - 4.0).abs() < 1.0e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn influence(vehicle: &mut Vehicle, setting: &Setting, solution: &Solution) -> Influence {
    let both = Both::new(vehicle.arm_mass(), setting.known, solution);
    // First pass: sums over samples that the first sample and the momentum need.
    let size = 10 + 6 * setting.segments.len();
    let mut out = Influence {
        covariance: DMatrix::zeros(size, size),
        ..Influence::default()
    };
    let mut inherited = SMatrix::<f64, 4, 4>::zeros();
    let mut sums = Vec::new();
    for segment in setting.segments {
        let sum = both.sums(vehicle, segment);
        for own in &sum.own {
            let C = own.fixed_columns::<4>(SLOPE);
            out.coupling += own.fixed_columns::<6>(ANGULAR).transpose() * C;
            inherited += C.transpose() * C;
        }
        out.momentum.push((
            sum.rows.fixed_columns::<5>(0) * both.x1 * (both.m_S / sum.count),
            sum.rows.fixed_columns::<7>(ANGULAR) * both.y1 / sum.count,
        ));
        sums.push(sum);
    }
    // Second pass: every source of every propagated sample.
    for (at, (segment, own)) in setting.segments.iter().zip(&sums).enumerate() {
        let stride = segment.len().div_ceil(FOLLOWED).max(1);
        let followed = (segment.len().saturating_sub(1)).div_ceil(stride).max(1) as f64;
        let followed_rows = segment.iter().enumerate();
        for (k, raw) in followed_rows.filter(|(k, _)| *k == 0 || (k - 1) % stride == 0) {
            let weight = match k {
                0 => 1.0,
                _ => (own.count - 1.0) / followed,
            };
            let rows = both.sample(own, k, weight);
            for (source, seen) in setting.sources {
                let stays = matches!(source, Source::VelocityStep(_));
                if stays && k == 0 {
                    continue;
                }
                let error = RowError {
                    rows: both.error(vehicle, raw, source),
                    stays,
                    seen: *seen,
                };
                both.follow(&mut out, (&sums, at), &rows, &error, &inherited);
            }
        }
    }
    out
}

/// Rows of a sample at the solution: step 1 `[A | -b]`, step 2 `[B | -c]`, and the derivative `C` of step 2 with respect
/// to the solution of step 1. Without step 2 its part is zero.
type Rows = SMatrix<f64, 3, 16>;
/// First column of step 2.
const ANGULAR: usize = 5;
/// First column of `C`.
const SLOPE: usize = 12;

/// Both steps at their solution.
struct Both<'a> {
    solution: &'a Solution<'a>,
    known: Given,
    arm_mass: f64,
    x1: SVector<f64, 5>,
    y1: SVector<f64, 7>,
    m_S: f64,
}

/// Rows affected by an error of one sample.
struct SampleRows {
    rows: Rows,
    /// `A` of all later samples, and their number.
    later: (SMatrix<f64, 3, 4>, f64),
    /// Number of rows of each step affected by the error, weighted for omitted samples.
    in_rows: [f64; 2],
    weight: f64,
}

/// One-sigma error of one source of one sample in the rows of both steps.
struct RowError {
    rows: Rows,
    /// Whether it remains in the rows of all later samples.
    stays: bool,
    /// Fraction of its variance present in the data.
    seen: f64,
}

/// Rows of a segment, and their sums.
struct SegmentSums {
    /// Rows less the known momentum, or less the first.
    own: Vec<Rows>,
    /// Sum of `own` over the samples before each sample, and over all.
    before: Vec<Rows>,
    /// Sum of the rows.
    rows: Rows,
    count: f64,
}

impl<'a> Both<'a> {
    fn new(arm_mass: f64, known: Given, solution: &'a Solution<'a>) -> Self {
        let y: SVector<f64, 6> = solution.angular.map_or_else(SVector::zeros, |(y, _)| y);
        Self {
            known,
            arm_mass,
            y1: y.push(1.0),
            x1: solution.x.push(1.0),
            m_S: arm_mass / solution.x[0],
            solution,
        }
    }

    /// Rows of both steps, without the derivative.
    fn steps(&self, reading: &Reading) -> Rows {
        let mut rows = Rows::zeros();
        put(&mut rows, 0, &linear_rows(reading));
        if self.solution.angular.is_some() {
            let rho_S = Vector3::new(self.x1[1], self.x1[2], self.x1[3]);
            put(&mut rows, ANGULAR, &angular_rows(reading, self.m_S, &rho_S));
        }
        rows
    }

    /// Rows of both steps with `C = d(B y + g)/dx` by central differences; nearly exact, because `g` is almost quadratic.
    fn rows(&self, reading: &Reading) -> Rows {
        let mut rows = self.steps(reading);
        if self.solution.angular.is_none() {
            return rows;
        }
        for j in 0..4 {
            let h = if j == 0 { 1.0e-4 * self.x1[0] } else { 1.0e-4 };
            let at = |sign: f64| {
                let mut x = self.x1;
                x[j] += sign * h;
                let rho_S = Vector3::new(x[1], x[2], x[3]);
                angular_rows(reading, self.arm_mass / x[0], &rho_S) * self.y1
            };
            rows.set_column(SLOPE + j, &((at(1.0) - at(-1.0)) / (2.0 * h)));
        }
        rows
    }

    /// What is subtracted from the rows of a segment with this first sample: known momentum, or the first rows.
    fn reference(&self, first: &Rows) -> Rows {
        let mut reference = *first;
        if let Some(p) = &self.known.p_C_N {
            let known = linear_known(p, self.arm_mass);
            put(&mut reference, 0, &known);
        }
        if let Some(h) = &self.known.h_C_N {
            let known = angular_known(h);
            put(&mut reference, ANGULAR, &known);
            reference.fixed_columns_mut::<4>(SLOPE).fill(0.0);
        }
        reference
    }

    fn sums(&self, vehicle: &mut Vehicle, segment: &[Raw]) -> SegmentSums {
        let rows = segment.iter().map(|raw| self.rows(&vehicle.reading(raw)));
        let rows: Vec<Rows> = rows.collect();
        let reference = rows.first().map_or_else(Rows::zeros, |r| self.reference(r));
        let own: Vec<Rows> = rows.iter().map(|r| r - reference).collect();
        let mut before = vec![Rows::zeros()];
        for (k, own) in own.iter().enumerate() {
            before.push(before[k] + own);
        }
        SegmentSums {
            own,
            before,
            rows: rows.iter().sum(),
            count: segment.len() as f64,
        }
    }

    fn sample(&self, sums: &SegmentSums, k: usize, weight: f64) -> SampleRows {
        let all = sums.before[sums.own.len()];
        // In option 2 the first sample is in all rows of its segment.
        let in_all = [self.known.p_C_N, self.known.h_C_N].map(|known| k == 0 && known.is_none());
        let mut rows = sums.own[k];
        if in_all[0] {
            put::<16, 5>(&mut rows, 0, &-all.fixed_columns::<5>(0));
        }
        if in_all[1] {
            put::<16, 11>(&mut rows, ANGULAR, &-all.fixed_columns::<11>(ANGULAR));
        }
        let later = (all - sums.before[k]).fixed_columns::<4>(0).into_owned();
        SampleRows {
            rows,
            later: (later, sums.count - k as f64),
            in_rows: in_all.map(|all| if all { sums.count - 1.0 } else { weight }),
            weight,
        }
    }

    fn error(&self, vehicle: &mut Vehicle, raw: &Raw, source: &Source) -> Rows {
        let mut at = |sign: f64| self.steps(&vehicle.reading(&source.moved(raw, sign)));
        (at(1.0) - at(-1.0)) * 0.5
    }

    /// Adds the effect of one error on the solutions of both steps and on the momentum of each segment.
    fn follow(
        &self,
        out: &mut Influence,
        (sums, at): (&[SegmentSums], usize),
        rows: &SampleRows,
        error: &RowError,
        inherited: &SMatrix<f64, 4, 4>,
    ) {
        let (A, in_linear, samples) = match error.stays {
            true => (rows.later.0, rows.weight * rows.later.1, rows.later.1),
            false => (
                rows.rows.fixed_columns::<4>(0).into_owned(),
                rows.in_rows[0],
                1.0,
            ),
        };
        let d1 = error.rows.fixed_columns::<5>(0).into_owned();
        let e1 = d1 * self.x1;
        out.linear.add(&d1, &e1, in_linear, error.seen);
        let c1 = self.solution.linear.along(&(A.transpose() * e1));
        let dx = self.solution.linear.in_units(&c1);
        let mut effect = DVector::<f64>::zeros(out.covariance.nrows());
        effect.fixed_rows_mut::<4>(0).copy_from(&c1);
        let dm = -self.m_S / self.solution.x[0] * dx[0];
        let mut dy = SVector::<f64, 6>::zeros();
        let mut own_h = Vector3::zeros();
        if let Some((_, angular)) = self.solution.angular {
            let (B, C) = (
                rows.rows.fixed_columns::<6>(ANGULAR),
                rows.rows.fixed_columns::<4>(SLOPE),
            );
            let d2 = error.rows.fixed_columns::<7>(ANGULAR).into_owned();
            own_h = d2 * self.y1;
            out.angular.add(&d2, &own_h, rows.in_rows[1], error.seen);
            let c2 = angular.along(&(B.transpose() * own_h + out.coupling * dx));
            effect.fixed_rows_mut::<6>(4).copy_from(&c2);
            dy = angular.in_units(&c2);
            let passed_on = dx.dot(&(inherited * dx));
            out.passed_on += rows.weight * passed_on;
            out.inherited += rows.weight * (2.0 * own_h.dot(&(C * dx)) + passed_on);
        }
        for (other, s) in sums.iter().enumerate() {
            let own = f64::from(u8::from(other == at)) * samples / s.count;
            let (P, all) = (out.momentum[other].0, &s.rows);
            let dP = (all.fixed_columns::<4>(0) * dx / s.count + e1 * own) * self.m_S
                + P * (dm / self.m_S);
            let turned = all.fixed_columns::<4>(SLOPE) * dx + all.fixed_columns::<6>(ANGULAR) * dy;
            let dH = turned / s.count + own_h * own;
            effect.fixed_rows_mut::<3>(10 + 6 * other).copy_from(&dP);
            effect.fixed_rows_mut::<3>(13 + 6 * other).copy_from(&dH);
        }
        out.covariance.ger(rows.weight, &effect, &effect, 1.0);
    }
}
