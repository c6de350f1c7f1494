//! The regressor of the momentum's rate of change: the sensitivity of accelerometers to the parameters.

use crate::acceleration::Accelerations;
use crate::kinematics::Kinematics;
use crate::momentum::Wrench;
use crate::tree::Tree;
use poinsot_spatial::{InertialParameters, Vector3, Vector6, stacked};

/// Rate of change of the momentum `[l'; h']` about the base origin's present place, inertial rate in base
/// axes, N and N m, of one unit of parameter k of body i at the velocities and accelerations given.
///
/// The rate of the whole is the sum of these columns times the parameters (in the order of
/// `poinsot_spatial::PARAMETER_NAMES`): [`Accelerations::momentum_rate`] is linear in them.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // A steady turn at 1 rad/s: 1 kg m of first moment along the arm needs 1 N towards the hinge.
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::z(), &[0.0]);
/// let mut accelerations = Accelerations::new(&tree);
/// accelerations.set_without_base(&tree, &kinematics, &[0.0], &[0.0]);
/// let column = momentum_rate_column(&accelerations, &kinematics, 1, 1);
/// assert_eq!(column, -Vector6::x());
/// ```
pub fn momentum_rate_column(
    accelerations: &Accelerations,
    kinematics: &Kinematics,
    i: usize,
    k: usize,
) -> Vector6 {
    let unit = InertialParameters::unit(k);
    let Wrench { force, torque } = accelerations.body_rate(&unit, kinematics, i);
    stacked(&force, &(torque + kinematics.p[i].cross(&force)))
}

/// Rate of change of the wheels' relative angular momentum, inertial rate in base axes, N m:
/// `sum Js (Omega' a + Omega w x a)` with `w` of the host.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // Speed rises by 2 rad/s2; the host is at rest.
/// let rate = wheel_rate(&tree, &kinematics, &[0.01], &[100.0], &[2.0]);
/// assert_eq!(rate, Vector3::z() * 0.02);
/// ```
pub fn wheel_rate(
    tree: &Tree,
    kinematics: &Kinematics,
    spin_inertia: &[f64],
    speed: &[f64],
    speed_rate: &[f64],
) -> Vector3 {
    let spins = spin_inertia.iter().zip(speed.iter().zip(speed_rate));
    tree.rotors
        .iter()
        .zip(spins)
        .map(|(rotor, (js, (omega, omega_rate)))| {
            let a = kinematics.R[rotor.body] * rotor.axis_B;
            (a * *omega_rate + kinematics.w[rotor.body].cross(&a) * *omega) * *js
        })
        .sum()
}
