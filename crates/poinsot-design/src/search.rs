//! Multistart search: many random manoeuvres, a few steps each, then all steps for the best.

use crate::shape::Space;
use crate::trial::{Program, Question};
use poinsot_solve::{Minimax, MinimaxOptions, MinimaxSearch, Reached, Values, minimax};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Random manoeuvres for each start of the search.
const RANDOM: usize = 24;
/// Steps before the worse half of the starts is dropped.
const FIRST_STEPS: usize = 4;
/// Steps of the last remaining start.
const LAST_STEPS: usize = 60;
/// Fraction of the limits that random manoeuvres use.
const STRETCH: f64 = 0.97;
/// The search stops when a step lowers the logarithm of the ratio by less (0.1 %).
const TOLERANCE: f64 = 1.0e-3;
/// First trust region, in free numbers.
const DELTA: f64 = 0.3;

/// The best manoeuvre of a search.
#[derive(Debug, Clone)]
pub struct Found {
    /// Free numbers and their values.
    pub reached: Reached,
    /// Objective of every start after its first steps, best first in each round.
    pub starts: Vec<f64>,
}

/// Searches the whole space from the manoeuvres `given` and random ones. Remaining evaluations go to further rounds
/// with new random manoeuvres.
pub fn search(
    question: &Question,
    space: &Space,
    given: &[Vec<f64>],
    evaluations: usize,
) -> Option<Found> {
    let program = Program { question, space };
    let mut rng = ChaCha8Rng::seed_from_u64(question.design.seed);
    let mut best: Option<Found> = None;
    let mut left = evaluations;
    let mut given = given.to_vec();
    loop {
        let Some(found) = round(&program, &mut rng, std::mem::take(&mut given), &mut left) else {
            return best;
        };
        let better = |b: &Found| found.reached.values.merit() < b.reached.values.merit();
        let mut starts = best.as_ref().map_or_else(Vec::new, |b| b.starts.clone());
        starts.extend(&found.starts);
        match &mut best {
            Some(b) if !better(b) => b.starts = starts,
            _ => best = Some(Found { starts, ..found }),
        }
        let least = question.design.starts * FIRST_STEPS * space.len();
        if left < least || program.stop() {
            return best;
        }
    }
}

/// One round: a few steps from each of the best random manoeuvres, the worse half dropped, until one is left.
fn round(
    program: &Program,
    rng: &mut ChaCha8Rng,
    given: Vec<Vec<f64>>,
    left: &mut usize,
) -> Option<Found> {
    let mut ends = begun(program, rng, given, left);
    let merit = |s: &MinimaxSearch| s.reached.values.merit();
    let mut starts = Vec::new();
    while !ends.is_empty() {
        let is_last = ends.len() == 1;
        let steps = if is_last { LAST_STEPS } else { FIRST_STEPS };
        let share = options(*left / ends.len(), steps);
        let spent: usize = ends
            .par_iter_mut()
            .map(|search| {
                let before = search.reached.evaluations;
                search.advance(program, &program.space.polytope, share);
                search.reached.evaluations - before
            })
            .sum();
        *left = left.saturating_sub(spent);
        ends.sort_by(|a, b| merit(a).total_cmp(&merit(b)));
        if starts.is_empty() {
            starts = ends.iter().map(|e| e.reached.values.worst()).collect();
        }
        if is_last {
            break;
        }
        ends.truncate(ends.len().div_ceil(2));
    }
    let reached = ends.into_iter().next()?.reached;
    Some(Found { reached, starts })
}

/// Starting points: the best of many random manoeuvres, and always those given.
fn begun(
    program: &Program,
    rng: &mut ChaCha8Rng,
    given: Vec<Vec<f64>>,
    left: &mut usize,
) -> Vec<MinimaxSearch> {
    let space = program.space;
    let wanted = program.question.design.starts;
    let mut pool = given;
    let of_case = pool.len();
    for _ in 0..(RANDOM * wanted).min(*left / 4) {
        let mut normal = || StandardNormal.sample(rng);
        let direction: Vec<f64> = (0..space.len()).map(|_| normal()).collect();
        pool.push(space.stretched(&direction, STRETCH));
    }
    *left = left.saturating_sub(pool.len());
    let values = in_parts(program, &pool);
    let evaluated = pool.into_iter().zip(values).enumerate();
    let mut all: Vec<(bool, MinimaxSearch)> = evaluated
        .filter_map(|(i, (x, values))| Some((i >= of_case, MinimaxSearch::begin(x, values?))))
        .collect();
    let merit = |s: &MinimaxSearch| s.reached.values.merit();
    all.sort_by(|a, b| a.0.cmp(&b.0).then(merit(&a.1).total_cmp(&merit(&b.1))));
    all.into_iter().map(|(_, s)| s).take(wanted).collect()
}

/// Continues from one manoeuvre in a slightly changed space.
pub fn refine(
    question: &Question,
    space: &Space,
    from: &[f64],
    evaluations: usize,
) -> Option<Reached> {
    let program = Program { question, space };
    let from = space.drawn_inside(from.to_vec());
    minimax(
        &program,
        &space.polytope,
        from,
        options(evaluations, LAST_STEPS),
    )
}

fn options(evaluations: usize, steps: usize) -> MinimaxOptions {
    MinimaxOptions {
        evaluations,
        steps,
        delta: DELTA,
        tolerance: TOLERANCE,
    }
}

/// Evaluates in chunks, so that an interruption keeps the completed ones.
fn in_parts(program: &Program, pool: &[Vec<f64>]) -> Vec<Option<Values>> {
    pool.chunks(16)
        .flat_map(|part| program.values(part))
        .collect()
}
