//! Vehicles drawn from the prior of a model, or from what an earlier answer told of it.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use poinsot_formats::address;
use poinsot_model::{Body, Model, Posterior};
use poinsot_spatial::{MASS_PROPERTY_NAMES, MassProperties, Matrix3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

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
    let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut vehicle = model.clone();
    let posterior = model.knowledge.posterior.as_ref();
    for body in &mut vehicle.bodies {
        let Some(prior) = body.prior.filter(|_| body.estimate.any()) else {
            continue;
        };
        let told = |name: &String| posterior.is_some_and(|p| p.place(name).is_some());
        let names = addresses(&body.name);
        let declared = |k: usize| prior.sigma(k).filter(|_| !told(&names[k]));
        let shifts = |unit: &mut dyn FnMut() -> f64| {
            let of = |k| declared(k).filter(|_| body.estimate.has(k));
            std::array::from_fn(|k| of(k).map_or(0.0, |sigma| sigma * unit()))
        };
        let drawn = (0..DRAWS).map(|_| moved(&body.nominal, shifts(&mut unit)));
        body.nominal = drawn.into_iter().find(is_physical).unwrap_or(body.nominal);
    }
    if let Some(posterior) = posterior {
        let drawn = (0..DRAWS).filter_map(|_| of_posterior(&vehicle, posterior, &mut unit));
        vehicle.bodies = drawn.into_iter().next().unwrap_or(vehicle.bodies);
    }
    vehicle
}

/// The bodies with a draw of what an earlier answer told; `None` if one is not physical.
fn of_posterior(
    vehicle: &Model,
    posterior: &Posterior,
    unit: &mut dyn FnMut() -> f64,
) -> Option<Vec<Body>> {
    let n = posterior.numbers.len();
    let covariance = DMatrix::from_fn(n, n, |i, j| posterior.between(i, j));
    let white = DVector::from_fn(n, |_, _| unit());
    let shift = covariance.cholesky()?.l() * white;
    let mut bodies = vehicle.bodies.clone();
    for body in &mut bodies {
        let places = addresses(&body.name).map(|name| posterior.place(&name));
        body.nominal = moved(&body.nominal, places.map(|k| k.map_or(0.0, |k| shift[k])));
    }
    bodies
        .iter()
        .all(|b| is_physical(&b.nominal))
        .then_some(bodies)
}

fn addresses(body: &str) -> [String; 10] {
    MASS_PROPERTY_NAMES.map(|name| address(&format!("{body}.{name}"), ""))
}

/// A body whose numbers are changed by these.
fn moved(body: &MassProperties, shifts: [f64; 10]) -> MassProperties {
    let own = body.to_array();
    MassProperties::from_array(&std::array::from_fn(|k| own[k] + shifts[k]))
}

/// Positive mass, and principal moments that a mass distribution can have.
fn is_physical(body: &MassProperties) -> bool {
    let moments = |I: Matrix3| SymmetricEigen::new(I).eigenvalues;
    body.mass > 0.0 && body.check_physical(0.0).is_ok() && moments(body.I_BBcm_B).min() > 0.0
}
