//! Bodies of an answer for predictions, and their sum.

use poinsot_dynamics::{Kinematics, composite};
use poinsot_identify::{Estimate, Number, tensor_name};
use poinsot_model::Model;
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3};

/// Bodies by a published method: its determined numbers, otherwise the numbers that it prints, otherwise nominal ones.
///
/// ```
#[doc = include_str!("../doc/record.txt")]
/// let input = record("linear", "ma2008/model.toml", "ma2008/traj1/telemetry.parquet")?;
/// let estimate = poinsot_identify::linear(&problem(&input))?;
/// let bodies = answered(&input.model, &estimate);
/// // The base was unknown, the arm keeps its nominal numbers.
/// assert!((bodies[0].mass - 1000.0).abs() < 1.0);
/// assert_eq!(bodies[1], input.model.bodies[1].nominal);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn answered(model: &Model, estimate: &Estimate) -> Vec<MassProperties> {
    let printed = |name: &str| {
        let report = estimate.method_report.as_ref()?;
        let found = report.numbers.iter().find(|n| n.name == name)?;
        found.number.value
    };
    let bodies = model.bodies.iter().zip(&estimate.bodies);
    bodies
        .map(|(body, answer)| {
            if !answer.asked {
                return body.nominal;
            }
            let best = |n: &Number, name: &str| {
                let printed = || printed(name).filter(|_| model.bodies.len() == 1);
                n.value.or_else(printed).unwrap_or(n.nominal)
            };
            let [xx, xy, yy, xz, yz, zz] = std::array::from_fn(|k| {
                best(&answer.inertia[k], &format!("inertia_{}", tensor_name(k)))
            });
            MassProperties {
                mass: best(&answer.mass, "mass"),
                p_BoBcm_B: Vector3::from(answer.com.map(|n| n.value.unwrap_or(n.nominal))),
                I_BBcm_B: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            }
        })
        .collect()
}

/// All bodies summed about the base origin, in the given configuration.
pub(crate) fn as_one(bodies: &[InertialParameters], kinematics: &Kinematics) -> InertialParameters {
    let c = composite(bodies, kinematics);
    InertialParameters {
        mass: c.mass,
        mc_B: c.mc,
        I_BBo_B: c.I_SBo_B,
    }
}
