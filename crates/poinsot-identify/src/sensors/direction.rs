//! Direction of a vector known in N, seen from a body: sun sensor, magnetometer.

use super::{IdealMeasurement, JointSlope, MeasurementJacobian, attitude};
use crate::motion::{PointKinematics, State};
use crate::problem::segment::SensorValue;
use nalgebra::SMatrix;
use poinsot_spatial::{Matrix3, Vector3, skew};

/// `d_Bi = R_NBi^T d_N`; a small turn `a` of the body changes it by `d_Bi x a`.
pub(super) fn measure(
    place: &PointKinematics,
    state: &State,
    (body, reference_N): (usize, &Vector3),
    list: Vec<JointSlope>,
) -> Option<IdealMeasurement> {
    let IdealMeasurement {
        value: SensorValue::Attitude(R_NBi),
        rate: Some(w_NBi_Bi),
        mut slopes,
    } = attitude::measure(place, state, body, list)
    else {
        return None;
    };
    let d = R_NBi.inverse() * reference_N;
    let turned = skew(&d);
    for (_, turn, rate) in &mut slopes.joints {
        (*turn, *rate) = (turned * *turn, Vector3::zeros());
    }
    Some(IdealMeasurement {
        value: SensorValue::Vector(d),
        // The reference is constant between two samples.
        rate: Some(d.cross(&w_NBi_Bi)),
        slopes: MeasurementJacobian {
            pose: turned * slopes.pose,
            twist: SMatrix::zeros(),
            joints: slopes.joints,
        },
    })
}

/// Takes a vector to two axes across a direction; its component along the direction is lost.
///
/// The axes follow the direction without a branch but for its sign (Duff et al. 2017).
pub(crate) fn across(direction: &Vector3) -> Matrix3 {
    let [x, y, z] = (*direction).into();
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    Matrix3::new(
        1.0 + sign * x * x * a,
        sign * b,
        -sign * x,
        b,
        sign + y * y * a,
        -y,
        0.0,
        0.0,
        0.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_two_axes_across_are_orthonormal() {
        for k in 0..200 {
            let s = f64::from(k);
            let d = Vector3::new(s.sin(), (1.7 * s).cos(), (0.3 * s).sin()).normalize();
            let E = across(&d);
            let two = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
            assert!((E * E.transpose() - two).amax() < 1e-14);
            assert!((E * d).amax() < 1e-14);
        }
    }
}
