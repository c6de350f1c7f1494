//! Numbers for copying: TOML for a model file, CSV for a spreadsheet, JSON for a program.

use indexmap::IndexMap;
use poinsot_figures::half_width;
use poinsot_formats::{BodyFile, EstimateFile, NumberFile};
use serde::Serialize;

/// A text with its file name.
#[derive(Serialize)]
pub(super) struct Export {
    label: &'static str,
    name: &'static str,
    text: String,
}

pub(super) fn exports(e: &EstimateFile) -> [Export; 3] {
    let all = |of: fn(&str, &BodyFile) -> String| -> String {
        e.bodies.iter().map(|(name, b)| of(name, b)).collect()
    };
    let head = "body,quantity,unit,value,half_width_95,nominal,source\n";
    let numbers: IndexMap<&String, _> = e.bodies.iter().map(|(n, b)| (n, entries(b))).collect();
    let json = serde_json::to_string_pretty(&numbers).unwrap_or_default();
    let export = |label, name, text| Export { label, name, text };
    [
        export("TOML", "mass_properties.toml", all(toml)),
        export("CSV", "mass_properties.csv", format!("{head}{}", all(csv))),
        export("JSON", "mass_properties.json", json + "\n"),
    ]
}

/// The value as text; for a known number, that of the model.
fn best(n: &NumberFile) -> Option<String> {
    n.value.map(|v| format!("{v:?}"))
}

/// A body in the format of a model file, without undetermined numbers.
fn toml(name: &str, b: &BodyFile) -> String {
    let centre = b
        .com_m
        .map(best)
        .into_iter()
        .collect::<Option<Vec<String>>>();
    let element = |(k, n): (&str, &NumberFile)| Some(format!("{k} = {}", best(n)?));
    let inertia = b.inertia_kg_m2.named().map(element);
    let inertia = inertia.into_iter().collect::<Option<Vec<String>>>();
    let lines = [
        ("mass_kg", best(&b.mass_kg)),
        ("com_m", centre.map(|c| format!("[{}]", c.join(", ")))),
        (
            "inertia_kg_m2",
            inertia.map(|i| format!("{{ {} }}", i.join(", "))),
        ),
    ];
    let line = |(key, text): (&str, Option<String>)| match text {
        Some(text) => format!("{key} = {text}\n"),
        None => format!("# {key}: not determined\n"),
    };
    let lines: String = lines.map(line).concat();
    format!("[[body]]\nname = {}\n{lines}\n", toml::Value::from(name))
}

fn csv(name: &str, b: &BodyFile) -> String {
    let name = name.replace('"', "\"\"");
    let row = |(what, e): (String, Entry)| {
        let source = e.source.as_deref().unwrap_or("not determined");
        let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:?}"));
        let (value, half) = (number(e.value), number(e.half_width_95));
        let (unit, nominal) = (e.unit, e.nominal);
        format!("\"{name}\",{what},{unit},{value},{half},{nominal:?},{source}\n")
    };
    entries(b).into_iter().map(row).collect()
}

/// One number of the JSON text; `null` if not determined.
#[derive(Serialize)]
struct Entry {
    unit: String,
    value: Option<f64>,
    half_width_95: Option<f64>,
    nominal: f64,
    source: Option<String>,
}

fn entries(b: &BodyFile) -> IndexMap<String, Entry> {
    let entry = |(what, unit, n): (String, &str, NumberFile)| {
        let entry = Entry {
            unit: unit.replace('²', "2"),
            value: n.value,
            half_width_95: half_width(n.sigma),
            nominal: n.nominal,
            source: n.source,
        };
        (what.replace(' ', "_"), entry)
    };
    b.numbers().into_iter().map(entry).collect()
}
