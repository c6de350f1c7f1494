//! Errors of this method, each with what to do.

use poinsot_files::{Faults, Place};

/// E0420: arrays of different lengths.
pub fn lengths() -> Faults {
    Faults::one(
        "E0420",
        Place::default().key("kim2010"),
        "attitude, rates and wheel momentum have different numbers of samples",
        "give one of each per time",
    )
}

/// E0421: fewer than three samples.
pub fn too_few() -> Faults {
    Faults::one(
        "E0421",
        Place::default().key("kim2010"),
        "fewer than three samples",
        "give a longer record",
    )
}

/// E0422: no rotation about an axis: (14) divides by zero.
pub fn no_rotation(axis: char) -> Faults {
    Faults::one(
        "E0422",
        Place::default().key("kim2010"),
        format!(
            "the body never turns about its {axis} axis, and (14) divides by the rate about it"
        ),
        "use a manoeuvre that turns about all three axes",
    )
}

/// E0423: wheel momentum never changes: z = 0 in (2).
pub fn no_wheel_motion() -> Faults {
    Faults::one(
        "E0423",
        Place::default().key("kim2010"),
        "the wheel momentum never changes: Q = 0 (8), and the scale of the inertia is undetermined",
        "check the wheel columns",
    )
}

/// E0424: values that are not finite.
pub fn not_finite() -> Faults {
    Faults::one(
        "E0424",
        Place::default().key("kim2010"),
        "the telemetry holds numbers that are not finite or overflow",
        "check units and magnitudes",
    )
}

/// E0425: unsuitable vehicle or experiment.
pub fn unsuited(obstacle: &str, advice: &str) -> Faults {
    let problem =
        format!("kim2010 is for one rigid body with wheels and no external torque: {obstacle}");
    Faults::one("E0425", Place::default(), problem, advice)
}
