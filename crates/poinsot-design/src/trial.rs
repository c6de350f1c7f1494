//! One candidate manoeuvre, flown by the nominal vehicle or by vehicles of the prior: its information and limits.

use crate::progress::{BestSoFar, Progress};
use crate::shape::{Space, linear_uses};
use crate::vehicles::drawn;
use crate::watch::{Course, WINDOWS_EACH, Watch};
use nalgebra::DMatrix;
use poinsot::Error;
use poinsot::bind::bind;
use poinsot::case::{Case, Design, Form, Objective, Scenario, Want};
use poinsot::simulate::{run, simulate_exact_of};
use poinsot_dynamics::Tree;
use poinsot_formats::ACTIVE;
use poinsot_identify::{Information, ROUGH, WantedTerm};
use poinsot_model::Model;
use poinsot_solve::{Minimax, Values};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Integration tolerance of candidates; its effect on sigmas is negligible.
const TOLERANCE: f64 = 1.0e-6;
/// Rows of a candidate per cycle of its fastest free motion, and the fewest rows. In the time of a search, three quarters of
/// them and more candidates lead further than half of them or all.
const ROWS_A_CYCLE: f64 = 14.0;
const LEAST_ROWS: f64 = 52.0;
/// Margin on the logarithm of the ratio while the shortest duration is sought. Thinned rows and limits checked at the
/// end can cost as much.
pub const SURE: f64 = 0.01;
/// Excess over a limit that the loose integration of a candidate may cause.
const HELD: f64 = 1.0e-4;
/// Relative change of the largest ratio that is told.
const TOLD: f64 = 1.0e-3;
/// Share of the time of a search until which it hops; the rest is for its last steps and for the vehicles of the prior.
const HOPPING: f64 = 0.75;
/// Vehicles of the prior in a robust design, by their random streams: the worst tenth are more than the free numbers of most
/// manoeuvres, which would else suit these vehicles alone.
pub const SCENARIOS: Range<u64> = 0..256;
/// Other vehicles, that no search has seen, by which a robust design is judged.
pub const OTHERS: Range<u64> = OTHERS_STREAM..OTHERS_STREAM + 1000;
const OTHERS_STREAM: u64 = 1 << 34;
/// Fraction of the worst scenarios whose mean a robust design minimises, and the fraction that it flies between two looks at all.
const TAIL: f64 = 0.1;
const NEAR_TAIL: f64 = 0.25;

/// The design problem by which a manoeuvre is evaluated.
pub struct Question {
    /// The case, with a loose integration tolerance.
    pub case: Case,
    /// The nominal vehicle.
    pub model: Model,
    /// The scenario of the case, with the motions that are not designed.
    pub scenario: Scenario,
    /// Wanted numbers.
    pub wants: Vec<Want>,
    /// Free motion and objective.
    pub design: Design,
    /// Limits on the motion.
    pub watch: Watch,
    /// Margin added to the excess of each watched limit, for values between rows and for what a search did not resolve.
    pub margins: Vec<f64>,
    /// Vehicles of the prior that exceed a watched limit first. Each must hold it in every candidate.
    pub critical: Vec<Critical>,
    /// What the whole prediction adds to each objective of a candidate.
    pub surcharge: Vec<f64>,
    /// Vehicles of a robust design that hold its worst tenth, which is the objective; empty if it is the nominal vehicle.
    pub vehicles: Vec<Model>,
    /// Time at which the search stops, last steps included.
    pub deadline: Option<Deadline>,
    /// Number of evaluations so far.
    pub evaluations: AtomicUsize,
    /// The best manoeuvre so far, where it is told.
    pub(crate) progress: Option<Progress>,
}

/// When a search has to end.
#[derive(Debug, Clone, Copy)]
pub struct Deadline {
    /// No hop is followed after this time.
    pub of_hops: Instant,
    /// No step is made after this time.
    pub of_all: Instant,
}

impl Deadline {
    /// From now on.
    pub fn after(minutes: f64) -> Self {
        let after = |minutes: f64| Instant::now() + Duration::from_secs_f64(60.0 * minutes);
        Self {
            of_hops: after(HOPPING * minutes),
            of_all: after(minutes),
        }
    }
}

/// A vehicle of the prior and the watched limit that it must hold.
#[derive(Debug, Clone)]
pub struct Critical {
    /// The vehicle.
    pub model: Model,
    /// Its standard normal numbers.
    pub z: Vec<f64>,
    /// Index of the limit.
    pub limit: usize,
}

/// Result of one flight.
pub struct Flight {
    /// Covariance of the wanted numbers.
    pub covariance: DMatrix<f64>,
    /// History of the watched values.
    pub course: Course,
}

impl Question {
    /// Whether the time for the search is over.
    pub fn is_over(&self) -> bool {
        let late = self.deadline.is_some_and(|d| Instant::now() >= d.of_all);
        late || crate::interrupt::is_requested()
    }

    /// Creates the design problem of a case; `deadline` ends the search.
    pub fn new(
        case: &Case,
        model: Model,
        (design, wants): (Design, Vec<Want>),
        watch: Watch,
        deadline: Option<Deadline>,
    ) -> Result<Self, Error> {
        let mut case = case.clone();
        case.tolerance.relative = case.tolerance.relative.max(TOLERANCE);
        let scenario = case.bind_around(&model, design.open())?;
        Ok(Self {
            case,
            scenario,
            margins: vec![0.0; watch.watched.len()],
            critical: Vec::new(),
            surcharge: vec![0.0; wants.len()],
            model,
            wants,
            design,
            watch,
            vehicles: Vec::new(),
            deadline,
            evaluations: AtomicUsize::new(0),
            progress: None,
        })
    }

    /// The scenario with these free numbers, on the rows of a candidate.
    pub fn scenario(&self, space: &Space, x: &[f64]) -> Option<Scenario> {
        let mut scenario = self.scenario.clone();
        let mut case = self.case.clone();
        case.duration_s = space.record();
        case.rate_hz /= thinned((&case, space.duration), &self.model, &self.design);
        scenario.times = case.times();
        space.place(x, &mut scenario)?;
        Some(scenario)
    }

    /// Simulates a scenario with a vehicle and computes the covariance.
    ///
    /// # Errors
    /// The motion cannot be computed, or a required sensor is missing.
    pub fn fly(&self, model: &Model, scenario: Scenario) -> Result<Flight, Error> {
        let mut course = Course::default();
        // Each row has the weight of the rows of the case that it replaces.
        let step = match (scenario.times.get(0), scenario.times.get(1)) {
            (Some(first), Some(second)) => second - first,
            _ => 1.0 / self.case.rate_hz,
        };
        let thinned = step * self.case.rate_hz;
        let exact = simulate_exact_of(&self.case, model, scenario, |sample| {
            course.push(self.watch.values(sample));
        })?;
        let tree = Tree::new(model);
        let bound = bind(model, &tree, &[exact.table])?;
        let problem = bound.problem(model, &tree);
        let priors = self.design.priors;
        let information = Information::of(&problem, priors, (ROUGH, thinned))?;
        let terms: Vec<Vec<WantedTerm>> = self.wants.iter().map(|w| w.terms.clone()).collect();
        Ok(Flight {
            covariance: information.covariance(&terms),
            course,
        })
    }

    /// Simulates the watched values only.
    ///
    /// # Errors
    /// The motion cannot be computed.
    pub fn course(&self, model: &Model, scenario: &Scenario) -> Result<Course, Error> {
        let mut course = Course::default();
        run(&self.case, model, None, scenario, |sample| {
            course.push(self.watch.values(sample));
            true
        })?;
        Ok(course)
    }

    /// Objectives of a covariance.
    pub fn objectives(&self, covariance: &DMatrix<f64>) -> Vec<f64> {
        let wanted = |i: usize| self.wants[i].sigma;
        if self.design.objective == Objective::LogDet {
            let n = self.wants.len();
            let scaled =
                DMatrix::from_fn(n, n, |i, j| covariance[(i, j)] / (wanted(i) * wanted(j)));
            let log = scaled
                .cholesky()
                .map_or(f64::INFINITY, |c| c.ln_determinant());
            return vec![0.5 * log / n as f64];
        }
        let of = |i: usize| 0.5 * covariance[(i, i)].ln() - wanted(i).ln() + self.surcharge[i];
        (0..self.wants.len()).map(of).collect()
    }

    /// How a candidate ranks; smaller is better. Where the shortest time is asked, any manoeuvre that reaches everything is better
    /// than one that does not, and a shorter one than a longer. Ratios that differ by less than [`TOLD`] are equal.
    fn rank(&self, duration: f64, values: &Values) -> [f64; 3] {
        let worst = (values.worst() / TOLD).ceil();
        match self.design.objective == Objective::ShortestTime {
            true if values.worst() <= -SURE => [0.0, duration, worst],
            _ => [1.0, worst, duration],
        }
    }

    /// Names of the limits of which a candidate leaves less than 1 %.
    fn active_limits(&self, (space, x): (&Space, &[f64]), course: &Course) -> Vec<String> {
        let of_motion = linear_uses(&self.model, space, x).into_iter();
        let mut names: Vec<String> = of_motion.filter(|u| u.active).map(|u| u.what).collect();
        let windows = course.windows(&self.watch);
        let limits = self.watch.watched.iter().zip(&self.margins);
        for ((limit, margin), part) in limits.zip(windows.chunks(WINDOWS_EACH)) {
            if part.iter().any(|beyond| -beyond - margin < ACTIVE) {
                names.push(limit.what.clone());
            }
        }
        names
    }

    /// Largest ratio of predicted to wanted sigma.
    fn worst_ratio(&self, covariance: &DMatrix<f64>) -> f64 {
        let of =
            |i: usize| covariance[(i, i)].sqrt() / self.wants[i].sigma * self.surcharge[i].exp();
        (0..self.wants.len()).map(of).fold(0.0, f64::max)
    }

    /// The logarithm of the largest ratio of each of these vehicles; `None` if one cannot fly.
    fn ratios(&self, vehicles: &[Model], scenario: &Scenario) -> Option<Vec<f64>> {
        let one = |m: &Model| {
            let flight = self.fly(m, scenario.clone()).ok()?;
            let worst = self.objectives(&flight.covariance);
            Some(worst.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)))
        };
        vehicles.par_iter().map(one).collect()
    }

    /// The vehicles of a robust design that do worst in this manoeuvre, enough for its worst tenth and those that may become it.
    pub fn worst_scenarios(&self, space: &Space, x: &[f64]) -> Option<Vec<Model>> {
        let all = self.drawn(SCENARIOS);
        let ratios = self.ratios(&all, &self.scenario(space, x)?)?;
        let mut ranked: Vec<(f64, Model)> = ratios.into_iter().zip(all).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate((NEAR_TAIL * SCENARIOS.end as f64) as usize);
        Some(ranked.into_iter().map(|r| r.1).collect())
    }

    /// The worst tenth of these vehicles.
    pub fn over(&self, numbers: Range<u64>, space: &Space, x: &[f64]) -> Option<f64> {
        let vehicles = self.drawn(numbers);
        let ratios = self.ratios(&vehicles, &self.scenario(space, x)?)?;
        Some(tail_mean(ratios, TAIL * vehicles.len() as f64))
    }

    fn drawn(&self, numbers: Range<u64>) -> Vec<Model> {
        let one = |k| drawn(&self.model, self.design.seed, k);
        numbers.map(one).collect()
    }

    /// Objectives and limits of the minimax program at these free numbers.
    pub fn values(&self, space: &Space, x: &[f64]) -> Option<Values> {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        let scenario = self.scenario(space, x)?;
        let flight = self.fly(&self.model, scenario.clone()).ok()?;
        let mut objectives = self.objectives(&flight.covariance);
        if !self.vehicles.is_empty() {
            let ratios = self.ratios(&self.vehicles, &scenario)?;
            objectives = vec![tail_mean(ratios, TAIL * SCENARIOS.end as f64)];
        }
        let mut limits = flight.course.windows(&self.watch);
        for critical in &self.critical {
            let own = self.course(&critical.model, &scenario).ok()?;
            let windows = own.windows(&self.watch);
            limits.extend(windows.chunks(WINDOWS_EACH).nth(critical.limit)?);
        }
        let of_nominal = 0..self.watch.watched.len();
        let of = of_nominal.chain(self.critical.iter().map(|c| c.limit));
        for (own, limit) in limits.chunks_mut(WINDOWS_EACH).zip(of) {
            own.iter_mut().for_each(|g| *g += self.margins[limit]);
        }
        let values = Values { objectives, limits };
        if let Some(progress) = &self.progress {
            let evaluations = self.evaluations.load(Ordering::Relaxed);
            let rank = (values.broken() <= HELD).then(|| self.rank(space.duration, &values));
            progress.take(evaluations, rank, |elapsed_s| BestSoFar {
                elapsed_s,
                evaluations,
                duration_s: space.record(),
                worst_ratio: self.worst_ratio(&flight.covariance),
                active_limits: self.active_limits((space, x), &flight.course),
            });
        }
        values.merit().is_finite().then_some(values)
    }
}

/// Number of rows of the case per row of a candidate. All rows are used where the information does not scale with the number of
/// rows: with correlated noise, and with wheels, whose motion between samples is not told.
fn thinned((case, duration): (&Case, f64), model: &Model, design: &Design) -> f64 {
    let remembers = model.sensors.iter().any(|s| !s.slow.is_empty());
    if remembers || model.environment.random_torque.is_some() || !model.wheels.is_empty() {
        return 1.0;
    }
    let moved = design.joints.iter().chain(&design.wheels);
    let cycles = moved.map(|m| match m.form {
        Form::Fourier {
            harmonics,
            base_frequency_hz,
            ..
        } => harmonics as f64 * base_frequency_hz.map_or(1.0, |f| f * duration),
        Form::Spline { nodes, .. } => 0.5 * nodes as f64,
        Form::Slews { slews, .. } => slews as f64,
    });
    let firings = design.thrusters.iter().map(|t| t.firings as f64);
    let rows = LEAST_ROWS.max(ROWS_A_CYCLE * cycles.chain(firings).fold(0.0, f64::max));
    (duration * case.rate_hz / rows).floor().max(1.0)
}

/// Mean of the worst `count`: conditional value at risk (Rockafellar and Uryasev 2000).
fn tail_mean(mut all: Vec<f64>, count: f64) -> f64 {
    all.sort_by(|a, b| b.total_cmp(a));
    let whole = count.floor() as usize;
    let part = count - whole as f64;
    let sum: f64 = all.iter().take(whole).sum();
    (sum + part * all.get(whole).copied().unwrap_or(0.0)) / count
}

/// The design problem in one space of free numbers.
pub struct Program<'q> {
    /// Design problem.
    pub question: &'q Question,
    /// The free numbers.
    pub space: &'q Space,
    /// Time at which it stops.
    pub until: Option<Instant>,
}

impl<'q> Program<'q> {
    /// Until the time for hops is over.
    pub fn new(question: &'q Question, space: &'q Space) -> Self {
        Self {
            question,
            space,
            until: question.deadline.map(|d| d.of_hops),
        }
    }

    /// The last steps.
    pub fn last(question: &'q Question, space: &'q Space) -> Self {
        Self {
            until: question.deadline.map(|d| d.of_all),
            ..Self::new(question, space)
        }
    }
}

impl Minimax for Program<'_> {
    fn values(&self, points: &[Vec<f64>]) -> Vec<Option<Values>> {
        let one = |x: &Vec<f64>| match self.stop() {
            true => None,
            false => self.question.values(self.space, x),
        };
        points.par_iter().map(one).collect()
    }

    fn stop(&self) -> bool {
        let late = self.until.is_some_and(|until| Instant::now() >= until);
        late || crate::interrupt::is_requested()
    }
}
