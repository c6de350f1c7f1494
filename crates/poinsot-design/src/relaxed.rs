//! Effect of a relaxed limit or longer duration, computed if a wanted sigma is not reached, and the front on request.

use crate::design::{Asked, FEW_STEPS};
use crate::search::refine;
use crate::shape::Space;
use crate::trial::{Question, Rows};
use poinsot::Error;
use poinsot::case::{Limits, Objective};
use poinsot_formats::{LimitUseFile, RelaxedFile};

/// Factor on a relaxed limit.
const RELAXED: f64 = 1.25;
/// Factors on the limit of a front, starting next to the case's limit on each side.
const FRONT: [&[f64]; 2] = [&[0.8, 0.65, 0.5], &[1.25, 1.5, 2.0]];

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
        let of = |group: &Group| Some(self.with(group, RELAXED, own, x)?.0);
        GROUPS.iter().filter(is_active).filter_map(of).collect()
    }

    /// The group of limits of a front.
    ///
    /// # Errors
    /// No group has this name.
    pub fn group(what: &str) -> Result<&'static Group, Error> {
        let found = GROUPS.iter().find(|g| g.words.replace(' ', "-") == what);
        found.ok_or_else(|| {
            let known: Vec<String> = GROUPS.iter().map(|g| g.words.replace(' ', "-")).collect();
            Error::usage(
                "--front",
                what,
                "no such limit",
                format!("use one of {}", known.join(", ")),
            )
        })
    }

    /// Largest ratio with one kind of limit tighter and looser than in the case. Each point starts from its neighbour.
    pub fn front(
        &self,
        group: &Group,
        (question, space): (&Question, &Space),
        x: &[f64],
        ratio: f64,
    ) -> Vec<RelaxedFile> {
        let own = (question, space);
        let mut all = vec![RelaxedFile {
            what: group.words.to_owned(),
            factor: 1.0,
            worst_ratio: ratio,
        }];
        for factors in FRONT {
            let mut from = x.to_vec();
            for factor in factors {
                let Some((point, next)) = self.with(group, *factor, own, &from) else {
                    break;
                };
                all.push(point);
                from = next;
            }
        }
        all.sort_by(|a, b| a.factor.total_cmp(&b.factor));
        all
    }

    /// Largest ratio with a limit scaled by a factor, and the free numbers in the units of the case's space, as are those
    /// from which it starts; `None` if no manoeuvre holds the limits.
    fn with(
        &self,
        group: &Group,
        factor: f64,
        (own, of_own): (&Question, &Space),
        from: &[f64],
    ) -> Option<(RelaxedFile, Vec<f64>)> {
        let mut limits = self.limits.clone();
        (group.relax)(&mut limits, factor);
        let of_time = if group.starts.is_empty() { factor } else { 1.0 };
        // What is flown next has its time.
        if group.starts.is_empty() && self.design.window.until.is_some() {
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
        let reached = refine(&question, (&space, Rows::Share(1.0)), &from, budget)?;
        (reached.values.broken() <= BROKEN).then(|| {
            let point = RelaxedFile {
                what: group.words.to_owned(),
                factor,
                worst_ratio: reached.values.worst().exp(),
            };
            (point, space.converted(&reached.x, of_own))
        })
    }
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
