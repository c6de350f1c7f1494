//! Pose of a body seen from another body: a camera on a servicer that sees the captured target.
//!
//! No motion of the base changes it, so that it determines joints, not the base.

use super::{IdealMeasurement, JointSlope, MeasurementJacobian};
use crate::motion::{JointEffect, PointKinematics};
use crate::problem::segment::SensorValue;
use nalgebra::{Rotation3, UnitQuaternion};
use poinsot_spatial::Vector3;

/// `R_BrBs` of body s seen from body r. Its changes are small turns in the axes of s.
pub(super) fn attitude(
    seen: &PointKinematics,
    from: &PointKinematics,
    list: Vec<JointSlope>,
) -> IdealMeasurement {
    let to_seen = seen.R.transpose();
    let R_BrBs = Rotation3::from_matrix_unchecked(from.R.transpose() * seen.R);
    IdealMeasurement {
        value: SensorValue::Attitude(UnitQuaternion::from_rotation_matrix(&R_BrBs)),
        rate: Some(to_seen * (seen.w - from.w)),
        slopes: of_joints(
            (seen, from),
            list,
            |joint| to_seen * joint.turn,
            |joint| -(to_seen * joint.turn),
        ),
    }
}

/// `p_BrS_Br = R_BBr^T (p_BoS_B - p_BoBr_B)` of a point S seen from the origin of body r.
pub(super) fn position(
    seen: &PointKinematics,
    from: &PointKinematics,
    list: Vec<JointSlope>,
) -> IdealMeasurement {
    let to_from = from.R.transpose();
    let apart = seen.r - from.r;
    IdealMeasurement {
        value: SensorValue::Vector(to_from * apart),
        rate: Some(to_from * (seen.v - from.v - from.w.cross(&apart))),
        slopes: of_joints(
            (seen, from),
            list,
            |joint| to_from * joint.shift,
            |joint| -(to_from * (joint.shift + joint.turn.cross(&apart))),
        ),
    }
}

/// Slopes over the joints that carry one of the two bodies; a joint that carries both changes nothing.
fn of_joints(
    (seen, from): (&PointKinematics, &PointKinematics),
    mut list: Vec<JointSlope>,
    of_seen: impl Fn(&JointEffect) -> Vector3,
    of_from: impl Fn(&JointEffect) -> Vector3,
) -> MeasurementJacobian {
    let alone = |joint: &&JointEffect, other: &PointKinematics| {
        let found = other.joints.binary_search_by_key(&joint.joint, |j| j.joint);
        found.is_err()
    };
    let slope = |joint: &JointEffect, position| (joint.joint, position, Vector3::zeros());
    let own = seen.joints.iter().filter(|joint| alone(joint, from));
    list.extend(own.map(|joint| slope(joint, of_seen(joint))));
    let own = from.joints.iter().filter(|joint| alone(joint, seen));
    list.extend(own.map(|joint| slope(joint, of_from(joint))));
    list.sort_unstable_by_key(|slope| slope.0);
    MeasurementJacobian {
        joints: list,
        ..MeasurementJacobian::default()
    }
}
