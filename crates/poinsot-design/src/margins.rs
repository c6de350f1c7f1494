//! Use of the limits by a manoeuvre, and the vehicles of the prior that must hold them.

use crate::design::{Asked, FEW_STEPS, ROBUST_PART};
use crate::progress::Progress;
use crate::reliability::{Fleet, Point, Reliability};
use crate::result::Uses;
use crate::search::{Found, NEVER, evaluated, refine};
use crate::shape::{Space, linear_uses};
use crate::trial::{Critical, Program, Question};
use crate::vehicles::{Prior, has_prior};
use crate::watch::{WINDOWS_EACH, Watched, fine_times};
use poinsot::Error;
use poinsot::case::Scenario;
use poinsot_formats::LimitUseFile;
use poinsot_model::Model;
use poinsot_solve::Reached;
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// What the vehicles of the prior that bound a manoeuvre may leave of a limit, or exceed it by until the manoeuvre is made smaller.
const ROOM: f64 = 0.005;
/// Distance, in sigma of the prior, of two vehicles that are one.
const SAME: f64 = 0.1;
/// Largest number of rounds that each add the vehicles that exceed a limit most.
const ROUNDS: usize = 8;
/// The same of a robust design, after the rounds of the nominal one.
const ROBUST_ROUNDS: usize = 3;
/// Factors on a manoeuvre that exceeds a limit for some vehicle.
const SHARES: [f64; 19] = [
    0.9995, 0.998, 0.995, 0.99, 0.98, 0.97, 0.96, 0.94, 0.92, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5, 0.4,
    0.3, 0.2, 0.1,
];
/// Tolerance on a limit, relative: the integration error.
const HELD: f64 = 1.0e-6;
/// Seed of the vehicles that bound the search, beside that of the search, and of those that judge its end: a manoeuvre suits those that
/// it was searched with.
const MARGIN_SEED: u64 = 1 << 32;
const JUDGE_SEED: u64 = 1 << 33;
/// Runs of the subset simulation in a round of the search, and for its end: their scatter is the error of what they say.
const ROUND_RUNS: RangeInclusive<u64> = 4..=4;
const JUDGE_RUNS: RangeInclusive<u64> = 8..=32;

/// How far a manoeuvre goes towards the watched limits.
struct Nearest {
    /// Of the nominal vehicle.
    limits: Vec<OfNominal>,
    /// Of those of the prior, for every window of every limit.
    prior: Option<Reliability>,
}

/// How far the nominal vehicle goes towards a limit, relative to it; positive beyond.
#[derive(Debug, Clone, Copy)]
struct OfNominal {
    /// Value that is nearest to the limit.
    value: f64,
    /// On a grid finer than the rows.
    beyond: f64,
    /// What that grid shows beyond the rows.
    between: f64,
}

impl Nearest {
    /// The vehicles of the prior that go furthest, in each window of a limit.
    fn windows(&self, limit: usize) -> &[Point] {
        let all = self.prior.as_ref();
        let own = all.and_then(|p| p.furthest.chunks(WINDOWS_EACH).nth(limit));
        own.unwrap_or_default()
    }

    /// The largest excess over a limit, of the nominal vehicle and of all but [`ALLOWED`](crate::reliability::ALLOWED) of the others.
    fn beyond(&self, limit: usize) -> f64 {
        let excess = |(k, point): (usize, &Point)| point.beyond[limit * WINDOWS_EACH + k];
        let all = self.windows(limit).iter().enumerate().map(excess);
        let tail = self.prior.as_ref().map_or(f64::INFINITY, |p| p.tail);
        all.map(|x| x.min(tail))
            .fold(self.limits[limit].beyond, f64::max)
    }

    /// The vehicles that exceed a limit in some window.
    fn critical(&self, limit: usize) -> Vec<Vec<f64>> {
        let first = limit * WINDOWS_EACH;
        let windows = self.windows(limit).iter().enumerate();
        let beyond = windows.filter(|(window, point)| point.beyond[first + window] > HELD);
        beyond.map(|(_, point)| point.z.clone()).collect()
    }

    /// Whether the nominal vehicle and all but [`ALLOWED`](crate::reliability::ALLOWED) of the others hold the limits, and not much
    /// more is left than that where vehicles of the prior bound the manoeuvre.
    fn fits(&self, is_bound: bool) -> bool {
        let least = if is_bound { -ROOM } else { f64::NEG_INFINITY };
        let of_prior = |p: &Reliability| (least..=ROOM).contains(&p.tail);
        self.limits.iter().all(|n| n.beyond <= HELD) && self.prior.as_ref().is_none_or(of_prior)
    }
}

/// The vehicles of the prior, flying one manoeuvre.
struct Flying<'q> {
    question: &'q Question,
    prior: Prior<'q>,
    scenario: Scenario,
    /// Of every limit, what the rows do not show.
    between: Vec<f64>,
}

impl<'q> Flying<'q> {
    fn new(
        question: &'q Question,
        model: &'q Model,
        scenario: &Scenario,
        nearest: &Nearest,
    ) -> Self {
        Self {
            question,
            prior: Prior::new(model),
            scenario: scenario.clone(),
            between: nearest.limits.iter().map(|n| n.between).collect(),
        }
    }
}

impl Fleet for Flying<'_> {
    fn len(&self) -> usize {
        self.prior.len()
    }

    fn is_possible(&self, z: &[f64]) -> bool {
        self.prior.bodies(z).is_some()
    }

    fn beyond(&self, z: &[f64]) -> Result<Vec<f64>, Error> {
        let vehicle = self.prior.vehicle(z);
        let vehicle = vehicle.as_ref().unwrap_or(&self.question.model);
        let course = self.question.course(vehicle, &self.scenario)?;
        let mut windows = course.windows(&self.question.watch);
        for (own, between) in windows.chunks_mut(WINDOWS_EACH).zip(&self.between) {
            own.iter_mut().for_each(|w| *w += between);
        }
        Ok(windows)
    }
}

impl Question {
    /// Adds a vehicle of the prior that must hold a limit, unless the same one has to. Whether it was added.
    fn must_hold(&mut self, limit: usize, z: Vec<f64>) -> bool {
        let distance = |c: &Critical| {
            c.z.iter()
                .zip(&z)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
        };
        let same = |c: &Critical| c.limit == limit && distance(c) < SAME * SAME;
        let vehicle = match self.critical.iter().any(same) {
            true => None,
            false => Prior::new(&self.model).vehicle(&z),
        };
        let Some(model) = vehicle else { return false };
        self.critical.push(Critical { model, z, limit });
        true
    }

    /// The vehicles that must hold a limit are those of the same directions that go as far as the tail does.
    fn follow_the_tail(&mut self, scenario: &Scenario, nearest: &Nearest) -> Result<(), Error> {
        let Some(reliability) = &nearest.prior else {
            return Ok(());
        };
        let vehicle = self.model.clone();
        let flying = Flying::new(self, &vehicle, scenario, nearest);
        let moved = |critical: &Critical| {
            let first = critical.limit * WINDOWS_EACH;
            let point = Point {
                z: critical.z.clone(),
                beyond: Vec::new(),
            };
            reliability.at_tail(&flying, &point, first..first + WINDOWS_EACH)
        };
        let moved = self.critical.par_iter().map(moved);
        let moved = moved.collect::<Result<Vec<_>, Error>>()?;
        let prior = Prior::new(&vehicle);
        for (critical, point) in self.critical.iter_mut().zip(moved) {
            if let Some(model) = prior.vehicle(&point.z) {
                (critical.model, critical.z) = (model, point.z);
            }
        }
        Ok(())
    }
}

impl Asked<'_> {
    /// Repeats the search with the vehicles of the prior that exceed a limit most, until all hold the limits: cutting sets
    /// (Mutapcic and Boyd 2009). A margin taken from one manoeuvre would be wrong for the next one.
    ///
    /// # Errors
    /// A vehicle of the prior cannot fly the manoeuvre.
    pub fn leave_margins(
        &self,
        question: &mut Question,
        space: &Space,
        reached: &mut Reached,
    ) -> Result<(), Error> {
        let (rounds, part) = match question.vehicles.is_empty() {
            true => (ROUNDS, self.design.evaluations / ROUNDS),
            false => (ROBUST_ROUNDS, self.design.evaluations / ROBUST_PART),
        };
        for _ in 0..rounds {
            if !self.tightened(question, space, &reached.x)? {
                break;
            }
            self.follow_the_worst(question, space, &reached.x);
            let program = Program::last(question, space);
            let shares = std::iter::once(1.0).chain(SHARES);
            let shorter = shares.map(|share| reached.x.iter().map(|x| share * x).collect());
            let mut budget = part.max(FEW_STEPS * (space.len() + 2));
            let from = evaluated(&program, shorter.collect(), &mut budget);
            let Some(from) = from.first().map(|search| &search.reached.x) else {
                break;
            };
            let Some(better) = refine(question, space, from, (budget, NEVER)) else {
                break;
            };
            *reached = better;
        }
        Ok(())
    }

    /// Adds what this manoeuvre lacks to hold the limits: critical vehicles, and margins for values between rows and for what the
    /// search did not resolve; their reach follows the share that exceeds a limit. Whether anything was added.
    fn tightened(&self, question: &mut Question, space: &Space, x: &[f64]) -> Result<bool, Error> {
        let nearest = self.nearest(question, space, x, (MARGIN_SEED, &ROUND_RUNS))?;
        if nearest.fits(!question.critical.is_empty()) {
            return Ok(false);
        }
        if let Some(scenario) = question.scenario(space, x) {
            question.follow_the_tail(&scenario, &nearest)?;
        }
        for (limit, nominal) in nearest.limits.iter().enumerate() {
            let new = nearest.critical(limit).into_iter();
            let new = new.map(|z| question.must_hold(limit, z));
            let is_new = new.fold(false, |any, new| any | new);
            let (beyond, margin) = (nearest.beyond(limit), &mut question.margins[limit]);
            if beyond > HELD {
                *margin = match is_new || nominal.between > *margin {
                    true => margin.max(nominal.between),
                    false => *margin + beyond,
                };
            }
        }
        question.progress.iter().for_each(Progress::forget);
        Ok(true)
    }

    /// The manoeuvre, or its largest fraction in [`SHARES`] that holds every limit on the fine grid, and its uses.
    pub fn held(
        &self,
        question: &Question,
        space: &Space,
        found: &Found,
    ) -> Result<(Vec<f64>, Uses), Error> {
        let x = space.drawn_inside(found.reached.x.clone());
        let by = |share: f64| -> Result<(Vec<f64>, Uses), Error> {
            let nearer: Vec<f64> = x.iter().map(|x| share * x).collect();
            let uses = self.uses(question, space, &nearer)?;
            Ok((nearer, uses))
        };
        let whole = by(1.0)?;
        if whole.1.hold(HELD) {
            return Ok(whole);
        }
        let (mut found, mut left) = (None, SHARES.as_slice());
        // A smaller one holds them if a larger one does.
        while !left.is_empty() {
            let (larger, smaller) = left.split_at(left.len() / 2);
            let tried = by(smaller[0])?;
            left = match tried.1.hold(HELD) {
                true => larger,
                false => &smaller[1..],
            };
            found = Some(tried).filter(|tried| tried.1.hold(HELD)).or(found);
        }
        Ok(found.unwrap_or(whole))
    }

    /// How far the manoeuvre goes towards each watched limit, by the vehicles of the prior as well.
    fn nearest(
        &self,
        question: &Question,
        space: &Space,
        x: &[f64],
        (seed, runs): (u64, &RangeInclusive<u64>),
    ) -> Result<Nearest, Error> {
        let mut nearest = Nearest {
            limits: Vec::new(),
            prior: None,
        };
        let scenario = question.scenario(space, x);
        let Some(scenario) = scenario.filter(|_| !question.watch.watched.is_empty()) else {
            return Ok(nearest);
        };
        let mut case = self.case.clone();
        case.duration_s = space.record();
        let mut dense = scenario.clone();
        dense.times = fine_times(&case);
        let of = |scenario| -> Result<Vec<(f64, f64)>, Error> {
            let course = question.course(self.model, scenario)?;
            Ok(course.worst(&question.watch))
        };
        let (fine, rows) = (of(&dense)?, of(&scenario)?);
        let nominal = fine.into_iter().zip(rows).map(|(fine, rows)| OfNominal {
            value: fine.0,
            beyond: fine.1,
            between: (fine.1 - rows.1).max(0.0),
        });
        nearest.limits = nominal.collect();
        if has_prior(self.model) {
            let flying = Flying::new(question, self.model, &scenario, &nearest);
            let seed = self.design.seed ^ seed;
            nearest.prior = Some(Reliability::of(&flying, HELD, runs, seed)?);
        }
        Ok(nearest)
    }

    /// Use of every limit, by the vehicles of the prior as well, on a finer grid than in the search.
    ///
    /// # Errors
    /// A vehicle cannot fly the manoeuvre.
    fn uses(&self, question: &Question, space: &Space, x: &[f64]) -> Result<Uses, Error> {
        let mut limits = linear_uses(self.model, space, x);
        let nearest = self.nearest(question, space, x, (JUDGE_SEED, &JUDGE_RUNS))?;
        let of = |(k, w): (usize, &Watched)| {
            let value = nearest.limits.get(k)?.value;
            let margin = -nearest.beyond(k);
            // A plume has no value if its thruster never fires.
            let known = value.is_finite();
            known.then(|| LimitUseFile::new(w.what.clone(), w.unit, value, w.limit, margin))
        };
        limits.extend(question.watch.watched.iter().enumerate().filter_map(of));
        Ok(Uses {
            limits,
            share_beyond: nearest.prior.as_ref().map(Reliability::share),
        })
    }
}
