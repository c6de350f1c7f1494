//! Error codes of this method: code, meaning, usual cause, remedy.

use crate::Explained;

pub(super) const CODES: &[Explained] = &[
    (
        "E0531",
        "xu2017 does not support momentum wheels.",
        "A model with [[wheel]].",
        "Take a wheel that stands still out, or use --method auto.",
    ),
    (
        "E0532",
        "xu2017 takes a body as known, as unknown, or with known mass and mass centre.",
        "estimate = [\"mass\"] on one body.",
        "Write estimate = true or [\"inertia\"], or use --method auto.",
    ),
    (
        "E0533",
        "xu2017: nothing sets the scale of the momentum equations.",
        "No thrust with the joints locked, and nothing known.",
        "Add a segment with thrust, or give the base.",
    ),
    (
        "E0534",
        "xu2017 needs the velocity of the base.",
        "No channels v_x v_y v_z.",
        "Add them, or use --method auto.",
    ),
    (
        "E0535",
        "xu2017 unlocks one joint at a time.",
        "Joints that move together.",
        "Split the motion into segments, or use --method auto.",
    ),
    (
        "E0536",
        "xu2017 assumes that momentum is conserved while a joint moves, and a thruster fires.",
        "A firing in a segment with joint motion.",
        "Cut it out, or use --method auto.",
    ),
    (
        "E0537",
        "xu2017 needs one configuration of the locked joints in all segments.",
        "A joint that was left elsewhere.",
        "Bring the joint back, or use --method auto.",
    ),
    (
        "E0538",
        "xu2017, variant swarm, must start at rest.",
        "The vehicle drifts or turns at the first sample.",
        "Use --variant linear, which takes the momentum as unknown.",
    ),
    (
        "E0539",
        "xu2017 has nothing to work on.",
        "No segment has thrust with the joints locked, and in none does a joint move.",
        "Fire thrusters or drive a joint.",
    ),
    (
        "E0540",
        "xu2017: the equations hold a number that is not finite.",
        "Magnitudes near the limits of double precision.",
        "Check units and magnitudes.",
    ),
];
