//! Predictions of an answer, for figures and held-back records.

pub(crate) mod completion;
pub(crate) mod curves;
pub(crate) mod held_back;

pub use curves::{
    HISTOGRAM_BARS, LAGS, PredictedChannel, Prediction, linear_predicted,
    maximum_likelihood_predicted, predicted_by,
};
