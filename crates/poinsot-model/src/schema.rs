//! JSON Schema of the model file, generated from the raw types. It documents the format and drives the structure
//! check, so that both agree.

use crate::file::{ModelFile, TelemetryMapFile};
use serde_json::Value;
use std::sync::LazyLock;

pub(crate) static MODEL_KEYS: LazyLock<Value> =
    LazyLock::new(|| without_null(schemars::schema_for!(ModelFile).to_value()));
pub(crate) static MAP_KEYS: LazyLock<Value> =
    LazyLock::new(|| without_null(schemars::schema_for!(TelemetryMapFile).to_value()));

/// The schema of `poinsot.model/1` (JSON Schema 2020-12). Descriptions carry the units.
///
/// ```
/// let schema = poinsot_model::model_schema();
/// assert!(schema["properties"]["body"].is_object());
/// ```
pub fn model_schema() -> Value {
    MODEL_KEYS.clone()
}

/// The schema of a file with only a `[telemetry]` table.
///
/// ```
/// let schema = poinsot_model::telemetry_map_schema();
/// assert!(schema["properties"]["telemetry"].is_object());
/// ```
pub fn telemetry_map_schema() -> Value {
    MAP_KEYS.clone()
}

/// TOML has no null: an optional key may be missing.
///
/// ```
/// use serde_json::json;
///
/// let clean = poinsot_model::without_null(json!({ "type": ["number", "null"] }));
/// assert_eq!(clean, json!({ "type": "number" }));
/// ```
pub fn without_null(value: Value) -> Value {
    match value {
        Value::Array(items) => Value::Array(items.into_iter().map(without_null).collect()),
        Value::Object(map) => {
            let mut clean = serde_json::Map::new();
            for (key, value) in map.into_iter().filter(|(key, _)| key != "default") {
                let value = match (key.as_str(), value) {
                    // What a row adds to JSON Schema stays as it is.
                    (own, value) if own.starts_with("x-") => value,
                    ("type", Value::Array(types)) => {
                        let types: Vec<Value> = types.into_iter().filter(|t| t != "null").collect();
                        match <[Value; 1]>::try_from(types) {
                            Ok([only]) => only,
                            Err(types) => Value::Array(types),
                        }
                    }
                    ("anyOf", Value::Array(items)) => {
                        let mut items: Vec<Value> = items
                            .into_iter()
                            .filter(|item| item.get("type").is_none_or(|t| t != "null"))
                            .map(without_null)
                            .collect();
                        if items.len() == 1
                            && let Some(Value::Object(only)) = items.pop()
                        {
                            for (key, value) in only {
                                clean.entry(key).or_insert(value);
                            }
                            continue;
                        }
                        Value::Array(items)
                    }
                    (_, value) => without_null(value),
                };
                clean.insert(key, value);
            }
            Value::Object(clean)
        }
        other => other,
    }
}
