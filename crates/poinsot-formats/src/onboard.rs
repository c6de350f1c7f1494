//! Table for on-board software.

use crate::estimate::EpochFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const ONBOARD: &str = "poinsot.onboard/1";

/// Determined mass properties with their covariance, without null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OnboardFile {
    /// "poinsot.onboard/1".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// Name of the vehicle.
    pub model: String,
    /// Origin of the times of the record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epoch: Option<EpochFile>,
    /// Whether the covariance is stated and no evidence contradicts it.
    pub reliable: bool,
    /// Bodies of which every number is known or determined.
    pub bodies: IndexMap<String, OnboardBodyFile>,
    /// Names of the rows of the covariance.
    pub covariance_names: Vec<String>,
    /// Units of the rows.
    pub covariance_units: Vec<String>,
    /// Covariance of the determined numbers, row by row.
    pub covariance: Vec<Vec<f64>>,
}

/// Mass properties of one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OnboardBodyFile {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Mass centre from the origin of the body's frame, in its axes, m.
    pub com_m: [f64; 3],
    /// Inertia tensor about the mass centre, in the body's axes, row by row, kg m2.
    pub inertia_kg_m2: [[f64; 3]; 3],
}
