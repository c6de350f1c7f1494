//! Velocity of a point in N; the difference of two is a velocity increment.

use super::{Seen, Slopes, joints, times_skew};
use crate::motion::Place;
use crate::problem::segment::SensorValue;
use poinsot_spatial::Matrix3;

/// `v_NP_N = R_NB (v + w x r)`.
pub(super) fn see(place: &Place, R_NB: &Matrix3) -> Seen {
    let turned = -times_skew(R_NB, &place.v);
    let by_rate = -times_skew(R_NB, &place.r);
    Seen {
        value: SensorValue::Vector(R_NB * place.v),
        rate: None,
        slopes: Slopes {
            joints: joints(place, |j| (R_NB * j.v, R_NB * j.shift)),
            ..Slopes::new([&turned, &Matrix3::zeros()], [R_NB, &by_rate])
        },
    }
}
