//! The Cramer-Rao bound for the data of the two steps.

use super::experiment::{Errors, Run, Sigma};
use crate::ma2008::{Reading, angular_rows, linear_rows};
use crate::study::statistics::largest;
use nalgebra::{DMatrix, SVector};
use poinsot_spatial::{Matrix6, TENSOR, Vector3, Vector6, stacked};

/// Step of the finite differences, in units of the unknowns.
const STEP: f64 = 1.0e-5;
/// Eigenvalues of the scaled information below this fraction of the largest are zero.
const ZERO: f64 = 1.0e-13;
/// Columns of the information below this fraction of the largest are round-off.
const NONE: f64 = 1.0e-10;

/// The ten unknowns, and six more for unknown momentum, with their units.
struct Unknowns<'a> {
    theta: Vec<f64>,
    unit: Vec<f64>,
    arm_mass: f64,
    known: bool,
    run: &'a Run,
}

impl<'a> Unknowns<'a> {
    fn new(run: &'a Run, known: bool) -> Self {
        let truth = run.truth();
        let arm_mass: f64 = run.model.bodies[1..].iter().map(|b| b.nominal.mass).sum();
        let mut theta = truth.to_array().to_vec();
        theta[0] = arm_mass / truth.mass;
        let size = truth.I_BBcm_B.norm();
        let mut unit = vec![theta[0], 1.0, 1.0, 1.0];
        unit.extend([size; 6]);
        if !known {
            theta.extend(&(run.known.p_C_N / truth.mass));
            theta.extend(&run.known.h_C_N);
            unit.extend([1.0, 1.0, 1.0, size, size, size]);
        }
        Self {
            theta,
            unit,
            arm_mass,
            known,
            run,
        }
    }

    /// The six equations of a sample, zero for the true values.
    fn equations(&self, s: &Reading, t: &[f64]) -> Vector6 {
        let known = &self.run.known;
        let three = |k: usize| Vector3::from_column_slice(&t[k..k + 3]);
        let x = SVector::<f64, 5>::new(t[0], t[1], t[2], t[3], 1.0);
        let y = SVector::<f64, 7>::from_iterator(t[4..10].iter().copied().chain([1.0]));
        let (P, H) = match self.known {
            true => (known.p_C_N * (t[0] / self.arm_mass), known.h_C_N),
            false => (three(10), three(13)),
        };
        let l = linear_rows(s) * x - P;
        let mass_centre = three(1);
        let h = angular_rows(s, self.arm_mass / t[0], &mass_centre) * y - H;
        stacked(&l, &h)
    }

    /// Information of one sample: `D^T S^-1 D`; `None` if a velocity is exact.
    fn information(&self, s: &Reading, sigma: Sigma) -> Option<DMatrix<f64>> {
        let mut S = Matrix6::zeros();
        let mut add = |change: &dyn Fn(&mut Reading, f64)| {
            let at = |sign: f64| {
                let mut moved = *s;
                change(&mut moved, sign);
                self.equations(&moved, &self.theta)
            };
            let e = (at(1.0) - at(-1.0)) * 0.5;
            S += e * e.transpose();
        };
        for k in 0..3 {
            let dv = s.R_NB.transpose().column(k) * sigma.v[k];
            add(&|moved, sign| moved.v_NBo_B += dv * sign);
            add(&|moved, sign| moved.w_NB_B[k] += sign * sigma.w[k]);
        }
        let mut D = DMatrix::<f64>::zeros(6, self.theta.len());
        for j in 0..self.theta.len() {
            let moved = |by: f64| {
                let mut t = self.theta.clone();
                t[j] += by * self.unit[j];
                self.equations(s, &t)
            };
            let slope = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
            D.column_mut(j).copy_from(&slope);
        }
        Some(D.transpose() * S.try_inverse()? * &D)
    }
}

impl Run {
    /// Cramer-Rao bound for noisy velocities, exact attitude and joints, and no position. RMS errors: mass (relative),
    /// mass centre (m), tensor (relative to its norm).
    ///
    /// Six equations `g = 0` and six noisy velocities per sample: with `g` differentiated over the unknowns (`D`) and
    /// over the velocities (`S = sum e e^T`), the information is `sum D^T S^-1 D`. Unknown momentum adds six unknowns.
    pub fn bound(&self, sigma: Sigma, known: bool) -> Errors {
        let unknowns = Unknowns::new(self, known);
        let n = unknowns.theta.len();
        let mut information = DMatrix::<f64>::zeros(n, n);
        for s in self.readings() {
            match unknowns.information(&s, sigma) {
                Some(of_sample) => information += of_sample,
                None => return [f64::INFINITY; 3],
            }
        }
        let variance = variances(&information);
        // A product of inertia is in the tensor twice.
        let times = |(i, j)| if i == j { 1.0 } else { 2.0 };
        let elements = TENSOR.into_iter().enumerate();
        let tensor: f64 = elements.map(|(k, e)| times(e) * variance[4 + k]).sum();
        let mass_centre: f64 = variance[1..4].iter().sum();
        [variance[0], mass_centre, tensor].map(f64::sqrt)
    }
}

/// Diagonal of the inverse of an information matrix; infinite where it has no information.
fn variances(information: &DMatrix<f64>) -> Vec<f64> {
    let n = information.nrows();
    // Scale to units of the unknowns, then to equal diagonals: with orbital velocity the columns differ by many powers
    // of ten. A column of round-off is zero.
    let size: Vec<f64> = (0..n).map(|i| information[(i, i)].sqrt()).collect();
    let floor = NONE * largest(size.iter().copied()).max(f64::MIN_POSITIVE);
    let some = |s: f64| if s > floor { s } else { f64::INFINITY };
    let size: Vec<f64> = size.into_iter().map(some).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| information[(i, j)] / size[i] / size[j]);
    let eigen = scaled.symmetric_eigen();
    let most = eigen.eigenvalues.max();
    let share = |i: usize, j: usize| {
        let (v, l) = (eigen.eigenvectors[(i, j)].powi(2), eigen.eigenvalues[j]);
        match l > ZERO * most {
            true => v / l,
            false if v > 1.0e-9 => f64::INFINITY,
            false => 0.0,
        }
    };
    let variance = |i: usize| match size[i].is_infinite() {
        true => f64::INFINITY,
        false => (0..n).map(|j| share(i, j)).sum::<f64>() / (size[i] * size[i]),
    };
    (0..n).map(variance).collect()
}
