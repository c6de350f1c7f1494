//! Tables of keys in words: each key with its value and unit.

use crate::suggest::{printed_unit, stem};
use poinsot_files::{list, short};
use serde::Serialize;
use serde_json::{Map, Value};

/// An entry of a list of tables on one line: its name, then its other keys.
pub(crate) fn entry(table: &impl Serialize) -> String {
    match serde_json::to_value(table) {
        Ok(Value::Object(mut keys)) => match keys.shift_remove("name") {
            Some(Value::String(name)) => format!("{name}: {}", phrases(&keys)),
            _ => phrases(&keys),
        },
        _ => String::new(),
    }
}

/// A table: a line for its own keys, and one for each table in it.
pub(crate) fn lines(table: &impl Serialize) -> Vec<String> {
    let mut out = Vec::new();
    if let Ok(Value::Object(keys)) = serde_json::to_value(table) {
        tell("", keys, &mut out);
    }
    out
}

fn tell(head: &str, keys: Map<String, Value>, out: &mut Vec<String>) {
    let (mut own, at) = (Map::new(), out.len());
    for (key, value) in keys {
        match value {
            Value::Object(inner) if inner.values().any(Value::is_object) => {
                for (name, value) in &inner {
                    out.push(format!("{head}{name}: {}", text(value)));
                }
            }
            Value::Array(items) if items.iter().any(Value::is_object) => {
                for item in items {
                    match item {
                        Value::Object(mut part) if part.contains_key("name") => {
                            let name = part.shift_remove("name").unwrap_or_default();
                            tell(&format!("{head}{}: ", words(&name)), part, out);
                        }
                        item => out.push(format!("{head}{key}: {}", text(&item))),
                    }
                }
            }
            value @ Value::Object(_) => out.push(format!("{head}{key}: {}", text(&value))),
            value => {
                own.insert(key, value);
            }
        }
    }
    if own.values().any(|value| !value.is_null()) {
        out.insert(at, format!("{head}{}", phrases(&own)));
    }
}

/// A value that stands alone.
fn text(value: &Value) -> String {
    value.as_object().map_or_else(|| words(value), phrases)
}

fn phrases(keys: &Map<String, Value>) -> String {
    let nothing = |value: &Value| value.as_array().is_some_and(Vec::is_empty);
    let given = keys.iter();
    let given = given.filter(|(_, value)| !value.is_null() && !nothing(value));
    let all: Vec<String> = given.map(|(key, value)| phrase(key, value)).collect();
    all.join(", ")
}

fn phrase(key: &str, value: &Value) -> String {
    let (stem, unit) = match (stem(key), value) {
        // A suffix of a vector names its frame.
        (Some(stem), Value::Array(_)) if key.ends_with("_N") => (stem, None),
        (Some(stem), _) => (stem, printed_unit(&key[stem.len() + 1..])),
        (None, _) => (key, None),
    };
    let what = stem.replace('_', " ");
    match (value, unit) {
        (Value::Bool(true), _) => what,
        (Value::Bool(false), _) => format!("no {what}"),
        (_, Some(unit)) => format!("{what} {} {unit}", words(value)),
        _ => format!("{what} {}", words(value)),
    }
}

fn words(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::Bool(flag) => flag.to_string(),
        Value::Number(x) => x.as_f64().map_or_else(|| x.to_string(), short),
        Value::String(text) => text.clone(),
        Value::Object(keys) => format!("({})", phrases(keys)),
        Value::Array(items) => {
            let numbers: Option<Vec<f64>> = items.iter().map(Value::as_f64).collect();
            match numbers {
                Some(numbers) => format!("({})", list(&numbers)),
                None => items.iter().map(words).collect::<Vec<_>>().join(" "),
            }
        }
    }
}
