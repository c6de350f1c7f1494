//! Kinetic energy of the tree.

use crate::kinematics::Kinematics;
use poinsot_spatial::InertialParameters;

/// Kinetic energy of all bodies at the velocities of the kinematics, rotors as if locked, J:
/// `sum (m v.v / 2 + v.(w x mc) + w.I w / 2)` about the bodies' origins.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::z(), &[0.0]);
/// // I_zz w^2 / 2, with 5.5 kg m2 about Bo.
/// assert_eq!(kinetic_energy(&bodies, &kinematics), 2.75);
/// ```
pub fn kinetic_energy(parameters: &[InertialParameters], kinematics: &Kinematics) -> f64 {
    let body = |(i, body): (usize, &InertialParameters)| {
        let R = &kinematics.R[i];
        let v = R.tr_mul(&kinematics.v[i]);
        let w = R.tr_mul(&kinematics.w[i]);
        let turning = 0.5 * w.dot(&(body.I_BBo_B * w));
        0.5 * body.mass * v.norm_squared() + v.dot(&w.cross(&body.mc_B)) + turning
    };
    parameters.iter().enumerate().map(body).sum()
}
