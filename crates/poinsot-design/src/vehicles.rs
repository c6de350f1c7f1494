//! Vehicles drawn from the prior of a model.

use nalgebra::SymmetricEigen;
use poinsot_identify::TENSOR;
use poinsot_model::Model;
use poinsot_spatial::{MassProperties, Matrix3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Draws of one body before the nominal body is used instead of an unphysical one.
const DRAWS: usize = 1000;

/// Whether any estimated mass property has a prior; otherwise every draw is the nominal vehicle.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// // The model gives sigma of the nominal inertia.
/// assert!(has_prior(&model));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn has_prior(model: &Model) -> bool {
    let bodies = model.bodies.iter();
    bodies
        .filter(|b| b.estimate.any())
        .any(|b| b.prior.is_some())
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
    let mut vehicle = model.clone();
    for body in &mut vehicle.bodies {
        let Some(prior) = body.prior.filter(|_| body.estimate.any()) else {
            continue;
        };
        let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
        let asked = body.estimate;
        for _ in 0..DRAWS {
            let mut one = body.nominal;
            if let Some(sigma) = prior.mass.filter(|_| asked.mass) {
                one.mass += sigma * unit();
            }
            if let Some(sigma) = prior.com.filter(|_| asked.com) {
                one.p_BoBcm_B.iter_mut().for_each(|c| *c += sigma * unit());
            }
            if let Some(sigma) = prior.inertia.filter(|_| asked.inertia) {
                for (i, j) in TENSOR {
                    let change = sigma * unit();
                    one.I_BBcm_B[(i, j)] += change;
                    if i != j {
                        one.I_BBcm_B[(j, i)] += change;
                    }
                }
            }
            if is_physical(&one) {
                body.nominal = one;
                break;
            }
        }
    }
    vehicle
}

/// Positive mass, and principal moments that a mass distribution can have.
fn is_physical(body: &MassProperties) -> bool {
    let moments = |I: Matrix3| SymmetricEigen::new(I).eigenvalues;
    body.mass > 0.0 && body.check_physical(0.0).is_ok() && moments(body.I_BBcm_B).min() > 0.0
}
