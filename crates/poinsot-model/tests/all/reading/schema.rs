//! The shipped examples and their schema.

use super::keys::full;
use super::shipped;
use poinsot_model::{EstimateSet, Nuisance, model_schema, read_model};

#[test]
fn exact_examples_load_without_notes() {
    for path in shipped() {
        let model = read_model(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(model.notes, Vec::<String>::new(), "{}", path.display());
    }
    let xu = read_model(&shipped()[3]).unwrap();
    assert_eq!(
        (xu.bodies.len(), xu.joints.len(), xu.thrusters.len()),
        (7, 6, 12)
    );
    assert!(xu.bodies.iter().all(|b| b.estimate == EstimateSet::ALL));
    let ma = read_model(&shipped()[2]).unwrap();
    assert_eq!(ma.sensors[0].bias, Nuisance::Estimate);
    assert_eq!(ma.bodies[4].nominal.mass, 0.0);
}

#[test]
fn exact_schema_has_every_key_of_the_examples() {
    let schema = model_schema();
    assert!(schema["properties"]["body"]["description"].is_string());
    assert!(!schema.to_string().contains("null"), "TOML has no null");
    let mut texts: Vec<String> = shipped()
        .iter()
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    texts.push(full());
    for text in texts {
        let table: toml::Table = toml::from_str(&text).unwrap();
        assert_keys(&schema, &schema, &toml::Value::Table(table));
    }
}

/// Checks a file against the schema, independently of the reader.
fn assert_keys(root: &serde_json::Value, schema: &serde_json::Value, value: &toml::Value) {
    let mut alternatives = vec![schema];
    let mut k = 0;
    while k < alternatives.len() {
        if let Some(path) = alternatives[k].get("$ref").and_then(|r| r.as_str()) {
            alternatives.push(root.pointer(path.trim_start_matches('#')).unwrap());
        }
        for list in ["anyOf", "oneOf"] {
            alternatives.extend(
                alternatives[k]
                    .get(list)
                    .and_then(|l| l.as_array())
                    .into_iter()
                    .flatten(),
            );
        }
        k += 1;
    }
    match value {
        toml::Value::Table(table) => {
            let object = alternatives
                .iter()
                .find(|a| a["type"] == "object")
                .expect("an object");
            for (key, value) in table {
                let inner = object["properties"].get(key);
                let inner =
                    inner.or_else(|| object.get("additionalProperties").filter(|a| a.is_object()));
                assert_keys(
                    root,
                    inner.unwrap_or_else(|| panic!("{key} is not in the schema")),
                    value,
                );
            }
        }
        toml::Value::Array(items) => {
            let list = alternatives
                .iter()
                .find(|a| a["type"] == "array")
                .expect("a list");
            for item in items.iter().filter(|item| item.is_table()) {
                assert_keys(root, &list["items"], item);
            }
        }
        _ => {}
    }
}

#[test]
fn unit_every_quantity_in_the_schema_is_described_with_its_unit() {
    let schema = model_schema();
    let mut checked = 0;
    for (_, table) in schema["$defs"].as_object().unwrap() {
        for (key, property) in table["properties"].as_object().into_iter().flatten() {
            for (suffix, unit) in [
                ("_kg", "kg"),
                ("_kg_m2", "kg m2"),
                ("_m", " m"),
                ("_N_s", "N s"),
                ("_N_per_m", "N/m"),
                ("_N_m_s_per_rad", "N m s/rad"),
            ] {
                // A stiffness in N/m is not a length.
                if key.ends_with(suffix) && (suffix.contains("per") || !key.contains("_per_")) {
                    let text = property["description"].as_str().unwrap();
                    assert!(text.contains(unit), "{key}: {text}");
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 15);
}
