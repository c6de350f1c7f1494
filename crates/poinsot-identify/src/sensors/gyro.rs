//! Gyro: the angular velocity of its body, in the body's axes.

use super::{Seen, Slopes, joints};
use crate::motion::Place;
use crate::problem::segment::SensorValue;
use poinsot_spatial::Matrix3;

/// `w_i = R^T w`; a joint turns the axes, and what moves beyond it.
pub(super) fn see(place: &Place) -> Seen {
    let to_body = place.R.transpose();
    let zero = Matrix3::zeros();
    Seen {
        value: SensorValue::Vector(to_body * place.w),
        rate: None,
        slopes: Slopes {
            joints: joints(place, |j| {
                (to_body * (j.w - j.turn.cross(&place.w)), to_body * j.turn)
            }),
            ..Slopes::new([&zero, &zero], [&zero, &to_body])
        },
    }
}
