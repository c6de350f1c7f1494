//! JSON Schemas of the file formats by name.

use crate::error::Error;
use serde_json::Value;

/// Name of the model file's format.
const MODEL: &str = "model";

/// JSON Schema (2020-12) of a file format.
///
/// # Errors
/// There is no format of this name.
pub fn schema(name: &str) -> Result<Value, Error> {
    if name == MODEL {
        return Ok(poinsot_model::model_schema());
    }
    poinsot_formats::schema(name).ok_or_else(|| Error::Usage {
        option: "NAME",
        value: name.to_owned(),
        why: format!(
            "there is no such format; use one of {MODEL}, {}",
            poinsot_formats::names().collect::<Vec<_>>().join(", ")
        ),
    })
}
