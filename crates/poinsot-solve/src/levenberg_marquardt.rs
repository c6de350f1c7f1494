//! Levenberg-Marquardt: the one loop behind every nonlinear fit.
//!
//! A problem gives its cost, its linearisation, and a damped step. The loop chooses the damping and decides
//! convergence. The reason of its end is part of the result, not an error.

/// Smallest accepted ratio of actual to predicted reduction.
const LEAST_GAIN: f64 = 1.0e-3;
/// Largest acceleration ratio of an accepted step. Transtrum and Sethna 2012 recommend 0.75, less for hard problems:
/// between 0.15 and 0.25 all 54 problems of NIST converge to the certified answer.
const LARGEST_ACCELERATION_RATIO: f64 = 0.25;
/// Largest number of attempts to find a step.
const ATTEMPTS: usize = 30;
/// Full steps in a row that may raise the cost, while the model at the end of each promises that the next makes up for it
/// (a watchdog: Chamberlain et al. 1982). Along a narrow curved valley full steps leave it and come back.
const AHEAD: usize = 3;
/// Relative difference of predicted reductions below which two steps are equal.
const SAME: f64 = 1.0e-12;
/// Iterations before the convergence rate is estimated.
const PACE: usize = 8;

/// A cost that is a sum of squares.
pub trait LeastSquares {
    /// A value of all unknowns.
    type Iterate;
    /// Residuals and sensitivities at an iterate, in the form that the steps need.
    type Rows;

    /// The cost; `None` if the model is not defined.
    fn cost(&self, at: &Self::Iterate) -> Option<f64>;

    /// The linearisation at an iterate; `None` if the model is not defined.
    fn linearise(&self, at: &Self::Iterate) -> Option<Linearised<Self::Rows>>;

    /// The linearisation after a full step with the derivatives of its start; `None` where they have to be computed at its
    /// end. `left` is the reduction of the cost that the next step would still bring, if steps shorten as the last two did.
    fn carried(
        &self,
        at: &Self::Iterate,
        here: &Linearised<Self::Rows>,
        step: &Step<Self::Iterate>,
        left: f64,
    ) -> Option<Linearised<Self::Rows>> {
        let _ = (at, here, step, left);
        None
    }

    /// Whether the full step is negligible.
    fn converged(&self, at: &Self::Iterate, here: &Linearised<Self::Rows>) -> bool;

    /// The step `d` that minimises `|r + J d|^2 + damping |d|^2` over scaled unknowns.
    fn step(
        &self,
        at: &Self::Iterate,
        here: &Linearised<Self::Rows>,
        damping: f64,
    ) -> Step<Self::Iterate>;

    /// Whether a step is damped where the full one fails; otherwise the fit ends there.
    fn damps(&self, here: &Linearised<Self::Rows>) -> bool {
        let _ = here;
        true
    }

    /// Whether to continue at this pace.
    fn should_continue(&self, here: &Linearised<Self::Rows>, pace: Pace) -> bool {
        let _ = (here, pace);
        true
    }
}

/// Convergence over the last iterations.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Mean reduction of the cost by an iteration.
    pub fell: f64,
    /// Predicted reduction of the cost by the full step in the last allowed iteration.
    pub left: f64,
}

/// A least-squares problem linearised at an iterate.
#[derive(Debug, Clone)]
pub struct Linearised<Rows> {
    /// Cost at the iterate.
    pub cost: f64,
    /// Round-off difference of two evaluations of the cost.
    pub round_off: f64,
    /// Allowed increase of the cost over a step, where the full step promises less: at least the round-off, more if the step ignores a
    /// part of the cost.
    pub slack: f64,
    /// Predicted reduction of the cost by the full step.
    pub predicted_reduction: f64,
    /// Smallest identified singular value, in scaled unknowns: its square is the smallest significant damping.
    pub smallest_singular_value: f64,
    /// Data for the steps.
    pub rows: Rows,
}

/// A proposed step.
#[derive(Debug, Clone)]
pub struct Step<Iterate> {
    /// The iterate after it.
    pub to: Iterate,
    /// Predicted reduction of the cost.
    pub predicted_reduction: f64,
    /// Twice the second-order part of the step over the first-order one, in scaled unknowns: the nonlinearity along it
    /// (geodesic acceleration). Zero if a problem does not compute it.
    pub acceleration_ratio: f64,
}

/// Why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The full step is negligible.
    Converged,
    /// The predicted reduction is round-off and no longer decreases.
    RoundOff,
    /// No step lowers the cost: a minimum to round-off, or a model that breaks down next to it.
    NoLowerCost,
    /// It would not converge within the allowed iterations, and the problem accepts the rest; or its steps lead nowhere.
    TooSlow,
    /// The allowed number of iterations.
    IterationLimit,
}

/// Where and why the iteration ended.
#[derive(Debug, Clone)]
pub struct Minimum<Iterate, Rows> {
    /// The best iterate.
    pub at: Iterate,
    /// The linearisation there.
    pub here: Linearised<Rows>,
    /// Number of steps.
    pub iterations: usize,
    /// Cost at the start and after every accepted step.
    pub costs: Vec<f64>,
    /// Reason of the end.
    pub end: End,
}

/// Minimises from a point whose linearisation is known, in at most `limit` iterations (Levenberg 1944,
/// Marquardt 1963).
///
/// Steps are Gauss-Newton steps as long as these give the predicted reduction. Otherwise damping is added to the
/// squared singular values, starting at the smallest squared, so that weak directions are damped first. Damping grows
/// faster with every failure and decreases with the gain of the last step (Madsen, Nielsen and Tingleff 2004,
/// algorithm 3.16).
///
/// ```
/// use poinsot_solve::{End, LeastSquares, Linearised, Step, levenberg_marquardt};
///
/// /// One residual, exp(x) - 2, with its derivative exp(x) as rows.
/// struct Logarithm;
/// impl LeastSquares for Logarithm {
///     type Iterate = f64;
///     type Rows = f64;
///     fn cost(&self, x: &f64) -> Option<f64> {
///         Some((x.exp() - 2.0).powi(2))
///     }
///     fn linearise(&self, x: &f64) -> Option<Linearised<f64>> {
///         let cost = self.cost(x)?;
///         let (round_off, slope) = (1.0e-15, x.exp());
///         // One equation and one unknown: the full step would bring the whole cost.
///         let (slack, predicted_reduction, smallest_singular_value) = (round_off, cost, slope);
///         let rows = slope;
///         Some(Linearised { cost, round_off, slack, predicted_reduction, smallest_singular_value, rows })
///     }
///     fn converged(&self, _: &f64, here: &Linearised<f64>) -> bool {
///         here.predicted_reduction < 1.0e-24
///     }
///     fn step(&self, x: &f64, here: &Linearised<f64>, damping: f64) -> Step<f64> {
///         let (slope, r) = (here.rows, x.exp() - 2.0);
///         let d = -slope * r / (slope * slope + damping);
///         let predicted_reduction = r * r - (r + slope * d).powi(2);
///         Step { to: x + d, predicted_reduction, acceleration_ratio: 0.0 }
///     }
/// }
///
/// let start = 0.0;
/// let here = Logarithm.linearise(&start).unwrap();
/// let minimum = levenberg_marquardt(&Logarithm, start, here, 30);
/// assert_eq!(minimum.end, End::Converged);
/// assert!((minimum.at - 2.0_f64.ln()).abs() < 1.0e-12);
/// ```
pub fn levenberg_marquardt<P: LeastSquares>(
    problem: &P,
    mut at: P::Iterate,
    mut here: Linearised<P::Rows>,
    limit: usize,
) -> Minimum<P::Iterate, P::Rows> {
    let mut damping = 0.0;
    let mut iterations = 0;
    let mut promises = vec![here.predicted_reduction];
    let mut costs = vec![here.cost];
    // Predicted reduction of the full step that led here.
    let mut full = None;
    let end = loop {
        if problem.converged(&at, &here) {
            break End::Converged;
        }
        if iterations == limit {
            break End::IterationLimit;
        }
        iterations += 1;
        tracing::info!(
            target: "poinsot::progress",
            stage = "fitting, iteration",
            done = iterations as u64,
            total = limit as u64,
            at_most = true
        );

        let felt = here.smallest_singular_value * here.smallest_singular_value;
        let mut growth = 2.0;
        let mut accepted = None;
        let mut refused = None;
        for _ in 0..ATTEMPTS {
            let step = problem.step(&at, &here, damping);
            // More damping has no effect if the step no longer changes.
            if refused.is_some_and(|promise| same(promise, step.predicted_reduction)) {
                break;
            }
            refused = Some(step.predicted_reduction);
            accepted = attempt(problem, (&at, &here, full), step, damping);
            if accepted.is_some() {
                full = (damping == 0.0).then_some(here.predicted_reduction);
                break;
            }
            if !problem.damps(&here) {
                break;
            }
            damping = f64::max(growth * damping, felt);
            growth *= 2.0;
        }
        let Some((next, there, gain)) = accepted else {
            break End::NoLowerCost;
        };
        if here.predicted_reduction < here.round_off
            && there.predicted_reduction >= here.predicted_reduction
        {
            break End::RoundOff;
        }
        (at, here) = (next, there);
        promises.push(here.predicted_reduction);
        costs.push(here.cost);
        let pace = pace(&costs, &promises, limit - iterations);
        if pace.is_some_and(|pace| !problem.should_continue(&here, pace)) {
            break End::TooSlow;
        }

        damping *= f64::max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0).powi(3));
        if damping < 1.0e-3 * felt {
            damping = 0.0;
        }
    };
    Minimum {
        at,
        here,
        iterations,
        costs,
        end,
    }
}

/// Whether steps with these predicted reductions are equal.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs() || a.is_nan() && b.is_nan()
}

impl<Rows> Linearised<Rows> {
    /// The slack where it counts: the full step promises less.
    fn allowed(&self) -> f64 {
        let small = self.predicted_reduction < self.slack;
        if small { self.slack } else { 0.0 }
    }
}

/// The current convergence, with `more` iterations left; `None` after too few.
fn pace(costs: &[f64], promises: &[f64], more: usize) -> Option<Pace> {
    let from = promises.len().checked_sub(1 + PACE)?;
    let (before, now) = (promises[from], *promises.last()?);
    Some(Pace {
        fell: (costs[from] - costs.last()?) / PACE as f64,
        left: now * (now / before).powf(more as f64 / PACE as f64),
    })
}

/// Tries a step: returns the iterate, its linearisation, and the ratio of actual to predicted reduction. `None` if the
/// ratio is too small, the nonlinearity too large, or the model undefined.
fn attempt<P: LeastSquares>(
    problem: &P,
    (at, here, before): (&P::Iterate, &Linearised<P::Rows>, Option<f64>),
    step: Step<P::Iterate>,
    damping: f64,
) -> Option<(P::Iterate, Linearised<P::Rows>, f64)> {
    if damping == 0.0 {
        return full_steps(problem, (at, here, before), step);
    }
    let wanted = step.predicted_reduction + here.allowed();
    let cost = (wanted > 0.0).then(|| problem.cost(&step.to)).flatten()?;
    let gain = (here.cost - cost + here.allowed()) / wanted;
    let believed = step.acceleration_ratio <= LARGEST_ACCELERATION_RATIO && gain >= LEAST_GAIN;
    let there = believed.then(|| problem.linearise(&step.to)).flatten()?;
    Some((step.to, there, gain))
}

/// The full step, or the first of a few in a row that lowers the cost enough.
fn full_steps<P: LeastSquares>(
    problem: &P,
    (at, here, before): (&P::Iterate, &Linearised<P::Rows>, Option<f64>),
    step: Step<P::Iterate>,
) -> Option<(P::Iterate, Linearised<P::Rows>, f64)> {
    let wanted = step.predicted_reduction + here.allowed();
    let gain = |cost: f64| (here.cost - cost + here.allowed()) / wanted;
    let shortened = before.map_or(1.0, |before| step.predicted_reduction / before);
    let left = step.predicted_reduction * shortened.min(1.0);
    let carried = problem.carried(at, here, &step, left);
    if let Some(there) = carried.filter(|there| gain(there.cost) >= LEAST_GAIN) {
        let gain = gain(there.cost);
        return Some((step.to, there, gain));
    }
    let mut step = step;
    let ahead = if problem.damps(here) { AHEAD } else { 0 };
    for _ in 0..=ahead {
        if step.acceleration_ratio > LARGEST_ACCELERATION_RATIO {
            return None;
        }
        // A full step is rarely rejected, so its linearisation is computed together with its cost.
        let there = problem.linearise(&step.to)?;
        if gain(there.cost) >= LEAST_GAIN {
            let gain = gain(there.cost);
            return Some((step.to, there, gain));
        }
        let promised = gain(there.cost - there.predicted_reduction) >= LEAST_GAIN;
        if !promised {
            return None;
        }
        step = problem.step(&step.to, &there, 0.0);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// A step to `pace` times the distance from the minimum, or never a lower cost for any damping.
    struct Slow {
        pace: f64,
        moves: bool,
        looks: Cell<usize>,
    }

    const SETTLED: f64 = 1.0e-8;

    impl LeastSquares for Slow {
        type Iterate = f64;
        type Rows = ();

        fn cost(&self, at: &f64) -> Option<f64> {
            self.looks.set(self.looks.get() + 1);
            self.moves.then_some(1.0e6 + at * at)
        }

        fn linearise(&self, at: &f64) -> Option<Linearised<()>> {
            Some(Linearised {
                cost: self.cost(at)?,
                round_off: 1.0e-12,
                slack: 1.0e-12,
                predicted_reduction: at * at,
                smallest_singular_value: 1.0,
                rows: (),
            })
        }

        fn converged(&self, _: &f64, here: &Linearised<()>) -> bool {
            here.predicted_reduction < SETTLED
        }

        fn should_continue(&self, _: &Linearised<()>, pace: Pace) -> bool {
            pace.left < SETTLED
        }

        fn step(&self, at: &f64, _: &Linearised<()>, _: f64) -> Step<f64> {
            Step {
                to: self.pace * at,
                predicted_reduction: at * at,
                acceleration_ratio: 0.0,
            }
        }
    }

    fn minimum(pace: f64, moves: bool) -> (Minimum<f64, ()>, usize) {
        let problem = Slow {
            pace,
            moves,
            looks: Cell::new(0),
        };
        let here = Linearised {
            cost: 1.0e6 + 1.0,
            round_off: 1.0e-12,
            slack: 1.0e-12,
            predicted_reduction: 1.0,
            smallest_singular_value: 1.0,
            rows: (),
        };
        let minimum = levenberg_marquardt(&problem, 1.0, here, 60);
        (minimum, problem.looks.get())
    }

    /// Steps that promise much and bring nothing: derivatives of another problem.
    struct Nowhere;

    impl LeastSquares for Nowhere {
        type Iterate = f64;
        type Rows = ();

        fn cost(&self, _: &f64) -> Option<f64> {
            Some(1.0e6)
        }

        fn linearise(&self, at: &f64) -> Option<Linearised<()>> {
            Some(Linearised {
                cost: self.cost(at)?,
                round_off: 1.0e-6,
                slack: 0.1,
                predicted_reduction: 50.0,
                smallest_singular_value: 1.0,
                rows: (),
            })
        }

        fn converged(&self, _: &f64, _: &Linearised<()>) -> bool {
            false
        }

        fn step(&self, at: &f64, _: &Linearised<()>, damping: f64) -> Step<f64> {
            Step {
                to: *at,
                predicted_reduction: 50.0 / (1.0 + damping),
                acceleration_ratio: 0.0,
            }
        }
    }

    #[test]
    fn unit_a_step_that_promises_a_rise_is_not_taken() {
        let problem = Nowhere;
        let here = problem.linearise(&0.0).expect("defined everywhere");
        let step = Step {
            to: 0.0,
            predicted_reduction: -50.0,
            acceleration_ratio: 0.0,
        };
        assert!(attempt(&problem, (&0.0, &here, None), step, 1.0).is_none());
    }

    #[test]
    fn unit_slack_lets_no_step_pass_that_promises_more() {
        let here = Nowhere.linearise(&0.0).expect("defined everywhere");
        let end = levenberg_marquardt(&Nowhere, 0.0, here, 60);
        assert_eq!((end.end, end.iterations), (End::NoLowerCost, 1));
    }

    #[test]
    fn unit_a_fit_that_would_not_arrive_in_time_is_given_up() {
        let (slow, _) = minimum(0.9, true);
        assert_eq!((slow.end, slow.iterations), (End::TooSlow, PACE));
        // 0.8^(2 * 42) < 1e-8: it converges.
        let (steady, _) = minimum(0.8, true);
        assert_eq!((steady.end, steady.iterations), (End::Converged, 42));
    }

    /// Residuals `steep (y - x^2)` and `1 - x`: a full step from the valley's floor raises the cost `steep^2` times, the next
    /// one ends at the minimum (Rosenbrock 1960, steeper).
    struct Valley {
        steep: f64,
    }

    impl LeastSquares for Valley {
        type Iterate = [f64; 2];
        type Rows = ();

        fn cost(&self, [x, y]: &[f64; 2]) -> Option<f64> {
            Some((self.steep * (y - x * x)).powi(2) + (1.0 - x).powi(2))
        }

        fn linearise(&self, at: &[f64; 2]) -> Option<Linearised<()>> {
            let cost = self.cost(at)?;
            Some(Linearised {
                cost,
                round_off: 1.0e-12,
                slack: 1.0e-12,
                predicted_reduction: cost,
                smallest_singular_value: 1.0,
                rows: (),
            })
        }

        fn converged(&self, _: &[f64; 2], here: &Linearised<()>) -> bool {
            here.predicted_reduction < SETTLED
        }

        fn step(&self, [x, _]: &[f64; 2], here: &Linearised<()>, damping: f64) -> Step<[f64; 2]> {
            // Both residuals vanish after the full step, to first order; damping shortens it along the floor.
            let dx = (1.0 - x) / (1.0 + damping);
            Step {
                to: [x + dx, x * x + 2.0 * x * dx],
                predicted_reduction: here.cost,
                acceleration_ratio: 0.0,
            }
        }
    }

    #[test]
    fn exact_full_steps_cross_a_curved_valley() {
        let valley = Valley { steep: 1.0e4 };
        let start = [-1.0, 1.0];
        let Some(here) = valley.linearise(&start) else {
            panic!("the valley has a cost everywhere");
        };
        let minimum = levenberg_marquardt(&valley, start, here, 60);
        assert_eq!((minimum.end, minimum.iterations), (End::Converged, 1));
        let [x, y] = minimum.at;
        assert!((x - 1.0).abs() + (y - 1.0).abs() < 1.0e-12);
    }

    /// Residual `exp(x) - 2`: steps shorten faster and faster.
    struct Bend {
        derivatives: Cell<usize>,
        serves_below: f64,
    }

    impl Bend {
        fn at(&self, x: f64, slope: f64) -> Linearised<f64> {
            let cost = (x.exp() - 2.0).powi(2);
            Linearised {
                cost,
                round_off: 1.0e-15,
                slack: 1.0e-15,
                predicted_reduction: cost,
                smallest_singular_value: slope,
                rows: slope,
            }
        }
    }

    impl LeastSquares for Bend {
        type Iterate = f64;
        type Rows = f64;

        fn cost(&self, x: &f64) -> Option<f64> {
            Some((x.exp() - 2.0).powi(2))
        }

        fn linearise(&self, x: &f64) -> Option<Linearised<f64>> {
            self.derivatives.set(self.derivatives.get() + 1);
            Some(self.at(*x, x.exp()))
        }

        fn carried(
            &self,
            _: &f64,
            here: &Linearised<f64>,
            step: &Step<f64>,
            left: f64,
        ) -> Option<Linearised<f64>> {
            (left < self.serves_below).then(|| self.at(step.to, here.rows))
        }

        fn converged(&self, _: &f64, here: &Linearised<f64>) -> bool {
            here.predicted_reduction < SETTLED
        }

        fn step(&self, x: &f64, here: &Linearised<f64>, _: f64) -> Step<f64> {
            Step {
                to: x - (x.exp() - 2.0) / here.rows,
                predicted_reduction: here.cost,
                acceleration_ratio: 0.0,
            }
        }
    }

    #[test]
    fn exact_earlier_derivatives_serve_where_little_is_left() {
        let [all, fewer] = [0.0, 1.0e-3].map(|serves_below| {
            let problem = Bend {
                derivatives: Cell::new(0),
                serves_below,
            };
            let here = problem.linearise(&1.0).expect("defined everywhere");
            let minimum = levenberg_marquardt(&problem, 1.0, here, 60);
            assert_eq!(minimum.end, End::Converged);
            assert!((minimum.at - 2.0_f64.ln()).abs() < SETTLED.sqrt());
            problem.derivatives.get()
        });
        assert_eq!((all, fewer), (4, 2));
    }

    /// Residual `atan(x)`: full steps from beyond 1.39 lead further and further away.
    struct Flat {
        damps: bool,
    }

    impl LeastSquares for Flat {
        type Iterate = f64;
        type Rows = ();

        fn cost(&self, x: &f64) -> Option<f64> {
            Some(x.atan().powi(2))
        }

        fn linearise(&self, x: &f64) -> Option<Linearised<()>> {
            let cost = x.atan().powi(2);
            Some(Linearised {
                cost,
                round_off: 1.0e-15,
                slack: 1.0e-15,
                predicted_reduction: cost,
                smallest_singular_value: 1.0 / (1.0 + x * x),
                rows: (),
            })
        }

        fn converged(&self, _: &f64, here: &Linearised<()>) -> bool {
            here.predicted_reduction < SETTLED
        }

        fn damps(&self, _: &Linearised<()>) -> bool {
            self.damps
        }

        fn step(&self, x: &f64, _: &Linearised<()>, damping: f64) -> Step<f64> {
            let slope = 1.0 / (1.0 + x * x);
            let d = -slope * x.atan() / (slope * slope + damping);
            Step {
                to: x + d,
                predicted_reduction: x.atan().powi(2) - (x.atan() + slope * d).powi(2),
                acceleration_ratio: 0.0,
            }
        }
    }

    #[test]
    fn exact_a_fit_within_the_linear_range_ends_where_a_full_step_fails() {
        for (start, damps, end) in [
            (1.0, false, End::Converged),
            (3.0, false, End::NoLowerCost),
            (3.0, true, End::Converged),
        ] {
            let problem = Flat { damps };
            let here = problem.linearise(&start).expect("defined everywhere");
            let minimum = levenberg_marquardt(&problem, start, here, 60);
            assert_eq!(minimum.end, end, "{start} {damps}");
            assert!(damps || minimum.end == End::Converged || minimum.at == start);
        }
    }

    #[test]
    fn unit_a_step_that_damping_does_not_change_is_tried_once() {
        let (stuck, looks) = minimum(0.5, false);
        assert_eq!((stuck.end, looks), (End::NoLowerCost, 1));
    }
}
