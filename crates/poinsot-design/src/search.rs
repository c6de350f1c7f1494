//! The search: a few steps from the best of many random manoeuvres, the worse half dropped until one is left; then hops
//! from the best one (Wales and Doye 1997, basin hopping), which keep part of what makes it good.

use crate::shape::Space;
use crate::trial::{Program, Question};
use poinsot_solve::{Minimax, MinimaxOptions, MinimaxSearch, Reached, Values};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Random manoeuvres for each start of the search.
const RANDOM: usize = 50;
/// Steps before the worse half of the starts is dropped, and before a hop is judged.
const FIRST_STEPS: usize = 6;
/// Steps of the last remaining start; more than any search has made.
const LAST_STEPS: usize = 500;
/// Lengths of hops in turn, standard deviation of each free number: a short one is soon followed to its end, a long one reaches
/// other manoeuvres.
const HOPS: [f64; 2] = [0.3, 0.8];
/// Manoeuvres tried at the end of a hop; the best is followed.
const HOP_POINTS: usize = 8;
/// The best start is followed while a step lowers the logarithm of the ratio by more, before the hops from it.
const START_TOLERANCE: f64 = 0.001;
/// A hop is followed while a step lowers the logarithm of the ratio by more (1 %).
const HOP_TOLERANCE: f64 = 0.01;
/// A hop is dropped that after its first steps is worse than the best by more, and by half of it after twice as many.
const HOPELESS: f64 = 0.3;
/// Evaluations for each free number that are kept for the last steps, and the largest share of all.
const LAST_EACH: usize = 8;
const LAST_SHARE: usize = 8;
/// Fraction of the limits that random manoeuvres use.
const STRETCH: f64 = 0.97;
/// Manoeuvres evaluated together: an interruption keeps those before.
const TOGETHER: usize = 16;
/// The search stops when a step lowers the logarithm of the ratio by less.
const TOLERANCE: f64 = 1.0e-5;
/// A merit that no manoeuvre has: the search goes on.
pub const NEVER: f64 = f64::NEG_INFINITY;
/// First trust region, in free numbers.
const DELTA: f64 = 0.3;

/// The best manoeuvre of a search.
#[derive(Debug, Clone)]
pub struct Found {
    /// Free numbers and their values.
    pub reached: Reached,
    /// Objective of every start after its first steps, best first, then of every hop.
    pub starts: Vec<f64>,
}

/// Searches the whole space from the manoeuvres `given` and random ones, then by hops until the evaluations are used or a
/// merit of `enough` is reached.
pub fn search(
    question: &Question,
    space: &Space,
    given: &[Vec<f64>],
    (evaluations, enough): (usize, f64),
) -> Option<Found> {
    let program = Program::new(question, space);
    let mut rng = ChaCha8Rng::seed_from_u64(question.design.seed);
    let last = (LAST_EACH * space.len()).min(evaluations / LAST_SHARE);
    let mut left = evaluations.saturating_sub(last);
    let starts = begun(&program, &mut rng, given.to_vec(), (&mut left, enough));
    if merit(starts.first()?) <= enough {
        let (reached, starts) = (starts.first()?.reached.clone(), objectives(&starts));
        return Some(Found { reached, starts });
    }
    let (mut best, mut starts) = halved(&program, starts, &mut left)?;
    while left > HOP_POINTS + 2 * space.len() && !program.stop() && merit(&best) > enough {
        let length = HOPS[starts.len() % HOPS.len()];
        let from = (&best.reached, length);
        let Some(hopped) = hop(&program, &mut rng, from, &mut left) else {
            break;
        };
        starts.push(hopped.reached.values.worst());
        if merit(&hopped) < merit(&best) {
            best = hopped;
        }
    }
    if merit(&best) > enough {
        let program = Program::last(question, space);
        // A hop settles earlier.
        best.reached.settled = false;
        best.advance(&program, &space.polytope, options(last + left, LAST_STEPS));
    }
    let reached = best.reached;
    Some(Found { reached, starts })
}

/// A hop from the best manoeuvre: the best of some manoeuvres around it, followed while it may become better.
fn hop(
    program: &Program,
    rng: &mut ChaCha8Rng,
    (best, length): (&Reached, f64),
    left: &mut usize,
) -> Option<MinimaxSearch> {
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    let around = |_| best.x.iter().map(|x| x + length * normal()).collect();
    let pool: Vec<Vec<f64>> = (0..HOP_POINTS).map(around).collect();
    let inside = pool.into_iter().map(|x| program.space.drawn_inside(x));
    let mut search = evaluated(program, inside.collect(), left)
        .into_iter()
        .next()?;
    for round in 1.. {
        let before = search.reached.evaluations;
        let follow = MinimaxOptions {
            tolerance: HOP_TOLERANCE,
            ..options(*left, FIRST_STEPS)
        };
        search.advance(program, &program.space.polytope, follow);
        let spent = search.reached.evaluations - before;
        *left = left.saturating_sub(spent);
        let behind = merit(&search) - best.values.merit();
        if spent == 0 || search.reached.settled || behind > HOPELESS / f64::from(round) {
            break;
        }
    }
    Some(search)
}

/// A few steps of each search, the worse half dropped, until one is left; beside it, the objective of each after its first steps.
fn halved(
    program: &Program,
    mut ends: Vec<MinimaxSearch>,
    left: &mut usize,
) -> Option<(MinimaxSearch, Vec<f64>)> {
    let mut starts = Vec::new();
    while !ends.is_empty() {
        let is_last = ends.len() == 1;
        let steps = if is_last { LAST_STEPS } else { FIRST_STEPS };
        let share = MinimaxOptions {
            tolerance: START_TOLERANCE,
            ..options(*left / ends.len(), steps)
        };
        let spent: usize = ends
            .par_iter_mut()
            .map(|search| {
                let before = search.reached.evaluations;
                search.advance(program, &program.space.polytope, share);
                search.reached.evaluations - before
            })
            .sum();
        *left = left.saturating_sub(spent);
        ends.sort_by(by_merit);
        if starts.is_empty() {
            starts = objectives(&ends);
        }
        if is_last {
            break;
        }
        ends.truncate(ends.len().div_ceil(2));
    }
    Some((ends.into_iter().next()?, starts))
}

/// Starting points: the best of many random manoeuvres, and always those given.
fn begun(
    program: &Program,
    rng: &mut ChaCha8Rng,
    given: Vec<Vec<f64>>,
    (left, enough): (&mut usize, f64),
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
    let random = pool.split_off(of_case);
    let mut all = evaluated(program, pool, left);
    for part in random.chunks(TOGETHER) {
        if all.iter().any(|s| merit(s) <= enough) {
            break;
        }
        all.extend(evaluated(program, part.to_vec(), left));
    }
    let given = all.len().min(of_case);
    all[given..].sort_by(by_merit);
    all.truncate(wanted);
    all
}

/// A search from each of these manoeuvres that can be flown, the best first.
pub fn evaluated(program: &Program, pool: Vec<Vec<f64>>, left: &mut usize) -> Vec<MinimaxSearch> {
    *left = left.saturating_sub(pool.len());
    let values: Vec<Option<Values>> = pool
        .chunks(TOGETHER)
        .flat_map(|p| program.values(p))
        .collect();
    let begun = |(x, values): (Vec<f64>, Option<Values>)| Some(MinimaxSearch::begin(x, values?));
    let mut all: Vec<MinimaxSearch> = pool.into_iter().zip(values).filter_map(begun).collect();
    all.sort_by(by_merit);
    all
}

/// Continues from one manoeuvre in a slightly changed space, unless it has a merit of `enough` there.
pub fn refine(
    question: &Question,
    space: &Space,
    from: &[f64],
    (evaluations, enough): (usize, f64),
) -> Option<Reached> {
    let program = Program::last(question, space);
    let mut left = evaluations;
    let from = vec![space.drawn_inside(from.to_vec())];
    let mut search = evaluated(&program, from, &mut left).into_iter().next()?;
    if merit(&search) > enough {
        search.advance(&program, &space.polytope, options(left, LAST_STEPS));
    }
    Some(search.reached)
}

fn objectives(searches: &[MinimaxSearch]) -> Vec<f64> {
    searches.iter().map(|s| s.reached.values.worst()).collect()
}

fn merit(search: &MinimaxSearch) -> f64 {
    search.reached.values.merit()
}

/// The better one first.
fn by_merit(a: &MinimaxSearch, b: &MinimaxSearch) -> Ordering {
    merit(a).total_cmp(&merit(b))
}

fn options(evaluations: usize, steps: usize) -> MinimaxOptions {
    MinimaxOptions {
        evaluations,
        steps,
        delta: DELTA,
        tolerance: TOLERANCE,
    }
}
