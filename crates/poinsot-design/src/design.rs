//! From a case to a designed manoeuvre.

use crate::interrupt::Listening;
use crate::mover::{Command, Target};
use crate::progress::{Progress, Told};
use crate::result::{Designed, REACHED, Uses};
use crate::search::{Found, NEVER, refine, search};
use crate::shape::Space;
use crate::trial::{Deadline, OTHERS, Question, SCENARIOS, SURE};
use crate::verify::{check_flights, verify};
use crate::watch::Watch;
use crate::written::manoeuvre_text;
use poinsot::Error;
use poinsot::case::{Case, Design, Limits, Objective, Want, parse_case, read_case};
use poinsot::posterior::{after_answer, known_sigma};
use poinsot::predict::{against_duration, predict_case, wanted_sigma};
use poinsot_dynamics::{Firing, Plan};
use poinsot_formats::{DESIGN, DesignFile, DesignedNumberFile, SearchFile, ShorterFile, finite};
use poinsot_model::{Model, read_model};
use poinsot_report::design_sentence;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Steps of a search that continues after a small change.
pub(crate) const FEW_STEPS: usize = 8;
/// Largest number of durations tried for the shortest one.
const TIMES: usize = 12;
/// Divisor of the evaluations when the shortest duration is sought: one part is kept for the bisections of the duration.
const TIME_PARTS: usize = 4;
/// Relative accuracy of the shortest duration.
const TIME_LEFT: f64 = 0.01;
/// Assumed exponent of the decrease of sigma with duration, until two durations are known. It exceeds the 1/2 of
/// independent samples, because slower motion also reaches further.
const FALL: f64 = 1.5;
/// Largest number of times that a whole prediction lengthens the shortest manoeuvre, and of those after which it is
/// shortened again.
const PREDICTIONS: usize = 8;
const SHORTENED: usize = 4;
/// Divisor of the evaluations of a robust design, each of which flies all its vehicles.
pub(crate) const ROBUST_PART: usize = 64;

/// Commands, firings, and the manoeuvre as the text of a case.
type Written = (Vec<(String, Command)>, Vec<(String, Firing)>, String);

/// Arguments of `design`.
#[derive(Debug, Clone, Default)]
pub struct DesignRequest {
    /// The case.
    pub case: PathBuf,
    /// Stop the search after this many minutes with the best manoeuvre so far.
    pub minutes: Option<f64>,
    /// Number of trial flights of the manoeuvre.
    pub verify: u64,
    /// Answer of `identify` after which the manoeuvre is flown: `estimate.json` or its folder.
    pub after: Option<PathBuf>,
    /// Whether that answer may be unreliable.
    pub accept_unreliable: bool,
    /// One or two kinds of limits whose front (largest ratio with the limits tighter and looser) is computed: `duration`,
    /// `wheel-speeds=0.5,1,2` with the factors on the limit.
    pub front: Vec<String>,
    /// Is told of each better manoeuvre while the search runs.
    pub told: Option<Told>,
}

/// Designs the manoeuvre of a case file.
///
/// # Errors
/// Case or model are invalid, the earlier answer is of another vehicle, or no manoeuvre within the limits can be computed.
///
/// ```
/// use poinsot_design::{DesignRequest, design};
///
/// // A box with one wheel: its moment about the axis of the wheel is wanted to 0.1 %, with at most 200 rad/s.
/// let case = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/case.toml");
/// let designed = design(&DesignRequest { case, ..DesignRequest::default() })?;
/// assert_eq!(designed.file.verdict, "reached");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn design(request: &DesignRequest) -> Result<Designed, Error> {
    let case = read_case(&request.case)?;
    let model = read_model(&case.model)?;
    design_case(&case, model, request)
}

/// The best manoeuvre of the nominal vehicle.
struct Nominal {
    space: Space,
    found: Found,
    /// Where the shortest manoeuvre is asked.
    shorter: Option<ShorterFile>,
}

impl Nominal {
    /// Whether the search has been stopped.
    fn is_stopped_by(&mut self, question: &Question) -> bool {
        let stopped = question.is_over();
        if let Some(shorter) = &mut self.shorter {
            shorter.stopped |= stopped;
        }
        stopped
    }
}

/// Inputs that are equal for all searches.
pub(crate) struct Asked<'c> {
    pub case: &'c Case,
    pub model: &'c Model,
    pub design: Design,
    wants: Vec<Want>,
    pub limits: Limits,
    deadline: Option<Deadline>,
}

/// Designs the manoeuvre of a case in memory.
///
/// # Errors
/// As [`design`].
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// let designed = design_case(&case, model, &DesignRequest::default())?;
/// // The ratio of sigma to wanted sigma, of the worst number.
/// assert!(designed.file.worst_ratio.unwrap() <= 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn design_case(case: &Case, model: Model, request: &DesignRequest) -> Result<Designed, Error> {
    let model = match &request.after {
        Some(answer) => after_answer(&model, answer, request.accept_unreliable)?,
        None => model,
    };
    let asked = Asked::new(case, &model, request.minutes)?;
    check_flights(case, &model, request.verify)?;
    let front = Asked::front_limits(&request.front)?;
    let listening = Listening::begin();
    let mut question = asked.question(&asked.limits)?;
    question.progress = Some(Progress::new(request.told));
    let window = asked.design.window;
    let designed = case.duration_s - window.begin() - window.rest(case.duration_s);
    let space = asked.space(&asked.limits, designed)?;
    let reference = asked.reference(&question);
    let Nominal {
        space,
        mut found,
        shorter,
    } = asked.nominal(&mut question, space)?;
    asked.leave_margins(&mut question, &space, &mut found.reached)?;
    let mut of_nominal = None;
    if asked.design.robust {
        of_nominal = Some(asked.held(&question, &space, &found)?);
        asked.for_the_prior(&mut question, &space, &mut found)?;
    }
    question.progress = None;
    let (mut x, mut uses) = asked.held(&question, &space, &found)?;
    let mut others = None;
    if let Some((nominal, of_nominal)) = of_nominal {
        let of_own = question.over(OTHERS, &space, &x);
        let of_first = question.over(OTHERS, &space, &nominal);
        if of_first < of_own {
            // Vehicles that no search has seen decide: the robust manoeuvre suits those of its search.
            (x, uses) = (nominal, of_nominal);
        }
        others = Some((question.over(SCENARIOS, &space, &x), of_own, of_first));
    }
    let mut designed = asked.told(&space, (&x, &found), (uses, reference, shorter))?;
    let file = &mut designed.file;
    let after = request.after.as_ref();
    file.after = after.map(|answer| answer.display().to_string());
    if let Some((of_search, of_own, of_nominal)) = others {
        file.robust_log_ratio = of_search;
        file.robust_log_ratio_others = of_own;
        file.nominal_log_ratio_others = of_nominal;
    }
    if file.verdict == NOT_REACHED && !crate::interrupt::is_requested() {
        file.relaxed = asked.relaxed(&question, &space, &x, &file.limits);
    }
    if !front.is_empty() && !crate::interrupt::is_requested() {
        let worst = file.worst_ratio.unwrap_or(f64::INFINITY);
        file.front = asked.front(&front, (&question, &space), &x, worst);
    }
    file.search.evaluations = question.evaluations.load(Ordering::Relaxed);
    drop(listening);
    if request.verify > 0 {
        let manoeuvre = parsed(case.path(), designed.manoeuvre.clone())?;
        file.verification = Some(verify(&manoeuvre, &question, request.verify)?);
    }
    file.in_words = design_sentence(file);
    Ok(designed)
}

/// The text of a case as if it lay beside the one that asks for the design.
fn parsed(asked: &Path, text: String) -> Result<Case, Error> {
    let path = asked.with_file_name("case.toml");
    parse_case(&path, text)
}

impl<'c> Asked<'c> {
    fn new(case: &'c Case, model: &'c Model, minutes: Option<f64>) -> Result<Self, Error> {
        let usage = |problem: &str, advice: &str| {
            Error::usage("CASE", case.path().display(), problem, advice)
        };
        let design = case.design(model)?;
        let design = design.ok_or_else(|| {
            usage(
                "it has no [design]",
                "add it with [[design.joint]], [[design.wheel]] or [[design.thruster]]",
            )
        })?;
        let wants = case.wants(model)?;
        if wants.is_empty() {
            return Err(usage(
                "it has no [[want]]",
                "add one with number = \"BODY.mass_kg\" and sigma",
            ));
        }
        if let Some(m) = minutes.filter(|m| !(m.is_finite() && *m > 0.0)) {
            let what = "must be a positive number";
            return Err(Error::usage("--minutes", m, what, "give for example 5"));
        }
        let mut limits = case.limits(model)?;
        let scenario = case.bind_around(model, design.open())?;
        let designed = |f: &Firing| {
            let own = design.thrusters.iter().any(|t| t.index == f.thruster);
            own && !design.window.keeps(f.on, f.off)
        };
        for limit in &mut limits.impulses {
            let fired = scenario.plan.firings.iter();
            let others = fired.filter(|f| limit.holds(f.thruster) && !designed(f));
            limit.spent = others.map(|f| f.force * (f.off - f.on)).sum();
        }
        Ok(Self {
            limits,
            design,
            wants,
            deadline: minutes.map(Deadline::after),
            case,
            model,
        })
    }

    fn space(&self, limits: &Limits, duration: f64) -> Result<Space, Error> {
        let times = (duration, self.design.window.rest(self.case.duration_s));
        Space::new(&self.design, limits, times).map_err(|(target, why)| {
            let what = format!("{}: {why}", target.name(self.model));
            Error::usage("CASE", self.case.path().display(), what, "")
        })
    }

    /// The design problem of the nominal vehicle.
    pub fn question(&self, limits: &Limits) -> Result<Question, Error> {
        let watch = Watch::new(self.model, limits);
        let what = (self.design.clone(), self.wants.clone());
        Question::new(self.case, self.model.clone(), what, watch, self.deadline)
    }

    /// Sigmas of the manoeuvre in the case itself; `None` if it moves no designed joint, wheel or thruster.
    fn reference(&self, question: &Question) -> Option<Vec<f64>> {
        if self.design.replaced.is_empty() {
            return None;
        }
        let hold = Plan::hold(self.model);
        let plan = &question.scenario.plan;
        let joints = self.design.joints.iter().map(|m| m.index);
        let wheels = self.design.wheels.iter().map(|m| m.index);
        let moves = joints.into_iter().any(|k| plan.joints[k] != hold.joints[k])
            || wheels.into_iter().any(|k| plan.wheels[k] != hold.wheels[k])
            || self
                .design
                .thrusters
                .iter()
                .any(|t| plan.firings.iter().any(|f| f.thruster == t.index));
        if !moves {
            return None;
        }
        let flight = question.fly(self.model, question.scenario.clone()).ok()?;
        let sigma = |i: usize| flight.covariance[(i, i)].sqrt();
        Some((0..self.wants.len()).map(sigma).collect())
    }

    /// Continues with the worst tenth of the vehicles of the prior as the objective.
    fn for_the_prior(
        &self,
        question: &mut Question,
        space: &Space,
        found: &mut Found,
    ) -> Result<(), Error> {
        question.vehicles = vec![self.model.clone()];
        self.follow_the_worst(question, space, &found.reached.x);
        question.progress.iter().for_each(Progress::forget);
        let few = FEW_STEPS * (space.len() + 2);
        let budget = (self.design.evaluations / ROBUST_PART).max(few);
        if let Some(better) = refine(question, space, &found.reached.x, (budget, NEVER)) {
            found.reached = better;
        }
        self.leave_margins(question, space, &mut found.reached)
    }

    /// The vehicles of a robust design that do worst in this manoeuvre are those of its objective.
    pub fn follow_the_worst(&self, question: &mut Question, space: &Space, x: &[f64]) {
        if question.vehicles.is_empty() {
            return;
        }
        if let Some(worst) = question.worst_scenarios(space, x) {
            question.vehicles = worst;
        }
    }

    /// The best manoeuvre of the nominal vehicle, at fixed or shortest duration; its prediction sets the surcharge.
    fn nominal(&self, question: &mut Question, space: Space) -> Result<Nominal, Error> {
        let own = space.nearest(&question.scenario);
        let given = match own.iter().any(|x| x.abs() > 1.0e-6) {
            true => vec![own],
            false => Vec::new(),
        };
        // The first manoeuvre that reaches everything is the start of shorter ones; part of the evaluations is kept for these.
        let all = self.design.evaluations;
        let part = match self.design.objective {
            Objective::ShortestTime => (all - all / TIME_PARTS, -SURE),
            _ => (all, NEVER),
        };
        let Some(found) = search(question, &space, &given, part) else {
            // Return the error of the simulation if the vehicle cannot fly even at rest.
            let rest = vec![0.0; space.len()];
            if let Some(scenario) = question.scenario(&space, &rest) {
                question.fly(self.model, scenario)?;
            }
            let value = self.case.path().display();
            let what = "no manoeuvre could be evaluated before the search was stopped";
            return Err(Error::usage("CASE", value, what, "give more time"));
        };
        let reaches = found.reached.values.merit() <= -SURE;
        let mut nominal = Nominal {
            space,
            found,
            shorter: None,
        };
        if self.design.objective == Objective::ShortestTime {
            nominal.shorter = Some(ShorterFile {
                missed_s: None,
                stopped: question.is_over(),
            });
            if reaches {
                let spent = question.evaluations.load(Ordering::Relaxed);
                let again = (2 * all / TIME_PARTS).saturating_sub(spent);
                self.shorten(question, &mut nominal);
                self.search_again(question, &mut nominal, again);
                self.as_predicted(question, &mut nominal)?;
            }
        }
        Ok(nominal)
    }

    /// Searches again at the shortest duration: its best manoeuvre may be far from that of the longest.
    fn search_again(&self, question: &Question, nominal: &mut Nominal, part: usize) {
        let given = [nominal.found.reached.x.clone()];
        let again = search(question, &nominal.space, &given, (part, NEVER));
        let merit = |f: &Found| f.reached.values.merit();
        if let Some(again) = again.filter(|f| merit(f) < merit(&nominal.found)) {
            nominal.found = again;
            self.shorten(question, nominal);
        }
        nominal.is_stopped_by(question);
    }

    /// A longer manoeuvre, where the whole prediction of this one misses a wanted sigma that its candidate reached.
    fn as_predicted(&self, question: &mut Question, nominal: &mut Nominal) -> Result<(), Error> {
        let mut reached = nominal.space.duration;
        for round in 0..PREDICTIONS {
            let from = nominal.found.reached.x.clone();
            let predicted = self.predicted_ratios(&nominal.space, &from)?;
            let missed = predicted.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            if missed.is_nan() || missed <= 0.0 {
                break;
            }
            if let Some(shorter) = &mut nominal.shorter {
                shorter.missed_s = Some(nominal.space.record());
            }
            let candidate = nominal.found.reached.values.objectives.iter();
            let differences = predicted.iter().zip(candidate).map(|(p, c)| p - c);
            let sums = question
                .surcharge
                .iter()
                .zip(differences)
                .map(|(s, d)| s + d);
            question.surcharge = sums.collect();
            reached = rounded_up(reached * ((missed + SURE) / FALL).exp(), self.case.rate_hz);
            let Ok(longer) = self.space(&self.limits, reached) else {
                break;
            };
            let part = (self.design.evaluations / (TIME_PARTS * TIMES)).max(8 * longer.len());
            let Some(better) = refine(question, &longer, &from, (part, NEVER)) else {
                break;
            };
            let is_enough = better.values.merit() <= -SURE;
            (nominal.space, nominal.found.reached) = (longer, better);
            if is_enough && round < SHORTENED {
                self.shorten(question, nominal);
                reached = nominal.space.duration;
            }
        }
        Ok(())
    }

    /// Logarithm of predicted over wanted sigma of every wanted number.
    fn predicted_ratios(&self, space: &Space, x: &[f64]) -> Result<Vec<f64>, Error> {
        let (.., text) = self.written(space, x)?;
        let case = parsed(self.case.path(), text)?;
        let prediction = predict_case(&case, self.vehicle(), 1.0)?;
        let ratio = |want: &Want| {
            let sigma = wanted_sigma(&prediction.bound, want);
            sigma.map_or(f64::INFINITY, |s| s / want.sigma).ln()
        };
        Ok(self.wants.iter().map(ratio).collect())
    }

    /// The vehicle as a prediction has it.
    fn vehicle(&self) -> Model {
        let mut vehicle = self.model.clone();
        if !self.design.priors {
            vehicle.bodies.iter_mut().for_each(|b| b.prior = None);
        }
        vehicle
    }

    /// Commands, firings, and the manoeuvre as the text of a case.
    fn written(&self, space: &Space, x: &[f64]) -> Result<Written, Error> {
        let commands = space.movers.iter().zip(space.commands(x));
        let commands: Vec<_> = commands
            .map(|(m, c)| (m.target.name(self.model), c.delayed(space.from)))
            .collect();
        let firings = space.valves.firings(x).into_iter();
        let firings: Vec<_> = firings
            .map(|f| (Target::Thruster(f.thruster).name(self.model), f))
            .collect();
        let manoeuvre = manoeuvre_text((self.case, &self.design), space, &commands, &firings)?;
        Ok((commands, firings, manoeuvre))
    }

    /// Shortest duration that reaches every wanted sigma: bracketed, then divided by the secant rule in logarithms.
    fn shorten(&self, question: &Question, nominal: &mut Nominal) {
        let part = self.design.evaluations / (TIME_PARTS * TIMES);
        let mut long = (
            nominal.space.duration.ln(),
            nominal.found.reached.values.worst() + SURE,
        );
        let mut short: Option<(f64, f64)> = None;
        let expected = |long: (f64, f64)| long.0 + (long.1 / FALL).clamp(-1.0, -TIME_LEFT);
        for _ in 0..TIMES {
            let next = match short {
                None => expected(long),
                Some(short) => {
                    let share = (short.1 / (short.1 - long.1)).clamp(0.25, 0.75);
                    short.0 + share * (long.0 - short.0)
                }
            };
            // Whole samples: at least one less than the longer.
            let one_less = nominal.space.duration - 1.0 / self.case.rate_hz;
            let duration = rounded_up(next.exp(), self.case.rate_hz).min(one_less);
            let is_left = |s: (f64, f64)| long.0 - s.0 >= TIME_LEFT && duration.ln() > s.0;
            if duration <= 0.0 || !short.is_none_or(is_left) {
                break;
            }
            let Ok(space) = self.space(&self.limits, duration) else {
                // So short a manoeuvre does not exist.
                short = short.or(Some((duration.ln(), f64::INFINITY)));
                break;
            };
            let from = &nominal.found.reached.x;
            // So good a manoeuvre is shortened by the largest step in any case.
            let how = (part.max(8 * space.len()), -FALL);
            let Some(reached) = refine(question, &space, from, how) else {
                break;
            };
            let time = space.duration.ln();
            if reached.values.merit() <= -SURE {
                long = (time, reached.values.worst() + SURE);
                (nominal.space, nominal.found.reached) = (space, reached);
                // This manoeuvre is much better: the shorter one failed by its search, not by its duration.
                short = short.filter(|s| s.0 < expected(long));
            } else if nominal.is_stopped_by(question) {
                // A search that was stopped says nothing of this duration.
                break;
            } else {
                short = Some((time, reached.values.merit() + SURE));
            }
        }
        let around = nominal.space.record() - nominal.space.duration;
        if let Some(shorter) = &mut nominal.shorter {
            shorter.missed_s = short.map(|s| s.0.exp() + around);
        }
    }

    fn told(
        &self,
        space: &Space,
        (x, found): (&[f64], &Found),
        (uses, reference, shorter): (Uses, Option<Vec<f64>>, Option<ShorterFile>),
    ) -> Result<Designed, Error> {
        let (commands, firings, manoeuvre) = self.written(space, x)?;
        let case = parsed(self.case.path(), manoeuvre.clone())?;
        let vehicle = self.vehicle();
        let ends = against_duration(&case, &vehicle, &self.wants, 1.0)?;
        let prediction = predict_case(&case, vehicle, 1.0)?;
        let wants = self
            .wants
            .iter()
            .enumerate()
            .map(|(i, want)| DesignedNumberFile {
                name: want.name.clone(),
                unit: want.unit.to_owned(),
                wanted_sigma: want.sigma,
                sigma: wanted_sigma(&prediction.bound, want),
                known_sigma: known_sigma(self.model, want),
                reference_sigma: reference.as_ref().map(|r| r[i]),
            });
        let wants: Vec<DesignedNumberFile> = wants.collect();
        let ratio = |w: &DesignedNumberFile| w.sigma.map_or(f64::INFINITY, |s| s / w.wanted_sigma);
        let worst = wants.iter().map(ratio).fold(0.0, f64::max);
        let unshortened = shorter.is_some_and(|s| s.stopped && s.missed_s.is_none());
        let verdict = match (worst <= 1.0 + ROUNDED && uses.hold(ROUNDED), unshortened) {
            (true, true) => "stopped",
            (true, false) => REACHED,
            (false, _) => NOT_REACHED,
        };
        let file = DesignFile {
            schema: DESIGN.to_owned(),
            poinsot: env!("CARGO_PKG_VERSION").to_owned(),
            case: self.case.path().display().to_string(),
            model: self.model.name.clone(),
            verdict: verdict.to_owned(),
            objective: word(self.design.objective).to_owned(),
            duration_s: space.record(),
            shorter,
            worst_ratio: finite(worst),
            wants,
            limits: uses.limits,
            share_beyond_limits: uses.share_beyond,
            against_duration: Some(ends),
            search: SearchFile {
                evaluations: 0,
                starts: found.starts.clone(),
                settled: found.reached.settled,
            },
            ..DesignFile::default()
        };
        Ok(Designed {
            file,
            model: self.model.clone(),
            manoeuvre,
            commands,
            firings,
        })
    }
}

/// Relative change allowed for the loose integration of the search.
const ROUNDED: f64 = 1.0e-4;
/// Verdict of a design that misses a wanted sigma or breaks a limit.
const NOT_REACHED: &str = "not_reached";

fn word(objective: Objective) -> &'static str {
    match objective {
        Objective::WorstRatio => "worst_ratio",
        Objective::LogDet => "log_det",
        Objective::ShortestTime => "shortest_time",
    }
}

/// Duration rounded up to whole samples.
fn rounded_up(duration: f64, rate_hz: f64) -> f64 {
    (duration * rate_hz - 1.0e-9).ceil() / rate_hz
}
