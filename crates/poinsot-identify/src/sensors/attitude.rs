//! Attitude of a body in N: a star tracker. Its changes are small turns in the body's axes.

use super::{IdealMeasurement, JointSlope, MeasurementJacobian, joints};
use crate::motion::{PointKinematics, State};
use crate::problem::segment::SensorValue;
use nalgebra::{Rotation3, UnitQuaternion};
use poinsot_spatial::{Matrix3, Vector3};

pub(super) fn measure(
    place: &PointKinematics,
    state: &State,
    body: usize,
    list: Vec<JointSlope>,
) -> IdealMeasurement {
    let to_body = place.R.transpose();
    let R_NBi = match body {
        0 => state.R_NB,
        _ => {
            let turn = Rotation3::from_matrix_unchecked(place.R);
            state.R_NB * UnitQuaternion::from_rotation_matrix(&turn)
        }
    };
    let zero = Matrix3::zeros();
    IdealMeasurement {
        value: SensorValue::Attitude(R_NBi),
        rate: Some(to_body * place.w),
        slopes: MeasurementJacobian {
            joints: joints(place, list, |j| (to_body * j.turn, Vector3::zeros())),
            ..MeasurementJacobian::new([&to_body, &zero], [&zero, &zero])
        },
    }
}
