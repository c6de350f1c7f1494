//! Levenberg-Marquardt: the one loop behind every nonlinear fit.
//!
//! A problem says what its cost is, how it looks close by, and where a damped step leads. The loop
//! decides how much damping a step needs and when the answer is reached. Why it ended is part of the
//! result, not an error.

/// Share of the promised decrease that a step must bring.
const LEAST_GAIN: f64 = 1.0e-3;
/// Largest bend of a step that is believed. Transtrum and Sethna 2012 recommend 0.75, less for hard
/// problems: between 0.15 and 0.25 all 54 certified problems of NIST end at the certified answer.
const MOST_BEND: f64 = 0.25;
/// Most attempts to find a step.
const ATTEMPTS: usize = 30;

/// A cost that is a sum of squares.
pub trait LeastSquares {
    /// A value of all unknowns.
    type Point;
    /// Residuals and sensitivities at a point, in whatever form the steps need.
    type Rows;

    /// The cost; `None` where the model does not hold.
    fn cost(&self, at: &Self::Point) -> Option<f64>;

    /// The problem close to a point; `None` where the model does not hold.
    fn linearise(&self, at: &Self::Point) -> Option<Linearised<Self::Rows>>;

    /// Whether the full step no longer matters.
    fn settled(&self, at: &Self::Point, here: &Linearised<Self::Rows>) -> bool;

    /// The step `d` that minimises `|r + J d|^2 + damping |d|^2` over scaled unknowns.
    fn step(
        &self,
        at: &Self::Point,
        here: &Linearised<Self::Rows>,
        damping: f64,
    ) -> Step<Self::Point>;
}

/// A least-squares problem close to a point.
#[derive(Debug, Clone)]
pub struct Linearised<Rows> {
    /// Cost at the point.
    pub cost: f64,
    /// By how much two evaluations of the cost may differ.
    pub round_off: f64,
    /// How much the linear model says the full step lowers the cost.
    pub promised: f64,
    /// Smallest singular value that counts, in scaled unknowns: its square is the damping that begins to
    /// be felt.
    pub weakest: f64,
    /// What the steps need.
    pub rows: Rows,
}

/// A step proposed.
#[derive(Debug, Clone)]
pub struct Step<Point> {
    /// Where it leads.
    pub to: Point,
    /// How much the linear model says it lowers the cost.
    pub promised: f64,
    /// Twice the second-order part of the step over the first-order one, in scaled unknowns: how far the
    /// model is from linear along it. Zero where a problem does not look.
    pub bend: f64,
}

/// Why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The full step no longer matters.
    Settled,
    /// What the full step promises is round-off, and no longer falls.
    RoundOff,
    /// No step lowers the cost: a minimum to round-off, or a model that breaks down next to it.
    NoLowerCost,
    /// As many iterations as allowed.
    IterationLimit,
}

/// Where and why the iteration ended.
#[derive(Debug, Clone)]
pub struct Minimum<Point, Rows> {
    /// The best point found.
    pub at: Point,
    /// The problem there.
    pub here: Linearised<Rows>,
    /// Steps taken.
    pub iterations: usize,
    /// Why no more were taken.
    pub end: End,
}

/// Minimises from a point whose linearisation is known, in at most `limit` iterations (Levenberg 1944,
/// Marquardt 1963).
///
/// Steps are plain Gauss-Newton while those bring what they promise. One that does not gets damping added
/// to the squared singular values, from the square of the weakest on: it holds back weak directions first.
/// Damping grows faster with every failure and falls with the gain of the last step (Madsen, Nielsen and
/// Tingleff 2004, algorithm 3.16).
pub fn levenberg_marquardt<P: LeastSquares>(
    problem: &P,
    mut at: P::Point,
    mut here: Linearised<P::Rows>,
    limit: usize,
) -> Minimum<P::Point, P::Rows> {
    let mut damping = 0.0;
    let mut iterations = 0;
    let end = loop {
        if problem.settled(&at, &here) {
            break End::Settled;
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

        let felt = here.weakest * here.weakest;
        let mut growth = 2.0;
        let mut accepted = None;
        for _ in 0..ATTEMPTS {
            accepted = attempt(problem, &at, &here, damping);
            if accepted.is_some() {
                break;
            }
            damping = f64::max(growth * damping, felt);
            growth *= 2.0;
        }
        let Some((next, there, gain)) = accepted else {
            break End::NoLowerCost;
        };
        if here.promised < here.round_off && there.promised >= here.promised {
            break End::RoundOff;
        }
        (at, here) = (next, there);

        damping *= f64::max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0).powi(3));
        if damping < 1.0e-3 * felt {
            damping = 0.0;
        }
    };
    Minimum {
        at,
        here,
        iterations,
        end,
    }
}

/// One step: where it leads, the problem there, and the share of the promise that came true. `None`
/// where too little did, where the model bends too much to be believed, or does not hold.
fn attempt<P: LeastSquares>(
    problem: &P,
    at: &P::Point,
    here: &Linearised<P::Rows>,
    damping: f64,
) -> Option<(P::Point, Linearised<P::Rows>, f64)> {
    let step = problem.step(at, here, damping);
    if damping == 0.0 {
        // A full step is rarely refused: its cost comes with the linearisation that follows.
        let there = problem.linearise(&step.to)?;
        let gain = (here.cost - there.cost + here.round_off) / (step.promised + here.round_off);
        let believed = step.bend <= MOST_BEND && gain >= LEAST_GAIN;
        return believed.then_some((step.to, there, gain));
    }
    let cost = problem.cost(&step.to)?;
    let gain = (here.cost - cost + here.round_off) / (step.promised + here.round_off);
    let believed = step.bend <= MOST_BEND && gain >= LEAST_GAIN;
    let there = believed.then(|| problem.linearise(&step.to)).flatten()?;
    Some((step.to, there, gain))
}
