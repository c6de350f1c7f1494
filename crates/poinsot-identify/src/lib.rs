//! Estimators, identifiability and information.
//!
//! [`Problem`] -> [`linear`] or [`maximum_likelihood`] -> [`Estimate`]. An invalid problem is an error; undetermined
//! numbers are part of the answer.
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
    SpectralLine, Suspect,
};
pub use evaluation::wanted::{Information, WantedNumber, WantedTerm};
pub use evaluation::{EvaluatedUnknown, Evaluation, EvaluationError, Evaluator, SensorResiduals};
pub use likelihood::impulse::{Impulse, Impulses, thrust_impulses};
pub use methods::cramer_rao::{cramer_rao, predicted_covariance};
pub use methods::linear::linear;
pub use methods::maximum_likelihood::{maximum_likelihood, maximum_likelihood_with};
pub use poinsot_solve::{NotFinite, Spectrum};
pub use prediction::completion::{CompletedVehicle, Completion, CompletionError, complete};
pub use prediction::held_back::{HeldBack, held_back};
pub use prediction::{
    HISTOGRAM_BARS, LAGS, PredictedChannel, PredictedMotion, Prediction, linear_predicted,
    maximum_likelihood_predicted, predicted_by,
};
pub use problem::loss::Loss;
pub use problem::parameters::{
    Equations, ErrorGroup, KnownUnknown, Parameters, ParametersError, TENSOR, Unknown, UnknownKind,
    axis_name, tensor_index, tensor_name,
};
pub use problem::segment::{
    Accelerations, BetweenReadings, Firing, InputErrors, Noise, Observations, RoundingError,
    Samples, Segment, SensorRecord, SensorSample, SensorValue, Translation,
};
pub use problem::settings::{Coordinates, Settings, SettingsError};
pub use problem::{Problem, ProblemError};
pub use solution::estimate::{
    BodyEstimate, ChannelFit, DeterminedCombination, Estimate, Identifiability, KnownEffect,
    KnownNumbers, MethodReport, MomentumEstimate, NamedNumber, Number, Principal, SegmentFit,
    Source, Status, UnobservableCombination,
};
pub use solution::evidence::{Effect, Evidence};
