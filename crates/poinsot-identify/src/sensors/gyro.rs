//! Gyro: the angular velocity of its body, in the body's axes.

use super::{IdealMeasurement, JointSlope, MeasurementJacobian, joints};
use crate::motion::PointKinematics;
use crate::problem::segment::SensorValue;
use poinsot_spatial::Matrix3;

/// `w_i = R^T w`; a joint rotates the axes and all outboard bodies.
pub(super) fn measure(place: &PointKinematics, list: Vec<JointSlope>) -> IdealMeasurement {
    let to_body = place.R.transpose();
    let zero = Matrix3::zeros();
    IdealMeasurement {
        value: SensorValue::Vector(to_body * place.w),
        rate: None,
        slopes: MeasurementJacobian {
            joints: joints(place, list, |j| {
                (to_body * (j.w - j.turn.cross(&place.w)), to_body * j.turn)
            }),
            ..MeasurementJacobian::new([&zero, &zero], [&zero, &to_body])
        },
    }
}
