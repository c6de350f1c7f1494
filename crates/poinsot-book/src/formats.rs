//! The pages of formats: keys of model file, case file and results, from their schemas.

use crate::commands::cell;
use minijinja::{Value, context};
use serde_json::Value as Schema;
use std::collections::BTreeMap;

/// The context of the page of one format.
pub fn format(name: &str, title: &str) -> Value {
    let schema = poinsot::schema(name).unwrap_or_default();
    let parts = definitions(&schema).map(|(name, schema)| definition(name, schema));
    let parts: Vec<Value> = std::iter::once(table(title, &schema))
        .chain(parts)
        .collect();
    context! { parts }
}

/// The context of `reference/results.md`.
pub fn results() -> Value {
    let names = poinsot::schema_names();
    let schemas = names.filter(|name| !OTHER_PAGES.contains(name));
    let schemas = schemas.filter_map(|name| Some((name, poinsot::schema(name).ok()?)));
    let schemas: Vec<(&str, Schema)> = schemas.collect();
    let own = schemas.iter().flat_map(|(_, schema)| definitions(schema));
    let shared: BTreeMap<&String, &Schema> = own.collect();
    let formats = schemas
        .iter()
        .map(|(name, schema)| table(&format!("The {name} format"), schema));
    let parts = shared.iter().map(|(name, schema)| definition(name, schema));
    let parts: Vec<Value> = formats.chain(parts).collect();
    context! { parts }
}

/// Formats documented on other pages.
const OTHER_PAGES: [&str; 3] = ["model", "map", "case"];

/// The parts that the tables of a schema refer to.
fn definitions(schema: &Schema) -> impl Iterator<Item = (&String, &Schema)> {
    schema
        .get("$defs")
        .and_then(Schema::as_object)
        .into_iter()
        .flatten()
}

/// A part: its table, or its kind of value.
fn definition(name: &str, schema: &Schema) -> Value {
    match schema.get("properties") {
        Some(_) => table(&title(name), schema),
        None => context! { title => title(name), about => about(schema), kind => kind(schema) },
    }
}

/// The table of the keys of a schema.
fn table(title: &str, schema: &Schema) -> Value {
    let required = schema.get("required").and_then(Schema::as_array);
    let is_required = |key: &str| required.is_some_and(|all| all.iter().any(|r| r == key));
    let keys = schema.get("properties").and_then(Schema::as_object);
    let keys = keys.into_iter().flatten().map(|(name, value)| {
        context! {
            name,
            kind => kind(value),
            about => cell(about(value).unwrap_or_default()),
            only => value.get("x-only").map(only),
            required => is_required(name),
        }
    });
    context! { title, about => about(schema), keys => keys.collect::<Vec<_>>() }
}

fn about(schema: &Schema) -> Option<&str> {
    schema.get("description").and_then(Schema::as_str)
}

/// Title of a type: `BodyFile` gives "body", `Axes_for_NumberFile` gives "axes of number".
fn title(name: &str) -> String {
    let mut out = String::new();
    for c in name.replace("File", "").replace("_for_", " of ").chars() {
        if c.is_uppercase() && !out.is_empty() && !out.ends_with(' ') {
            out.push(' ');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// The values of another key with which a key is allowed.
fn only(condition: &Schema) -> String {
    let keys = condition.as_object().into_iter().flatten();
    let words = |values: &Schema| {
        let values = values.as_array().into_iter().flatten();
        let words: Vec<String> = values.map(|v| format!("`{v}`")).collect();
        words.join(", ").replace('"', "")
    };
    keys.map(|(key, values)| format!(" Only where `{key}` is {}.", words(values)))
        .collect()
}

/// The range of a number, as text.
fn range(value: &Schema) -> String {
    let bounds = [
        [("exclusiveMinimum", "above"), ("minimum", "from")],
        [("exclusiveMaximum", "below"), ("maximum", "up to")],
    ];
    let bound = |(name, word): (&str, &str)| Some(format!(" {word} {}", value.get(name)?));
    let all = bounds
        .into_iter()
        .filter_map(|two| two.into_iter().find_map(bound));
    all.collect::<String>().replace(" from 0", "")
}

/// Possible values of a schema entry, as text.
fn kind(value: &Schema) -> String {
    if let Some(target) = value.get("$ref").and_then(Schema::as_str) {
        let name = title(target.rsplit('/').next().unwrap_or(target));
        return format!("[{name}](#{})", name.replace(' ', "-"));
    }
    if let Some(choices) = value.get("enum").and_then(Schema::as_array) {
        let words: Vec<String> = choices.iter().map(|c| format!("`{c}`")).collect();
        return words.join(", ");
    }
    if let Some(only) = value.get("const") {
        return format!("`{only}`");
    }
    for key in ["anyOf", "oneOf"] {
        if let Some(choices) = value.get(key).and_then(Schema::as_array) {
            let words: Vec<String> = choices.iter().map(kind).collect();
            return words.join(" or ");
        }
    }
    if let Some(types) = value.get("type").and_then(Schema::as_array) {
        let alone = |kind: &Schema| {
            let mut one = value.clone();
            one["type"] = kind.clone();
            self::kind(&one)
        };
        let words: Vec<String> = types.iter().map(alone).collect();
        return words.join(" or ");
    }
    match value.get("type").and_then(Schema::as_str) {
        Some("array") => {
            let of = value.get("items").map(kind).unwrap_or_default();
            let count = |key: &str| value.get(key).and_then(Schema::as_u64);
            match (count("minItems"), count("maxItems")) {
                (Some(a), Some(b)) if a == b => format!("{a} of: {of}"),
                _ => format!("list of: {of}"),
            }
        }
        Some("object") => match value.get("properties").and_then(Schema::as_object) {
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
        Some(other) => format!("{other}{}", range(value)),
        None => String::new(),
    }
}
