//! JSON Schemas of the file formats by name.

use crate::check::Described;
use crate::error::{Error, unknown};
use crate::propose::InspectionAnswer;
use poinsot_formats::StatedFile;
use schemars::{JsonSchema, schema_for};
use serde_json::Value;

/// Name of a format, and its JSON Schema.
type Format = (&'static str, fn() -> Value);

/// Formats of the model file, of a separate `[telemetry]` table, and of results of other crates.
const OTHERS: [Format; 4] = [
    ("model", poinsot_model::model_schema),
    ("map", poinsot_model::telemetry_map_schema),
    ("description", of::<Described>),
    ("inspection", of::<InspectionAnswer>),
];

fn of<T: JsonSchema>() -> Value {
    schema_for!(StatedFile<T>).to_value()
}

/// Formats stored as TOML.
const TOML: [&str; 2] = ["case", "plan"];

/// Names of all formats.
///
/// ```
/// assert!(poinsot::schema_names().any(|name| name == "model"));
/// ```
pub fn schema_names() -> impl Iterator<Item = &'static str> {
    let others = OTHERS.into_iter().map(|(name, _)| name);
    others.chain(poinsot_formats::names())
}

/// JSON Schema (2020-12) of a file format.
///
/// # Errors
/// The format is unknown.
///
/// ```
/// let schema = poinsot::schema("model")?;
/// assert!(schema["properties"]["body"].is_object());
/// assert!(poinsot::schema("novel").is_err());
/// # Ok::<(), poinsot::Error>(())
/// ```
pub fn schema(name: &str) -> Result<Value, Error> {
    if let Some((_, schema)) = OTHERS.into_iter().find(|(n, _)| *n == name) {
        return Ok(schema());
    }
    let found = poinsot_formats::schema(name).map(|schema| match TOML.contains(&name) {
        true => poinsot_model::without_null(schema),
        false => schema,
    });
    found.ok_or_else(|| unknown("NAME", name, "format", schema_names()))
}
