//! Velocity of a point in N; the difference of two is a velocity increment.

use super::{IdealMeasurement, JointSlope, MeasurementJacobian, joints, times_skew};
use crate::motion::PointKinematics;
use crate::problem::segment::SensorValue;
use poinsot_spatial::Matrix3;

/// `v_NP_N = R_NB (v + w x r)`.
pub(super) fn measure(
    place: &PointKinematics,
    R_NB: &Matrix3,
    list: Vec<JointSlope>,
) -> IdealMeasurement {
    let turned = -times_skew(R_NB, &place.v);
    let by_rate = -times_skew(R_NB, &place.r);
    IdealMeasurement {
        value: SensorValue::Vector(R_NB * place.v),
        rate: None,
        slopes: MeasurementJacobian {
            joints: joints(place, list, |j| (R_NB * j.v, R_NB * j.shift)),
            ..MeasurementJacobian::new([&turned, &Matrix3::zeros()], [R_NB, &by_rate])
        },
    }
}
