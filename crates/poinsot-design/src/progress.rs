//! The best manoeuvre so far, told while the search runs.

use poinsot_files::counted;
use serde::Serialize;
use std::fmt;
use std::sync::Mutex;
use std::time::Instant;

/// The best manoeuvre that a search has found so far.
///
/// ```
/// use poinsot_design::BestSoFar;
///
/// let best = BestSoFar {
///     elapsed_s: 4.0,
///     evaluations: 800,
///     duration_s: 35.0,
///     worst_ratio: 0.957,
///     active_limits: vec!["body rate".to_owned()],
/// };
/// assert_eq!(best.to_string(), "largest ratio 0.957 in 35 s, limited by body rate");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestSoFar {
    /// Time since the search began, s.
    pub elapsed_s: f64,
    /// Manoeuvres evaluated so far.
    pub evaluations: usize,
    /// Duration of the manoeuvre, s.
    pub duration_s: f64,
    /// Largest ratio of predicted to wanted sigma.
    pub worst_ratio: f64,
    /// Limits of which it leaves less than 1 %.
    pub active_limits: Vec<String>,
}

impl fmt::Display for BestSoFar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let duration = poinsot_model::rounded(self.duration_s, 4);
        write!(f, "largest ratio {:.3} in {duration} s", self.worst_ratio)?;
        match &self.active_limits[..] {
            [] => Ok(()),
            [only] => write!(f, ", limited by {only}"),
            [first, others @ ..] => write!(f, ", limited by {first} and {} more", others.len()),
        }
    }
}

/// Who is told of each better manoeuvre.
pub type Told = fn(&BestSoFar);

/// The best manoeuvre so far and how it ranks; smaller is better.
pub(crate) struct Progress {
    begun: Instant,
    best: Mutex<Option<([f64; 3], BestSoFar)>>,
    told: Option<Told>,
}

impl Progress {
    pub fn new(told: Option<Told>) -> Self {
        Self {
            begun: Instant::now(),
            best: Mutex::default(),
            told,
        }
    }

    /// What was best may not be under other limits, or for other vehicles.
    pub fn forget(&self) {
        if let Ok(mut best) = self.best.lock() {
            *best = None;
        }
    }

    /// Takes a candidate with this rank, and tells of it if it is the best so far; one without a rank is not flown.
    pub fn take(
        &self,
        evaluations: usize,
        rank: Option<[f64; 3]>,
        found: impl FnOnce(f64) -> BestSoFar,
    ) {
        let Ok(mut best) = self.best.lock() else {
            return;
        };
        let is_better = |rank: &[f64; 3]| best.as_ref().is_none_or(|(known, _)| rank < known);
        if let Some(rank) = rank.filter(is_better) {
            let found = found(self.begun.elapsed().as_secs_f64());
            if let Some(told) = self.told {
                told(&found);
            }
            *best = Some((rank, found));
        }
        if tracing::event_enabled!(target: "poinsot::progress", tracing::Level::INFO) {
            let found = best.as_ref().map(|b| format!(": {}", b.1));
            tracing::info!(
                target: "poinsot::progress",
                stage = counted(evaluations, "manoeuvre") + &found.unwrap_or_default(),
            );
        }
    }
}
