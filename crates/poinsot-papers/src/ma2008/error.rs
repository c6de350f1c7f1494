//! Errors of this method, each with what to do.

use poinsot_files::{Faults, Place};

/// E0521: unknown arm.
pub fn unknown_arm(body: &str) -> Faults {
    Faults::one(
        "E0521",
        Place::item("body", body),
        "estimate: ma2008 needs every body but the base known",
        "take estimate out of it, or use --method auto",
    )
}

/// E0522: base partly known.
pub fn base_partly_known(body: &str) -> Faults {
    Faults::one(
        "E0522",
        Place::item("body", body),
        "estimate: ma2008 identifies mass, mass centre and inertia of the base together",
        "write estimate = true, or use --method auto",
    )
}

/// E0523: no arm.
pub fn no_arm(base: &str) -> Faults {
    Faults::one(
        "E0523",
        Place::default().key("model"),
        format!(
            "the bodies beyond the base '{base}' have no mass: ma2008 needs an arm of known mass"
        ),
        "describe it, or use --method auto",
    )
}

/// E0524: no part of the momentum known.
pub fn momentum_unknown() -> Faults {
    Faults::one(
        "E0524",
        Place::default(),
        "[momentum] linear_N_s and angular_N_m_s are both \"estimate\": variant known-momentum needs one of them or both in N (N s; N m s about the system mass centre at the first sample)",
        "give it, or use --variant unknown-momentum",
    )
}

/// E0525: no velocity.
pub fn no_velocity(label: &str) -> Faults {
    Faults::one(
        "E0525",
        Place::item("segment", label),
        "no velocity channel (v_x v_y v_z): ma2008 needs it for step 1",
        "add it, or velocity increments (dv_x dv_y dv_z) for variant unknown-momentum, or use --method maximum_likelihood",
    )
}

/// E0526: thrust.
pub fn thrust(label: &str) -> Faults {
    Faults::one(
        "E0526",
        Place::item("segment", label),
        "a thruster fires: ma2008 assumes that momentum is conserved",
        "cut the firing out, or use --method auto",
    )
}

/// E0527: a wheel of unknown spin inertia.
pub fn unknown_wheel(wheel: &str) -> Faults {
    Faults::one(
        "E0527",
        Place::item("wheel", wheel),
        "estimate: ma2008 needs its spin inertia known",
        "take estimate out of it, or use --method auto",
    )
}

/// E0528: too few samples.
pub fn too_few_samples(label: &str, samples: usize, needed: usize, variant: &str) -> Faults {
    Faults::one(
        "E0528",
        Place::item("segment", label),
        format!("{samples} samples: variant {variant} needs at least {needed} for four unknowns"),
        "add samples at other arm configurations",
    )
}

/// E0529: numbers overflow.
pub fn not_finite() -> Faults {
    Faults::one(
        "E0529",
        Place::default(),
        "the equations hold a number that is not finite",
        "check units and magnitudes of the telemetry",
    )
}
