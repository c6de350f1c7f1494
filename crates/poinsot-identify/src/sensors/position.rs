//! Position of a point in N, from the place of the base origin at the first sample.

use super::{IdealMeasurement, JointSlope, MeasurementJacobian, joints, times_skew};
use crate::motion::{PointKinematics, State};
use crate::problem::segment::SensorValue;
use poinsot_spatial::{Matrix3, Vector3};

/// `p_NoP_N = p_NoBo_N + R_NB r`.
pub(super) fn measure(
    place: &PointKinematics,
    state: &State,
    R_NB: &Matrix3,
    list: Vec<JointSlope>,
) -> IdealMeasurement {
    let turned = -times_skew(R_NB, &place.r);
    let (one, zero) = (Matrix3::identity(), Matrix3::zeros());
    IdealMeasurement {
        value: SensorValue::Vector(state.p_NoBo_N + R_NB * place.r),
        rate: Some(R_NB * place.v),
        slopes: MeasurementJacobian {
            joints: joints(place, list, |j| (R_NB * j.shift, Vector3::zeros())),
            ..MeasurementJacobian::new([&turned, &one], [&zero, &zero])
        },
    }
}
