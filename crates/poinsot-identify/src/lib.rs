//! Estimators, identifiability and information.
//!
//! [`Problem`] -> [`linear`] or [`maximum_likelihood`] -> [`Estimate`]. An invalid problem is an error; undetermined
//! numbers are part of the answer.
//!
//! | subject | item |
//! |---|---|
//! | the input | [`Problem`]: a model, its tree, [`Segment`]s of samples, [`Noise`] |
//! | estimators | [`linear`], [`maximum_likelihood`], [`maximum_likelihood_with`] ([`Settings`], [`Loss`]) |
//! | accuracy before the experiment | [`predicted_covariance`], [`cramer_rao`], [`Evaluator`] |
//! | the answer | [`Estimate`], [`Status`], [`BodyEstimate`], [`Number`] |
//! | what the data determine | [`Identifiability`], [`Combination`], [`split`], [`Spectrum`] |
//! | why it fits or not | [`Remark`], [`Diagnostics`], [`SegmentFit`] |
//! | prediction with the answer | [`complete`], [`held_back`], [`predicted_by`] |
//!
//! The crate `poinsot` makes a [`Problem`] from files or tables (`poinsot::bind`).
//!
//! # Example
//! A box whose wheel runs up about z. The gyro shows how the box answers, so its moment about z is determined, and the
//! two products with z. The other three elements are not:
//!
//! ```
#![doc = include_str!("../doc/spun_box.txt")]
//! let estimate = maximum_likelihood(&problem)?;
//! assert_eq!(estimate.status, Status::Partial);
//! assert_eq!(estimate.identifiability.rank, 3);
//!
//! let [I_xx, .., I_zz] = estimate.bodies[0].inertia;
//! assert_eq!(I_xx.value, None);
//! assert!((I_zz.value.unwrap() - 2.5).abs() < 1.0e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Files
//! Folders, each of which imports only those before it: `problem`, `motion`, `sensors`, `likelihood`, `fit`,
//! `diagnosis`, `solution`, `certify`, `remedies`, `answer`, `methods`, then `prediction` and `evaluation`.
//!
//! - `problem/`: input. `question.rs`, `segment.rs`: its types. `parameters.rs`, `parameters/`: the unknowns; `registry.rs`
//!   has every kind once, with name, unit, declaration and fault. `fault.rs`: kinds of faults and advice.
//!   `prior.rs`, `loss.rs`. `alternative.rs`: what is assumed of inputs between their samples. `settings.rs`: choices of a fit and thresholds of the tests, with their defaults.
//!   `quantity.rs`: mass, mass centre and inertia with gradients. `shifted_vehicle.rs`: the vehicle with other known
//!   numbers.
//! - `motion.rs`, `motion/`: the pose-momentum equation. `vehicle.rs`: the vehicle at one value of the unknowns.
//!   `steps.rs`, `grid.rs`: number of steps. `advance.rs`: one step. `chord.rs`: wheels within an interval.
//!   `variation.rs`: columns of the unknowns. `inputs.rs`: inputs and their errors. `virtual_joints.rs`: errors of joint origins
//!   and axes. `environment.rs`: external torques. `acceleration.rs`. `input_noise.rs`: propagation of joint and wheel
//!   noise. `input_curves.rs`: smoothing splines for input lags.
//! - `sensors/`: the measurement models at the estimated motion. `stream.rs`: samples with their predictions, for likelihood
//!   and curves.
//! - `likelihood.rs`, `likelihood/`: predictions against measurements. `rows.rs`, `impulse.rs`: whitened equations of
//!   the linear method, and thrust between samples.
//! - `fit/`: `experiment.rs`: a problem at any value of its unknowns, and its Fisher information. `triangle.rs`:
//!   triangle of the shared unknowns. `step.rs`: one step. `momentum_state.rs`: the fit. `search.rs`: the search from
//!   every start along the record. `part_of_record.rs`: its beginnings, or few of its samples. `coordinates.rs`: steps that keep bodies physical. `step_error.rs`: checks the integration step.
//!   `alternatives.rs`: fits of the alternatives of what inputs do between their samples, and the choice.
//!   `known_numbers.rs`: known numbers within their uncertainty. `degrees_of_freedom.rs`. `experiment/`: columns of
//!   known numbers, predicted measurements.
//! - `diagnosis/`: causes of a misfit. `oscillation.rs`: a mode in the residual. `candidates.rs`: numbers of the registry that telemetry can show, and known numbers.
//!   `table.rs`: their columns. `onset.rs`, `pulse.rs`: causes that start within a record. `score.rs`: misfit explained
//!   by columns. `noise_models.rs`: other noise models. `suspects.rs`: evidence. `conflict.rs`: priors against data.
//!   `octaves.rs`: residuals by octave. `deviance.rs`: likelihood under the declared noise.
//! - `solution/`: `solved.rs`: the numerical solution. `unobservable_set.rs`: invariants along unobservable directions.
//!   `estimate.rs`: types of the answer. `evidence.rs`: the list of its remarks, from which status and reliability
//!   follow.
//! - `certify/`: `combination.rs`: readable combinations. `continuation.rs`: paths of equal prediction.
//!   `barycentre.rs`: augmented inertias and couplings of a tree. `naming.rs`: names of unobservable directions.
//! - `remedies/`: changes that resolve unobservable directions, alone or in pairs.
//! - `answer/`: from the solved problem to the `Estimate`. `write.rs`, and one file per part. `reliability.rs`: the
//!   tests of the answer. `sensor_noise.rs`: every sensor against its declared noise. `determined.rs`: combinations
//!   printed instead of single numbers.
//! - `methods/`: `linear.rs`, `maximum_likelihood.rs`: the two methods. `other_minima.rs`: further starts where a minimum does not
//!   stand. `flexible.rs`: modes that the data show, and the entry to maximum likelihood. `cramer_rao.rs`: the bound.
//! - `prediction/`: `curves.rs`: curves of the report. `held_back.rs`: a record that was not used. `completion.rs`:
//!   completion of undetermined numbers for a prediction.
//! - `evaluation/`: `evaluator.rs`: all quantities at any value of the unknowns, for other methods. `wanted.rs`: sigmas
//!   of a few numbers for a search.
#![allow(non_snake_case)]

mod answer;
mod certify;
mod diagnosis;
mod evaluation;
mod fit;
#[cfg(test)]
mod information_tests;
mod likelihood;
mod methods;
mod motion;
mod prediction;
mod problem;
mod remedies;
mod sensors;
mod solution;

pub use certify::barycentre::Barycentric;
pub use certify::combination::{Combination, Combinations, split};
pub use diagnosis::octaves::Octave;
pub use diagnosis::{
    ChannelDiagnosis, Diagnostics, FaultKind, Finding, HeldOut, MomentumDrift, SensorLag,
    SpectralLine, Suspect, SuspectValue,
};
pub use evaluation::wanted::{Information, ROUGH, WantedTerm};
pub use evaluation::{EvaluatedUnknown, Evaluation, Evaluator, SensorResiduals};
pub use fit::sampled_motion::{InputSample, JointMotion};
pub use likelihood::impulse::{Impulse, Impulses, thrust_impulses};
pub use methods::cramer_rao::{cramer_rao, predicted_covariance};
pub use methods::flexible::{maximum_likelihood, maximum_likelihood_with};
pub use methods::linear::linear;
pub use poinsot_solve::{NotFinite, Spectrum};
pub use prediction::completion::{CompletedVehicle, Completion, complete};
pub use prediction::held_back::{HeldBack, held_back};
pub use prediction::{
    HISTOGRAM_BARS, LAGS, PredictedChannel, Prediction, linear_predicted,
    maximum_likelihood_predicted, predicted_by,
};
pub use problem::error_process::{ErrorProcess, ErrorStep};
pub use problem::loss::Loss;
pub use problem::parameters::{
    Equations, ErrorGroup, KnownUnknown, Parameters, TENSOR, Unknown, UnknownKind, axis_name,
    tensor_index, tensor_name,
};
pub use problem::segment::{
    Accelerations, BetweenReadings, Firing, InputChannel, InputErrors, InputRate, Noise,
    Observations, RateParts, RoundingError, Samples, Segment, SensorRecord, SensorSample,
    SensorValue, Translation,
};
pub use problem::settings::{Coordinates, DiagnosisSettings, IntegrationSettings, Modes, Settings};
pub use problem::{Problem, ProblemError, refusal};
pub use solution::estimate::{
    BodyEstimate, ChannelFit, DeterminedCombination, Estimate, Identifiability, KnownEffect,
    KnownNumbers, MethodReport, MomentumEstimate, NamedNumber, Number, Principal, ReportedNumber,
    SegmentFit, Source, Status, UnobservableCombination,
};
pub use solution::evidence::{Effect, Remark, RemarkKind};
