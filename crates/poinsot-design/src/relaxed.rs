//! What a limit would give if it were relaxed: where something wanted is not reached, the reader learns what to change.

use crate::design::{Asked, FEW_STEPS};
use crate::result::{LimitUse, Relaxed};
use crate::search::refine;
use crate::shape::Space;
use poinsot::case::{Design, Limits, Objective};

/// Factor on a limit that is relaxed.
const RELAXED: f64 = 1.25;

impl Asked<'_> {
    /// What each kind of active limit would give if it were relaxed, and a longer time.
    pub fn relaxed(&self, space: &Space, x: &[f64], uses: &[LimitUse]) -> Vec<Relaxed> {
        let mut out = Vec::new();
        for group in GROUPS {
            let active = |u: &LimitUse| u.is_active() && u.what.starts_with(group.starts);
            let names_time = group.starts.is_empty();
            if !names_time && !uses.iter().any(active) {
                continue;
            }
            let mut limits = self.limits.clone();
            (group.relax)(&mut limits);
            let factor = if names_time { RELAXED } else { 1.0 };
            let ratio = self.ratio_with(&limits, factor * space.duration, x);
            if let Some(ratio) = ratio {
                out.push(Relaxed {
                    what: group.words.to_owned(),
                    factor: RELAXED,
                    ratio,
                });
            }
        }
        out
    }

    fn ratio_with(&self, limits: &Limits, duration: f64, x: &[f64]) -> Option<f64> {
        let space = Space::new(&self.design, limits, duration).ok()?;
        let design = Design {
            robust: false,
            objective: Objective::WorstRatio,
            ..self.design.clone()
        };
        let question = self.question(design, limits).ok()?;
        let budget = FEW_STEPS * (space.len() + 2);
        let reached = refine(&question, &space, x, budget)?;
        Some(reached.values.worst().exp())
    }
}

/// Limits that are relaxed together; the duration has no name among the uses.
struct Group {
    words: &'static str,
    starts: &'static str,
    relax: fn(&mut Limits),
}

const GROUPS: [Group; 7] = [
    Group {
        words: "joint positions",
        starts: "position of",
        relax: |l| {
            for j in &mut l.joints {
                j.position = (RELAXED * j.position.0, RELAXED * j.position.1);
            }
        },
    },
    Group {
        words: "joint rates",
        starts: "rate of",
        relax: |l| l.joints.iter_mut().for_each(|j| j.rate *= RELAXED),
    },
    Group {
        words: "joint accelerations",
        starts: "acceleration of",
        relax: |l| l.joints.iter_mut().for_each(|j| j.acceleration *= RELAXED),
    },
    Group {
        words: "wheel speeds",
        starts: "speed of",
        relax: |l| l.wheels.iter_mut().for_each(|w| w.speed *= RELAXED),
    },
    Group {
        words: "torques",
        starts: "torque of",
        relax: |l| {
            l.joints.iter_mut().for_each(|j| j.effort *= RELAXED);
            l.wheels.iter_mut().for_each(|w| w.torque *= RELAXED);
        },
    },
    Group {
        words: "body rate",
        starts: "body rate",
        relax: |l| l.body_rate *= RELAXED,
    },
    Group {
        words: "duration",
        starts: "",
        relax: |_| {},
    },
];
