//! Error codes of this method: code, meaning, usual cause, remedy.

use crate::Explained;

pub(super) const CODES: &[Explained] = &[
    (
        "E0420",
        "kim2010: attitude, rates and wheel momentum have different numbers of samples.",
        "Series given by a program.",
        "Give one of each per time.",
    ),
    (
        "E0421",
        "kim2010 needs at least three samples.",
        "A record that was cut.",
        "Give more samples.",
    ),
    (
        "E0422",
        "kim2010: the body never turns about one of its axes.",
        "The method divides by the rate about each axis (14).",
        "Use a manoeuvre that turns about all three axes, or another method.",
    ),
    (
        "E0423",
        "kim2010: the momentum of the wheels never changes.",
        "The scale of the inertia is then undetermined.",
        "Check the wheel columns.",
    ),
    (
        "E0424",
        "kim2010: the telemetry holds numbers that are not finite or overflow.",
        "Magnitudes near the limits of double precision.",
        "Check units.",
    ),
    (
        "E0425",
        "kim2010 is for one rigid body with wheels and no external torque.",
        "Joints, thrusters or several segments.",
        "Use --method auto.",
    ),
];
