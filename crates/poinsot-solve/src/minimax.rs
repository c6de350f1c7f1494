//! Minimax of several smooth functions within linear and smooth limits: sequential quadratic programming with a trust
//! region (Nocedal and Wright 2006, ch. 18; minimax form: Madsen and Schjaer-Jacobsen 1978).
//!
//! Every step solves, by the interior-point solver Clarabel (Goulart and Chen 2024),
//!
//! `min t + mu s + d^T B d / 2`, `f_i + J_i d <= t`, `g_j + G_j d <= s`, `s >= 0`, `x + d` in the polytope, `|d| <= delta`
//!
//! with damped BFGS for B. Where the functions bend so much that a step gains less than half of its promise, the program is
//! solved again with their values at its end (second-order correction, section 18.3). The linear limits hold at every
//! evaluated point. The Jacobians begin as finite differences and follow the steps by Broyden's update (1965), which costs
//! nothing; differences are taken again where they explain a step badly, and before the search ends.

mod quadratic;

use crate::polytope::Polytope;
use nalgebra::{DMatrix, DVector};
use quadratic::{Jacobian, Step, quadratic};

/// Step of the finite differences, in units of the unknowns.
const DIFFERENCE: f64 = 1.0e-5;
/// Penalty of a violated limit: larger than the multiplier of any sensible limit.
const PRICE: f64 = 20.0;
/// Least ratio of actual to predicted reduction of an accepted step.
const TAKEN: f64 = 0.05;
/// Ratio below which a step is corrected for the curvature of the functions.
const CORRECTED: f64 = 0.5;
/// Ratio above which the trust region grows.
const GOOD: f64 = 0.7;
/// Ratio above which the Jacobians follow a step without new differences, and the most steps in a row.
const EXPLAINED: f64 = 0.5;
const FOLLOWED: usize = 10;
/// Initial curvature of B.
const CURVATURE: f64 = 1.0e-3;

/// Values of all functions at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// The largest of these is minimised.
    pub objectives: Vec<f64>,
    /// Each must be at most zero.
    pub limits: Vec<f64>,
}

impl Values {
    /// The largest objective.
    pub fn worst(&self) -> f64 {
        largest(&self.objectives)
    }

    /// Largest violation of a limit; zero if all hold.
    pub fn broken(&self) -> f64 {
        largest(&self.limits).max(0.0)
    }

    /// Largest objective plus penalty.
    pub fn merit(&self) -> f64 {
        self.worst() + PRICE * self.broken()
    }
}

fn largest(all: &[f64]) -> f64 {
    all.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b))
}

/// The functions of a minimax program.
pub trait Minimax {
    /// Values at each point, in order; `None` if undefined. Points may be evaluated in parallel.
    fn values(&self, points: &[Vec<f64>]) -> Vec<Option<Values>>;

    /// Whether the search should stop with its present result.
    fn stop(&self) -> bool {
        false
    }
}

/// Options of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinimaxOptions {
    /// Largest number of evaluations.
    pub evaluations: usize,
    /// Largest number of steps.
    pub steps: usize,
    /// Initial size of the trust region, in units of the unknowns.
    pub delta: f64,
    /// The search ends below this predicted reduction.
    pub tolerance: f64,
}

/// Result of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// The unknowns.
    pub x: Vec<f64>,
    /// Values there.
    pub values: Values,
    /// Evaluations used.
    pub evaluations: usize,
    /// Whether the predicted reduction is below the tolerance.
    pub settled: bool,
}

/// A search that can be continued, with its Jacobians and curvature.
///
/// ```
/// use poinsot_solve::{Minimax, MinimaxOptions, MinimaxSearch, Polytope, Side, Values};
///
/// /// (x - 1)^2 and (x + 1)^2: the larger is smallest at zero.
/// struct Parabolas;
/// impl Minimax for Parabolas {
///     fn values(&self, points: &[Vec<f64>]) -> Vec<Option<Values>> {
///         let at = |x: &Vec<f64>| Values {
///             objectives: vec![(x[0] - 1.0).powi(2), (x[0] + 1.0).powi(2)],
///             limits: vec![],
///         };
///         points.iter().map(|x| Some(at(x))).collect()
///     }
/// }
///
/// let within = Polytope { sides: vec![Side { a: vec![(0, 1.0)], low: -3.0, high: 3.0 }] };
/// let options = MinimaxOptions { evaluations: 200, steps: 50, delta: 0.5, tolerance: 1.0e-9 };
/// let first = Parabolas.values(&[vec![2.0]]).pop().flatten().unwrap();
/// let mut search = MinimaxSearch::begin(vec![2.0], first);
/// search.advance(&Parabolas, &within, options);
/// let reached = search.reached;
/// assert!(reached.x[0].abs() < 1.0e-6 && (reached.values.worst() - 1.0).abs() < 1.0e-6);
/// ```
pub struct MinimaxSearch {
    /// Present result.
    pub reached: Reached,
    slopes: Option<Jacobian>,
    /// Steps that the Jacobians have followed since their differences.
    followed: usize,
    B: DMatrix<f64>,
    /// Whether B holds more than its initial value.
    is_known: bool,
    /// Size of the trust region; `None` before the first step.
    delta: Option<f64>,
}

impl MinimaxSearch {
    /// Starts at a point inside the polytope with its values.
    pub fn begin(x: Vec<f64>, values: Values) -> Self {
        let n = x.len();
        Self {
            reached: Reached {
                x,
                values,
                evaluations: 1,
                settled: false,
            },
            slopes: None,
            followed: 0,
            B: DMatrix::identity(n, n) * CURVATURE,
            is_known: false,
            delta: None,
        }
    }

    /// Continues until a limit of the options is reached or the predicted reduction is below the tolerance.
    /// Evaluations and steps are counted from here.
    pub fn advance(
        &mut self,
        program: &impl Minimax,
        polytope: &Polytope,
        options: MinimaxOptions,
    ) {
        let n = self.reached.x.len();
        let before = self.reached.evaluations;
        let mut delta = self.delta.unwrap_or(options.delta);
        for _ in 0..options.steps {
            let used = self.reached.evaluations - before;
            if self.reached.settled || program.stop() || used + n + 1 > options.evaluations {
                break;
            }
            if self.slopes.is_none() {
                self.slopes = slopes(program, &mut self.reached);
                self.followed = 0;
            }
            let reached = &mut self.reached;
            let Some(slopes) = &self.slopes else {
                break;
            };
            let here = (reached.x.as_slice(), &reached.values);
            let Some(step) = quadratic(here, slopes, &self.B, polytope, delta) else {
                break;
            };
            let promised = reached.values.merit() - step.merit;
            if promised < options.tolerance {
                if self.followed > 0 {
                    self.slopes = None;
                    continue;
                }
                reached.settled = true;
                break;
            }
            reached.evaluations += 1;
            let Some((mut x, mut values)) = tried(program, polytope, &reached.x, &step.d) else {
                delta *= 0.25;
                continue;
            };
            if reached.values.merit() - values.merit() < CORRECTED * promised {
                let bends = slopes.without(&step.d, &values);
                let again = quadratic(
                    (reached.x.as_slice(), &bends),
                    slopes,
                    &self.B,
                    polytope,
                    delta,
                );
                let again = again.and_then(|again| {
                    reached.evaluations += 1;
                    tried(program, polytope, &reached.x, &again.d)
                });
                if let Some(better) = again.filter(|(_, v)| v.merit() < values.merit()) {
                    (x, values) = better;
                }
            }
            let fall = reached.values.merit() - values.merit();
            let length = step.d.amax();
            if fall < TAKEN * promised && self.followed > 0 {
                self.slopes = None;
                continue;
            }
            if fall < TAKEN * promised {
                delta = 0.4 * length.min(delta);
                reached.settled = delta < DIFFERENCE;
                continue;
            }
            let moved = DVector::from_vec(x.clone()) - DVector::from_vec(reached.x.clone());
            let explained = fall > EXPLAINED * promised && self.followed < FOLLOWED;
            let followed = explained.then(|| slopes.following(&moved, &reached.values, &values));
            (reached.x, reached.values) = (x, values);
            if fall > GOOD * promised && length > 0.9 * delta {
                delta = (2.0 * delta).min(1.0);
            }
            self.followed = followed.as_ref().map_or(0, |_| self.followed + 1);
            let next = followed.or_else(|| self::slopes(program, reached));
            if let Some(next) = &next {
                let bend = bent(&step, slopes, next);
                update(&mut self.B, &moved, &bend, &mut self.is_known);
            }
            self.slopes = next;
        }
        self.delta = Some(delta);
    }
}

/// The point after a step, moved back inside if the solver's round-off left the polytope.
fn tried(
    program: &impl Minimax,
    polytope: &Polytope,
    x: &[f64],
    d: &DVector<f64>,
) -> Option<(Vec<f64>, Values)> {
    let room = polytope.reach(x, d.as_slice()).min(1.0);
    let at: Vec<f64> = x.iter().zip(d.iter()).map(|(x, d)| x + room * d).collect();
    let values = program.values(std::slice::from_ref(&at)).pop()??;
    values.merit().is_finite().then_some((at, values))
}

/// One-sided differences. A function undefined next to the point ends the search.
fn slopes(program: &impl Minimax, reached: &mut Reached) -> Option<Jacobian> {
    let n = reached.x.len();
    let beside: Vec<Vec<f64>> = (0..n)
        .map(|j| {
            let mut x = reached.x.clone();
            x[j] += DIFFERENCE;
            x
        })
        .collect();
    let all = program.values(&beside);
    reached.evaluations += n;
    let all: Vec<Values> = all.into_iter().collect::<Option<_>>()?;
    let here = &reached.values;
    let slope = |there: f64, here: f64| (there - here) / DIFFERENCE;
    let objectives = DMatrix::from_fn(here.objectives.len(), n, |i, j| {
        slope(all[j].objectives[i], here.objectives[i])
    });
    let limits = DMatrix::from_fn(here.limits.len(), n, |i, j| {
        slope(all[j].limits[i], here.limits[i])
    });
    let finite = objectives
        .iter()
        .chain(limits.iter())
        .all(|x| x.is_finite());
    finite.then_some(Jacobian { objectives, limits })
}

/// Change of the gradient of the Lagrangian.
fn bent(step: &Step, before: &Jacobian, after: &Jacobian) -> DVector<f64> {
    let (objectives, limits) = &step.multipliers;
    (&after.objectives - &before.objectives).transpose() * objectives
        + (&after.limits - &before.limits).transpose() * limits
}

/// Powell's damped BFGS.
fn update(B: &mut DMatrix<f64>, s: &DVector<f64>, y: &DVector<f64>, known: &mut bool) {
    let sy = s.dot(y);
    if !*known && sy > 0.0 {
        *B = DMatrix::identity(s.len(), s.len()) * (y.dot(y) / sy).max(CURVATURE);
        *known = true;
    }
    let Bs = &*B * s;
    let sBs = s.dot(&Bs);
    if sBs.is_nan() || sBs <= f64::MIN_POSITIVE {
        return;
    }
    let theta = match sy >= 0.2 * sBs {
        true => 1.0,
        false => 0.8 * sBs / (sBs - sy),
    };
    let r = y * theta + &Bs * (1.0 - theta);
    let sr = s.dot(&r);
    if sr > 1.0e-14 * sBs {
        *B += &r * r.transpose() / sr - &Bs * Bs.transpose() / sBs;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polytope::Side;

    struct Functions<F: Fn(&[f64]) -> Values>(F);

    impl<F: Fn(&[f64]) -> Values> Minimax for Functions<F> {
        fn values(&self, points: &[Vec<f64>]) -> Vec<Option<Values>> {
            points.iter().map(|x| Some((self.0)(x))).collect()
        }
    }

    fn minimax(
        program: &impl Minimax,
        polytope: &Polytope,
        start: Vec<f64>,
        options: MinimaxOptions,
    ) -> Option<Reached> {
        let first = program.values(std::slice::from_ref(&start)).pop()??;
        let mut search = MinimaxSearch::begin(start, first);
        search.advance(program, polytope, options);
        Some(search.reached)
    }

    const OPTIONS: MinimaxOptions = MinimaxOptions {
        evaluations: 2000,
        steps: 200,
        delta: 0.5,
        tolerance: 1.0e-10,
    };

    /// Problem CB2 of Charalambous and Bandler 1976: 1.9522245 at (1.1390, 0.8996).
    #[test]
    fn paper_the_smallest_largest_of_three_functions_is_that_of_charalambous_and_bandler() {
        let program = Functions(|x: &[f64]| Values {
            objectives: vec![
                x[0].powi(2) + x[1].powi(4),
                (2.0 - x[0]).powi(2) + (2.0 - x[1]).powi(2),
                2.0 * (x[1] - x[0]).exp(),
            ],
            limits: Vec::new(),
        });
        let found = minimax(&program, &Polytope::default(), vec![2.0, 2.0], OPTIONS).unwrap();
        assert!(found.settled);
        assert!(
            (found.values.worst() - 1.952_224_5).abs() < 1.0e-6,
            "{found:?}"
        );
        assert!((found.x[0] - 1.1390).abs() < 1.0e-3 && (found.x[1] - 0.8996).abs() < 1.0e-3);
    }

    /// Hock and Schittkowski 1981, problem 24 (linear limits: -1 at (3, sqrt 3)) and problem 22 (one smooth limit: 1 at
    /// (1, 1)).
    #[test]
    fn paper_problems_with_limits_end_at_the_solutions_of_hock_and_schittkowski() {
        let program = Functions(|x: &[f64]| Values {
            objectives: vec![((x[0] - 3.0).powi(2) - 9.0) * x[1].powi(3) / (27.0 * 3.0_f64.sqrt())],
            limits: Vec::new(),
        });
        let root = 3.0_f64.sqrt();
        let side = |a: f64, b: f64, low: f64, high: f64| Side {
            a: vec![(0, a), (1, b)],
            low,
            high,
        };
        let polytope = Polytope {
            sides: vec![
                side(1.0 / root, -1.0, 0.0, f64::INFINITY),
                side(1.0, root, 0.0, 6.0),
                side(1.0, 0.0, 0.0, f64::INFINITY),
                side(0.0, 1.0, 0.0, f64::INFINITY),
            ],
        };
        let found = minimax(&program, &polytope, vec![1.0, 0.5], OPTIONS).unwrap();
        assert!((found.values.worst() + 1.0).abs() < 1.0e-6, "{found:?}");
        assert!(polytope.holds(&found.x, 1.0e-12));

        let program = Functions(|x: &[f64]| Values {
            objectives: vec![(x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)],
            limits: vec![x[0] + x[1] - 2.0, x[0].powi(2) - x[1]],
        });
        let found = minimax(&program, &Polytope::default(), vec![2.0, 2.0], OPTIONS).unwrap();
        assert!((found.values.worst() - 1.0).abs() < 1.0e-5, "{found:?}");
        assert!(found.values.broken() < 1.0e-6);
    }

    /// Along the circle of Maratos (Nocedal and Wright 2006, example 15.4) a full step towards the minimum breaks the limit by its
    /// second order: the correction is what takes such steps.
    #[test]
    fn exact_a_bent_limit_does_not_shorten_the_steps() {
        let program = Functions(|x: &[f64]| {
            let bent: f64 = x.iter().map(|x| x * x).sum::<f64>() - 1.0;
            Values {
                objectives: vec![2.0 * bent - x[0]],
                limits: vec![bent, -bent],
            }
        });
        let start: Vec<f64> = (0..8)
            .map(|k| [0.6, 0.8].get(k).copied().unwrap_or(0.0))
            .collect();
        let found = minimax(&program, &Polytope::default(), start, OPTIONS).unwrap();
        println!("{} evaluations", found.evaluations);
        assert!((found.values.worst() + 1.0).abs() < 1.0e-6, "{found:?}");
        // Without it: 733.
        assert!(found.evaluations < 400, "{}", found.evaluations);
    }
}
