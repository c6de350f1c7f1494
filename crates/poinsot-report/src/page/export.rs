//! Numbers for copying: TOML for a model file, CSV for a spreadsheet, JSON for a program.

use super::numbers::half_width;
use indexmap::IndexMap;
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
    let bodies: Vec<(&str, &BodyFile)> = e.bodies.iter().map(|(n, b)| (n.as_str(), b)).collect();
    let all = |of: fn(&str, &BodyFile) -> String| -> String {
        bodies.iter().map(|(name, b)| of(name, b)).collect()
    };
    let head = "body,quantity,unit,value,half_width_95,nominal,source\n";
    let entries: IndexMap<&str, _> = bodies.iter().map(|(n, b)| (*n, entries(b))).collect();
    [
        Export {
            label: "TOML",
            name: "mass_properties.toml",
            text: all(toml),
        },
        Export {
            label: "CSV",
            name: "mass_properties.csv",
            text: format!("{head}{}", all(csv)),
        },
        Export {
            label: "JSON",
            name: "mass_properties.json",
            text: serde_json::to_string_pretty(&entries).unwrap_or_default() + "\n",
        },
    ]
}

/// The value; for a known number, that of the model.
fn best(n: &NumberFile) -> Option<f64> {
    if n.is_known() {
        Some(n.nominal)
    } else {
        n.value
    }
}

/// A body in the format of a model file, without undetermined numbers.
fn toml(name: &str, b: &BodyFile) -> String {
    let mut out = format!("[[body]]\nname = {}\n", toml::Value::from(name));
    let centre = [0, 1, 2].map(|k| best(&b.com_m.number(k)));
    let inertia = b
        .inertia_kg_m2
        .named()
        .map(|(k, n)| best(n).map(|v| format!("{k} = {v:?}")));
    let mut line = |key: &str, text: Option<String>| match text {
        Some(text) => out.push_str(&format!("{key} = {text}\n")),
        None => out.push_str(&format!("# {key}: not determined\n")),
    };
    line("mass_kg", best(&b.mass_kg).map(|v| format!("{v:?}")));
    let centre: Option<Vec<String>> = centre.iter().map(|v| v.map(|v| format!("{v:?}"))).collect();
    line("com_m", centre.map(|c| format!("[{}]", c.join(", "))));
    let inertia: Option<Vec<String>> = inertia.into_iter().collect();
    line(
        "inertia_kg_m2",
        inertia.map(|i| format!("{{ {} }}", i.join(", "))),
    );
    out.push('\n');
    out
}

fn csv(name: &str, b: &BodyFile) -> String {
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:?}"));
    b.numbers()
        .iter()
        .map(|(what, unit, n)| {
            let source = n.source.as_deref().unwrap_or("not determined");
            format!(
                "\"{}\",{},{},{},{},{:?},{source}\n",
                name.replace('"', "\"\""),
                what.replace(' ', "_"),
                unit.replace('²', "2"),
                number(best(n)),
                number(half_width(n.sigma)),
                n.nominal,
            )
        })
        .collect()
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
            value: best(&n),
            half_width_95: half_width(n.sigma),
            nominal: n.nominal,
            source: n.source,
        };
        (what.replace(' ', "_"), entry)
    };
    b.numbers().into_iter().map(entry).collect()
}
