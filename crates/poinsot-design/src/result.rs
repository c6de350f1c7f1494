//! Result of a design.

use crate::mover::Command;
use crate::reliability::ALLOWED;
use poinsot_dynamics::Firing;
use poinsot_formats::{DesignFile, LimitUseFile};
use poinsot_model::Model;

/// Verdict of a design that reaches every wanted sigma within all limits.
pub(crate) const REACHED: &str = "reached";

/// A designed manoeuvre with its results.
#[derive(Debug, Clone)]
pub struct Designed {
    /// The answer, as `design.json` has it.
    pub file: DesignFile,
    /// The vehicle.
    pub model: Model,
    /// Case file that flies the manoeuvre, with its model in `model.toml` beside it.
    pub manoeuvre: String,
    /// Command of every mover, with its name.
    pub commands: Vec<(String, Command)>,
    /// Designed firings, with the name of the thruster.
    pub firings: Vec<(String, Firing)>,
}

impl Designed {
    /// The thrusters whose firings were designed.
    pub fn thrusters(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.firings.iter().map(|f| f.1.thruster).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether every wanted sigma is reached within all limits, by the shortest manoeuvre where that is asked, and the
    /// trial flights agree.
    pub fn passes(&self) -> bool {
        let agrees = self.file.verification.as_ref().is_none_or(|v| v.agrees);
        self.file.verdict == REACHED && agrees
    }
}

/// What a manoeuvre uses of the limits.
#[derive(Debug, Clone)]
pub(crate) struct Uses {
    /// Every limit.
    pub limits: Vec<LimitUseFile>,
    /// Share of the vehicles of the prior that exceed some limit; `None` without a prior or such a limit.
    pub share_beyond: Option<f64>,
}

impl Uses {
    /// Whether every limit holds, up to `slack`.
    pub fn hold(&self, slack: f64) -> bool {
        let allowed = self.share_beyond.is_none_or(|share| share <= ALLOWED);
        allowed && self.limits.iter().all(|u| u.margin >= -slack)
    }
}
