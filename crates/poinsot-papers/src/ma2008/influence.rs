//! First-order effect of the declared noise on both steps.
//!
//! With `T = [A | -b]` the perturbed rows give `A dx = -dT (x, 1)`. Noise source j of sample k therefore changes the
//! solution by `dx = -(A^T A)^-1 Abar_k^T e_kj`, `e_kj = dT_kj (x, 1)`. `Abar_k` is `A_k`, except for the first sample
//! of a segment in option 2, which is in every row: `Abar_0 = -sum A_k`. The error of step 1 enters step 2 through
//! `C = d(B y + g)/dx`. `dT_kj` is computed by central differences of one sigma.

use super::arm::{Raw, Reading, Vehicle};
use super::equations::{AngularRows, Given, LinearRows, angular_known, linear_known, linear_rows};
use super::solution::{AtSolution, Solution};
use super::sources::Source;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use poinsot_spatial::Vector3;

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
    let mut coupling = SMatrix::<f64, 6, 4>::zeros();
    let mut inherited = SMatrix::<f64, 4, 4>::zeros();
    let sums: Vec<SegmentSums> = setting
        .segments
        .iter()
        .map(|segment| both.sums(vehicle, segment, &mut coupling, &mut inherited))
        .collect();
    let momentum = sums.iter().map(|s| both.momentum(s)).collect();
    let mut out = Influence::new(6 * sums.len(), coupling, momentum);
    // Second pass: every source of every propagated sample.
    for (at, (segment, own)) in setting.segments.iter().zip(&sums).enumerate() {
        let stride = segment.len().div_ceil(FOLLOWED).max(1);
        let followed = (segment.len().saturating_sub(1)).div_ceil(stride).max(1) as f64;
        for (k, raw) in segment.iter().enumerate() {
            if k > 0 && (k - 1) % stride != 0 {
                continue;
            }
            let weight = if k == 0 {
                1.0
            } else {
                (own.count - 1.0) / followed
            };
            let Some(rows) = both.sample(vehicle, own, raw, (k, weight)) else {
                continue;
            };
            for (source, seen) in setting.sources {
                if let Some(error) = both.error(vehicle, raw, source, &rows) {
                    both.follow(&mut out, (&sums, at), &rows, &error, (*seen, &inherited));
                }
            }
        }
    }
    out
}

impl Influence {
    fn new(
        momenta: usize,
        coupling: SMatrix<f64, 6, 4>,
        momentum: Vec<(Vector3, Vector3)>,
    ) -> Self {
        Self {
            covariance: DMatrix::zeros(10 + momenta, 10 + momenta),
            linear: StepNoise::new(),
            angular: StepNoise::new(),
            momentum,
            coupling,
            inherited: 0.0,
            passed_on: 0.0,
        }
    }
}

/// Both steps at their solution.
struct Both<'a> {
    solution: &'a Solution<'a>,
    known: Given,
    reference: (Option<LinearRows>, Option<AngularRows>),
    steps: AtSolution,
    x1: SVector<f64, 5>,
    m_S: f64,
}

/// Rows affected by an error of one sample.
struct SampleRows {
    A: SMatrix<f64, 3, 4>,
    B: SMatrix<f64, 3, 6>,
    C: SMatrix<f64, 3, 4>,
    /// Rows of step 1 of all later samples, and their number.
    later: (SMatrix<f64, 3, 4>, f64),
    /// Number of rows of each step affected by the error, weighted for omitted samples.
    in_rows: [f64; 2],
    weight: f64,
    first: bool,
}

/// One-sigma error of one source of one sample in the rows of both steps.
struct RowError {
    d1: LinearRows,
    d2: AngularRows,
    /// Whether it remains in the rows of all later samples.
    stays: bool,
}

impl<'a> Both<'a> {
    fn new(arm_mass: f64, known: Given, solution: &'a Solution<'a>) -> Self {
        let y: SVector<f64, 6> = solution.angular.map_or_else(SVector::zeros, |(y, _)| y);
        Self {
            known,
            reference: (
                known.p_C_N.map(|p| linear_known(&p, arm_mass)),
                known.h_C_N.map(|h| angular_known(&h)),
            ),
            steps: AtSolution {
                arm_mass,
                x: solution.x,
                y1: SVector::from_iterator(y.iter().copied().chain([1.0])),
            },
            x1: SVector::from_iterator(solution.x.iter().copied().chain([1.0])),
            m_S: arm_mass / solution.x[0],
            solution,
        }
    }

    /// Rows of both steps of a sample, and the derivative of step 2 with respect to the solution of step 1. The latter
    /// is zero if step 2 is not solved.
    fn rows(&self, reading: &Reading) -> (LinearRows, AngularRows, SMatrix<f64, 3, 4>) {
        let linear = linear_rows(reading);
        match self.solution.angular {
            Some(_) => (
                linear,
                self.steps.angular(reading),
                self.steps.slope(reading),
            ),
            None => (linear, SMatrix::zeros(), SMatrix::zeros()),
        }
    }

    fn sums(
        &self,
        vehicle: &mut Vehicle,
        segment: &[Raw],
        coupling: &mut SMatrix<f64, 6, 4>,
        inherited: &mut SMatrix<f64, 4, 4>,
    ) -> SegmentSums {
        let mut sum = SegmentSums::default();
        for raw in segment {
            let (t1, t2, c) = self.rows(&vehicle.reading(raw));
            let slope = if self.known.h_C_N.is_some() {
                SMatrix::zeros()
            } else {
                c
            };
            let first = (
                self.reference.0.unwrap_or(t1),
                self.reference.1.unwrap_or(t2),
                slope,
            );
            let (r1, r2, rc) = *sum.first.get_or_insert(first);
            let a = (t1 - r1).fixed_columns::<4>(0).into_owned();
            let b = (t2 - r2).fixed_columns::<6>(0).into_owned();
            *coupling += b.transpose() * (c - rc);
            *inherited += (c - rc).transpose() * (c - rc);
            sum.before.push(sum.A);
            sum.A += a;
            sum.B += b;
            sum.t1 += t1;
            sum.t2 += t2;
            sum.C += c;
            sum.own_C += c - rc;
        }
        sum.count = segment.len() as f64;
        sum
    }

    fn momentum(&self, sums: &SegmentSums) -> (Vector3, Vector3) {
        (
            sums.t1 * self.x1 * (self.m_S / sums.count),
            sums.t2 * self.steps.y1 / sums.count,
        )
    }

    fn sample(
        &self,
        vehicle: &mut Vehicle,
        sums: &SegmentSums,
        raw: &Raw,
        (k, weight): (usize, f64),
    ) -> Option<SampleRows> {
        let (r1, r2, rc) = sums.first?;
        let (t1, t2, c) = self.rows(&vehicle.reading(raw));
        // In option 2 the first sample is in all rows of its segment.
        let in_all = [self.known.p_C_N, self.known.h_C_N].map(|known| k == 0 && known.is_none());
        let A = match in_all[0] {
            true => -sums.A,
            false => (t1 - r1).fixed_columns::<4>(0).into_owned(),
        };
        let (B, C) = match in_all[1] {
            true => (-sums.B, -sums.own_C),
            false => ((t2 - r2).fixed_columns::<6>(0).into_owned(), c - rc),
        };
        Some(SampleRows {
            A,
            B,
            C,
            later: (sums.A - sums.before[k], sums.count - k as f64),
            in_rows: in_all.map(|all| if all { sums.count - 1.0 } else { weight }),
            weight,
            first: k == 0,
        })
    }

    fn error(
        &self,
        vehicle: &mut Vehicle,
        raw: &Raw,
        source: &Source,
        rows: &SampleRows,
    ) -> Option<RowError> {
        let stays = matches!(source, Source::VelocityStep(_));
        if stays && rows.first {
            return None;
        }
        let plus = vehicle.reading(&source.moved(raw, 1.0));
        let minus = vehicle.reading(&source.moved(raw, -1.0));
        let angular = self.solution.angular.is_some();
        Some(RowError {
            d1: (linear_rows(&plus) - linear_rows(&minus)) * 0.5,
            d2: match angular {
                true => (self.steps.angular(&plus) - self.steps.angular(&minus)) * 0.5,
                false => SMatrix::zeros(),
            },
            stays,
        })
    }

    /// Adds the effect of one error on the solutions of both steps and on the momentum of each segment.
    fn follow(
        &self,
        out: &mut Influence,
        (sums, at): (&[SegmentSums], usize),
        rows: &SampleRows,
        error: &RowError,
        (seen, inherited): (f64, &SMatrix<f64, 4, 4>),
    ) {
        let (A, in_linear, samples) = match error.stays {
            true => (&rows.later.0, rows.weight * rows.later.1, rows.later.1),
            false => (&rows.A, rows.in_rows[0], 1.0),
        };
        let e1 = error.d1 * self.x1;
        out.linear.add(&error.d1, &e1, in_linear, seen);
        let c1 = self.solution.linear.along(&(A.transpose() * e1));
        let dx = self.solution.linear.in_units(&c1);
        let mut effect = DVector::<f64>::zeros(out.covariance.nrows());
        effect.fixed_rows_mut::<4>(0).copy_from(&c1);
        let dm = -self.m_S / self.solution.x[0] * dx[0];
        let mut dy = SVector::<f64, 6>::zeros();
        let mut own_h = Vector3::zeros();
        if let Some((_, angular)) = self.solution.angular {
            let e2 = error.d2 * self.steps.y1;
            out.angular.add(&error.d2, &e2, rows.in_rows[1], seen);
            let c2 = angular.along(&(rows.B.transpose() * e2 + out.coupling * dx));
            effect.fixed_rows_mut::<6>(4).copy_from(&c2);
            dy = angular.in_units(&c2);
            let passed_on = dx.dot(&(inherited * dx));
            out.passed_on += rows.weight * passed_on;
            out.inherited += rows.weight * (2.0 * e2.dot(&(rows.C * dx)) + passed_on);
            own_h = e2;
        }
        for (other, s) in sums.iter().enumerate() {
            let own = f64::from(u8::from(other == at)) * samples / s.count;
            let P = out.momentum[other].0;
            let dP = (s.t1.fixed_columns::<4>(0) * dx / s.count + e1 * own) * self.m_S
                + P * (dm / self.m_S);
            let dH = (s.C * dx + s.t2.fixed_columns::<6>(0) * dy) / s.count + own_h * own;
            effect.fixed_rows_mut::<3>(10 + 6 * other).copy_from(&dP);
            effect.fixed_rows_mut::<3>(13 + 6 * other).copy_from(&dH);
        }
        out.covariance.ger(rows.weight, &effect, &effect, 1.0);
    }
}

#[derive(Default)]
struct SegmentSums {
    A: SMatrix<f64, 3, 4>,
    /// Sum of `A` over the samples before each sample.
    before: Vec<SMatrix<f64, 3, 4>>,
    B: SMatrix<f64, 3, 6>,
    C: SMatrix<f64, 3, 4>,
    own_C: SMatrix<f64, 3, 4>,
    t1: SMatrix<f64, 3, 5>,
    t2: SMatrix<f64, 3, 7>,
    first: Option<(SMatrix<f64, 3, 5>, SMatrix<f64, 3, 7>, SMatrix<f64, 3, 4>)>,
    count: f64,
}
