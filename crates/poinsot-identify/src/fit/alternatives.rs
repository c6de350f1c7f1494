//! Alternatives of what inputs do between their samples: their fits, the choice, and what the answer owes to it.
//!
//! The torque of a wheel is constant between samples, or its speed is smooth, or, where these two differ, its torque is a
//! process (`wheel_torque.rs`). The likelihood decides. Where it can hardly tell two motions of the wheels apart, the
//! answer may be that of the wrong one: its second moment about the truth is `C + p d d^T`, with p the probability of the other
//! one and d the way from this answer to the other one. p is `1 / (1 + exp(D / 2))` with D the difference of -2 ln L at both
//! minima, where both were as probable before the data.

use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::momentum_state::{Fitted, fit_from, fit_on};
use crate::fit::sampled_motion::Changes;
use crate::fit::search::{fit, fit_about_smoothed};
use crate::fit::smoothed_inputs::{SmoothedInputs, is_biased};
use crate::fit::step::{ITERATIONS, Linearisation, moved};
use crate::fit::step_error::{StepError, within_steps};
use crate::fit::wheel_torque::RandomTorque;
use crate::problem::Problem;
use crate::problem::alternative::BetweenSamples;
use crate::problem::parameters::{Parameters, Unknown};
use poinsot_solve::{LeastSquares, Linearised};
use statrs::distribution::{ContinuousCDF, Normal};

/// Change of the answer between two alternatives, sigmas, from which the torque is fitted as a process: a smaller one adds less
/// than 5 % to an error.
const MATTERS: f64 = 0.3;
/// Share of the variance from which the choice between two wheel motions is said.
const NOTED_SHARE: f64 = 0.02;

/// The wheel motion that the answer does not assume.
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
    /// The other one, linearised where the fit with the chosen one ended.
    fn new(fit: &AlternativeFit, there: &Linearised<Linearisation>) -> Self {
        let (experiment, fitted) = (&fit.experiment, &fit.fitted);
        // Where the residual is larger than declared, so is its difference.
        let misfit = (fitted.chi2() / fitted.rows().max(1) as f64).max(1.0);
        let worse = (least(there) - fit.cost()).max(0.0) / misfit;
        let probability = 1.0 / (1.0 + (0.5 * worse).exp());
        let shift = there.rows.mass_shift();
        Self {
            probability,
            step: step(experiment, &fitted.at, &there.rows),
            shift,
            added: probability * shift * shift / misfit,
        }
    }

    /// What a prediction expects of the choice: measurements without noise, of a vehicle with these unknowns. The difference
    /// of -2 ln L of noisy ones then scatters about its value D here with a sigma of 2 sqrt(D). `held` is the experiment there
    /// with constant torques of the wheels, `smooth` with smooth speeds.
    pub fn expected(
        (experiment, at): (&Experiment, &Iterate),
        held: &Linearised<Linearisation>,
        smooth: &Linearised<Linearisation>,
    ) -> Self {
        let difference = least(held) - least(smooth);
        let far = (0.5 * difference.abs().sqrt()).min(f64::MAX);
        let [a, b] = [held, smooth].map(|h| step(experiment, at, &h.rows));
        Self {
            probability: Normal::standard().cdf(-far),
            step: a.iter().zip(&b).map(|(a, b)| a - b).collect(),
            ..Self::default()
        }
    }

    /// What the choice adds to the covariance of two numbers, of which these are the changes along the step.
    pub fn covariance(&self, a: f64, b: f64) -> f64 {
        self.probability * a * b
    }

    /// What it adds to the variance of a number with this gradient.
    pub fn variance(&self, gradient: &[f64]) -> f64 {
        let change = self.change(gradient);
        self.covariance(change, change)
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

/// The fit of an alternative.
pub(crate) struct AlternativeFit<'a> {
    pub experiment: Experiment<'a>,
    pub fitted: Fitted,
    /// Change of the mass properties with another motion of the wheels, sigmas.
    pub shift: f64,
    /// The wheel motion to which it was preferred; `None` without a choice, or where a fit did not converge.
    pub other: Option<OtherWheelMotion>,
}

impl<'a> AlternativeFit<'a> {
    pub fn new(experiment: Experiment<'a>, fitted: Fitted) -> Self {
        Self {
            experiment,
            fitted,
            shift: 0.0,
            other: None,
        }
    }

    /// A fit that ends at no minimum replaces none that does.
    fn may_become(&self, other: &Fitted) -> bool {
        let [other, own] = [other, &self.fitted].map(|f| (f.is_found(), f.converged));
        other >= own
    }

    /// -2 ln L at its end, up to a constant.
    fn cost(&self) -> f64 {
        self.experiment.cost_of(&self.fitted)
    }

    /// The better of the fits with constant torque, which this is, and with smooth speeds. The difference of both answers shows
    /// whether the wheels are sampled often enough.
    pub fn or_smooth_wheels(mut self) -> Self {
        let smooth = with_smooth_wheels(&self.experiment);
        let Some(smooth) = smooth.filter(|_| self.fitted.is_found()) else {
            return self;
        };
        let cost = self.cost();
        // One linearisation at the end of the first shows whether the second can be better.
        let there = smooth.linearise(&self.fitted.at);
        let converged = there.as_ref().filter(|_| self.fitted.converged);
        self.other = converged.map(|there| OtherWheelMotion::new(&self, there));
        let promising = there.filter(|there| least(there) < cost);
        let found = promising.and_then(|t| fit_on(&smooth, self.fitted.at.clone(), t, ITERATIONS));
        let better = |found: &Fitted| smooth.cost_of(found) < cost && self.may_become(found);
        if let Some(fitted) = found.filter(better) {
            let there = self.experiment.linearise(&fitted.at);
            self = Self::new(smooth, fitted);
            self.other = there.map(|there| OtherWheelMotion::new(&self, &there));
        }
        let shift = self.other.as_ref().map_or(0.0, |other| other.shift);
        self.shift = shift.max(sparse_wheel_shift(&self.experiment, &self.fitted));
        self.other = self.other.filter(|_| self.fitted.converged);
        self
    }

    /// The torque of the wheels as a process, where it may change the answer, or where no fit along measured speeds converges or their
    /// noise would bias it. `explains` says whether a fit explains the record.
    pub fn wheel_process(&self, explains: impl Fn(&Fitted) -> bool) -> Option<RandomTorque> {
        let fitted = &self.fitted;
        let noisy = !fitted.converged
            || rounding_lasts(self.experiment.problem)
            || is_biased(&self.experiment, fitted) == Some(true);
        if self.shift <= MATTERS && !noisy {
            return None;
        }
        let trusted = explains(fitted) && !self.is_sensitive() && !noisy;
        random_torque(&self.experiment, fitted, trusted)
    }

    /// Whether it depends on how wheels run between samples that are rarer than those of other sensors.
    pub fn is_sensitive(&self) -> bool {
        let mut segments = self.experiment.problem.segments.iter();
        self.shift > self.experiment.settings.sensitivity_sigmas
            && segments.any(|s| s.observations.between_readings)
    }

    /// The better of this fit and the one with the records in which the torque of the wheels is a process; a misfit that the
    /// latter does not explain has another cause, which the diagnosis names.
    pub fn or_random_torque(
        self,
        driven: Option<&'a Problem<'a>>,
        explains: impl Fn(&Fitted) -> bool,
    ) -> Self {
        let found = driven.and_then(|driven| {
            let experiment = self.experiment.with_problem(driven);
            let experiment = experiment.under(BetweenSamples::RandomTorque);
            let fitted = match self.fitted.converged {
                true => fit_from(&experiment, self.fitted.at.clone(), ITERATIONS)?,
                false => fit(&experiment, None).ok()?,
            };
            Some(Self::new(experiment, fitted))
        });
        let better = |found: &Self| {
            let lower = !self.fitted.converged || found.cost() < self.cost();
            found.fitted.converged && lower
        };
        match found.filter(|found| better(found) && explains(&found.fitted)) {
            Some(mut found) => {
                let there = self.experiment.linearise(&found.fitted.at);
                found.other = there.map(|there| OtherWheelMotion::new(&found, &there));
                found
            }
            None => self,
        }
    }

    /// The same about smoothed inputs, where it does not converge along the measured ones, or their noise would bias it; a misfit is
    /// looked at along the inputs as they were measured.
    pub fn smoothed(
        &self,
        explains: impl Fn(&Fitted) -> bool,
        linear: Option<&Iterate>,
    ) -> Option<SmoothedInputs> {
        if !self.fitted.converged {
            return fit_about_smoothed(&self.experiment, linear);
        }
        let trusted = explains(&self.fitted);
        let found = trusted.then(|| SmoothedInputs::new(&self.experiment, &self.fitted));
        found.flatten()
    }

    /// The fit about smoothed inputs, which `problem` holds.
    pub fn about(self, smoothed: Option<(&'a Problem<'a>, Fitted)>) -> Self {
        match smoothed {
            Some((problem, fitted)) => Self {
                experiment: (self.experiment).of_vehicle(problem, self.experiment.parameters),
                fitted,
                ..self
            },
            None => self,
        }
    }

    /// The same with integration steps as fine as the answer needs, and the error that is left.
    pub fn within_steps(mut self) -> (Self, Option<StepError>) {
        let (fitted, error) = within_steps(&mut self.experiment, self.fitted, ITERATIONS);
        self.fitted = fitted;
        (self, error)
    }

    /// What is assumed of the inputs of a problem, and what the choice adds to the sigmas.
    pub fn assumption(&self, problem: &Problem) -> Option<String> {
        problem.assumes_wheel_motion().then(|| {
            let noted = self.other.as_ref().filter(|o| o.added > NOTED_SHARE);
            let choice = noted.map_or(String::new(), |o| {
                format!(
                    ", {:.0} % probable; the alternative would change the answer by {:.1} sigma, which the sigmas include",
                    100.0 * (1.0 - o.probability),
                    o.shift
                )
            });
            format!("{}{choice}", self.experiment.wheels.words())
        })
    }
}

/// Whether rounding errors of wheels last over several samples: then their correlation is known roughly alone.
fn rounding_lasts(problem: &Problem) -> bool {
    let segments = problem.segments.iter();
    let mut wheels = segments.flat_map(|s| &s.observations.wheels);
    wheels.any(|wheel| wheel.errors.lasts())
}

/// The torque of the wheels as a process, where a fit without it would not be trusted, or the data prefer
/// changes at any time to changes at the samples alone. Both are processes, so that the tachometers judge them as well as all
/// other sensors.
pub(crate) fn random_torque(
    experiment: &Experiment,
    fitted: &Fitted,
    trusted: bool,
) -> Option<RandomTorque> {
    let problem = experiment.problem;
    let cost = |torque: &RandomTorque, wheels: BetweenSamples| {
        let problem = problem.with_segments(&torque.segments);
        let driven = experiment.with_problem(&problem).under(wheels);
        Some(least(&driven.linearise(&fitted.at)?) + torque.deviance)
    };
    let anywhere = RandomTorque::new(problem, Changes::Slope)?;
    if !trusted {
        return Some(anywhere);
    }
    let held = RandomTorque::new(problem, Changes::SlopeAtTimes)?;
    let [random, straight] = [BetweenSamples::RandomTorque, BetweenSamples::Held];
    (cost(&anywhere, random)? < cost(&held, straight)?).then_some(anywhere)
}

/// -2 ln L at the end of a full step.
fn least(here: &Linearised<Linearisation>) -> f64 {
    here.cost - here.predicted_reduction
}

/// The full step in all unknowns.
fn step(experiment: &Experiment, at: &Iterate, there: &Linearisation) -> Vec<f64> {
    let mass = there.spectrum.damped(&there.shared.rhs(), 0.0);
    let end = moved(experiment, at, there.parts(), &mass);
    end.x.iter().zip(&at.x).map(|(a, b)| a - b).collect()
}

/// The experiment with smooth wheel speeds; `None` where no wheel motion is assumed.
pub(crate) fn with_smooth_wheels<'a>(experiment: &Experiment<'a>) -> Option<Experiment<'a>> {
    let smooth = BetweenSamples::Smooth;
    (experiment.problem.assumes_wheel_motion()).then(|| experiment.under(smooth))
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
    let problem = experiment.problem.with_segments(&segments);
    let other = experiment.with_problem(&problem);
    let smooth = BetweenSamples::Smooth;
    let here = other.under(smooth).linearise(&fitted.at);
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
