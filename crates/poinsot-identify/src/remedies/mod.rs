//! Changes that resolve an unobservable direction: computed, not guessed.
//!
//! One record with another motion, thrust, momentum or sensor, or one known number, is added to the experiment. The
//! joint information is decomposed again, and a direction is resolved if it is then identified. Information needs the
//! predicted motion and the noise, but no simulated samples. For what no single change resolves, changes are added
//! one by one, each time the one that determines most, and those that turn out not to be needed are left out again.

mod baseline;
mod records;

use crate::problem::Problem;
use crate::solution::estimate::UnobservableCombination;
use crate::solution::solved::{OfLikelihood, Solution};
use baseline::Baseline;
use poinsot_files::counted;
use poinsot_solve::Spectrum;

/// Share of a direction's square that must be identified for it to count as resolved.
const CLOSED: f64 = 0.99;
/// Most changes of one remedy: a longer list is no advice.
const TOGETHER: usize = 12;
/// Accuracy of a number that is given, relative to the nominal mass, length and inertia.
const GIVEN: f64 = 1.0e-3;

/// A row of information: over all unknowns in the order of the parameters.
type Row = Vec<f64>;

/// Effort of a change, the smallest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Effort {
    /// A manoeuvre of the existing vehicle.
    Manoeuvre,
    /// A rotation in which the total momentum differs: a torque from outside, which a vehicle with wheels alone lacks.
    Turn,
    /// Additional equipment.
    Equipment,
    /// A number from another source.
    Number,
}

/// What is done.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Action {
    /// A record or a sensor, in words.
    Record(String),
    /// The mass, mass centre or inertia of a body is given.
    Number(&'static str, String),
}

/// One change.
struct Change {
    action: Action,
    effort: Effort,
    rows: Vec<Row>,
}

/// Several changes in words.
fn in_words(changes: &[&Change]) -> String {
    let mut all: Vec<String> = Vec::new();
    let mut numbers: Vec<(&str, Vec<&str>)> = Vec::new();
    for change in changes {
        match &change.action {
            Action::Record(text) => all.push(text.clone()),
            Action::Number(what, body) => match numbers.iter_mut().find(|n| n.0 == *what) {
                Some((_, bodies)) => bodies.push(body),
                None => numbers.push((what, vec![body])),
            },
        }
    }
    if !numbers.is_empty() {
        let of = |(what, bodies): &(&str, Vec<&str>)| format!("the {what} of {}", listed(bodies));
        let numbers: Vec<String> = numbers.iter().map(of).collect();
        let (numbers, sigma) = (listed(&numbers), percent(GIVEN));
        all.push(format!("fix {numbers} to a sigma of {sigma} of nominal"));
    }
    all.join(", and ")
}

/// Words with commas, the last two with "and".
fn listed<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => words.concat(),
    }
}

/// Effect of one change, or of several together.
struct Effect {
    text: String,
    effort: Effort,
    /// Number of directions that are identified in addition.
    gain: usize,
    /// Per unobservable direction: the identified share and its sigma, natural units.
    seen: Vec<(f64, f64)>,
    /// What the sigma does not count.
    beside: &'static str,
}

impl Effect {
    fn of(
        baseline: &Baseline,
        rank: usize,
        changes: &[&Change],
        directions: &[Vec<f64>],
    ) -> Option<Self> {
        let rows: Vec<&Row> = changes.iter().flat_map(|c| &c.rows).collect();
        let spectrum = baseline.spectrum(&rows)?;
        Some(Self {
            gain: spectrum.rank.saturating_sub(rank),
            seen: directions.iter().map(|z| seen(&spectrum, z)).collect(),
            text: in_words(changes),
            effort: changes.iter().map(|c| c.effort).max()?,
            beside: match baseline.problem.model.uncertain().next().is_none() {
                true => "",
                false => " beside that of known numbers",
            },
        })
    }

    fn closes(&self, k: usize) -> bool {
        self.seen[k].0 > CLOSED
    }

    /// Largest sigma of a direction that it resolves, natural units.
    fn largest_sigma(&self) -> f64 {
        let closed = self.seen.iter().filter(|(share, _)| *share > CLOSED);
        closed.map(|(_, sigma)| *sigma).fold(0.0, f64::max)
    }

    fn sigma(&self) -> String {
        let sigma = percent(self.largest_sigma());
        format!("then sigma at most {sigma} of nominal{}", self.beside)
    }

    /// The action with its gain: the same words for every direction that it resolves.
    fn words(&self) -> String {
        format!(
            "{} ({}; resolves {} of {} unobservable directions)",
            self.text,
            self.sigma(),
            self.gain,
            self.seen.len()
        )
    }
}

/// Replaces each remedy by a tested one. Unobservable directions keep theirs if none can be tested: the answer was
/// withheld, or priors determine them.
pub(crate) fn try_changes(
    problem: &Problem,
    solution: &Solution,
    open: &mut [UnobservableCombination],
) {
    let own = solution.likelihood.as_ref();
    let can = own.filter(|own| own.data_alone.is_none() && own.converged && !open.is_empty());
    let Some(mut tried) = can.and_then(|own| Tried::new(problem, (solution, own), open)) else {
        return;
    };
    for (k, direction) in open.iter_mut().enumerate() {
        // What the curvature would give, but not the profile: a change that is tried by the curvature says nothing.
        if tried.narrow[k] {
            continue;
        }
        direction.remedy = tried.sentence(k);
    }
}

/// Every change with its effect.
struct Tried<'a> {
    baseline: Baseline<'a>,
    /// Rank of the experiment as it is.
    rank: usize,
    directions: Vec<Vec<f64>>,
    /// Whether the experiment as it is resolves a direction by its curvature.
    narrow: Vec<bool>,
    changes: Vec<(Change, Effect)>,
    /// What is needed for the directions that no single change resolves, once it is known.
    together: Option<Together>,
}

impl<'a> Tried<'a> {
    fn new(
        problem: &'a Problem<'a>,
        solution: (&Solution, &OfLikelihood),
        open: &[UnobservableCombination],
    ) -> Option<Self> {
        let baseline = Baseline::new(problem, solution)?;
        let before = baseline.spectrum(&[])?;
        let rank = before.rank;
        let directions: Vec<Vec<f64>> = open.iter().map(|o| baseline.direction(o)).collect();
        let narrow = directions.iter().map(|z| seen(&before, z).0 > CLOSED);
        let narrow = narrow.collect();
        let changes: Vec<(Change, Effect)> = baseline
            .changes()
            .into_iter()
            .filter_map(|change| {
                let effect = Effect::of(&baseline, rank, &[&change], &directions)?;
                Some((change, effect))
            })
            .collect();
        (!changes.is_empty()).then_some(Self {
            baseline,
            rank,
            directions,
            narrow,
            changes,
            together: None,
        })
    }

    /// The best change for one direction in words; the fewest together if no single one resolves it.
    fn sentence(&mut self, k: usize) -> String {
        let effects = self.changes.iter().map(|c| &c.1);
        if let Some(best) = best(effects, k) {
            return best.words();
        }
        if self.together.is_none() {
            self.together = self.several();
        }
        let more = match &self.together {
            Some(together) if together.effect.closes(k) => return together.words.clone(),
            Some(together) => format!(", nor {} of them together", together.size),
            None => String::new(),
        };
        let changes = counted(self.changes.len(), "change");
        format!("none of {changes} resolves it{more}")
    }

    /// Changes added one by one, those of least effort first, of these the one that determines most; without those that
    /// the others make needless.
    fn needed(&self) -> Vec<usize> {
        let mut list: Vec<usize> = Vec::new();
        while list.len() < TOGETHER {
            let known = self.baseline.condensed(&self.rows(&list));
            let before = self.baseline.rank(&known, &[]);
            let mut next: Option<(Effort, usize, usize)> = None;
            for at in (0..self.changes.len()).filter(|at| !list.contains(at)) {
                let effort = self.changes[at].0.effort;
                if next.is_some_and(|(least, ..)| effort > least) {
                    continue;
                }
                let rank = self.baseline.rank(&known, &self.changes[at].0.rows);
                let better = next.is_none_or(|(least, most, _)| effort < least || rank > most);
                if rank > before && better {
                    next = Some((effort, rank, at));
                }
            }
            match next {
                Some((.., at)) => list.push(at),
                None => break,
            }
        }
        let most = self.gain(&list);
        // The last ones take the most effort.
        for place in (0..list.len()).rev() {
            let mut without = list.clone();
            without.remove(place);
            if self.gain(&without) == most {
                list = without;
            }
        }
        list
    }

    /// What is needed, in words: the gain of each effort stands behind its changes.
    fn several(&self) -> Option<Together> {
        let list = self.needed();
        let changes: Vec<&Change> = list.iter().map(|at| &self.changes[*at].0).collect();
        let effect = Effect::of(&self.baseline, self.rank, &changes, &self.directions)?;
        let mut parts = Vec::new();
        let (mut size, mut resolved) = (0, 0);
        for alike in changes.chunk_by(|a, b| a.effort == b.effort) {
            size += alike.len();
            let gain = self.gain(&list[..size]);
            let told = match resolved {
                0 => format!("of {} unobservable directions", self.directions.len()),
                _ => "more".to_owned(),
            };
            let sigma = match size == changes.len() {
                true => format!("; {}", effect.sigma()),
                false => String::new(),
            };
            let (text, more) = (in_words(alike), gain - resolved);
            parts.push(format!("{text} (resolves {more} {told}{sigma})"));
            resolved = gain;
        }
        Some(Together {
            words: format!("only together: {}", parts.join(", and ")),
            size,
            effect,
        })
    }

    /// Number of directions that several changes identify in addition.
    fn gain(&self, set: &[usize]) -> usize {
        let spectrum = self.baseline.spectrum(&self.rows(set));
        spectrum.map_or(0, |s| s.rank.saturating_sub(self.rank))
    }

    /// The rows of several changes.
    fn rows(&self, set: &[usize]) -> Vec<&Row> {
        let changes = set.iter().flat_map(|at| &self.changes[*at].0.rows);
        changes.collect()
    }
}

/// Several changes that determine all that can be determined.
struct Together {
    words: String,
    size: usize,
    effect: Effect,
}

/// The change that resolves a direction with the least effort; then the one that resolves most, then the most accurate in all
/// that it resolves, so that directions share a remedy where they can.
fn best<'e>(effects: impl Iterator<Item = &'e Effect>, k: usize) -> Option<&'e Effect> {
    effects.filter(|e| e.closes(k)).min_by(|a, b| {
        (a.effort, b.gain)
            .cmp(&(b.effort, a.gain))
            .then(a.largest_sigma().total_cmp(&b.largest_sigma()))
    })
}

fn percent(sigma: f64) -> String {
    let p = 100.0 * sigma;
    let decimals = (1.0 - p.abs().max(1.0e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{p:.decimals$} %")
}

/// Share of a direction, by squares, that a spectrum identifies, and the one sigma of that part.
fn seen(spectrum: &Spectrum, z: &[f64]) -> (f64, f64) {
    (spectrum.identified_share(z), spectrum.variance(z).sqrt())
}
