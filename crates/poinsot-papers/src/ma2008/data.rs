//! Input of the method from a problem: requirements and samples.

use super::arm::Raw;
use super::equations::Given;
use super::increments::relative;
use crate::ma2008::error;
use crate::method::Named;
use poinsot_files::Faults;
use poinsot_identify::{Problem, Segment};
use poinsot_model::{EstimateSet, MomentumKnowledge};
use poinsot_spatial::Matrix3;

/// Option for both steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Option 1 for linear momentum, angular momentum or both, as given in the model.
    KnownMomentum,
    /// Option 2: both momenta are eliminated by differences.
    UnknownMomentum,
}

impl Named for Variant {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (
            Self::UnknownMomentum,
            "unknown-momentum",
            "option 2: increments eliminate the momentum",
        ),
        (
            Self::KnownMomentum,
            "known-momentum",
            "option 1: the model gives linear or angular momentum, or both",
        ),
    ];
}

/// The momentum that the variant takes as known, or why the method cannot be applied.
pub(super) fn check(problem: &Problem, variant: Variant) -> Result<Given, Faults> {
    let model = problem.model;
    if let Some(body) = model.bodies.iter().skip(1).find(|b| b.estimate.any()) {
        let body = body.name.clone();
        return Err(error::unknown_arm(&body));
    }
    let base = model.bodies.first().map(|b| (b.name.clone(), b.estimate));
    let (base, asked) = base.unwrap_or_default();
    if asked != EstimateSet::ALL {
        return Err(error::base_partly_known(&base));
    }
    let arm: f64 = model.bodies.iter().skip(1).map(|b| b.nominal.mass).sum();
    if arm.is_nan() || arm <= 0.0 {
        return Err(error::no_arm(&base));
    }
    if let Some(wheel) = model.wheels.iter().find(|w| w.estimate) {
        let wheel = wheel.name.clone();
        return Err(error::unknown_wheel(&wheel));
    }
    let needed = match variant {
        Variant::KnownMomentum => 2,
        Variant::UnknownMomentum => 3,
    };
    for segment in problem.segments {
        let label = segment.label.clone();
        let samples = segment.samples.time_s.len();
        if !segment.firings.is_empty() {
            return Err(error::thrust(&label));
        }
        if samples < needed {
            return Err(error::too_few_samples(
                &label,
                samples,
                needed,
                variant.name(),
            ));
        }
    }
    if variant == Variant::UnknownMomentum {
        return Ok(Given::default());
    }
    let pick = |k: MomentumKnowledge| match k {
        MomentumKnowledge::Known(value) => Some(value),
        MomentumKnowledge::Estimate => None,
    };
    let given = Given {
        p_C_N: pick(model.momentum.linear),
        h_C_N: pick(model.momentum.angular),
    };
    match given == Given::default() {
        true => Err(error::momentum_unknown()),
        false => Ok(given),
    }
}

/// Samples of a segment, and the covariance per interval if velocity is summed from increments.
pub(super) fn raws(
    problem: &Problem,
    segment: &Segment,
    given: &Given,
) -> Result<(Vec<Raw>, Option<Matrix3>), Faults> {
    let s = &segment.samples;
    let summed = match (&s.translation, given.p_C_N) {
        (None, None) => relative(segment),
        _ => None,
    };
    let velocity = |k: usize| match (&s.translation, &summed) {
        (Some(t), _) => Some(t.v_NBo_N[k]),
        (None, Some(relative)) => relative.velocity[k],
        (None, None) => None,
    };
    let (dof, wheels) = (problem.tree.dof(), problem.tree.rotors.len());
    let row = |list: &[f64], k: usize, n: usize| list[k * n..(k + 1) * n].to_vec();
    let raws: Vec<Raw> = (0..s.time_s.len())
        .filter_map(|k| {
            Some(Raw {
                R_NB: s.R_NB[k],
                v_NBo_N: velocity(k)?,
                w_NB_B: s.w_NB_B[k],
                q: row(&s.joint_position, k, dof),
                rates: row(&s.joint_rate, k, dof),
                wheel_speed: row(&s.wheel_speed, k, wheels),
            })
        })
        .collect();
    if raws.len() < 2 {
        let label = segment.label.clone();
        return Err(error::no_velocity(&label));
    }
    Ok((raws, summed.map(|r| r.step)))
}
