//! Converts earlier versions of result files to the current structure before they are parsed.

use crate::address::address;
use crate::estimate::ReferenceFile;
use serde_json::{Map, Value};

/// Name suffixes of nuisance parameters in version 1; longer ones before those that they end in.
const UNITS_1: [(&str, &str); 10] = [
    ("_kg_m2", "kg m2"),
    ("_rad_s2", "rad/s2"),
    ("_rad_s", "rad/s"),
    ("_m_s2", "m/s2"),
    ("_m_s", "m/s"),
    ("_N_m", "N m"),
    ("_rad", "rad"),
    ("_m", "m"),
    ("_s", "s"),
    ("_N", "N"),
];

/// `estimate/1`: vectors and tensors were tables of value, sigma, nominal and source; names had no unit, or a unit
/// suffix.
pub(crate) fn estimate_1(file: &mut Value) {
    let bodies = file.get("bodies").and_then(Value::as_object);
    let base = bodies.and_then(|b| b.keys().next().cloned());
    bodies_1(file);
    rename(file.get_mut("nuisance"), nuisance_1);
    addresses_1(file);
    let reference = ReferenceFile::of_base(&base.unwrap_or_default());
    if let (Some(file), Ok(reference)) = (file.as_object_mut(), serde_json::to_value(reference)) {
        file.insert("reference".to_owned(), reference);
    }
}

/// `truth/1`: as `estimate/1`, with values only. Sensor errors, listed by unit, are dropped.
pub(crate) fn truth_1(file: &mut Value) {
    bodies_1(file);
    if let Some(file) = file.as_object_mut() {
        // Version 1 has null if a case without samples has no start.
        file.retain(|_, value| !value.is_null());
        file.remove("noise");
    }
}

/// Bodies, the whole, and momentum.
fn bodies_1(file: &mut Value) {
    let bodies = file.get_mut("bodies").and_then(Value::as_object_mut);
    let bodies = bodies.into_iter().flat_map(Map::values_mut);
    bodies.for_each(body_1);
    list(file, "system").for_each(body_1);
    list(file, "momentum").for_each(momentum_1);
}

fn list<'v>(file: &'v mut Value, key: &str) -> impl Iterator<Item = &'v mut Value> {
    let items = file.get_mut(key).and_then(Value::as_array_mut);
    items.into_iter().flatten()
}

fn body_1(body: &mut Value) {
    elements(body.get_mut("com_m"), &AXES);
    elements(body.get_mut("inertia_kg_m2"), &TENSOR);
    if let Some(about) = body.get_mut("barycentric") {
        elements(about.get_mut("mc_kg_m"), &AXES);
        elements(about.get_mut("I_BBo_kg_m2"), &TENSOR);
    }
    if let Some(joints) = body.as_object_mut().and_then(|b| b.remove("joints")) {
        body["joint_positions"] = joints;
    }
}

fn momentum_1(momentum: &mut Value) {
    for key in ["linear_N_s", "angular_N_m_s"] {
        elements(momentum.get_mut(key), &AXES);
    }
}

/// Names of the components of a vector and of a tensor in version 1.
const AXES: [&str; 3] = ["x", "y", "z"];
const TENSOR: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

/// From `{ value: [..] }` or `{ value: { xx: .. } }` to `{ x: { value: .. } }`.
fn elements(quantity: Option<&mut Value>, names: &[&str]) {
    let Some(quantity) = quantity else { return };
    let Some(parts) = quantity.as_object() else {
        return;
    };
    let one = |k: usize, name: &str| -> Value {
        let part = |(key, of): (&String, &Value)| {
            let found = of.get(name).or_else(|| of.get(k));
            (key.clone(), found.cloned().unwrap_or(Value::Null))
        };
        parts.iter().map(part).collect::<Map<_, _>>().into()
    };
    let all = names.iter().enumerate();
    let all: Map<String, Value> = all.map(|(k, n)| ((*n).to_owned(), one(k, n))).collect();
    *quantity = all.into();
}

/// Converts `gyro.bias_x_rad_s` to `gyro.bias_rad_s.x`.
fn nuisance_1(name: &str) -> String {
    let unit = UNITS_1.iter().find(|(end, _)| name.ends_with(end));
    match unit {
        Some((end, unit)) => address(&name[..name.len() - end.len()], unit),
        None => address(name, "1"),
    }
}

fn rename(table: Option<&mut Value>, name: impl Fn(&str) -> String) {
    let Some(table) = table.and_then(Value::as_object_mut) else {
        return;
    };
    let old = std::mem::take(table);
    *table = old.into_iter().map(|(key, v)| (name(&key), v)).collect();
}

/// Converts names in the covariance, in combinations and in known numbers.
fn addresses_1(file: &mut Value) {
    let mut known: Vec<(String, String)> = Vec::new();
    if let Some(covariance) = file.get_mut("covariance") {
        let units = covariance.get("units").cloned().unwrap_or_default();
        let names = covariance.get_mut("names").and_then(Value::as_array_mut);
        for (k, name) in names.into_iter().flatten().enumerate() {
            let unit = units.get(k).and_then(Value::as_str).unwrap_or("1");
            let old = name.as_str().unwrap_or("").to_owned();
            let new = address(&old, unit);
            *name = new.clone().into();
            known.push((old, new));
        }
    }
    let of_covariance = |old: &str| {
        let found = known.iter().find(|(name, _)| name == old);
        found.map_or_else(|| address(old, "1"), |(_, new)| new.clone())
    };
    if let Some(found) = file.get_mut("identifiability") {
        for key in ["identifiable", "not_identifiable"] {
            for one in list(found, key) {
                rename(one.get_mut("coefficients"), of_covariance);
            }
        }
    }
    let Some(numbers) = file.get_mut("known_numbers") else {
        return;
    };
    rename(numbers.get_mut("sigma_data"), of_covariance);
    for one in list(numbers, "sensitivities") {
        let text = |key: &str| one.get(key).and_then(Value::as_str).unwrap_or("1");
        one["number"] = address(text("number"), text("unit")).into();
        rename(one.get_mut("change"), of_covariance);
        rename(one.get_mut("variance_share"), of_covariance);
    }
}
