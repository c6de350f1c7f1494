//! Use of the limits by a manoeuvre, and the margins needed by the vehicles of the prior.

use crate::design::{Asked, FEW_STEPS};
use crate::mover::{Order, Target};
use crate::result::LimitUse;
use crate::search::{last_rows, refine};
use crate::shape::{Space, Use};
use crate::trial::Question;
use crate::vehicles::{drawn, has_prior};
use crate::watch::fine_times;
use poinsot::Error;
use poinsot_model::Model;
use poinsot_solve::Reached;
use rayon::prelude::*;

/// Vehicles of the prior that must hold the limits that depend on the vehicle. If all do, 99 % of the prior does with
/// probability 95 % (`0.99^300 = 0.05`).
const VEHICLES: u64 = 300;
/// Largest number of rounds that adjust the margins.
const MARGIN_ROUNDS: usize = 3;
/// Factors on a manoeuvre, tried where a limit is exceeded by less than the search resolves.
const SHARES: [f64; 7] = [1.0, 0.9995, 0.998, 0.995, 0.99, 0.98, 0.95];
/// Tolerance on a limit, relative: the integration error.
const HELD: f64 = 1.0e-6;
/// First random stream of the vehicles that check margins; lower streams belong to robust designs.
const MARGIN_STREAM: u64 = 1 << 32;

impl Asked<'_> {
    /// Repeats the search with larger margins until the vehicles of the prior hold the limits.
    pub fn leave_margins(&self, question: &mut Question, space: &Space, reached: &mut Reached) {
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
            if let Some(better) = refine(question, (space, last_rows(question)), &reached.x, budget)
            {
                *reached = better;
            }
        }
    }

    /// The manoeuvre, or its largest fraction in [`SHARES`] that holds every limit on the fine grid.
    pub fn held(&self, question: &Question, space: &Space, x: Vec<f64>) -> Result<Vec<f64>, Error> {
        for share in SHARES {
            let nearer: Vec<f64> = x.iter().map(|x| share * x).collect();
            let uses = self.uses(question, space, &nearer)?;
            if uses.iter().all(|u| u.margin >= -HELD) {
                return Ok(nearer);
            }
        }
        Ok(x)
    }

    /// Excess of each watched limit: between the rows of a candidate, and for the vehicles of the prior.
    fn excess(&self, question: &Question, space: &Space, x: &[f64]) -> Option<Vec<(f64, f64)>> {
        let scenario = question.candidate((space, last_rows(question)), x)?;
        let worst = |model: &Model| -> Option<Vec<f64>> {
            let course = question.course(model, &scenario).ok()?;
            Some(course.worst(&question.watch).iter().map(|w| w.1).collect())
        };
        let nominal = worst(self.model)?;
        let fine = self.fine(question, space, x).ok()??;
        let mut between = vec![0.0_f64; nominal.len()];
        for ((b, fine), nominal) in between.iter_mut().zip(&fine).zip(&nominal) {
            // The last steps had other rows, which may have missed what these exceed.
            *b = (fine.1 - nominal.min(0.0)).max(0.0);
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

    /// For each watched limit: the value nearest to it and its relative excess, on a grid finer than the rows of the
    /// case.
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

    /// Use of every limit, on a finer grid than in the search.
    pub fn uses(
        &self,
        question: &Question,
        space: &Space,
        x: &[f64],
    ) -> Result<Vec<LimitUse>, Error> {
        let mut all = space.valves.uses(x, |k| self.name(Target::Thruster(k)));
        for u in space.uses(x) {
            all.push(self.linear_use(space, &u));
        }
        if question.watch.watched.is_empty() {
            return Ok(all);
        }
        if let Some(worst) = self.fine(question, space, x)? {
            let margins = question.watch.watched.iter().zip(&question.prior_margins);
            // A plume has no value if its thruster never fires.
            let known = margins
                .zip(worst)
                .filter(|(_, (value, _))| value.is_finite());
            for ((w, margin), (value, beyond)) in known {
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
