//! Steps that keep every unknown body physical.
//!
//! Answer, covariance and identifiability are stated in the ten linear parameters of each body, and so are the steps.
//! The pseudo-inertia is linear in them, so the physical bodies are a convex cone, and close to a point chi-square is a
//! parabola: the best step within the cone is the shortest vector of a small convex problem (`semidefinite.rs`), with
//! one answer, on the edge or not. A plain step that stays inside needs no correction.

use crate::problem::parameters::{Equations, Parameters, TENSOR, UnknownKind};
use nalgebra::{Matrix4, SymmetricEigen};
use poinsot_solve::Spectrum;
use poinsot_solve::semidefinite::{Block, Shortest, shortest};
use poinsot_spatial::{MassProperties, Matrix3, pseudo_inertia};

/// Smallest eigenvalue of a pseudo-inertia over the reference that is kept: above round-off, far below any thickness.
const FLOOR: f64 = 1.0e-10;
/// The same below which a body is at the limit.
const EDGE: f64 = 1.0e-6;
/// The same of a start.
const START: f64 = 0.05;
/// Least second moment of the reference along any axis, over their sum: a nominal plate may be flat.
const THICKNESS: f64 = 1.0e-3;
/// Relative violation of the triangle inequality that printed nominal numbers may have.
const PRINTED: f64 = 1.0e-9;
/// Share that an unobservable direction may have in a body that it does not change.
const UNCHANGED: f64 = 1.0e-6;
/// Weight of unobservable directions over that of the weakest identified one: they follow the others and cost nothing.
const OPEN: f64 = 1.0e-4;

/// The unknown bodies, each as a matrix that is positive definite while the body is physical.
#[derive(Clone)]
pub(crate) struct PhysicalBodies {
    bodies: Vec<Body>,
    /// Values of the unknowns that are no nuisances at which every matrix is the identity.
    reference: Vec<f64>,
}

/// One unknown body: its pseudo-inertia over that of the reference, `L^-1 J(x) L^-T`, is linear in the unknowns.
#[derive(Clone)]
struct Body {
    /// Index in the model.
    index: usize,
    /// The matrix where all unknowns are zero.
    constant: Matrix4<f64>,
    /// Its slope over the unknowns that belong to the body.
    slopes: Vec<(usize, Matrix4<f64>)>,
}

impl PhysicalBodies {
    /// `None` where no unknown body is physical to begin with: then there is no constraint.
    pub fn new(parameters: &Parameters) -> Option<Self> {
        let mut reference = parameters.nominal_vector();
        let bodies: Vec<Body> = (0..parameters.estimate.len())
            .filter_map(|index| Body::new(parameters, index, &mut reference))
            .collect();
        reference.truncate(parameters.decided_by_steps());
        (!bodies.is_empty()).then_some(Self { bodies, reference })
    }

    /// The bodies that no unobservable direction exchanges with another body; `None` without any. The others have no
    /// reported number that could be unphysical.
    pub fn separable(mut self, spectrum: &Spectrum) -> Option<Self> {
        let touched = |body: &Body, k: usize| {
            let own = body.slopes.iter().map(|(u, _)| u);
            own.map(|u| spectrum.directions[(*u, k)].powi(2))
                .sum::<f64>()
                > UNCHANGED * UNCHANGED
        };
        let mut traded = vec![false; self.bodies.len()];
        for k in spectrum.rank..spectrum.natural.len() {
            let own: Vec<bool> = self.bodies.iter().map(|b| touched(b, k)).collect();
            if own.iter().filter(|t| **t).count() > 1 {
                traded
                    .iter_mut()
                    .zip(own)
                    .for_each(|(all, one)| *all |= one);
            }
        }
        let mut apart = traded.iter().map(|t| !t);
        self.bodies.retain(|_| apart.next().unwrap_or(true));
        (!self.bodies.is_empty()).then_some(self)
    }

    /// Whether all bodies are physical at these values of the mass unknowns.
    pub fn contain(&self, x: &[f64]) -> bool {
        self.bodies.iter().all(|b| b.smallest(x) > FLOOR)
    }

    /// A physical start: as far from the reference towards it as the bodies stay so.
    pub fn start(&self, x: &mut [f64]) {
        let mut share: f64 = 1.0;
        for body in &self.bodies {
            // (1 - s) + s l > 0 for the smallest eigenvalue l.
            let l = body.smallest(x);
            if l < START {
                share = share.min(0.9 / (1.0 - l.max(-1.0e9)));
            }
        }
        if share < 1.0 {
            for (x, from) in x.iter_mut().zip(&self.reference) {
                *x = from + share * (*x - from);
            }
        }
    }

    /// Indices of the bodies at the limit, and the number of active conditions: k (k + 1) / 2 for k vanishing
    /// eigenvalues.
    pub fn at_the_edge(&self, x: &[f64]) -> (Vec<usize>, usize) {
        let mut conditions = 0;
        let mut indices = Vec::new();
        for body in &self.bodies {
            let eigen = SymmetricEigen::new(body.at(x)).eigenvalues;
            let k = eigen.iter().filter(|e| **e < EDGE).count();
            if k > 0 {
                conditions += k * (k + 1) / 2;
                indices.push(body.index);
            }
        }
        (indices, conditions)
    }

    /// The damped step of the mass unknowns, natural units, that lowers the linear model's chi-square most while all
    /// bodies stay physical, and how much it does. Unobservable directions may follow.
    ///
    /// In the directions of the spectrum, `y = V^T z`, the cost is `sum w_k^2 (y_k - t_k)^2`, so `u_k = w_k (y_k - t_k)`
    /// is the shortest vector for which the bodies are physical.
    pub fn step(
        &self,
        spectrum: &Spectrum,
        rhs: &[f64],
        damping: f64,
        x: &[f64],
    ) -> (Vec<f64>, f64) {
        let n = spectrum.natural.len();
        let open = OPEN * spectrum.smallest_singular_value().min(1.0e12);
        let along: Vec<f64> = (0..spectrum.rank)
            .map(|k| spectrum.left_along(rhs, k))
            .collect();
        let weight: Vec<f64> = (0..n)
            .map(|k| match k < spectrum.rank {
                true => (spectrum.singular[k].powi(2) + damping).sqrt(),
                false => open,
            })
            .collect();
        let target: Vec<f64> = (0..n)
            .map(|k| match along.get(k) {
                Some(b) => spectrum.singular[k] * b / (weight[k] * weight[k]),
                None => 0.0,
            })
            .collect();
        let blocks: Vec<Block> = self
            .bodies
            .iter()
            .map(|body| body.block(spectrum, x, &target, &weight))
            .collect();
        let start: Vec<f64> = (0..n)
            .map(|k| {
                let y: f64 = (0..n)
                    .map(|i| {
                        spectrum.directions[(i, k)] * (self.reference[i] - x[i])
                            / spectrum.natural[i]
                    })
                    .sum();
                weight[k] * (y - target[k])
            })
            .collect();
        // Without a solution there is no step and no predicted reduction: the fit does not converge.
        let Some(Shortest { u, excess }) = shortest(&blocks, &start) else {
            return (vec![0.0; n], f64::NAN);
        };
        let y: Vec<f64> = (0..n).map(|k| target[k] + u[k] / weight[k]).collect();
        let each = along.iter().zip(&spectrum.singular).zip(&y);
        let lowered: f64 = each.map(|((b, s), y)| b * b - (b - s * y).powi(2)).sum();
        // The best step may lower more by the excess of this one.
        (spectrum.combined(0..n, |k| y[k]), lowered + excess)
    }
}

impl Body {
    /// `None` where nothing is unknown or the nominal body is none: an unphysical start cannot be kept physical. A
    /// nominal plate or rod is thickened in the reference.
    fn new(parameters: &Parameters, index: usize, reference: &mut [f64]) -> Option<Self> {
        let unknowns = unknowns_of(parameters, index);
        if unknowns.is_empty() {
            return None;
        }
        if parameters.estimate[index].inertia {
            let thicker = thickening(&parameters.nominal_properties[index])?;
            for u in &unknowns {
                if is_moment(&parameters.unknowns[*u].kind) {
                    reference[*u] += 2.0 * thicker;
                }
            }
        }
        let L = matrix(parameters, index, reference).cholesky()?.l();
        let over = |J: Matrix4<f64>| -> Option<Matrix4<f64>> {
            let half = L.solve_lower_triangular(&J)?;
            let whole = L.solve_lower_triangular(&half.transpose())?;
            Some((whole + whole.transpose()) * 0.5)
        };
        let mut x = vec![0.0; reference.len()];
        let nothing = matrix(parameters, index, &x);
        let mut slopes = Vec::new();
        for u in unknowns {
            x[u] = 1.0;
            slopes.push((u, over(matrix(parameters, index, &x) - nothing)?));
            x[u] = 0.0;
        }
        Some(Self {
            index,
            constant: over(nothing)?,
            slopes,
        })
    }

    fn at(&self, x: &[f64]) -> Matrix4<f64> {
        let slopes = self.slopes.iter();
        slopes.fold(self.constant, |S, (u, slope)| S + slope * x[*u])
    }

    /// Smallest eigenvalue; minus infinity where a number is not finite.
    fn smallest(&self, x: &[f64]) -> f64 {
        let S = self.at(x);
        if S.iter().any(|x| !x.is_finite()) {
            return f64::NEG_INFINITY;
        }
        SymmetricEigen::new(S).eigenvalues.min()
    }

    /// The condition on `u = w (y - t)` that the body stays above the floor after the step `V y`.
    fn block(&self, spectrum: &Spectrum, x: &[f64], target: &[f64], weight: &[f64]) -> Block {
        let along: Vec<Matrix4<f64>> = (0..weight.len())
            .map(|k| {
                let own = self.slopes.iter();
                own.fold(Matrix4::zeros(), |sum, (u, slope)| {
                    sum + slope * (spectrum.directions[(*u, k)] * spectrum.natural[*u])
                })
            })
            .collect();
        let here = self.at(x) - Matrix4::identity() * FLOOR;
        Block {
            constant: along.iter().zip(target).fold(here, |S, (B, t)| S + B * *t),
            slopes: along.iter().zip(weight).map(|(B, w)| B / *w).collect(),
        }
    }
}

/// The matrix that is positive definite while a body is physical: the pseudo-inertia, or of it the part that can
/// change. Straight in the unknowns.
fn matrix(parameters: &Parameters, index: usize, x: &[f64]) -> Matrix4<f64> {
    match (parameters.equations, parameters.estimate[index].inertia) {
        (Equations::Momentum, true) => pseudo_inertia(&parameters.bodies(x)[index]),
        (Equations::Momentum, false) => {
            let mass = parameters.bodies(x)[index].mass;
            let mut J = Matrix4::identity();
            J[(3, 3)] = mass;
            J
        }
        // The mass is known and the mass centre has no part in it.
        (Equations::Rotation, _) => {
            let mut I = Matrix3::zeros();
            for (unknown, value) in parameters.unknowns.iter().zip(x) {
                if let UnknownKind::CentralInertia(e) = unknown.kind {
                    let (i, j) = TENSOR[e];
                    I[(i, j)] = *value;
                    I[(j, i)] = *value;
                }
            }
            let mut J = Matrix4::identity();
            J.fixed_view_mut::<3, 3>(0, 0).copy_from(&second_moment(&I));
            J
        }
    }
}

fn second_moment(I: &Matrix3) -> Matrix3 {
    Matrix3::identity() * (0.5 * I.trace()) - I
}

/// What the second moment of the nominal body lacks to be [`THICKNESS`] thick along every axis, kg m2; `None` for an
/// impossible one.
fn thickening(nominal: &MassProperties) -> Option<f64> {
    let second = second_moment(&nominal.I_BBcm_B);
    let sum = second.trace();
    let least = SymmetricEigen::new(second).eigenvalues.min();
    let possible = nominal.mass > 0.0 && sum > 0.0 && least >= -PRINTED * sum;
    possible.then(|| (THICKNESS * sum - least).max(0.0))
}

/// Whether an unknown is a moment of inertia: on the diagonal of a tensor.
fn is_moment(kind: &UnknownKind) -> bool {
    let element = match kind {
        UnknownKind::Barycentric(parts) => parts.first().and_then(|p| (p.0 % 10).checked_sub(4)),
        UnknownKind::CentralInertia(e) => Some(*e),
        _ => None,
    };
    element.is_some_and(|e| TENSOR[e].0 == TENSOR[e].1)
}

/// The unknowns that make up a body's mass and inertia.
fn unknowns_of(parameters: &Parameters, body: usize) -> Vec<usize> {
    let list = parameters.unknowns.iter().enumerate();
    list.filter(|(_, unknown)| match &unknown.kind {
        UnknownKind::Barycentric(parts) => parts.first().is_some_and(|p| p.0 / 10 == body),
        UnknownKind::CentralInertia(_) => body == 0,
        _ => false,
    })
    .map(|(u, _)| u)
    .collect()
}
