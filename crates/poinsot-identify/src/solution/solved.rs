//! The numerical solution of a problem.

use crate::diagnosis::{Diagnostics, FaultKind};
use crate::fit::alternatives::OtherWheelMotion;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::known_numbers::Effects;
use crate::fit::step::BoundaryBodies;
use crate::fit::triangle::{ConditionalEstimate, SharedTriangle};
use crate::likelihood::InitialState;
use crate::problem::alternative::BetweenSamples;
use crate::problem::parameters::Parameters;
use crate::problem::prior::{Conflict, PriorTest};
use crate::problem::quantity::Quantity;
use crate::problem::settings::Settings;
use crate::solution::estimate::SegmentFit;
use crate::solution::evidence::Remark;
use crate::solution::unobservable_set::UnobservableSet;
use poinsot_model::Momentum;
use poinsot_solve::Spectrum;
use poinsot_spatial::{Matrix3, Vector3};

/// Largest change of a constant quantity along a path, sigmas: it adds half a percent to the variance.
pub(crate) const CHANGE: f64 = 0.1;

/// A vector with its gradient over the unknowns (three rows) and its own covariance given them.
#[derive(Clone)]
pub(crate) struct VectorQuantity {
    pub value: Vector3,
    pub gradient: [Vec<f64>; 3],
    pub own: Matrix3,
}

impl VectorQuantity {
    /// A vector that is known.
    pub fn known(value: Vector3, unknowns: usize) -> Self {
        Self {
            value,
            gradient: std::array::from_fn(|_| vec![0.0; unknowns]),
            own: Matrix3::zeros(),
        }
    }

    /// Components `from..from + 3` of a conditional estimate.
    pub fn of_initial_state(
        conditional: &ConditionalEstimate,
        from: usize,
        value: Vector3,
    ) -> Self {
        Self {
            value,
            gradient: std::array::from_fn(|k| conditional.slope[from + k].clone()),
            own: conditional
                .covariance
                .fixed_view::<3, 3>(from, from)
                .into_owned(),
        }
    }
}

/// Momentum at the start of a segment, in N: linear, and angular about the system's mass centre.
pub(crate) struct StartOfSegment {
    pub linear: VectorQuantity,
    pub angular: VectorQuantity,
    pub given: Momentum,
    /// Whether any sensor measures translation.
    pub translation: bool,
}

/// The solution of a problem.
pub(crate) struct Solution {
    pub method: &'static str,
    pub parameters: Parameters,
    pub shared: SharedTriangle,
    /// Spectrum of the data and all declared priors.
    pub spectrum: Spectrum,
    /// Values of all unknowns in the order of `parameters`.
    pub x: Vec<f64>,
    /// Residual sum of squares of the whitened rows and degrees of freedom.
    pub residual: (f64, usize),
    /// Share of the measured change of momentum that the model explains; `None` where all of it is
    /// proportional to the unknowns.
    pub explained: Option<f64>,
    pub starts: Vec<StartOfSegment>,
    pub fit: Vec<SegmentFit>,
    /// Paths along unobservable directions.
    pub unobservable_set: UnobservableSet,
    /// What the methods say of it.
    pub remarks: Vec<Remark>,
    /// Whether noise accumulates over rows, which the sigmas assume independent.
    pub noise_accumulates: bool,
    /// Thresholds of the tests.
    pub settings: Settings,
    /// What maximum likelihood adds; `None` of the linear method.
    pub likelihood: Option<OfLikelihood>,
}

/// What maximum likelihood alone makes.
pub(crate) struct OfLikelihood {
    /// Spectrum without the priors of mass properties, where any are declared.
    pub data_alone: Option<Spectrum>,
    pub iterations: usize,
    /// Cost at the start and after every accepted step of the last fit.
    pub costs: Vec<f64>,
    pub converged: bool,
    /// Whether the search ended at a minimum, by which the model can be judged.
    pub found: bool,
    /// Whether the model does not explain a beginning of the record to which a fit converged.
    pub contradicted: bool,
    /// The part of the record that a failed search explains, in words.
    pub followed: Option<String>,
    /// What the fit assumes of the inputs between their samples.
    pub wheels: BetweenSamples,
    /// What the wheels may do between samples instead.
    pub other_wheel_motion: Option<OtherWheelMotion>,
    /// Bodies at an active limit of physical mass properties.
    pub held: Option<BoundaryBodies>,
    /// Diagnosis of the residuals.
    pub diagnostics: Diagnostics,
    /// Tests of the declared numbers against the data.
    pub prior_tests: Vec<PriorTest>,
    /// Priors that the data contradict.
    pub conflict: Option<Conflict>,
    /// How the answer depends on the known numbers, where any is uncertain.
    pub known: Option<Effects>,
}

impl OfLikelihood {
    /// Whether the residual contradicts a rigid vehicle.
    pub fn not_rigid(&self) -> bool {
        let mut findings = self.diagnostics.findings.iter();
        findings.any(|f| f.fault == FaultKind::NotRigid)
    }
}

impl Solution {
    /// Whether it is a minimum; a closed form is.
    pub fn is_found(&self) -> bool {
        self.likelihood.as_ref().is_none_or(|own| own.found)
    }

    /// Whether the iteration converged; a closed form needs none.
    pub fn converged(&self) -> bool {
        self.likelihood.as_ref().is_none_or(|own| own.converged)
    }

    /// Spectrum without the priors of mass properties, where any are used.
    pub fn data_alone(&self) -> Option<&Spectrum> {
        self.likelihood.as_ref()?.data_alone.as_ref()
    }

    /// What the data determine, priors of mass properties left out.
    pub fn of_data(&self) -> &Spectrum {
        self.data_alone().unwrap_or(&self.spectrum)
    }

    /// What the wheels may do between samples instead.
    pub fn other_wheel_motion(&self) -> Option<&OtherWheelMotion> {
        self.likelihood.as_ref()?.other_wheel_motion.as_ref()
    }

    /// Its values of all unknowns.
    pub fn point(&self, experiment: &Experiment) -> Iterate {
        let segments = experiment.problem.segments.iter().zip(&self.starts);
        let initial_states = segments.map(|(segment, start)| {
            let mut at: InitialState = experiment.measured_initial_state(segment, &self.x);
            at.P = match experiment.sees_translation {
                true => start.linear.value,
                false => Vector3::zeros(),
            };
            at.h_SScm_N = start.angular.value;
            at
        });
        Iterate {
            initial_states: initial_states.collect(),
            x: self.x.clone(),
        }
    }

    /// Whether the value of a quantity is constant along all paths of equal prediction, but for what its sigma tells of weak directions.
    pub fn keeps(&self, here: &Quantity, sigma: f64, at: impl Fn(&[f64]) -> f64) -> bool {
        let told = |x: &[f64]| {
            let step: Vec<f64> = x.iter().zip(&self.x).map(|(to, from)| to - from).collect();
            self.spectrum.weak_change(&here.gradient, &step)
        };
        let mut changes = (self.unobservable_set.points()).map(|x| at(x) - here.value - told(x));
        changes.all(|change| change.abs() <= CHANGE * sigma)
    }

    /// The same of value and sigma.
    pub fn holds(&self, here: &Quantity, sigma: f64, at: impl Fn(&[f64]) -> Quantity) -> bool {
        self.keeps(here, sigma, |x| at(x).value) && self.unobservable_set.keeps_sigma(here, at)
    }

    /// Chi-square per degree of freedom.
    pub fn chi2_per_dof(&self) -> f64 {
        self.residual.0 / self.residual.1.max(1) as f64
    }
}
