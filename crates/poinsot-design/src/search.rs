//! From random manoeuvres to the best one: many starts, a few steps each, then all steps for the most promising.

use crate::shape::Space;
use crate::trial::{Program, Question};
use poinsot_solve::{Minimax, MinimaxOptions, Reached, Values, minimax};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Random manoeuvres for each start of the search.
const RANDOM: usize = 24;
/// Steps of every start.
const FIRST_STEPS: usize = 6;
/// Steps of those that are followed to their end.
const LAST_STEPS: usize = 60;
/// How many are.
const FOLLOWED: usize = 2;
/// Share of the limits that random manoeuvres use.
const STRETCH: f64 = 0.97;
/// A step that lowers the logarithm of the ratio by less ends the search: a tenth of a percent.
const TOLERANCE: f64 = 1.0e-3;
/// First trust region, in free numbers.
const DELTA: f64 = 0.3;

/// The best manoeuvre of a search.
#[derive(Debug, Clone)]
pub struct Found {
    /// Free numbers and their values.
    pub reached: Reached,
    /// The worst objective at the end of every start, in their order.
    pub starts: Vec<f64>,
}

/// Searches the whole space; `given` are manoeuvres to start from beside random ones.
pub fn search(question: &Question, space: &Space, given: &[Vec<f64>], evaluations: usize) -> Option<Found> {
    let program = Program { question, space };
    let wanted = question.design.starts;
    let mut pool: Vec<Vec<f64>> = given.to_vec();
    let mut rng = ChaCha8Rng::seed_from_u64(question.design.seed);
    let random = (RANDOM * wanted).min(evaluations / 4);
    for _ in 0..random {
        let direction: Vec<f64> = (0..space.len())
            .map(|_| StandardNormal.sample(&mut rng))
            .collect();
        pool.push(space.stretched(&direction, STRETCH));
    }
    let mut left = evaluations.saturating_sub(pool.len());
    let merits = in_parts(&program, &pool);
    let mut order: Vec<usize> = (0..pool.len()).filter(|i| merits[*i].is_some()).collect();
    let merit = |i: &usize| merits[*i].as_ref().map_or(f64::INFINITY, Values::merit);
    order.sort_by(|a, b| merit(a).total_cmp(&merit(b)));
    // What was given is always tried.
    let first: Vec<usize> = (0..given.len()).filter(|i| merits[*i].is_some()).collect();
    order.retain(|i| !first.contains(i));
    let chosen: Vec<usize> = first.into_iter().chain(order).take(wanted.max(given.len())).collect();
    let mut ends: Vec<Reached> = Vec::new();
    for &i in &chosen {
        let share = left / (2 * (chosen.len() - ends.len())).max(1);
        let end = minimax(&program, &space.polytope, pool[i].clone(), options(share, FIRST_STEPS));
        let end = end.or_else(|| unmoved(&pool[i], merits[i].as_ref()?));
        if let Some(end) = end {
            left = left.saturating_sub(end.evaluations);
            ends.push(end);
        }
    }
    let starts = ends.iter().map(|e| e.values.worst()).collect();
    ends.sort_by(|a, b| a.values.merit().total_cmp(&b.values.merit()));
    let followed = ends.len().min(FOLLOWED);
    for k in 0..followed {
        let share = left / (followed - k);
        let from = ends[k].x.clone();
        if let Some(end) = minimax(&program, &space.polytope, from, options(share, LAST_STEPS)) {
            left = left.saturating_sub(end.evaluations);
            if end.values.merit() <= ends[k].values.merit() {
                ends[k] = end;
            }
        }
    }
    ends.sort_by(|a, b| a.values.merit().total_cmp(&b.values.merit()));
    let reached = ends.into_iter().next()?;
    Some(Found { reached, starts })
}

/// Goes on from one manoeuvre in a space that is a little different.
pub fn refine(question: &Question, space: &Space, from: &[f64], evaluations: usize) -> Option<Reached> {
    let program = Program { question, space };
    let from = space.drawn_inside(from.to_vec());
    minimax(&program, &space.polytope, from, options(evaluations, LAST_STEPS))
}

fn options(evaluations: usize, steps: usize) -> MinimaxOptions {
    MinimaxOptions {
        evaluations,
        steps,
        delta: DELTA,
        tolerance: TOLERANCE,
    }
}

/// A manoeuvre from which the search could not take a step.
fn unmoved(x: &[f64], values: &Values) -> Option<Reached> {
    Some(Reached {
        x: x.to_vec(),
        values: values.clone(),
        evaluations: 0,
        settled: false,
    })
}

/// Part by part, so that an interruption keeps what is done.
fn in_parts(program: &Program, pool: &[Vec<f64>]) -> Vec<Option<Values>> {
    pool.chunks(16).flat_map(|part| program.values(part)).collect()
}
