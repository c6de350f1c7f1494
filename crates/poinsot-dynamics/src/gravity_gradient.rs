//! The gravity-gradient torque.

use crate::kinematics::Kinematics;
use crate::momentum::Wrench;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3};

/// Gravity-gradient torque about the system's mass centre, N m: `3 gm / r^5  r x (I r)` (Hughes 1986, sec. 8.1), to
/// first order in the size of the vehicle over the distance.
///
/// `r` from the attracting body to the vehicle, m, and the inertia about the mass centre, kg m2, in one set of
/// axes; the torque comes in the same.
///
/// ```
/// use poinsot_dynamics::gravity_gradient_torque;
/// use poinsot_spatial::{Matrix3, Vector3};
///
/// let (gm, r) = (3.986_004_418e14, 7.0e6);
/// let I = Matrix3::from_diagonal(&Vector3::new(100.0, 200.0, 250.0));
/// // 45 degrees between the local vertical and x: 3/2 n^2 (I_yy - I_xx) about z.
/// let vertical = Vector3::new(1.0, 1.0, 0.0).normalize() * r;
/// let torque = gravity_gradient_torque(gm, &vertical, &I);
/// let expected = 1.5 * gm / (r * r * r) * 100.0;
/// assert!((torque.z / expected - 1.0).abs() < 1.0e-12);
/// ```
pub fn gravity_gradient_torque(gm: f64, r: &Vector3, I_SScm: &Matrix3) -> Vector3 {
    let distance = r.norm();
    if distance == 0.0 {
        return Vector3::zeros();
    }
    let u = r / distance;
    u.cross(&(I_SScm * u)) * (3.0 * gm / distance.powi(3))
}

/// Gravity-gradient wrench on one body of a vehicle with a freely falling mass centre, about the body's origin, in base
/// axes, to first order in the size of the vehicle over the distance `|r|`. With `u = r / |r|` and `d` from the
/// system's mass centre to a particle the force on it is `gm / |r|^3 (3 u u^T - 1) d dm`. Over all bodies the forces
/// cancel and the torques add up to [`gravity_gradient_torque`].
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // Along the vertical a mass d from the system's mass centre is pulled away by 2 gm / r^3 d.
/// let (gm, r_B) = (3.986_004_418e14, Vector3::x() * 7.0e6);
/// let centre = composite(&bodies, &kinematics).p_BoScm_B();
/// let tide = |i: usize| tidal_wrench(gm, &r_B, &centre, &bodies[i], &kinematics, i);
/// let pull = 2.0 * gm / r_B.norm().powi(3) * (2.0 - centre.x);
/// assert!((tide(1).force.x / pull - 1.0).abs() < 1.0e-12);
/// // The forces on all bodies cancel.
/// assert!((tide(0).force + tide(1).force).norm() < 1.0e-12 * pull);
/// ```
pub fn tidal_wrench(
    gm: f64,
    r_B: &Vector3,
    p_BoScm_B: &Vector3,
    body: &InertialParameters,
    kinematics: &Kinematics,
    i: usize,
) -> Wrench {
    let distance = r_B.norm();
    if distance == 0.0 {
        return Wrench::ZERO;
    }
    let (u, rate) = (r_B / distance, gm / distance.powi(3));
    let tide = |x: &Vector3| (u * (3.0 * u.dot(x)) - x) * rate;
    let R = &kinematics.R[i];
    let mc = R * body.mc_B;
    // Of the part of d that is alike for all particles of the body, and of the part within it.
    let common = tide(&(kinematics.p[i] - p_BoScm_B));
    let I_CCo_B = R * body.I_BBo_B * R.transpose();
    Wrench {
        force: common * body.mass + tide(&mc),
        torque: mc.cross(&common) + u.cross(&(I_CCo_B * u)) * (3.0 * rate),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition: gravity on every point mass, its moment about their mass centre.
    #[test]
    fn exact_torque_is_that_of_gravity_on_point_masses() {
        let gm = 3.986004418e14;
        let r = Vector3::new(4.0e6, -3.0e6, 4.5e6);
        let points = [
            (3.0, Vector3::new(1.0, 0.2, -0.5)),
            (5.0, Vector3::new(-0.4, 0.9, 0.3)),
            (2.0, Vector3::new(0.1, -1.5, 0.8)),
            (4.0, Vector3::new(-0.6, -0.2, -0.7)),
        ];
        let mass: f64 = points.iter().map(|(m, _)| m).sum();
        let centre: Vector3 = points.iter().map(|(m, p)| p * *m).sum::<Vector3>() / mass;
        let (mut torque, mut I) = (Vector3::zeros(), Matrix3::zeros());
        // Unrealistically large, so that the difference of two forces is not round-off.
        let size = 1.0e3;
        for (m, p) in points {
            let arm = (p - centre) * size;
            let place = r + arm;
            // A uniform field has no moment: subtracted to keep the digits.
            let pull = -place * (gm / place.norm().powi(3)) + r * (gm / r.norm().powi(3));
            torque += arm.cross(&(pull * m));
            I += (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * m;
        }
        let found = gravity_gradient_torque(gm, &r, &I);
        // The next order is 5/2 of size over distance.
        assert!(
            (found - torque).norm() < 2.0e-3 * torque.norm(),
            "{found} {torque}"
        );
        assert!((found - torque).norm() > 0.0);
    }
}
