//! Result of a design.

use crate::mover::Command;
use poinsot::case::Want;
use poinsot::trials::Band;
use poinsot_dynamics::Firing;
use poinsot_formats::AgainstDurationFile;
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

/// Use of one limit.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitUse {
    /// Limited quantity.
    pub what: String,
    /// Unit.
    pub unit: &'static str,
    /// Value that comes closest to the limit.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// Margin relative to the limit; negative if the limit is exceeded.
    pub margin: f64,
}

/// Margin below which a limit counts as active.
pub const ACTIVE: f64 = 0.01;

impl LimitUse {
    /// Whether the limit is active.
    pub fn is_active(&self) -> bool {
        self.margin < ACTIVE
    }
}

/// Effect of one relaxed limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// Kind of limit.
    pub what: String,
    /// Factor on the limit.
    pub factor: f64,
    /// Largest ratio with it.
    pub ratio: f64,
}

/// One wanted number over all trial flights.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifiedNumber {
    /// Name of the wanted number.
    pub name: String,
    /// RMS of the error over the sigma predicted for that flight.
    pub rms_ratio: f64,
    /// 99.9 % band of that RMS.
    pub band: Band,
    /// Number of flights that determined it.
    pub flights: u64,
}

/// Result of the trial flights.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Number of flights.
    pub flights: u64,
    /// Flights that did not determine all wanted numbers, with the reason.
    pub failed: Vec<String>,
    /// In the order of the wanted numbers.
    pub numbers: Vec<VerifiedNumber>,
    /// Number of flights that exceeded a limit.
    pub limits_broken: u64,
}

impl Verification {
    /// Whether every ratio lies in its band, no flight failed, and at most 1 % exceeded a limit.
    pub fn agrees(&self) -> bool {
        let held = self.numbers.iter().all(|n| n.band.holds(n.rms_ratio));
        // Margins cover 99 % of the prior.
        held && self.failed.is_empty() && 100 * self.limits_broken <= self.flights
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
    pub shorter: Option<Shorter>,
    /// Wanted numbers with their predicted sigmas.
    pub wants: Vec<Reach>,
    /// Use of every limit.
    pub limits: Vec<LimitUse>,
    /// Effect of relaxed limits, if a wanted sigma is not reached.
    pub relaxed: Vec<Relaxed>,
    /// The front of one kind of limit; empty if not requested.
    pub front: Vec<Relaxed>,
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
    pub verification: Option<Verification>,
}

/// The search for shorter manoeuvres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shorter {
    /// Longest duration of the manoeuvre, s, at which a search did not reach every wanted sigma; `None` if none was searched.
    pub missed_s: Option<f64>,
    /// Whether the search was stopped before its end.
    pub stopped: bool,
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
    pub fn broken(&self) -> impl Iterator<Item = &LimitUse> {
        self.limits.iter().filter(|l| l.margin < -ROUNDED)
    }

    /// Whether the shortest manoeuvre is asked, and the search was stopped before any shorter one was tried.
    pub fn is_unshortened(&self) -> bool {
        self.shorter
            .is_some_and(|s| s.stopped && s.missed_s.is_none())
    }

    /// Whether every wanted sigma is reached, by the shortest manoeuvre where that is asked, and the trial flights agree.
    pub fn passes(&self) -> bool {
        let agrees = self.verification.as_ref().is_none_or(Verification::agrees);
        self.is_reached() && !self.is_unshortened() && agrees
    }
}

/// Relative change allowed for the loose integration of the search.
const ROUNDED: f64 = 1.0e-4;
