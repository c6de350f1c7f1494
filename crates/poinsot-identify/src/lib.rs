//! Estimators, identifiability and information.
//!
//! [`Problem`] -> [`linear`] or [`maximum_likelihood`] -> [`Estimate`]. A question that cannot be asked is an error; what the
//! data leave open is part of the answer.
#![allow(non_snake_case)]

mod answer;
mod answer_body;
mod answer_covariance;
mod answer_known;
mod answer_momentum;
mod as_predicted;
mod barycentre;
mod bound;
mod coarse;
mod combination;
mod completion;
mod conflict;
mod coordinates;
mod degrees_of_freedom;
mod determined;
mod deviance;
mod diagnosis;
mod estimate;
mod evaluation;
mod experiment;
mod fit;
mod held_back;
mod impulse;
#[cfg(test)]
mod information_tests;
mod input_curves;
mod input_noise;
mod known;
mod likelihood;
mod linear;
mod loss;
mod maximum_likelihood;
mod motion;
mod octaves;
mod open_set;
mod parameters;
mod prediction;
mod prior;
mod problem;
mod propagation;
mod quantity;
mod remedies;
mod residual;
mod rows;
mod segment;
mod sensors;
mod shared;
mod shifted;
mod solved;
mod step;
mod trust;
mod walk;
mod wanted;
mod words;

pub use barycentre::Barycentric;
pub use bound::cramer_rao;
pub use combination::{Combination, Combinations, split};
pub use completion::{CompletedVehicle, Completion, CompletionError, complete};
pub use coordinates::{Coordinates, FitOptions};
pub use diagnosis::{
    ChannelDiagnosis, Diagnostics, FaultKind, Finding, MomentumDrift, SensorLag, SpectralLine,
    Suspect,
};
pub use estimate::{
    BodyEstimate, ChannelFit, DeterminedCombination, Estimate, Identifiability, KnownEffect,
    KnownNumbers, MethodReport, MomentumEstimate, NamedNumber, Number, OpenCombination, Principal,
    SegmentFit, Source, Status,
};
pub use evaluation::{EvaluatedUnknown, Evaluation, EvaluationError, Evaluator, SensorResiduals};
pub use held_back::{HeldBack, held_back};
pub use impulse::{Impulse, Impulses, thrust_impulses};
pub use linear::linear;
pub use loss::Loss;
pub use maximum_likelihood::{SENSITIVE, maximum_likelihood, maximum_likelihood_with};
pub use octaves::Octave;
pub use parameters::{
    Equations, ErrorGroup, KnownUnknown, Parameters, ParametersError, TENSOR, Unknown, UnknownKind,
    axis_name, tensor_index, tensor_name,
};
pub use poinsot_solve::{NotFinite, Spectrum};
pub use prediction::{
    HISTOGRAM_BARS, LAGS, PredictedChannel, PredictedMotion, Prediction, linear_predicted,
    maximum_likelihood_predicted, predicted_by,
};
pub use problem::{Problem, ProblemError};
pub use segment::{
    Accelerations, Firing, InputErrors, Noise, Observations, Samples, Segment, SensorRecord,
    SensorSample, SensorValue, Translation,
};
pub use wanted::{Information, WantedNumber, WantedTerm};
