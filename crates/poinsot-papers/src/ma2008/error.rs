//! Errors of this method, each one line with its remedy.

/// Why the method cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Ma2008Error {
    /// Unknown arm.
    #[error(
        "E0521 body '{body}': estimate: ma2008 needs every body but the base known; take estimate out of it, or use --method auto"
    )]
    UnknownArm {
        /// Body.
        body: String,
    },
    /// Base partly known.
    #[error(
        "E0522 body '{body}': estimate: ma2008 identifies mass, mass centre and inertia of the base together; write estimate = true, or use --method auto"
    )]
    BasePartlyKnown {
        /// Body.
        body: String,
    },
    /// No arm.
    #[error(
        "E0523 model: the bodies beyond the base '{base}' have no mass: ma2008 needs an arm of known mass; describe it, or use --method auto"
    )]
    NoArm {
        /// Base.
        base: String,
    },
    /// No part of the momentum known.
    #[error(
        "E0524 [momentum] linear_N_s and angular_N_m_s are both \"estimate\": variant known-momentum needs one of them or both in N (N s; N m s about the system mass centre at the first sample); give it, or use --variant unknown-momentum"
    )]
    MomentumUnknown,
    /// No velocity.
    #[error(
        "E0525 segment '{label}': no velocity channel (v_x v_y v_z): ma2008 needs it for step 1; add it, or velocity increments (dv_x dv_y dv_z) for variant unknown-momentum, or use --method maximum_likelihood"
    )]
    NoVelocity {
        /// Segment.
        label: String,
    },
    /// Thrust.
    #[error(
        "E0526 segment '{label}': a thruster fires: ma2008 assumes that momentum is conserved; cut the firing out, or use --method auto"
    )]
    Thrust {
        /// Segment.
        label: String,
    },
    /// A wheel of unknown spin inertia.
    #[error(
        "E0527 wheel '{wheel}': estimate: ma2008 needs its spin inertia known; take estimate out of it, or use --method auto"
    )]
    UnknownWheel {
        /// Wheel.
        wheel: String,
    },
    /// Too few samples.
    #[error(
        "E0528 segment '{label}': {samples} samples: variant {variant} needs at least {needed} for four unknowns; add samples at other arm configurations"
    )]
    TooFewSamples {
        /// Segment.
        label: String,
        /// Samples found.
        samples: usize,
        /// Samples needed.
        needed: usize,
        /// Variant.
        variant: &'static str,
    },
    /// Numbers overflow.
    #[error(
        "E0529 the equations hold a number that is not finite; check units and magnitudes of the telemetry"
    )]
    NotFinite,
}
