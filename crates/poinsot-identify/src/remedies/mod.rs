//! Changes that resolve an unobservable direction: computed, not guessed.
//!
//! One record with another motion, thrust, momentum or sensor, or one known number, is added to the experiment. The
//! joint information is decomposed again, and a direction is resolved if it is then identified. Information needs the
//! predicted motion and the noise, but no simulated samples. Pairs are tested if no single change resolves a direction.

mod baseline;
mod records;

use crate::problem::Problem;
use crate::solution::estimate::UnobservableCombination;
use crate::solution::solved::Solution;
use baseline::Baseline;
use poinsot_solve::Spectrum;
use std::collections::BTreeMap;

/// Share of a direction's square that must be identified for it to count as resolved.
const CLOSED: f64 = 0.99;
/// Share of a direction's square below which a change has no effect on it.
const NOTHING: f64 = 0.05;
/// Changes of which pairs are tried for a direction.
const PAIRED: usize = 8;

/// A row of information: over all unknowns in the order of the parameters.
type Row = Vec<f64>;

/// Effort of a change, the smallest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Effort {
    /// A manoeuvre of the existing vehicle.
    Manoeuvre,
    /// Additional equipment.
    Equipment,
    /// A number from another source.
    Number,
}

/// One change.
struct Change {
    text: String,
    effort: Effort,
    rows: Vec<Row>,
}

/// Effect of a change.
struct Effect {
    text: String,
    effort: Effort,
    /// Per unobservable direction: the identified share and its sigma, natural units.
    seen: Vec<(f64, f64)>,
}

impl Effect {
    fn of(baseline: &Baseline, changes: &[&Change], directions: &[Vec<f64>]) -> Option<Self> {
        let rows: Vec<&Row> = changes.iter().flat_map(|c| &c.rows).collect();
        let spectrum = baseline.spectrum(&rows)?;
        let texts: Vec<&str> = changes.iter().map(|c| c.text.as_str()).collect();
        Some(Self {
            seen: directions.iter().map(|z| seen(&spectrum, z)).collect(),
            text: texts.join(", and "),
            effort: changes.iter().map(|c| c.effort).max()?,
        })
    }

    fn closed(&self) -> usize {
        self.seen
            .iter()
            .filter(|(share, _)| *share > CLOSED)
            .count()
    }

    /// The action with its gain for one direction.
    fn words(&self, k: usize) -> String {
        format!(
            "{} (then sigma {} of nominal; resolves {} of {} unobservable directions)",
            self.text,
            percent(self.seen[k].1),
            self.closed(),
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
    let can = matches!(solution.method, "maximum_likelihood" | "cramer_rao")
        && solution.data_alone.is_none()
        && solution.converged
        && !open.is_empty();
    let Some(mut tried) = can.then(|| Tried::new(problem, solution, open)).flatten() else {
        return;
    };
    for (k, direction) in open.iter_mut().enumerate() {
        if let Some(text) = tried.sentence(k) {
            direction.remedy = text;
        }
    }
}

/// Every change with its effect.
struct Tried<'a> {
    baseline: Baseline<'a>,
    directions: Vec<Vec<f64>>,
    changes: Vec<(Change, Effect)>,
    /// Effects of the pairs that were tried, by their places among the changes.
    pairs: BTreeMap<[usize; 2], Option<Effect>>,
}

impl<'a> Tried<'a> {
    fn new(
        problem: &'a Problem<'a>,
        solution: &Solution,
        open: &[UnobservableCombination],
    ) -> Option<Self> {
        let baseline = Baseline::new(problem, solution)?;
        let directions: Vec<Vec<f64>> = open.iter().map(|o| baseline.direction(o)).collect();
        let changes: Vec<(Change, Effect)> = baseline
            .changes()
            .into_iter()
            .filter_map(|change| {
                let effect = Effect::of(&baseline, &[&change], &directions)?;
                Some((change, effect))
            })
            .collect();
        (!changes.is_empty()).then_some(Self {
            baseline,
            directions,
            changes,
            pairs: BTreeMap::new(),
        })
    }

    /// The best change for one direction in words; the best pair if no single change helps.
    fn sentence(&mut self, k: usize) -> Option<String> {
        let effects = self.changes.iter().map(|c| &c.1);
        if let Some(best) = best(effects, k) {
            return Some(best.words(k));
        }
        let share = |i: usize| self.changes[i].1.seen[k].0;
        let mut most: Vec<usize> = (0..self.changes.len()).collect();
        most.sort_by(|a, b| share(*b).total_cmp(&share(*a)));
        most.truncate(PAIRED);
        let first = &self.changes[*most.first()?].1;
        let pairs = most.iter().enumerate().flat_map(|(i, a)| {
            let others = most[i + 1..].iter();
            others.map(move |b| [*a, *b])
        });
        for pair in pairs.clone() {
            // The best changes of one direction are often those of another.
            self.pairs.entry(pair).or_insert_with(|| {
                let changes = pair.map(|i| &self.changes[i].0);
                Effect::of(&self.baseline, &changes, &self.directions)
            });
        }
        let tried: Vec<&Effect> = pairs.filter_map(|p| self.pairs.get(&p)?.as_ref()).collect();
        if let Some(best) = best(tried.iter().copied(), k) {
            return Some(format!("only together: {}", best.words(k)));
        }
        let none = format!(
            "none of {} changes and {} pairs resolves it",
            self.changes.len(),
            tried.len()
        );
        Some(match first.seen[k].0 > NOTHING {
            true => format!(
                "{none}; the best is: {} ({:.0} % of it)",
                first.text,
                100.0 * first.seen[k].0
            ),
            false => none,
        })
    }
}

/// The change that resolves a direction with the least effort; then the one that resolves most, then the most accurate.
fn best<'e>(effects: impl Iterator<Item = &'e Effect>, k: usize) -> Option<&'e Effect> {
    let closing = effects.filter(|e| e.seen[k].0 > CLOSED);
    closing.min_by(|a, b| {
        (a.effort, b.closed())
            .cmp(&(b.effort, a.closed()))
            .then(a.seen[k].1.total_cmp(&b.seen[k].1))
    })
}

fn percent(sigma: f64) -> String {
    let p = 100.0 * sigma;
    let decimals = (1.0 - p.abs().max(1.0e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{p:.decimals$} %")
}

/// Share of a direction, by squares, that a spectrum identifies, and the one sigma of that part.
fn seen(spectrum: &Spectrum, z: &[f64]) -> (f64, f64) {
    let (mut share, mut variance) = (0.0, 0.0);
    for k in 0..spectrum.rank {
        let along: f64 = z
            .iter()
            .enumerate()
            .map(|(i, x)| x * spectrum.directions[(i, k)])
            .sum();
        share += along * along;
        variance += (along / spectrum.singular[k]).powi(2);
    }
    (share, variance.sqrt())
}
