//! `diagnostics` of `estimate.json`: tests of the residuals.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Tests of the residuals. Undetermined numbers are null.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiagnosticsFile {
    /// Chi-square of all segments.
    pub chi2: Option<f64>,
    /// Degrees of freedom.
    pub dof: usize,
    /// -2 ln of the restricted likelihood, up to a constant that no declaration of noise changes.
    pub deviance: Option<f64>,
    /// Excess of chi-square over its expectation, in its standard deviations.
    pub excess_sigmas: Option<f64>,
    /// Sensors by name.
    pub channels: BTreeMap<String, ChannelFile>,
    /// The end of every record against the prediction of a fit without it. Absent where it is not tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out: Option<HeldOutFile>,
    /// Change of momentum not explained by declared forces or torques.
    pub momentum_drift: Vec<DriftFile>,
    /// Delays between sensors.
    pub lags: Vec<LagFile>,
    /// Faults whose estimation would reduce chi-square, best first.
    pub suspects: Vec<SuspectFile>,
    /// Spectral lines of the residual.
    pub lines: Vec<LineFile>,
    /// What was concluded.
    pub findings: Vec<FindingFile>,
}

/// Residual of one sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelFile {
    /// Numbers measured.
    pub readings: usize,
    /// Chi-square per number.
    pub chi2_per_number: Option<f64>,
    /// The same from the median, robust against outliers.
    pub typical_chi2_per_number: Option<f64>,
    /// Outliers.
    pub outliers: usize,
    /// Share of outliers.
    pub outlier_share: f64,
    /// p-value of a white residual. Absent where it is not tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whiteness_p: Option<f64>,
}

/// The end of every record against the prediction of a fit without it, to first order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeldOutFile {
    /// Share of every record that was held out.
    pub share: f64,
    /// Numbers held out.
    pub numbers: usize,
    /// Normalised square of the prediction error; its covariance includes noise and fit.
    pub chi2: f64,
    /// p-value of the error.
    pub p: f64,
}

/// Unexplained force and torque.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DriftFile {
    /// Segment. Absent for all segments together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub segment: Option<String>,
    /// Torque in N, N m.
    pub torque_N_m: [Option<f64>; 3],
    /// One sigma each.
    pub torque_sigma_N_m: [Option<f64>; 3],
    /// Force in N, N. Absent where translation is not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_N: Option<[Option<f64>; 3]>,
    /// One sigma each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_sigma_N: Option<[Option<f64>; 3]>,
    /// p-value of no drift.
    pub p: Option<f64>,
}

/// Delay of one sensor behind another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LagFile {
    /// The later sensor, and the one it is compared with.
    pub between: [String; 2],
    /// Delay, s.
    pub lag_s: f64,
    /// One sigma, s.
    pub sigma_s: f64,
    /// p-value of no delay.
    pub p: Option<f64>,
}

/// A fault whose estimation would reduce chi-square.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SuspectFile {
    /// Kind of fault.
    pub fault: String,
    /// The sensor, wheel, thruster or environment.
    pub name: String,
    /// Decrease of chi-square.
    pub decrease_of_chi2: Option<f64>,
    /// Share of the misfit that it explains.
    pub explains: f64,
    /// Its size.
    pub values: Vec<ValueFile>,
}

/// Size of a fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValueFile {
    /// Name of the unknown.
    pub name: String,
    /// Value, in `unit`.
    pub value: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// A spectral line of the residual.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LineFile {
    /// Segment.
    pub segment: String,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Share of the residual's power.
    pub share: f64,
}

/// A conclusion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FindingFile {
    /// Kind of fault.
    pub fault: String,
    /// In words.
    pub text: String,
}
