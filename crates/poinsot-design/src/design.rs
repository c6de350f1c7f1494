//! A design from case to manoeuvre.

use crate::interrupt::Listening;
use crate::result::{Designed, LimitUse, Reach};
use crate::search::{Found, refine, search};
use crate::shape::{Order, Space, Target, Use};
use crate::trial::Question;
use crate::vehicles::{drawn, has_prior};
use crate::verify::verify;
use crate::watch::{Watch, fine_times};
use crate::written::manoeuvre_text;
use poinsot::Error;
use poinsot::case::{Case, Design, Limits, Objective, Want, parse_case, read_case};
use poinsot::predict::{predict_case, wanted_sigma};
use poinsot::simulate::SimulateError;
use poinsot_dynamics::{Plan, Tree};
use poinsot_model::{Model, read_model};
use poinsot_solve::Reached;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Vehicles of the prior that must hold the limits that depend on them: where all do, 99 % of the prior does with a
/// probability of 95 % (`0.99^300 = 0.05`).
const VEHICLES: u64 = 300;
/// Rounds in which margins for these vehicles are found.
const MARGIN_ROUNDS: usize = 3;
/// Steps of a search that goes on after a small change.
pub(crate) const FEW_STEPS: usize = 8;
/// Times that are tried for the shortest one.
const TIMES: usize = 12;
/// Parts of the evaluations of a shortest time: two searches, and two divisions of the time.
const TIME_PARTS: usize = 4;
/// Share of the shortest time that may be left.
const TIME_LEFT: f64 = 0.01;
/// How the logarithm of a sigma falls with that of the time, before two times are known: faster than the mean of
/// independent samples, because slower motion also reaches further.
const FALL: f64 = 1.5;
/// By how much a shortest time reaches what is wanted: thinned rows and limits that are left to the end cost as much.
const SURE: f64 = 0.01;
/// Shares of a manoeuvre that are tried where a limit is broken by what the search does not resolve.
const SHARES: [f64; 7] = [1.0, 0.9995, 0.998, 0.995, 0.99, 0.98, 0.95];
/// By what part of itself a limit may be exceeded: the error of the integration.
const HELD: f64 = 1.0e-6;
/// Streams of random numbers of the vehicles that check margins; those below belong to robust designs.
const MARGIN_STREAM: u64 = 1 << 32;
/// Part of the evaluations of a robust design, each of which flies all its vehicles.
const ROBUST_PART: usize = 16;

/// A question to `design`.
#[derive(Debug, Clone, Default)]
pub struct DesignRequest {
    /// The case.
    pub case: PathBuf,
    /// Ends the search after this many minutes with what it has.
    pub minutes: Option<f64>,
    /// Trial flights of the manoeuvre; none with 0.
    pub verify: u64,
}

/// Designs the manoeuvre of a case file.
///
/// # Errors
/// Case or model are refused, or no manoeuvre within the limits can be computed.
pub fn design(request: &DesignRequest) -> Result<Designed, Error> {
    let case = read_case(&request.case).map_err(SimulateError::from)?;
    let model = read_model(&case.model)?;
    design_case(&case, model, request)
}

/// What stays the same over all searches.
pub(crate) struct Asked<'c> {
    case: &'c Case,
    model: &'c Model,
    pub design: Design,
    wants: Vec<Want>,
    pub limits: Limits,
    joint_names: Vec<String>,
    deadline: Option<Instant>,
}

/// The same in memory.
///
/// # Errors
/// As [`design`].
pub fn design_case(case: &Case, model: Model, request: &DesignRequest) -> Result<Designed, Error> {
    let asked = Asked::new(case, &model, request.minutes)?;
    let listening = Listening::begin();
    let question = asked.question(asked.design.clone(), &asked.limits)?;
    let space = asked.space(&asked.limits, case.duration_s)?;
    let reference = asked.reference(&question);
    let (space, mut found) = asked.nominal(&question, space)?;
    let mut evaluations = question.evaluations.load(Ordering::Relaxed);
    let mut question = question;
    let mut robust = None;
    if asked.design.robust {
        let own = asked.question(asked.design.clone(), &asked.limits)?;
        let budget = asked.design.evaluations / ROBUST_PART;
        if let Some(better) = refine(&own, &space, &found.reached.x, budget) {
            robust = Some(better.values.worst());
            found.reached = better;
        }
        evaluations += own.evaluations.load(Ordering::Relaxed);
        question = own;
    }
    if !question.watch.watched.is_empty() {
        asked.leave_margins(&mut question, &space, &mut found.reached);
    }
    let x = asked.held(
        &question,
        &space,
        space.drawn_inside(found.reached.x.clone()),
    )?;
    let mut designed = asked.told(&question, &space, (&x, &found), reference)?;
    designed.robust = robust;
    if !designed.is_reached() && !crate::interrupt::is_requested() {
        designed.relaxed = asked.relaxed(&space, &x, &designed.limits);
    }
    designed.evaluations = evaluations.max(question.evaluations.load(Ordering::Relaxed));
    drop(listening);
    if request.verify > 0 {
        let case = manoeuvre_of(&designed)?;
        designed.verification = Some(verify(&case, &designed, &question, request.verify)?);
    }
    Ok(designed)
}

/// The manoeuvre as a case, read from the text that is written.
fn manoeuvre_of(designed: &Designed) -> Result<Case, Error> {
    let path = Path::new(&designed.case).with_file_name("case.toml");
    let case = parse_case(&path, designed.manoeuvre.clone()).map_err(SimulateError::from)?;
    Ok(case)
}

impl<'c> Asked<'c> {
    fn new(case: &'c Case, model: &'c Model, minutes: Option<f64>) -> Result<Self, Error> {
        let usage = |why: &str| Error::Usage {
            option: "CASE",
            value: case.path().display().to_string(),
            why: why.to_owned(),
        };
        let refused = SimulateError::from;
        let design = case.design(model).map_err(refused)?;
        let design = design.ok_or_else(|| {
            usage("it has no [design]; add it with [[design.joint]] or [[design.wheel]]")
        })?;
        let wants = case.wants(model).map_err(refused)?;
        if wants.is_empty() {
            return Err(usage(
                "it has no [[want]]; add one with number = \"BODY.mass_kg\" and sigma",
            ));
        }
        let minutes = match minutes {
            Some(m) if !(m.is_finite() && m > 0.0) => {
                return Err(Error::Usage {
                    option: "--minutes",
                    value: m.to_string(),
                    why: "must be a positive number; give for example 5".to_owned(),
                });
            }
            other => other,
        };
        let tree = Tree::new(model);
        let names = tree
            .coordinates
            .iter()
            .map(|k| model.joints[*k].name.clone());
        Ok(Self {
            limits: case.limits(model).map_err(refused)?,
            design,
            wants,
            joint_names: names.collect(),
            deadline: minutes.map(|m| Instant::now() + Duration::from_secs_f64(60.0 * m)),
            case,
            model,
        })
    }

    fn name(&self, target: Target) -> &str {
        match target {
            Target::Joint(k) => &self.joint_names[k],
            Target::Wheel(k) => &self.model.wheels[k].name,
        }
    }

    fn space(&self, limits: &Limits, duration: f64) -> Result<Space, Error> {
        Space::new(&self.design, limits, duration).map_err(|(target, why)| Error::Usage {
            option: "CASE",
            value: self.case.path().display().to_string(),
            why: format!(
                "{}: {why}; give [[limits.joint]] or [[limits.wheel]] that include its initial position",
                self.name(target)
            ),
        })
    }

    pub fn question(&self, design: Design, limits: &Limits) -> Result<Question, Error> {
        let watch = Watch::new(self.model, limits, &self.joint_names);
        let what = (design, self.wants.clone());
        Question::new(self.case, self.model.clone(), what, watch, self.deadline)
    }

    /// Sigmas of the manoeuvre that the case itself holds; `None` where it moves nothing that is designed.
    fn reference(&self, question: &Question) -> Option<Vec<f64>> {
        let hold = Plan::hold(self.model);
        let plan = &question.scenario.plan;
        let joints = self.design.joints.iter().map(|m| m.index);
        let wheels = self.design.wheels.iter().map(|m| m.index);
        let moves = joints.into_iter().any(|k| plan.joints[k] != hold.joints[k])
            || wheels.into_iter().any(|k| plan.wheels[k] != hold.wheels[k]);
        if !moves {
            return None;
        }
        let flight = question.fly(self.model, question.scenario.clone()).ok()?;
        let sigma = |i: usize| flight.covariance[(i, i)].sqrt();
        Some((0..self.wants.len()).map(sigma).collect())
    }

    /// The best manoeuvre of the nominal vehicle, in its time.
    fn nominal(&self, question: &Question, space: Space) -> Result<(Space, Found), Error> {
        let plain;
        let question = match self.design.robust {
            true => {
                let design = Design {
                    robust: false,
                    ..self.design.clone()
                };
                plain = self.question(design, &self.limits)?;
                &plain
            }
            false => question,
        };
        let own = space.nearest(&question.scenario);
        let given = match own.iter().any(|x| x.abs() > 1.0e-6) {
            true => vec![own],
            false => Vec::new(),
        };
        let part = match self.design.objective {
            Objective::ShortestTime => self.design.evaluations / TIME_PARTS,
            _ => self.design.evaluations,
        };
        let Some(found) = search(question, &space, &given, part) else {
            // Why the vehicle cannot fly at all, in the words of the simulation.
            let rest = vec![0.0; space.len()];
            if let Some(scenario) = question.scenario(&space, &rest) {
                question.fly(self.model, scenario)?;
            }
            return Err(Error::Usage {
                option: "CASE",
                value: self.case.path().display().to_string(),
                why:
                    "no manoeuvre could be evaluated before the search was stopped; give more time"
                        .to_owned(),
            });
        };
        match self.design.objective {
            Objective::ShortestTime if found.reached.values.merit() <= -SURE => {
                let (space, found) = self.shortest(question, space, found);
                // The best in the longest time need not lie near the best in the shortest: once more, in that time.
                let given = [found.reached.x.clone()];
                let merit = |f: &Found| f.reached.values.merit();
                match search(question, &space, &given, part) {
                    Some(again) if merit(&again) < merit(&found) => {
                        Ok(self.shortest(question, space, again))
                    }
                    _ => Ok((space, found)),
                }
            }
            _ => Ok((space, found)),
        }
    }

    /// The shortest time in which everything is reached: bracketed, then divided where a straight line in logarithms
    /// crosses.
    fn shortest(&self, question: &Question, space: Space, found: Found) -> (Space, Found) {
        let part = self.design.evaluations / (TIME_PARTS * TIMES);
        let (mut best, mut found) = (space, found);
        let mut long = (best.duration.ln(), found.reached.values.worst() + SURE);
        let mut short: Option<(f64, f64)> = None;
        for _ in 0..TIMES {
            let next = match short {
                None => long.0 + (long.1 / FALL).clamp(-1.0, -TIME_LEFT),
                Some(short) => {
                    let share = (short.1 / (short.1 - long.1)).clamp(0.1, 0.9);
                    short.0 + share * (long.0 - short.0)
                }
            };
            if short.is_some_and(|s| long.0 - s.0 < TIME_LEFT) {
                break;
            }
            let Ok(space) = self.space(&self.limits, rounded_up(next.exp(), self.case.rate_hz))
            else {
                break;
            };
            let from = &found.reached.x;
            let Some(reached) = refine(question, &space, from, part.max(8 * space.len())) else {
                break;
            };
            let time = space.duration.ln();
            match reached.values.merit() <= -SURE {
                true => {
                    long = (time, reached.values.worst() + SURE);
                    (best, found.reached) = (space, reached);
                }
                false => short = Some((time, reached.values.merit() + SURE)),
            }
        }
        (best, found)
    }

    /// Searches on with margins until the vehicles of the prior hold the limits that depend on them.
    fn leave_margins(&self, question: &mut Question, space: &Space, reached: &mut Reached) {
        for _ in 0..MARGIN_ROUNDS {
            let Some(excess) = self.excess(question, space, &reached.x) else {
                return;
            };
            let (between, prior): (Vec<f64>, Vec<f64>) = excess.into_iter().unzip();
            question.prior_margins = prior;
            let all: Vec<f64> = between
                .iter()
                .zip(&question.prior_margins)
                .map(|(a, b)| a + b)
                .collect();
            let enough = all
                .iter()
                .zip(&question.margins)
                .all(|(e, m)| *e <= *m + HELD);
            if enough {
                return;
            }
            for (margin, e) in question.margins.iter_mut().zip(all) {
                *margin = margin.max(e);
            }
            let budget = FEW_STEPS * (space.len() + 2);
            if let Some(better) = refine(question, space, &reached.x, budget) {
                *reached = better;
            }
        }
    }

    /// The manoeuvre, or the nearest one on the way from it to rest that holds every limit on the fine grid.
    fn held(&self, question: &Question, space: &Space, x: Vec<f64>) -> Result<Vec<f64>, Error> {
        for share in SHARES {
            let nearer: Vec<f64> = x.iter().map(|x| share * x).collect();
            let uses = self.uses(question, space, &nearer)?;
            if uses.iter().all(|u| u.margin >= -HELD) {
                return Ok(nearer);
            }
        }
        Ok(x)
    }

    /// By how much the motion goes further, for each watched limit, between the rows of a candidate and with the
    /// vehicles of the prior.
    fn excess(&self, question: &Question, space: &Space, x: &[f64]) -> Option<Vec<(f64, f64)>> {
        let scenario = question.scenario(space, x)?;
        let worst = |model: &Model| -> Option<Vec<f64>> {
            let course = question.course(model, &scenario).ok()?;
            Some(course.worst(&question.watch).iter().map(|w| w.1).collect())
        };
        let nominal = worst(self.model)?;
        let fine = self.fine(question, space, x).ok()??;
        let mut between = vec![0.0_f64; nominal.len()];
        for ((b, fine), nominal) in between.iter_mut().zip(&fine).zip(&nominal) {
            *b = (fine.1 - nominal).max(0.0);
        }
        if !has_prior(self.model) {
            return Some(between.into_iter().map(|b| (b, 0.0)).collect());
        }
        let seed = self.design.seed;
        let all: Vec<Option<Vec<f64>>> = (0..VEHICLES)
            .into_par_iter()
            .map(|k| worst(&drawn(self.model, seed, MARGIN_STREAM + k)))
            .collect();
        let mut most = vec![0.0_f64; nominal.len()];
        for one in all.into_iter().flatten() {
            for ((most, x), nominal) in most.iter_mut().zip(one).zip(&nominal) {
                *most = most.max(x - nominal);
            }
        }
        Some(between.into_iter().zip(most).collect())
    }

    /// Value that comes closest to each watched limit, and how far it is beyond, on a grid finer than the case's rows.
    fn fine(
        &self,
        question: &Question,
        space: &Space,
        x: &[f64],
    ) -> Result<Option<Vec<(f64, f64)>>, Error> {
        let mut case = self.case.clone();
        case.duration_s = space.duration;
        let Some(mut scenario) = question.scenario(space, x) else {
            return Ok(None);
        };
        scenario.times = fine_times(&case);
        let course = question.course(self.model, &scenario)?;
        Ok(Some(course.worst(&question.watch)))
    }

    fn told(
        &self,
        question: &Question,
        space: &Space,
        (x, found): (&[f64], &Found),
        reference: Option<Vec<f64>>,
    ) -> Result<Designed, Error> {
        let commands = space.movers.iter().zip(space.commands(x));
        let commands: Vec<_> = commands
            .map(|(m, c)| (self.name(m.target).to_owned(), c))
            .collect();
        let manoeuvre = manoeuvre_text(self.case, space, &commands)?;
        let mut designed = Designed {
            model: self.model.clone(),
            case: self.case.path().display().to_string(),
            manoeuvre,
            commands,
            duration_s: space.duration,
            objective: word(self.design.objective),
            wants: Vec::new(),
            limits: self.uses(question, space, x)?,
            relaxed: Vec::new(),
            evaluations: 0,
            starts: found.starts.clone(),
            settled: found.reached.settled,
            robust: None,
            verification: None,
        };
        let case = manoeuvre_of(&designed)?;
        let mut vehicle = self.model.clone();
        if !self.design.priors {
            vehicle.bodies.iter_mut().for_each(|b| b.prior = None);
        }
        let prediction = predict_case(&case, vehicle, 1.0)?;
        let reaches = self.wants.iter().enumerate().map(|(i, want)| Reach {
            want: want.clone(),
            sigma: wanted_sigma(&prediction.bound, want),
            reference: reference.as_ref().map(|r| r[i]),
        });
        designed.wants = reaches.collect();
        Ok(designed)
    }

    /// How far every limit is used, on a finer grid than the search's.
    fn uses(&self, question: &Question, space: &Space, x: &[f64]) -> Result<Vec<LimitUse>, Error> {
        let mut all: Vec<LimitUse> = Vec::new();
        for u in space.uses(x) {
            all.push(self.linear_use(space, &u));
        }
        if question.watch.watched.is_empty() {
            return Ok(all);
        }
        if let Some(worst) = self.fine(question, space, x)? {
            let margins = question.watch.watched.iter().zip(&question.prior_margins);
            for ((w, margin), (value, beyond)) in margins.zip(worst) {
                all.push(LimitUse {
                    what: w.what.clone(),
                    unit: w.unit,
                    value,
                    limit: w.limit,
                    margin: -(beyond + margin),
                });
            }
        }
        Ok(all)
    }

    fn linear_use(&self, space: &Space, u: &Use) -> LimitUse {
        let mover = &space.movers[u.mover];
        let (low, high) = mover.bounds[u.order as usize];
        let half = match low.is_finite() && high.is_finite() {
            true => 0.5 * (high - low),
            false => u.limit.abs(),
        };
        let (word, unit) = match (mover.target, u.order, mover.slides) {
            (Target::Wheel(_), ..) => ("speed", "rad/s"),
            (_, Order::Value, false) => ("position", "rad"),
            (_, Order::Value, true) => ("position", "m"),
            (_, Order::Rate, false) => ("rate", "rad/s"),
            (_, Order::Rate, true) => ("rate", "m/s"),
            (_, Order::Acceleration, false) => ("acceleration", "rad/s2"),
            (_, Order::Acceleration, true) => ("acceleration", "m/s2"),
        };
        LimitUse {
            what: format!("{word} of {}", self.name(mover.target)),
            unit,
            value: u.value,
            limit: u.limit,
            margin: (u.limit - u.value).abs() / half
                * if inside(u, low, high) { 1.0 } else { -1.0 },
        }
    }
}

fn inside(u: &Use, low: f64, high: f64) -> bool {
    let slack = 1.0e-9 * u.limit.abs();
    (low - slack..=high + slack).contains(&u.value)
}

fn word(objective: Objective) -> &'static str {
    match objective {
        Objective::WorstRatio => "worst_ratio",
        Objective::LogDet => "log_det",
        Objective::ShortestTime => "shortest_time",
    }
}

/// A duration of whole samples.
fn rounded_up(duration: f64, rate_hz: f64) -> f64 {
    (duration * rate_hz - 1.0e-9).ceil() / rate_hz
}
