//! The kernel of trials on the samples of a problem.
//!
//! Gyro and velocity have their declared noise; attitude, joints and wheels are exact. Both steps are solved without the
//! effect of noise on their regressors, so no sigma is stated.

use super::arm::Vehicle;
use super::data::{Variant, check, raws};
use super::equations::Known;
use super::lanes::LANES;
use super::trials::Trials;
use crate::ma2008::error;
use crate::method::Kernel;
use poinsot_files::Faults;
use poinsot_identify::Problem;
use poinsot_spatial::{MassProperties, Matrix3, Vector3, tensor};
use std::ops::Range;

/// The kernel of a problem whose samples determine the whole base; `None` unless it has one segment, equal noise on the axes of gyro and of velocity, and both
/// momenta known or none.
///
/// # Errors
/// As [`super::identify`].
pub(super) fn kernel(problem: &Problem, variant: Variant) -> Result<Option<Trials>, Faults> {
    let given = check(problem, variant)?;
    let known = match (given.p_C_N, given.h_C_N) {
        (Some(p_C_N), Some(h_C_N)) => Some(Known { p_C_N, h_C_N }),
        (None, None) => None,
        _ => return Ok(None),
    };
    let [segment] = problem.segments else {
        return Ok(None);
    };
    if segment.samples.translation.is_none() {
        let label = segment.label.clone();
        return Err(error::no_velocity(&label));
    }
    let (raws, _) = raws(problem, segment, &given)?;
    let mut vehicle = Vehicle::new(problem.model, problem.tree);
    let samples: Vec<_> = raws.iter().map(|raw| vehicle.reading(raw)).collect();
    let sigma = |covariance: &Matrix3| {
        let variance = covariance[(0, 0)];
        // The kernel draws in base axes, the velocity is measured in N: only equal noise of all axes is the same.
        (*covariance == Matrix3::identity() * variance).then(|| [variance.sqrt(); 3])
    };
    let noise = problem.noise;
    let (Some(v), Some(w)) = (sigma(&noise.velocity), sigma(&noise.gyro)) else {
        return Ok(None);
    };
    Ok(Some(Trials::new(&samples, known, v, w)))
}

/// The body of the ten numbers of a trial.
fn body([mass, x, y, z, inertia @ ..]: [f64; 10]) -> MassProperties {
    MassProperties {
        mass,
        p_BoBcm_B: Vector3::new(x, y, z),
        I_BBcm_B: tensor(inertia),
    }
}

impl Kernel for Trials {
    fn trials(&self, seed: u64, numbers: Range<u64>) -> Vec<MassProperties> {
        let lanes = LANES as u64;
        let groups = numbers.start / lanes..numbers.end.div_ceil(lanes);
        let mut number = groups.start * lanes;
        let mut bodies = Vec::new();
        self.run(seed, groups, |results| {
            for lane in 0..LANES {
                if numbers.contains(&number) {
                    bodies.push(body(results.map(|of_lanes| of_lanes[lane])));
                }
                number += 1;
            }
        });
        bodies
    }
}
