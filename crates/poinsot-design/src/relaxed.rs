//! Effect of a relaxed limit or longer duration, computed if a wanted sigma is not reached, and the front on request.

use crate::design::{Asked, FEW_STEPS};
use crate::search::{NEVER, refine};
use crate::shape::Space;
use crate::trial::Question;
use poinsot::Error;
use poinsot::case::{Limits, Objective};
use poinsot_formats::{FrontPointFile, LimitUseFile, RelaxedFile};
use std::cmp::Ordering;

/// Factor on a relaxed limit.
const RELAXED: f64 = 1.25;
/// Factors on the limit of a front, unless others are given.
const FRONT: [f64; 6] = [0.5, 0.65, 0.8, 1.25, 1.5, 2.0];

impl Asked<'_> {
    /// Largest ratio with each kind of active limit relaxed, and with a longer duration.
    pub fn relaxed(
        &self,
        question: &Question,
        space: &Space,
        x: &[f64],
        uses: &[LimitUseFile],
    ) -> Vec<RelaxedFile> {
        let is_active = |group: &&Group| {
            let own = |u: &LimitUseFile| group.starts.iter().any(|start| u.what.starts_with(start));
            group.starts.is_empty() || uses.iter().any(|u| u.active && own(u))
        };
        let own = (question, space);
        let of = |group: &Group| {
            Some(RelaxedFile {
                what: group.words.to_owned(),
                factor: RELAXED,
                worst_ratio: self.with(&[(group, RELAXED)], own, x)?.worst_ratio,
            })
        };
        GROUPS.iter().filter(is_active).filter_map(of).collect()
    }

    /// The limits of a front: `duration`, `wheel-speeds=0.5,1,2`.
    ///
    /// # Errors
    /// No group has this name, or a factor is not positive.
    pub fn front_limits(given: &[String]) -> Result<Vec<FrontLimit>, Error> {
        let one = |text: &String| {
            let (name, factors) = match text.split_once('=') {
                Some((name, values)) => (name, values.split(',').map(positive).collect()),
                None => (text.as_str(), Some(FRONT.to_vec())),
            };
            let problem = "the factors on a limit must be positive numbers";
            let advice = "give for example wheel-speeds=0.5,1,2";
            let factors = factors.ok_or_else(|| Error::usage("--front", text, problem, advice))?;
            let group = Self::group(name)?;
            Ok(FrontLimit { group, factors })
        };
        given.iter().map(one).collect()
    }

    fn group(what: &str) -> Result<&'static Group, Error> {
        let found = GROUPS.iter().find(|g| g.words.replace(' ', "-") == what);
        found.ok_or_else(|| {
            let known: Vec<String> = GROUPS.iter().map(|g| g.words.replace(' ', "-")).collect();
            let advice = format!("use one of {}", known.join(", "));
            Error::usage("--front", what, "no such limit", advice)
        })
    }

    /// Largest ratio at every combination of the factors on these limits. Each point starts from the nearest one that is done, and
    /// again from a better one within tighter limits, whose manoeuvre holds the looser ones.
    pub fn front(
        &self,
        limits: &[FrontLimit],
        own: (&Question, &Space),
        x: &[f64],
        ratio: f64,
    ) -> Vec<FrontPointFile> {
        let mut done = vec![Point {
            factors: vec![1.0; limits.len()],
            x: x.to_vec(),
            worst_ratio: ratio,
        }];
        let reach = |factors: &[f64], from: &Point| {
            let relaxed = limits.iter().map(|l| l.group).zip(factors.iter().copied());
            self.with(&relaxed.collect::<Vec<_>>(), own, &from.x)
        };
        for factors in combinations(limits) {
            let away = |p: &&Point| distance(&p.factors, &factors);
            let nearest = done.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let found = nearest.and_then(|from| reach(&factors, from));
            done.extend(found);
        }
        for k in 1..done.len() {
            let better = done.iter().filter(|p| p.dominates(&done[k]));
            let best = better.min_by(|a, b| a.worst_ratio.total_cmp(&b.worst_ratio));
            let again = best.and_then(|from| reach(&done[k].factors, from));
            if let Some(again) = again.filter(|p| p.worst_ratio < done[k].worst_ratio) {
                done[k] = again;
            }
        }
        let names = limits.iter().map(|l| l.group.words.to_owned());
        let file = |p: &Point| FrontPointFile {
            factors: names.clone().zip(p.factors.iter().copied()).collect(),
            worst_ratio: p.worst_ratio,
            dominated: done.iter().any(|other| other.dominates(p)),
        };
        let mut all: Vec<&Point> = done.iter().collect();
        all.sort_by(|a, b| a.factors.partial_cmp(&b.factors).unwrap_or(Ordering::Equal));
        all.into_iter().map(file).collect()
    }

    /// The point with limits scaled by factors, from free numbers in the units of the case's space; `None` if no manoeuvre holds
    /// the limits.
    fn with(
        &self,
        relaxed: &[(&Group, f64)],
        (own, of_own): (&Question, &Space),
        from: &[f64],
    ) -> Option<Point> {
        let mut limits = self.limits.clone();
        let mut of_time = 1.0;
        for (group, factor) in relaxed {
            (group.relax)(&mut limits, *factor);
            if group.starts.is_empty() {
                of_time *= factor;
            }
        }
        // What is flown next has its time.
        if of_time != 1.0 && self.design.window.until.is_some() {
            return None;
        }
        let times = (of_time * of_own.duration, of_own.rest);
        let space = Space::new(&self.design, &limits, times).ok()?;
        let mut question = self.question(&limits).ok()?;
        question.design.objective = Objective::WorstRatio;
        // The limits have other values, but the same order.
        question.margins.clone_from(&own.margins);
        question.critical.clone_from(&own.critical);
        let budget = FEW_STEPS * (space.len() + 2);
        let from = of_own.converted(from, &space);
        let reached = refine(&question, &space, &from, (budget, NEVER))?;
        (reached.values.broken() <= BROKEN).then(|| Point {
            factors: relaxed.iter().map(|r| r.1).collect(),
            x: space.converted(&reached.x, of_own),
            worst_ratio: reached.values.worst().exp(),
        })
    }
}

/// A limit of a front with the factors on it.
pub(crate) struct FrontLimit {
    group: &'static Group,
    factors: Vec<f64>,
}

/// A point of a front.
struct Point {
    /// Factor on each limit.
    factors: Vec<f64>,
    /// Free numbers, in the units of the case's space.
    x: Vec<f64>,
    worst_ratio: f64,
}

impl Point {
    /// Whether it is as good within tighter limits.
    fn dominates(&self, other: &Self) -> bool {
        let mut pairs = self.factors.iter().zip(&other.factors);
        let as_tight = pairs.all(|(a, b)| a <= b);
        as_tight && self.worst_ratio <= other.worst_ratio && self.factors != other.factors
    }
}

fn positive(text: &str) -> Option<f64> {
    let value: f64 = text.trim().parse().ok()?;
    (value.is_finite() && value > 0.0).then_some(value)
}

/// Every combination of factors, those next to the case first, without the case itself.
fn combinations(limits: &[FrontLimit]) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for limit in limits {
        let longer = |begun: &Vec<f64>| {
            let ends = limit.factors.iter();
            ends.map(|f| [begun.as_slice(), &[*f]].concat())
                .collect::<Vec<_>>()
        };
        all = all.iter().flat_map(longer).collect();
    }
    let of_case = vec![1.0; limits.len()];
    all.retain(|factors| *factors != of_case);
    all.sort_by(|a, b| distance(a, &of_case).total_cmp(&distance(b, &of_case)));
    all
}

/// Distance in logarithms.
fn distance(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a / b).ln().abs()).sum()
}

/// Allowed violation of a limit in a comparison, because its search stops early.
const BROKEN: f64 = 0.01;

/// Limits that are relaxed together.
pub(crate) struct Group {
    words: &'static str,
    /// Prefixes of the names of their uses; none for the duration.
    starts: &'static [&'static str],
    relax: fn(&mut Limits, f64),
}

static GROUPS: [Group; 11] = [
    Group {
        words: "joint positions",
        starts: &["position of"],
        relax: |l, f| {
            for j in &mut l.joints {
                j.position = (f * j.position.0, f * j.position.1);
            }
        },
    },
    Group {
        words: "joint rates",
        starts: &["rate of"],
        relax: |l, f| l.joints.iter_mut().for_each(|j| j.rate *= f),
    },
    Group {
        words: "joint accelerations",
        starts: &["acceleration of"],
        relax: |l, f| l.joints.iter_mut().for_each(|j| j.acceleration *= f),
    },
    Group {
        words: "wheel speeds",
        starts: &["speed of"],
        relax: |l, f| l.wheels.iter_mut().for_each(|w| w.speed *= f),
    },
    Group {
        words: "torques",
        starts: &["torque of"],
        relax: |l, f| {
            l.joints.iter_mut().for_each(|j| j.effort *= f);
            l.wheels.iter_mut().for_each(|w| w.torque *= f);
        },
    },
    Group {
        words: "body rate",
        starts: &["body rate"],
        relax: |l, f| l.body_rate *= f,
    },
    Group {
        words: "cones",
        starts: &["angle of cone"],
        relax: |l, f| {
            for c in &mut l.cones {
                c.half_angle = match c.keep_in {
                    true => (f * c.half_angle).min(std::f64::consts::PI),
                    false => c.half_angle / f,
                };
            }
        },
    },
    Group {
        words: "clearance",
        starts: &["distance of", "plume of"],
        relax: |l, f| l.clearance /= f,
    },
    Group {
        words: "shortest firing",
        starts: &["firing of", "pause of"],
        relax: |l, f| {
            for t in &mut l.thrusters {
                t.minimum_on /= f;
                t.minimum_off /= f;
            }
        },
    },
    Group {
        words: "propellant",
        starts: &["impulse of", "propellant of"],
        relax: |l, f| l.impulses.iter_mut().for_each(|i| i.impulse *= f),
    },
    Group {
        words: "duration",
        starts: &[],
        relax: |_, _| {},
    },
];
