//! What is assumed of inputs between their samples: the alternatives that a fit compares.

/// What wheels do between their samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BetweenSamples {
    /// The torque is constant.
    Held,
    /// The speed is smooth.
    Smooth,
    /// The torque changes at random, by as much as the samples tell.
    RandomTorque,
}

/// One set of assumptions about the inputs between their samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Alternative {
    pub wheels: BetweenSamples,
    /// Share of a rounding step by which a joint at rest moves while its reading stays.
    pub rest_motion: f64,
}

impl Default for Alternative {
    /// Constant torque; nothing moves further than a step unseen.
    fn default() -> Self {
        Self {
            wheels: BetweenSamples::Held,
            rest_motion: 1.0,
        }
    }
}

impl Alternative {
    /// The same with another motion of the wheels.
    pub fn with(self, wheels: BetweenSamples) -> Self {
        Self { wheels, ..self }
    }

    /// Whether wheel speeds are smooth between samples.
    pub fn is_smooth(self) -> bool {
        self.wheels == BetweenSamples::Smooth
    }
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
