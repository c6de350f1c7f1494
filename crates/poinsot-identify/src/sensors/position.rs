//! Position of a point in N, from the place of the base origin at the first sample.

use super::{Seen, Slopes, joints, times_skew};
use crate::motion::{Place, State};
use crate::problem::segment::SensorValue;
use poinsot_spatial::{Matrix3, Vector3};

/// `p_NoP_N = p_NoBo_N + R_NB r`.
pub(super) fn see(place: &Place, state: &State, R_NB: &Matrix3) -> Seen {
    let turned = -times_skew(R_NB, &place.r);
    let (one, zero) = (Matrix3::identity(), Matrix3::zeros());
    Seen {
        value: SensorValue::Vector(state.p_NoBo_N + R_NB * place.r),
        rate: Some(R_NB * place.v),
        slopes: Slopes {
            joints: joints(place, |j| (R_NB * j.shift, Vector3::zeros())),
            ..Slopes::new([&turned, &one], [&zero, &zero])
        },
    }
}
