//! What wheels do between their samples: three hypotheses, and what the answer owes to the choice.
//!
//! The torque of a wheel is constant between samples, or its speed is smooth, or, where these two differ, its torque is a
//! process (`wheel_torque.rs`). Which of them is the best one is decided by the data. Where they can hardly tell, the answer may be that of the wrong one: its second moment about the truth is
//! `C + p d d^T`, with p the probability of the other hypothesis and d the way from this answer to the other one. p is
//! `1 / (1 + exp(D / 2))` with D the difference of -2 ln L at both minima, where both were as probable before the data.

use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::momentum_state::{Fitted, fit_from, fit_on};
use crate::fit::step::{ITERATIONS, Linearisation, moved};
use crate::fit::wheel_torque::{RandomTorque, TorqueChanges};
use crate::problem::Problem;
use crate::problem::parameters::{Parameters, Unknown};
use poinsot_solve::{LeastSquares, Linearised};
use statrs::distribution::{ContinuousCDF, Normal};

/// Change of the answer between two hypotheses, sigmas, from which the torque is fitted as a process: a smaller one adds less
/// than 5 % to an error.
pub(crate) const MATTERS: f64 = 0.3;

/// What wheels do between their samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BetweenSamples {
    /// The torque is constant.
    Held,
    /// The speed is smooth.
    Smooth,
    /// The torque changes at random, by as much as the samples tell.
    RandomTorque,
}

impl BetweenSamples {
    /// As an assumption of an answer.
    pub fn words(self) -> &'static str {
        match self {
            Self::Held => "wheel torque constant between samples (zero-order hold)",
            Self::Smooth => "wheel speed smooth between samples",
            Self::RandomTorque => "wheel torque changes at random, also between samples",
        }
    }
}

/// The hypothesis that the answer does not assume.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct OtherWheelMotion {
    /// How probable it is.
    pub probability: f64,
    /// Way from the answer to the one with it, over all unknowns.
    pub step: Vec<f64>,
    /// Its length in the mass properties, sigmas; an answer says it, a prediction does not.
    pub shift: f64,
    /// What it adds to the variance along the step, relative to that of noise as large as the residual; for an answer.
    pub added: f64,
}

impl OtherWheelMotion {
    /// What the choice adds to the covariance of two numbers, of which these are the changes along the step.
    pub fn covariance(&self, a: f64, b: f64) -> f64 {
        self.probability * a * b
    }

    /// Change along the step of a number with this gradient.
    pub fn change(&self, gradient: &[f64]) -> f64 {
        gradient.iter().zip(&self.step).map(|(g, s)| g * s).sum()
    }

    /// The same in a wider set of unknowns: those that are new do not change.
    pub fn among(mut self, own: &Parameters, all: &Parameters) -> Self {
        let of = |unknown: &Unknown| own.place(&unknown.kind).and_then(|k| self.step.get(k));
        let step = |unknown: &Unknown| of(unknown).copied().unwrap_or(0.0);
        self.step = all.unknowns.iter().map(step).collect();
        self
    }
}

/// The better of the two hypotheses.
pub(crate) struct WheelMotion {
    pub fitted: Fitted,
    /// Change of the mass properties with the other hypothesis, sigmas.
    pub shift: f64,
    /// `None` where a fit did not converge.
    pub other: Option<OtherWheelMotion>,
}

/// The data decide between both hypotheses. The difference of both answers shows whether the wheels are sampled often enough.
pub(crate) fn choose_wheel_motion(experiment: &mut Experiment, held: Fitted) -> WheelMotion {
    let cost = experiment.cost_of(&held);
    experiment.wheels_smooth = true;
    let Some(smooth) = experiment.linearise(&held.at) else {
        experiment.wheels_smooth = false;
        return WheelMotion {
            shift: sparse_wheel_shift(experiment, &held),
            fitted: held,
            other: None,
        };
    };
    // One linearisation at the end of the first shows whether the second can be better.
    let promising = least(&smooth) < cost;
    let other = held
        .converged
        .then(|| other(experiment, &held, cost, &smooth));
    let better = |found: &Fitted| experiment.cost_of(found) < cost;
    let found = promising.then(|| fit_on(experiment, held.at.clone(), smooth, ITERATIONS));
    let Some(fitted) = found.flatten().filter(better) else {
        experiment.wheels_smooth = false;
        return WheelMotion {
            shift: shift_of(&other).max(sparse_wheel_shift(experiment, &held)),
            fitted: held,
            other,
        };
    };
    let cost = experiment.cost_of(&fitted);
    experiment.wheels_smooth = false;
    let there = experiment.linearise(&fitted.at);
    experiment.wheels_smooth = true;
    let other = there.map(|there| self::other(experiment, &fitted, cost, &there));
    WheelMotion {
        shift: shift_of(&other).max(sparse_wheel_shift(experiment, &fitted)),
        other: other.filter(|_| fitted.converged),
        fitted,
    }
}

/// An answer with the torque of the wheels as a process.
pub(crate) struct DrivenAtRandom<'a> {
    pub experiment: Experiment<'a>,
    pub fitted: Fitted,
    /// The hypothesis that it is preferred to.
    pub other: Option<OtherWheelMotion>,
}

/// The torque of the wheels as a process, where a fit without it would not be trusted, or the data prefer
/// changes at any time to changes at the samples alone. Both are processes, so that the tachometers judge them as well as all
/// other sensors.
pub(crate) fn random_torque(
    experiment: &Experiment,
    (fitted, trusted): (&Fitted, bool),
) -> Option<RandomTorque> {
    let problem = experiment.problem;
    let cost = |torque: &RandomTorque| {
        let problem = torque.problem(problem);
        let here = driven(experiment, &problem).linearise(&fitted.at)?;
        Some(least(&here) + torque.deviance)
    };
    let anywhere = RandomTorque::new(problem, TorqueChanges::Anywhere)?;
    if !trusted {
        return Some(anywhere);
    }
    let held = RandomTorque::new(problem, TorqueChanges::AtSamples)?;
    (cost(&anywhere)? < cost(&held)?).then_some(anywhere)
}

/// The experiment with wheels that run straight from change to change of their torque.
fn driven<'a>(experiment: &Experiment<'a>, problem: &'a Problem<'a>) -> Experiment<'a> {
    let mut new = Experiment::new(problem, experiment.parameters);
    (new.settings, new.rest_motion) = (experiment.settings, experiment.rest_motion);
    new
}

/// The fit with the torque of the wheels as a process, from the end of another one; `None` where that is no better.
pub(crate) fn fit_random_torque<'a>(
    experiment: &Experiment<'a>,
    problem: &'a Problem<'a>,
    fitted: &Fitted,
) -> Option<DrivenAtRandom<'a>> {
    let new = driven(experiment, problem);
    let found = fit_from(&new, fitted.at.clone(), ITERATIONS).filter(|f| f.converged)?;
    let cost = new.cost_of(&found);
    if cost >= experiment.cost_of(fitted) {
        return None;
    }
    let there = experiment.linearise(&found.at);
    let other = there.map(|there| other(experiment, &found, cost, &there));
    Some(DrivenAtRandom {
        experiment: new,
        fitted: found,
        other,
    })
}

fn shift_of(other: &Option<OtherWheelMotion>) -> f64 {
    other.as_ref().map_or(0.0, |o| o.shift)
}

/// -2 ln L at the end of a full step.
fn least(here: &Linearised<Linearisation>) -> f64 {
    here.cost - here.predicted_reduction
}

/// The other hypothesis, linearised where the fit with the assumed one ended at this cost.
fn other(
    experiment: &Experiment,
    fitted: &Fitted,
    cost: f64,
    there: &Linearised<Linearisation>,
) -> OtherWheelMotion {
    // Where the residual is larger than declared, so is its difference.
    let rows: usize = fitted.evaluated.iter().map(|e| e.rows).sum();
    let chi2: f64 = fitted.evaluated.iter().map(|e| e.chi2).sum();
    let misfit = (chi2 / rows.max(1) as f64).max(1.0);
    let worse = (least(there) - cost).max(0.0) / misfit;
    let probability = 1.0 / (1.0 + (0.5 * worse).exp());
    let shift = there.rows.mass_shift();
    OtherWheelMotion {
        probability,
        step: step(experiment, &fitted.at, &there.rows),
        shift,
        added: probability * shift * shift / misfit,
    }
}

/// The full step in all unknowns.
fn step(experiment: &Experiment, at: &Iterate, there: &Linearisation) -> Vec<f64> {
    let mass = there.spectrum.damped(&there.shared.rhs(), 0.0);
    let end = moved(experiment, at, there.parts(), &mass);
    end.x.iter().zip(&at.x).map(|(a, b)| a - b).collect()
}

/// What a prediction expects of the choice: measurements without noise, of a vehicle with these unknowns. The difference
/// of -2 ln L of noisy ones then scatters about its value D here with a sigma of 2 sqrt(D).
pub(crate) fn expected_other(experiment: &Experiment, at: &Iterate) -> Option<OtherWheelMotion> {
    if !experiment.problem.assumes_wheel_motion() {
        return None;
    }
    let mut both = experiment.of_vehicle(experiment.problem, experiment.parameters);
    let [held, smooth] = [false, true].map(|smooth| {
        both.wheels_smooth = smooth;
        both.linearise(at)
    });
    let (held, smooth) = (held?, smooth?);
    let difference = least(&held) - least(&smooth);
    let far = (0.5 * difference.abs().sqrt()).min(f64::MAX);
    let [a, b] = [&held, &smooth].map(|h| step(&both, at, &h.rows));
    Some(OtherWheelMotion {
        probability: Normal::standard().cdf(-far),
        step: a.iter().zip(&b).map(|(a, b)| a - b).collect(),
        ..OtherWheelMotion::default()
    })
}

/// Change of the answer if sparsely sampled wheels have smooth instead of linear speeds between samples.
fn sparse_wheel_shift(experiment: &Experiment, fitted: &Fitted) -> f64 {
    let mut segments = experiment.problem.segments.iter();
    if !fitted.converged || segments.all(|s| s.observations.smooth_wheel_speed.is_empty()) {
        return 0.0;
    }
    let mut segments = experiment.problem.segments.to_vec();
    for segment in &mut segments {
        let o = &mut segment.observations;
        if o.smooth_wheel_speed.len() == o.wheel_speed.len() {
            o.wheel_speed = std::mem::take(&mut o.smooth_wheel_speed);
        }
    }
    let problem = Problem {
        segments: &segments,
        ..*experiment.problem
    };
    let mut other = experiment.with_problem(&problem);
    other.wheels_smooth = true;
    let here = other.linearise(&fitted.at);
    here.map_or(0.0, |here| here.rows.mass_shift())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By noise, the difference of -2 ln L scatters about D with a sigma of 2 sqrt(D). The probability that an answer states
    /// for the hypothesis which it did not choose is, in the mean, how often the wrong one is chosen: what a prediction states.
    #[test]
    fn exact_the_mean_stated_probability_is_how_often_the_choice_is_wrong() {
        let normal = Normal::standard();
        for far in [0.01, 0.3, 1.0, 2.5, 5.0] {
            let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            let stated = |z: f64| {
                let difference = far * far + 2.0 * far * z;
                density(z) / (1.0 + (0.5 * difference.abs()).exp())
            };
            let (step, count) = (1.0e-4, 100_000);
            let sum: f64 = (-count..=count).map(|k| stated(f64::from(k) * step)).sum();
            let wrong = normal.cdf(-0.5 * far);
            assert!(
                (sum * step - wrong).abs() < 1.0e-6,
                "{far}: {} {wrong}",
                sum * step
            );
        }
    }
}
