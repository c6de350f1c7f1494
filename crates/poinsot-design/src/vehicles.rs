//! Vehicles of the prior of a model, or of what an earlier answer told of it.

use nalgebra::{DMatrix, DVectorView, SymmetricEigen};
use poinsot_formats::address;
use poinsot_model::{Body, Model};
use poinsot_spatial::{MASS_PROPERTY_NAMES, MassProperties, Matrix3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range;

/// Draws of one body before the nominal body is used instead of an unphysical one.
const DRAWS: usize = 1000;

/// Whether any estimated mass property has a prior or was told by an earlier answer; otherwise every draw is the nominal vehicle.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// // The model gives sigma of the nominal inertia.
/// assert!(has_prior(&model));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn has_prior(model: &Model) -> bool {
    let mut unknown = model.bodies.iter().filter(|b| b.estimate.any());
    model.knowledge.posterior.is_some() || unknown.any(|b| b.prior.is_some())
}

/// Vehicle number `number` of a seed; the result is deterministic.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// let zz = |number| drawn(&model, 1, number).bodies[0].nominal.I_BBcm_B[(2, 2)];
/// // The same number gives the same vehicle; each is physical.
/// assert_eq!(zz(3), zz(3));
/// assert_ne!(zz(3), zz(4));
/// assert!(drawn(&model, 1, 3).bodies[0].nominal.check_physical(0.0).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drawn(model: &Model, seed: u64, number: u64) -> Model {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    Prior::new(model).drawn(&mut || StandardNormal.sample(&mut rng))
}

/// The vehicles of the prior as a function of independent standard normal numbers.
pub(crate) struct Prior<'m> {
    model: &'m Model,
    /// One for each row of `factor`.
    moved: Vec<Moved>,
    /// Shifts of the mass properties for standard normal numbers.
    factor: DMatrix<f64>,
    /// Numbers that are drawn together: those of a body, then those of the earlier answer.
    parts: Vec<Range<usize>>,
}

/// A mass property that the prior spreads.
struct Moved {
    body: usize,
    /// Place among the ten.
    place: usize,
}

impl<'m> Prior<'m> {
    /// The prior of a model.
    pub fn new(model: &'m Model) -> Self {
        let posterior = model.knowledge.posterior.as_ref();
        let (mut declared, mut told) = (Vec::new(), Vec::new());
        let mut parts = Vec::new();
        for (i, body) in model.bodies.iter().enumerate() {
            let first = declared.len();
            for (place, name) in addresses(&body.name).iter().enumerate() {
                let of_answer = posterior.and_then(|p| p.place(name));
                let asked = body.prior.filter(|_| body.estimate.has(place));
                let moved = Moved { body: i, place };
                match (of_answer, asked.and_then(|p| p.sigma(place))) {
                    (Some(number), _) => told.push((moved, number)),
                    (None, Some(sigma)) => declared.push((moved, sigma)),
                    _ => {}
                }
            }
            if declared.len() > first {
                parts.push(first..declared.len());
            }
        }
        let known = posterior.and_then(|p| {
            let n = p.numbers.len();
            DMatrix::from_fn(n, n, |i, j| p.between(i, j)).cholesky()
        });
        let known = known.map_or(DMatrix::zeros(0, 0), |c| c.l());
        let (first, own) = (declared.len(), known.ncols());
        let mut factor = DMatrix::zeros(first + told.len(), first + own);
        for (i, (_, sigma)) in declared.iter().enumerate() {
            factor[(i, i)] = *sigma;
        }
        if own > 0 {
            for (i, (_, number)) in told.iter().enumerate() {
                let mut row = factor.view_mut((first + i, first), (1, own));
                row.copy_from(&known.row(*number));
            }
            parts.push(first..first + own);
        }
        let declared = declared.into_iter().map(|d| d.0);
        Self {
            model,
            moved: declared.chain(told.into_iter().map(|t| t.0)).collect(),
            factor,
            parts,
        }
    }

    /// How many standard normal numbers a vehicle has.
    pub fn len(&self) -> usize {
        self.factor.ncols()
    }

    /// The vehicle of these numbers; `None` if one of its bodies is not physical.
    pub fn vehicle(&self, normal: &[f64]) -> Option<Model> {
        let bodies = self.bodies(normal)?;
        let mut vehicle = self.model.clone();
        vehicle.bodies = bodies;
        Some(vehicle)
    }

    /// Its bodies alone.
    pub fn bodies(&self, normal: &[f64]) -> Option<Vec<Body>> {
        let shifts = &self.factor * DVectorView::from_slice(normal, normal.len());
        let mut bodies = self.model.bodies.clone();
        for (moved, shift) in self.moved.iter().zip(shifts.iter()) {
            let nominal = &mut bodies[moved.body].nominal;
            let mut numbers = nominal.to_array();
            numbers[moved.place] += shift;
            *nominal = MassProperties::from_array(&numbers);
        }
        let holds = |m: &Moved| is_physical(&bodies[m.body].nominal);
        self.moved.iter().all(holds).then_some(bodies)
    }

    fn drawn(&self, unit: &mut dyn FnMut() -> f64) -> Model {
        let mut normal = vec![0.0; self.len()];
        for part in &self.parts {
            let is_found = (0..DRAWS).any(|_| {
                normal[part.clone()].fill_with(&mut *unit);
                self.bodies(&normal).is_some()
            });
            if !is_found {
                normal[part.clone()].fill(0.0);
            }
        }
        self.vehicle(&normal).unwrap_or_else(|| self.model.clone())
    }
}

fn addresses(body: &str) -> [String; 10] {
    MASS_PROPERTY_NAMES.map(|name| address(&format!("{body}.{name}"), ""))
}

/// Positive mass, and principal moments that a mass distribution can have.
fn is_physical(body: &MassProperties) -> bool {
    let moments = |I: Matrix3| SymmetricEigen::new(I).eigenvalues;
    body.mass > 0.0 && body.check_physical(0.0).is_ok() && moments(body.I_BBcm_B).min() > 0.0
}
