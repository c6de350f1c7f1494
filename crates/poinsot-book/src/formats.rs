//! The page of formats: keys of the model file from its schema, keys of the result from an answer.

use crate::commands::{GENERATED, cell};
use crate::error::BookError;
use crate::results::Example;
use serde_json::{Map, Value};
use std::fmt::Write;

/// The page `formats.md`.
///
/// # Errors
/// The program refuses its own example.
pub fn page() -> Result<String, BookError> {
    let mut out = "# Formats\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(
        "Everything is SI, and every key that holds a quantity ends in its unit. Axes, points and signs are those of \
         [Notation](notation.md). Telemetry and case files are described in [Borders](CONTRACT.md), with examples in \
         [the cases](../examples/cases/README.md).\n\n",
    );
    model(&mut out);
    estimate(&mut out)?;
    Ok(out)
}

fn model(out: &mut String) {
    let schema = poinsot_model::model_schema();
    out.push_str(
        "## The model file: poinsot.model/1\n\n\
         TOML. An unknown key is an error, with the nearest known key. `poinsot schema` prints the JSON Schema from which \
         these tables are made and by which a file is checked.\n",
    );
    table("top level", &schema, out);
    let empty = Map::new();
    let parts = schema
        .get("$defs")
        .and_then(Value::as_object)
        .unwrap_or(&empty);
    for (name, part) in parts {
        if part.get("properties").is_some() {
            table(&title(name), part, out);
        } else {
            let about = part
                .get("description")
                .and_then(Value::as_str)
                .unwrap_or_default();
            let _ = write!(out, "\n### {}\n\n{}\n", title(name), about.trim());
            let _ = write!(out, "\n{}\n", kind(part));
        }
    }
}

/// `BodyFile` is written "body".
fn title(name: &str) -> String {
    let mut out = String::new();
    for c in name.strip_suffix("File").unwrap_or(name).chars() {
        if c.is_uppercase() && !out.is_empty() {
            out.push(' ');
        }
        out.extend(c.to_lowercase());
    }
    out
}

fn table(heading: &str, part: &Value, out: &mut String) {
    let _ = write!(out, "\n### {heading}\n");
    if let Some(about) = part.get("description").and_then(Value::as_str) {
        let _ = write!(out, "\n{about}\n");
    }
    let required: Vec<&str> = part
        .get("required")
        .and_then(Value::as_array)
        .map(|r| r.iter().filter_map(Value::as_str).collect())
        .unwrap_or_default();
    out.push_str("\n| key | value | meaning |\n|---|---|---|\n");
    let Some(keys) = part.get("properties").and_then(Value::as_object) else {
        return;
    };
    for (key, value) in keys {
        let about = value
            .get("description")
            .and_then(Value::as_str)
            .unwrap_or_default();
        let needed = if required.contains(&key.as_str()) {
            " **Required.**"
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "| `{key}` | {} | {}{needed} |",
            kind(value),
            cell(about)
        );
    }
}

/// What a value of the schema may be, in words.
fn kind(value: &Value) -> String {
    if let Some(target) = value.get("$ref").and_then(Value::as_str) {
        let name = title(target.rsplit('/').next().unwrap_or(target));
        return format!("[{name}](#{})", name.replace(' ', "-"));
    }
    if let Some(choices) = value.get("enum").and_then(Value::as_array) {
        let words: Vec<String> = choices.iter().map(|c| format!("`{c}`")).collect();
        return words.join(", ");
    }
    if let Some(only) = value.get("const") {
        return format!("`{only}`");
    }
    for key in ["anyOf", "oneOf"] {
        if let Some(choices) = value.get(key).and_then(Value::as_array) {
            let words: Vec<String> = choices.iter().map(kind).collect();
            return words.join(" or ");
        }
    }
    match value.get("type").and_then(Value::as_str) {
        Some("array") => {
            let of = value.get("items").map(kind).unwrap_or_default();
            let count = |key: &str| value.get(key).and_then(Value::as_u64);
            match (count("minItems"), count("maxItems")) {
                (Some(a), Some(b)) if a == b => format!("{a} of: {of}"),
                _ => format!("list of: {of}"),
            }
        }
        Some("object") => match value.get("properties").and_then(Value::as_object) {
            Some(keys) => {
                let words: Vec<String> = keys.keys().map(|k| format!("`{k}`")).collect();
                format!("table with {}", words.join(", "))
            }
            None => match value.get("additionalProperties") {
                Some(of) if of.is_object() => format!("table of: {}", kind(of)),
                _ => "table".to_owned(),
            },
        },
        Some("string") => "text".to_owned(),
        Some("boolean") => "`true`, `false`".to_owned(),
        Some(other) => other.to_owned(),
        None => String::new(),
    }
}

/// Meaning of the keys at the top of a result.
const MEANINGS: [(&str, &str); 20] = [
    ("schema", "Format."),
    ("poinsot", "Version that wrote it."),
    ("method", "Method that gave the answer."),
    ("variant", "Variant of the method, where it has any."),
    (
        "status",
        "`converged`, `partial`, `not_identifiable`, `iteration_limit` or `rejected`.",
    ),
    ("iterations", "Iterations of the fit; 0 for a closed form."),
    ("model", "Name of the vehicle."),
    (
        "inputs",
        "Every file read, with its SHA-256, segment, time span and rows.",
    ),
    (
        "bodies",
        "By name: mass, mass centre and inertia about the mass centre in body axes, each with value, sigma, nominal and source; principal moments and axes; the ten parameters about the body's origin.",
    ),
    (
        "covariance",
        "Names, units and matrix of all estimated mass properties and nuisances.",
    ),
    (
        "system",
        "Composite of the whole vehicle at the first sample, with the joint positions for which it holds.",
    ),
    (
        "momentum",
        "Linear momentum, and angular momentum about the mass centre, at the first sample of every segment, in N.",
    ),
    (
        "nuisance",
        "Whatever else was estimated: biases, scales, lags.",
    ),
    (
        "identifiability",
        "Number of unknowns, rank, sigma of every direction in natural units, combinations that are determined and that are not.",
    ),
    (
        "fit",
        "Per segment: samples, chi-square per degree of freedom, and for every sensor rms and whiteness of the residual.",
    ),
    (
        "covariance_trustworthy",
        "`false` where anything speaks against the answer, or no covariance is stated.",
    ),
    (
        "doubts",
        "Why the answer is not to be relied on, the most important first; empty where nothing speaks against it. Not empty: exit code 1.",
    ),
    (
        "method_report",
        "What a published method prints besides; `null` otherwise.",
    ),
    ("repairs", "What was assumed or repaired."),
    ("ignored_columns", "Columns nobody asked for."),
];

fn estimate(out: &mut String) -> Result<(), BookError> {
    let answer = Example::named("stsat3, several axes").answer()?;
    out.push_str(
        "\n## The result: poinsot.estimate/1\n\n\
         `estimate.json`. A number that the data and declared priors do not determine is `null` in value, sigma and source. \
         The keys below are those of a real answer; `[]` is an entry of a list, `*` any name.\n\n\
         | key | meaning |\n|---|---|\n",
    );
    let empty = Map::new();
    let keys = answer.as_object().unwrap_or(&empty);
    for key in keys.keys() {
        let meaning = MEANINGS.iter().find(|(k, _)| k == key).map(|(_, m)| *m);
        let meaning = meaning.unwrap_or(match key.as_str() {
            "warnings" => "What a reader should know before trusting the numbers.",
            _ => "",
        });
        let _ = writeln!(out, "| `{key}` | {meaning} |");
    }
    out.push_str("\nIn full:\n\n```text\n");
    let mut lines = Vec::new();
    for (key, value) in keys {
        paths(key, value, &mut lines);
    }
    lines.dedup();
    out.push_str(&lines.join("\n"));
    out.push_str("\n```\n");
    Ok(())
}

/// Every path of a document with the type of what stands there.
fn paths(path: &str, value: &Value, out: &mut Vec<String>) {
    let named = ["bodies", "nuisance", "fit[].channels"].contains(&path);
    match value {
        Value::Object(map) if named => {
            if let Some(first) = map.values().next() {
                paths(&format!("{path}.*"), first, out);
            }
        }
        Value::Object(map) if map.is_empty() => out.push(format!("{path}: table")),
        Value::Object(map) => map
            .iter()
            .for_each(|(key, value)| paths(&format!("{path}.{key}"), value, out)),
        Value::Array(list) => match list.first() {
            Some(first) => paths(&format!("{path}[]"), first, out),
            None => out.push(format!("{path}[]")),
        },
        Value::Null => out.push(format!("{path}: null here")),
        Value::Bool(_) => out.push(format!("{path}: true or false")),
        Value::Number(_) => out.push(format!("{path}: number")),
        Value::String(_) => out.push(format!("{path}: text")),
    }
}
