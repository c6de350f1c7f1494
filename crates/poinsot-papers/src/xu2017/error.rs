//! Errors of this method, each with what to do.

use poinsot_files::{Faults, Place, rounded};

/// E0531: the model has wheels.
pub fn wheel(wheel: &str) -> Faults {
    Faults::one(
        "E0531",
        Place::item("wheel", wheel),
        "xu2017 knows no momentum wheels",
        "take it out of the model if it stands still, or use --method auto",
    )
}

/// E0532: a body partly known, other than mass and mass centre together.
pub fn partly_known(body: &str) -> Faults {
    Faults::one(
        "E0532",
        Place::item("body", body),
        "estimate: xu2017 takes a body as known, as unknown (estimate = true), or with known mass and mass centre (estimate = [\"inertia\"])",
        "change it, or use --method auto",
    )
}

/// E0533: neither thrust nor a known body sets the scale.
pub fn no_scale() -> Faults {
    Faults::one(
        "E0533",
        Place::default(),
        "no thruster fires with the joints locked, and no body fixes the scale of the momentum equations (35)",
        "add a segment with thrust, take estimate out of the base or the arm, or use --method auto",
    )
}

/// E0534: no velocity.
pub fn no_velocity(label: &str, what: &str) -> Faults {
    Faults::one(
        "E0534",
        Place::item("segment", label),
        format!("no velocity channel (v_x v_y v_z): xu2017 needs it for {what}"),
        "add it, or use --method auto",
    )
}

/// E0535: several joints move and several bodies are unknown.
pub fn joints_together(label: &str, joints: &str) -> Faults {
    Faults::one(
        "E0535",
        Place::item("segment", label),
        format!(
            "joints {joints} move together: xu2017 unlocks one joint at a time unless a single body is unknown"
        ),
        "split the motion, or use --method auto",
    )
}

/// E0536: thrust while a joint moves.
pub fn thrust_in_motion(label: &str, joint: &str) -> Faults {
    Faults::one(
        "E0536",
        Place::item("segment", label),
        format!(
            "a thruster fires while joint '{joint}' moves: xu2017 takes momentum as conserved then"
        ),
        "cut the firing out, or use --method auto",
    )
}

/// E0537: a joint is locked in another configuration.
pub fn other_configuration(label: &str, joint: &str, found: f64, expected: f64) -> Faults {
    Faults::one(
        "E0537",
        Place::item("segment", label),
        format!(
            "joint '{joint}' is locked at {}, elsewhere at {} (rad or m): (43)-(46) need one normal configuration in all segments",
            rounded(found, 6),
            rounded(expected, 6)
        ),
        "bring the joint back, or use --method auto",
    )
}

/// E0538: the swarm's objective assumes zero momentum.
pub fn not_at_rest(label: &str, rate: f64, speed: f64, variant: &str) -> Faults {
    Faults::one(
        "E0538",
        Place::item("segment", label),
        format!(
            "the vehicle moves at {} rad/s and {} m/s at the first sample: the objective (52) assumes zero momentum, so variant {variant} must start at rest",
            rounded(rate, 2),
            rounded(speed, 2)
        ),
        "use --variant linear, which takes the momentum as unknown",
    )
}

/// E0539: no usable segment.
pub fn nothing_moves() -> Faults {
    Faults::one(
        "E0539",
        Place::default(),
        "no segment has thrust with the joints locked, and in none does a joint move: xu2017 has nothing to work on",
        "fire thrusters or drive a joint, or use --method auto",
    )
}

/// E0540: numbers overflow.
pub fn not_finite() -> Faults {
    Faults::one(
        "E0540",
        Place::default(),
        "the equations hold a number that is not finite",
        "check units and magnitudes of the telemetry",
    )
}
