use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// How columns of a telemetry file become channels.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TelemetryFile {
    /// Channel (standard name, SI; or <sensor>.<channel>) to the column that holds it.
    pub columns: Option<BTreeMap<String, ColumnFile>>,
    /// Rows are kept where each of these columns holds exactly this text.
    #[serde(rename = "where")]
    pub rows: Option<BTreeMap<String, String>>,
}

/// A column and its unit.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColumnFile {
    /// Name of the column in the file.
    #[schemars(required)]
    pub column: Option<String>,
    /// Unit of the column, for example "deg/s".
    #[schemars(required)]
    pub unit: Option<String>,
}

/// A file that holds the [telemetry] table alone.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TelemetryMapFile {
    /// How columns of a telemetry file become channels.
    #[schemars(required)]
    pub telemetry: Option<TelemetryFile>,
}
