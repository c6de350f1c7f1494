//! Generates the pages of formats: keys of model file, case file and results, from their schemas.

use crate::GENERATED;
use crate::commands::cell;
use serde_json::{Map, Value};
use std::fmt::Write;

/// The page `reference/formats.md`.
pub fn page() -> String {
    let mut out = "# Formats\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(
        "All numbers are in SI, and every key of a quantity ends in its unit. Axes, points and signs are those of \
         [Notation](notation.md). [Case files](case.md) have a separate page.\n\n",
    );
    model(&mut out);
    out
}

/// The page `reference/case.md`.
pub fn case_page() -> String {
    let mut out = "# Case files\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(CASES);
    schema_tables("case", "Keys", &mut out);
    out
}

const CASES: &str = "\
A case file (TOML, `poinsot.case/2`) describes what a vehicle does: `simulate` writes its telemetry, `predict` its accuracy, \
`design` a better manoeuvre; `validate` and `campaign` compare with it. An unknown key is an error that names the nearest \
known key. Files of `poinsot.case/1` are read too. [The cases](../../data/cases/README.md) are examples.

1. Write the case beside its model:

       schema = \"poinsot.case/2\"
       model = \"tug_truth.toml\"
       duration_s = 120.0

       [initial]
       omega_rad_s = [0.01, -0.015, 0.02]

       [[firing]]
       thruster = \"thr1\"
       on_s = 2.0
       off_s = 8.0
       force_N = 10.0

       [output]
       rate_hz = 10

2. Check it: `poinsot check case.toml` prints it in words, or every fault with its line.
3. Simulate it: `poinsot simulate case.toml --out sim` writes `telemetry.csv` and `truth.json`.
4. Predict it: `poinsot predict case.toml` prints the accuracy that the manoeuvre gives.

Gravity, thrusters and attitude feedback may be combined. Joints follow `joint_motion`, or `joint_torque` and springs, then \
without `control` and gravity. Wheel motions and joint torques come from tables or telemetry files. `poinsot schema case` \
prints the JSON Schema from which these tables are generated.
";

/// The page `reference/results.md`.
pub fn results_page() -> String {
    let mut out = "# Result formats\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(
        "Every file that Poinsot writes, and every answer with `--json`, names its format in the key `schema`. `poinsot \
         schema NAME` prints the JSON Schema from which this page is generated. Null means not determined. What was not \
         requested, or does not apply, is absent. Numbers have the same name, shape and unit in every format.\n\n\
         Names of numbers are addresses: the name of a body, joint, wheel, thruster or sensor, a quantity with its unit, and \
         a component: `bus.mass_kg`, `bus.com_m.x`, `bus.inertia_kg_m2.xy`, `gyro.bias_rad_s.x`, `wheel1.spin_inertia_kg_m2`. \
         Plans, `--vary` and `[[want]]` use the same addresses.\n",
    );
    let mut parts = std::collections::BTreeMap::new();
    for name in poinsot::schema_names() {
        let Some(schema) = poinsot::schema(name)
            .ok()
            .filter(|_| !OTHER_PAGES.contains(&name))
        else {
            continue;
        };
        table(&format!("The {name} format"), &schema, &mut out);
        let own = schema.get("$defs").and_then(Value::as_object);
        parts.extend(
            own.into_iter()
                .flatten()
                .map(|(k, v)| (k.clone(), v.clone())),
        );
    }
    for (name, part) in &parts {
        definition(name, part, &mut out);
    }
    out
}

/// Formats documented on other pages.
const OTHER_PAGES: [&str; 3] = ["model", "map", "case"];

fn model(out: &mut String) {
    out.push_str(
        "## The model file: poinsot.model/1\n\n\
         TOML. An unknown key is an error that names the nearest known key. `poinsot schema` prints the JSON Schema from \
         which these tables are generated and with which files are checked.\n",
    );
    schema_tables("model", "top level", out);
}

/// The tables of one format and its parts.
fn schema_tables(name: &str, heading: &str, out: &mut String) {
    let schema = poinsot::schema(name).unwrap_or_default();
    table(heading, &schema, out);
    let empty = Map::new();
    let parts = schema
        .get("$defs")
        .and_then(Value::as_object)
        .unwrap_or(&empty);
    for (name, part) in parts {
        definition(name, part, out);
    }
}

/// A named part of a schema.
fn definition(name: &str, part: &Value, out: &mut String) {
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
        let only = value.get("x-only").map(only).unwrap_or_default();
        let needed = if required.contains(&key.as_str()) {
            " **Required.**"
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "| `{key}` | {} | {}{only}{needed} |",
            kind(value),
            cell(about)
        );
    }
}

/// The values of another key with which a key is allowed.
fn only(condition: &Value) -> String {
    let keys = condition.as_object().into_iter().flatten();
    let words = |values: &Value| {
        let values = values.as_array().into_iter().flatten();
        let words: Vec<String> = values.map(|v| format!("`{v}`")).collect();
        words.join(", ").replace('"', "")
    };
    keys.map(|(key, values)| format!(" Only where `{key}` is {}.", words(values)))
        .collect()
}

/// The range of a number, as text.
fn range(value: &Value) -> String {
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
    if let Some(types) = value.get("type").and_then(Value::as_array) {
        let alone = |kind: &Value| {
            let mut one = value.clone();
            one["type"] = kind.clone();
            self::kind(&one)
        };
        let words: Vec<String> = types.iter().map(alone).collect();
        return words.join(" or ");
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
        Some(other) => format!("{other}{}", range(value)),
        None => String::new(),
    }
}
