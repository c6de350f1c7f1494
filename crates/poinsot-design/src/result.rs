//! Result of a design.

use crate::mover::Command;
use poinsot::case::Want;
use poinsot_dynamics::Firing;
use poinsot_formats::{
    AgainstDurationFile, DesignVerificationFile, LimitUseFile, RelaxedFile, ShorterFile,
};
use poinsot_model::Model;

/// One wanted number and its predicted sigma.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Wanted number.
    pub want: Want,
    /// Predicted sigma; `None` if the manoeuvre does not determine the number.
    pub sigma: Option<f64>,
    /// Predicted sigma of the manoeuvre in the case itself, if it has one.
    pub reference: Option<f64>,
}

impl Reach {
    /// Sigma over wanted sigma.
    pub fn ratio(&self) -> f64 {
        self.sigma.map_or(f64::INFINITY, |s| s / self.want.sigma)
    }
}

/// A designed manoeuvre with its results.
#[derive(Debug, Clone)]
pub struct Designed {
    /// The vehicle.
    pub model: Model,
    /// Path of the case.
    pub case: String,
    /// Case file that flies the manoeuvre, with its model in `model.toml` beside it.
    pub manoeuvre: String,
    /// Command of every mover, with its name.
    pub commands: Vec<(String, Command)>,
    /// Designed firings, with the name of the thruster.
    pub firings: Vec<(String, Firing)>,
    /// Duration of the manoeuvre, s.
    pub duration_s: f64,
    /// Name of the objective.
    pub objective: &'static str,
    /// How far shorter manoeuvres were searched, where the shortest one is asked.
    pub shorter: Option<ShorterFile>,
    /// Wanted numbers with their predicted sigmas.
    pub wants: Vec<Reach>,
    /// Use of every limit.
    pub limits: Vec<LimitUseFile>,
    /// Effect of relaxed limits, if a wanted sigma is not reached.
    pub relaxed: Vec<RelaxedFile>,
    /// The front of one kind of limit; empty if not requested.
    pub front: Vec<RelaxedFile>,
    /// Sigmas of the wanted numbers for shorter records.
    pub against_duration: Option<AgainstDurationFile>,
    /// Number of manoeuvres evaluated.
    pub evaluations: usize,
    /// Logarithm of the largest ratio for every start and hop.
    pub starts: Vec<f64>,
    /// Whether the predicted improvement of the last step was below the tolerance.
    pub settled: bool,
    /// Objective of a robust design.
    pub robust: Option<Robust>,
    /// Trial flights, if requested.
    pub verification: Option<DesignVerificationFile>,
}

/// Conditional value at risk of the logarithm of the largest ratio over vehicles of the prior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robust {
    /// Over the vehicles of the search.
    pub searched: f64,
    /// Over a thousand others; `None` if one of them cannot fly the manoeuvre.
    pub others: Option<f64>,
    /// Over the same thousand with the best manoeuvre for the nominal vehicle.
    pub nominal: Option<f64>,
}

impl Designed {
    /// The thrusters whose firings were designed.
    pub fn thrusters(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.firings.iter().map(|f| f.1.thruster).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Largest ratio of sigma to wanted sigma.
    pub fn worst_ratio(&self) -> f64 {
        self.wants.iter().map(Reach::ratio).fold(0.0, f64::max)
    }

    /// Whether every wanted sigma is reached and no limit is exceeded.
    pub fn is_reached(&self) -> bool {
        self.worst_ratio() <= 1.0 + ROUNDED && self.broken().next().is_none()
    }

    /// Exceeded limits.
    pub fn broken(&self) -> impl Iterator<Item = &LimitUseFile> {
        self.limits.iter().filter(|l| l.margin < -ROUNDED)
    }

    /// Whether the shortest manoeuvre is asked, and the search was stopped before any shorter one was tried.
    pub fn is_unshortened(&self) -> bool {
        self.shorter
            .is_some_and(|s| s.stopped && s.missed_s.is_none())
    }

    /// Whether every wanted sigma is reached, by the shortest manoeuvre where that is asked, and the trial flights agree.
    pub fn passes(&self) -> bool {
        let agrees = self.verification.as_ref().is_none_or(|v| v.agrees);
        self.is_reached() && !self.is_unshortened() && agrees
    }
}

/// Relative change allowed for the loose integration of the search.
const ROUNDED: f64 = 1.0e-4;
