//! Use of the limits by a manoeuvre, and the vehicles of the prior that must hold them.

use crate::design::{Asked, FEW_STEPS, ROBUST_PART};
use crate::search::{evaluated, refine};
use crate::shape::{Space, linear_uses};
use crate::trial::{Critical, Program, Question};
use crate::vehicles::{drawn, has_prior};
use crate::watch::{WINDOWS_EACH, fine_times};
use poinsot::Error;
use poinsot_formats::LimitUseFile;
use poinsot_model::Model;
use poinsot_solve::Reached;
use rayon::prelude::*;

/// Vehicles of the prior that must hold the limits that depend on the vehicle. The search adapts to those that it meets: with up
/// to 39 vehicles on a limit at its end, 99 % of the prior holds it with probability 95 % (Campi and Garatti 2008).
const VEHICLES: u64 = 5000;
/// Largest number of rounds that each add the vehicles that exceed a limit most.
const ROUNDS: usize = 8;
/// Factors on a manoeuvre that exceeds a limit for some vehicle.
const SHARES: [f64; 16] = [
    1.0, 0.9995, 0.998, 0.995, 0.99, 0.98, 0.97, 0.96, 0.94, 0.92, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5,
];
/// Tolerance on a limit, relative: the integration error.
const HELD: f64 = 1.0e-6;
/// First random stream of the vehicles that check margins; lower streams belong to robust designs.
const MARGIN_STREAM: u64 = 1 << 32;

/// How far a manoeuvre goes towards one watched limit, relative to it; positive beyond.
#[derive(Debug, Clone)]
struct Nearest {
    /// Value of the nominal vehicle that is nearest to the limit.
    value: f64,
    /// The nominal vehicle, on a grid finer than the rows.
    nominal: f64,
    /// What that grid shows beyond the rows.
    between: f64,
    /// In each part of the manoeuvre, the worst of the vehicles of the prior, and its number.
    worst: [Option<(f64, u64)>; WINDOWS_EACH],
}

impl Nearest {
    /// The largest, values between rows included.
    fn beyond(&self) -> f64 {
        let worst = self.worst.iter().flatten().map(|w| w.0 + self.between);
        worst.fold(self.nominal, f64::max)
    }

    /// The vehicles that exceed the limit most in some part of the manoeuvre.
    fn critical(&self) -> Vec<u64> {
        let worst = self.worst.iter().flatten();
        let beyond = worst.filter(|w| w.0 + self.between > HELD);
        beyond.map(|w| w.1).collect()
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
        for _ in 0..ROUNDS {
            if question.watch.watched.is_empty() || !self.tightened(question, space, &reached.x)? {
                break;
            }
            let program = Program::last(question, space);
            let shorter = SHARES.map(|share| reached.x.iter().map(|x| share * x).collect());
            let part = match question.vehicles.is_empty() {
                true => self.design.evaluations / ROUNDS,
                false => self.design.evaluations / ROBUST_PART,
            };
            let mut budget = part.max(FEW_STEPS * (space.len() + 2));
            let from = evaluated(&program, shorter.to_vec(), &mut budget);
            let Some(from) = from.first().map(|search| &search.reached.x) else {
                break;
            };
            let Some(better) = refine(question, space, from, budget) else {
                break;
            };
            *reached = better;
        }
        Ok(())
    }

    /// Adds what this manoeuvre lacks to hold the limits: critical vehicles, and margins for values between rows and for what
    /// the search did not resolve. Whether anything was added.
    fn tightened(&self, question: &mut Question, space: &Space, x: &[f64]) -> Result<bool, Error> {
        let nearest = self.nearest(question, space, x)?;
        let is_beyond = |n: &Nearest| n.beyond() > HELD;
        for (limit, found) in nearest.iter().enumerate().filter(|(_, n)| is_beyond(n)) {
            let mut is_new = false;
            for number in found.critical() {
                let same = |c: &Critical| c.limit == limit && c.number == number;
                if !question.critical.iter().any(same) {
                    is_new = true;
                    question.critical.push(Critical {
                        model: self.of_prior(number),
                        number,
                        limit,
                    });
                }
            }
            let margin = &mut question.margins[limit];
            *margin = match is_new || found.between > *margin {
                true => margin.max(found.between),
                false => *margin + found.beyond(),
            };
        }
        let added = nearest.iter().any(is_beyond);
        if added {
            question.forget_best();
        }
        Ok(added)
    }

    /// The manoeuvre, or its largest fraction in [`SHARES`] that holds every limit on the fine grid, and its uses.
    pub fn held(
        &self,
        question: &Question,
        space: &Space,
        x: Vec<f64>,
    ) -> Result<(Vec<f64>, Vec<LimitUseFile>), Error> {
        for share in SHARES {
            let nearer: Vec<f64> = x.iter().map(|x| share * x).collect();
            let uses = self.uses(question, space, &nearer)?;
            if uses.iter().all(|u| u.margin >= -HELD) {
                return Ok((nearer, uses));
            }
        }
        let uses = self.uses(question, space, &x)?;
        Ok((x, uses))
    }

    /// A vehicle that checks the limits.
    fn of_prior(&self, number: u64) -> Model {
        drawn(self.model, self.design.seed, MARGIN_STREAM + number)
    }

    /// How far the manoeuvre goes towards each watched limit, by the vehicles of the prior as well.
    fn nearest(
        &self,
        question: &Question,
        space: &Space,
        x: &[f64],
    ) -> Result<Vec<Nearest>, Error> {
        let Some(scenario) = question.scenario(space, x) else {
            return Ok(Vec::new());
        };
        let mut case = self.case.clone();
        case.duration_s = space.record();
        let mut dense = scenario.clone();
        dense.times = fine_times(&case);
        let of = |scenario| -> Result<Vec<(f64, f64)>, Error> {
            let course = question.course(self.model, scenario)?;
            Ok(course.worst(&question.watch))
        };
        let mut all: Vec<Nearest> = of(&dense)?
            .into_iter()
            .zip(of(&scenario)?)
            .map(merged)
            .collect();
        let numbers = if has_prior(self.model) { VEHICLES } else { 0 };
        let flights: Result<Vec<_>, Error> = (0..numbers)
            .into_par_iter()
            .map(|number| {
                let course = question.course(&self.of_prior(number), &scenario)?;
                Ok((number, course.windows(&question.watch)))
            })
            .collect();
        for (number, flight) in flights? {
            for (own, windows) in all.iter_mut().zip(flight.chunks(WINDOWS_EACH)) {
                for (worst, beyond) in own.worst.iter_mut().zip(windows) {
                    if worst.is_none_or(|w| *beyond > w.0) {
                        *worst = Some((*beyond, number));
                    }
                }
            }
        }
        Ok(all)
    }

    /// Use of every limit, by the vehicles of the prior as well, on a finer grid than in the search.
    ///
    /// # Errors
    /// A vehicle cannot fly the manoeuvre.
    pub fn uses(
        &self,
        question: &Question,
        space: &Space,
        x: &[f64],
    ) -> Result<Vec<LimitUseFile>, Error> {
        let mut all = linear_uses(self.model, space, x);
        if question.watch.watched.is_empty() {
            return Ok(all);
        }
        let watched = question.watch.watched.iter();
        let nearest = self.nearest(question, space, x)?;
        // A plume has no value if its thruster never fires.
        let known = watched.zip(nearest).filter(|(_, n)| n.value.is_finite());
        all.extend(known.map(|(w, n)| {
            LimitUseFile::new(w.what.clone(), w.unit, n.value, w.limit, -n.beyond())
        }));
        Ok(all)
    }
}

/// Value and excess of one limit on the fine grid and on the rows.
fn merged((fine, rows): ((f64, f64), (f64, f64))) -> Nearest {
    Nearest {
        value: fine.0,
        nominal: fine.1,
        between: (fine.1 - rows.1).max(0.0),
        worst: [None; WINDOWS_EACH],
    }
}
