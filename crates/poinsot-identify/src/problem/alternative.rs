//! What is assumed of inputs between their samples: the alternatives that a fit compares.

/// What wheels do between their samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum BetweenSamples {
    /// The torque is constant.
    #[default]
    Held,
    /// The speed is smooth.
    Smooth,
    /// The torque changes at random, by as much as the samples tell.
    RandomTorque,
}

impl BetweenSamples {
    /// As an assumption of an answer.
    pub fn words(self) -> &'static str {
        match self {
            Self::Held => "wheel torque constant between samples (zero-order hold)",
            Self::Smooth => "wheel speed smooth between samples",
            Self::RandomTorque => "wheel torque changes at random, also between samples",
        }
    }
}
