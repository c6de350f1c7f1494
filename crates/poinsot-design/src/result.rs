//! What a design gives.

use crate::mover::Command;
use poinsot::case::Want;
use poinsot::predict::Ended;
use poinsot::trials::Band;
use poinsot_dynamics::Firing;
use poinsot_model::Model;

/// One wanted number and what the manoeuvre gives of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// What is wanted.
    pub want: Want,
    /// Predicted sigma; `None` where the manoeuvre does not show the number.
    pub sigma: Option<f64>,
    /// Predicted sigma of the manoeuvre that the case itself holds, where it holds one.
    pub reference: Option<f64>,
}

impl Reach {
    /// Sigma over wanted sigma.
    pub fn ratio(&self) -> f64 {
        self.sigma.map_or(f64::INFINITY, |s| s / self.want.sigma)
    }
}

/// How far one limit is used.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitUse {
    /// What is limited.
    pub what: String,
    /// Unit.
    pub unit: &'static str,
    /// Value that comes closest to the limit.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// Room as a share of the limit; negative where it is broken.
    pub margin: f64,
}

/// Room below which a limit counts as active.
pub const ACTIVE: f64 = 0.01;

impl LimitUse {
    /// Whether the limit holds the manoeuvre back.
    pub fn is_active(&self) -> bool {
        self.margin < ACTIVE
    }
}

/// What one limit relaxed would give.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// Which limits.
    pub what: String,
    /// Factor on the limit.
    pub factor: f64,
    /// Largest ratio then.
    pub ratio: f64,
}

/// One wanted number over all flights.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifiedNumber {
    /// What is wanted.
    pub name: String,
    /// Root mean square of error over the predicted sigma of that flight.
    pub rms_ratio: f64,
    /// Its 99.9 % band.
    pub band: Band,
    /// Flights that determined it.
    pub flights: u64,
}

/// What trial flights show.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Flights.
    pub flights: u64,
    /// Flights without an answer to everything that is wanted, and why.
    pub failed: Vec<String>,
    /// In the order of what is wanted.
    pub numbers: Vec<VerifiedNumber>,
    /// Flights in which a limit was broken.
    pub limits_broken: u64,
}

impl Verification {
    /// Whether every ratio lies in its band, no flight failed, and at most one in a hundred broke a limit.
    pub fn agrees(&self) -> bool {
        let held = self.numbers.iter().all(|n| n.band.holds(n.rms_ratio));
        // Margins are for 99 % of the prior.
        held && self.failed.is_empty() && 100 * self.limits_broken <= self.flights
    }
}

/// The manoeuvre with what it gives.
#[derive(Debug, Clone)]
pub struct Designed {
    /// The vehicle.
    pub model: Model,
    /// Path of the case.
    pub case: String,
    /// The case as a file that flies the manoeuvre, with its model at `model.toml` beside it.
    pub manoeuvre: String,
    /// Name of every mover with its command.
    pub commands: Vec<(String, Command)>,
    /// Name of the thruster of every designed firing, with the firing.
    pub firings: Vec<(String, Firing)>,
    /// Duration of the manoeuvre, s.
    pub duration_s: f64,
    /// Word for what was minimised.
    pub objective: &'static str,
    /// What is wanted.
    pub wants: Vec<Reach>,
    /// How far every limit is used.
    pub limits: Vec<LimitUse>,
    /// What relaxed limits would give, where something is not reached.
    pub relaxed: Vec<Relaxed>,
    /// What one kind of limit, tighter and looser, would give; empty where nobody asked.
    pub front: Vec<Relaxed>,
    /// Sigmas of what is wanted with the record ended earlier.
    pub against_duration: Vec<Ended>,
    /// Evaluations of manoeuvres.
    pub evaluations: usize,
    /// Logarithm of the largest ratio at the end of every start.
    pub starts: Vec<f64>,
    /// Whether no step of the search promised more than its tolerance.
    pub settled: bool,
    /// Conditional value at risk of the logarithm of the largest ratio, of a robust design.
    pub robust: Option<f64>,
    /// Trial flights, where they were asked for.
    pub verification: Option<Verification>,
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

    /// Whether every wanted sigma is reached and no limit is broken.
    pub fn is_reached(&self) -> bool {
        self.worst_ratio() <= 1.0 + ROUNDED && self.broken().next().is_none()
    }

    /// Limits that are broken.
    pub fn broken(&self) -> impl Iterator<Item = &LimitUse> {
        self.limits.iter().filter(|l| l.margin < -ROUNDED)
    }

    /// Whether everything wanted is reached and trial flights agree.
    pub fn passes(&self) -> bool {
        let agrees = self.verification.as_ref().is_none_or(Verification::agrees);
        self.is_reached() && agrees
    }
}

/// What the loose integration of the search may change.
const ROUNDED: f64 = 1.0e-4;
