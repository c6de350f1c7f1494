//! Addresses of numbers in a case or model file: `body.arm.mass_kg`, `bus.inertia_kg_m2.xx`, `output.rate_hz`,
//! `joint_motion.joint1.sine_rad.0`; and `noise` or `gyro.noise`, a factor on declared noise and rounding steps.
//!
//! The grammar is that of `poinsot_formats::Address`. The steps of an address are keys. In a list of tables a step is
//! the name of an element (its `name`, `joint`, `wheel` or `thruster`) or its number from zero. In a list of numbers
//! it is a number from zero, or x, y, z, w. An address may begin with the name of a body, joint, wheel, thruster or
//! sensor, as in results (`bus.com_m.x`, `gyro.bias_rad_s.x`). If several parts have that name, the one with the key
//! is meant.

use crate::case::did_you_mean;
use poinsot_formats::{Address, OfFile, element as number_of};
use std::path::PathBuf;
use toml::Value;

/// Lists of the model whose element names may start an address.
const NAMED: [&str; 5] = ["body", "joint", "wheel", "thruster", "sensor"];
/// Keys that name an element of a list.
const NAMES: [&str; 4] = ["name", "joint", "wheel", "thruster"];
/// Last step of an address of declared noise.
const NOISE: &str = "noise";
/// Prefixes of the sensor keys that the noise factor scales.
const NOISY: [&str; 2] = ["noise_", "quantisation_"];

/// A file of an experiment.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub path: PathBuf,
    /// As read.
    pub text: String,
    /// Its table; an URDF file has none.
    pub table: Option<Value>,
}

/// The files of an experiment.
#[derive(Debug, Clone)]
pub(crate) struct Documents {
    /// The case, if the experiment is simulated.
    pub case: Option<Document>,
    /// The model with the true numbers.
    pub truth: Document,
    /// The nominal model of the identification.
    pub nominal: Document,
    /// Whether the tables differ from the texts.
    pub changed: bool,
}

impl Document {
    pub fn new(path: PathBuf, text: String) -> Self {
        let table = text.parse().map(Value::Table).ok();
        Self { path, text, table }
    }
}

/// New value of a number, from its index in the address and its value in the file.
pub(crate) type Edit<'a> = dyn FnMut(usize, f64) -> f64 + 'a;

/// Why an address names no number, and what to do.
pub(crate) type Refusal = (String, String);

/// Changes the numbers at an address.
///
/// # Errors
/// The address names no number; the texts are fault and remedy.
pub(crate) fn edit(
    documents: &mut Documents,
    address: &str,
    of: OfFile,
    change: &mut Edit<'_>,
) -> Result<(), Refusal> {
    documents.changed = true;
    let address = Address::parse(address);
    let mut case = documents.case.as_mut().and_then(|d| d.table.as_mut());
    if let Some(case) = case.as_deref_mut()
        && let Some(way) = way_in_case(case, address)
    {
        if of == OfFile::Nominal {
            let what = "a case has no nominal numbers: identification uses telemetry, not the case";
            return Err((what.to_owned(), "write of = \"both\"".to_owned()));
        }
        return change_leaves(walk(case, &way)?, change);
    }
    let nominal = Some(&mut documents.nominal).filter(|_| of != OfFile::Truth);
    let truth = Some(&mut documents.truth).filter(|_| of != OfFile::Nominal);
    for model in truth.into_iter().chain(nominal) {
        let model = model.table.as_mut().ok_or_else(|| {
            let what = "the model is not TOML, and an address is a key of TOML";
            let remedy = "make a model file of it: poinsot import ROBOT.urdf -o MODEL.toml";
            (what.to_owned(), remedy.to_owned())
        })?;
        if address.quantity() == NOISE && address.component().is_none() {
            let owner = address.owner();
            let sensor = owner.strip_prefix("sensor.").unwrap_or(owner);
            scale_noise(model, sensor, change)?;
        } else {
            let way = way_in_model(model, address, case.as_deref())?;
            change_leaves(walk(model, &way)?, change)?;
        }
    }
    Ok(())
}

/// Steps from the top of a file: those to an element, then the rest of the address.
fn way(to: &[&str], rest: Address<'_>) -> Vec<String> {
    let to = to.iter().copied();
    to.chain(rest.steps()).map(str::to_owned).collect()
}

/// Steps of an address in the case: its own, or that of a sensor output, `gyro.bias_rad_s.x`.
fn way_in_case(case: &Value, address: Address<'_>) -> Option<Vec<String>> {
    let first = address.first();
    if case.get(first).is_some() && !matches!(first, "schema" | "model") {
        return Some(way(&[], address));
    }
    let sensors = case.get("output")?.get("sensor")?;
    let (at, rest) = owned(sensors, address)?;
    sensors.get(at)?.get(rest.first())?;
    Some(way(&["output", "sensor", &at.to_string()], rest))
}

/// The list element named at the start of an address, and the rest of the address. Names may contain dots.
fn owned<'a>(list: &Value, address: Address<'a>) -> Option<(usize, Address<'a>)> {
    let items = list.as_array()?;
    let mut owners = address.owners();
    owners.find_map(|(name, rest)| Some((element(items, name)?, rest)))
}

/// Steps of an address in a model.
fn way_in_model(
    model: &Value,
    address: Address<'_>,
    case: Option<&Value>,
) -> Result<Vec<String>, Refusal> {
    let first = address.first();
    if model.get(first).is_some() {
        return Ok(way(&[], address));
    }
    let of_list = |list: &'static str| {
        let (at, rest) = owned(model.get(list)?, address)?;
        Some((list, at, rest))
    };
    let mut owners: Vec<_> = NAMED.into_iter().filter_map(of_list).collect();
    // A body and its joint may share a name: the key decides.
    let has = |(list, at, rest): &(&str, usize, Address<'_>)| {
        let item = model.get(*list).and_then(|l| l.get(*at));
        item.is_some_and(|item| item.get(rest.first()).is_some())
    };
    if owners.iter().filter(|o| has(o)).count() == 1 {
        owners.retain(has);
    }
    match owners.as_slice() {
        [(list, at, rest)] => Ok(way(&[list, &at.to_string()], *rest)),
        [] => {
            let mut known = known_below(model);
            known.extend(case.map(known_below).unwrap_or_default());
            let lists = NAMED.iter().filter_map(|list| model.get(list));
            known.extend(lists.flat_map(known_below));
            known.push(NOISE.to_owned());
            let what = format!("no key, body, joint, wheel, thruster or sensor \"{first}\"");
            Err((what, did_you_mean(first, known.iter().map(String::as_str))))
        }
        [(list, ..), ..] => {
            let lists: Vec<&str> = owners.iter().map(|o| o.0).collect();
            let what = format!("\"{first}\" is the name of a {}", lists.join(" and a "));
            let text = address.text();
            let remedy = format!("begin the address with one of them: {list}.{text}");
            Err((what, remedy))
        }
    }
}

/// Index of a list element: of a number by x, y, z, w or its index, of a table by name or index. Several firings of one
/// thruster are ambiguous.
fn element(items: &[Value], step: &str) -> Option<usize> {
    let named = items.iter().any(Value::is_table);
    let index = if named {
        step.parse().ok()
    } else {
        number_of(step)
    };
    if index.is_some() || !named {
        return index.filter(|at| *at < items.len());
    }
    let text = |item: &Value, key: &&str| item.get(*key).and_then(Value::as_str) == Some(step);
    let is = |item: &&Value| NAMES.iter().any(|key| text(item, key));
    let mut found = items.iter().enumerate().filter(|(_, item)| is(item));
    let first = found.next()?.0;
    found.next().is_none().then_some(first)
}

/// The value at these steps.
fn walk<'v>(mut value: &'v mut Value, way: &[String]) -> Result<&'v mut Value, Refusal> {
    for step in way {
        let known = known_below(value);
        let found = match value {
            Value::Array(items) => element(items, step).and_then(|at| items.get_mut(at)),
            Value::Table(table) => table.get_mut(step),
            _ => None,
        };
        value = found.ok_or_else(|| absent(step, &known))?;
    }
    Ok(value)
}

fn known_below(value: &Value) -> Vec<String> {
    match value {
        Value::Table(table) => table.keys().cloned().collect(),
        Value::Array(items) => {
            let name = |(k, item): (usize, &Value)| {
                let mut names = NAMES.iter().filter_map(|n| item.get(n)?.as_str());
                names.next().map_or(k.to_string(), str::to_owned)
            };
            items.iter().enumerate().map(name).collect()
        }
        _ => Vec::new(),
    }
}

fn absent(step: &str, known: &[String]) -> Refusal {
    let what = format!("there is no \"{step}\" here, or several elements bear this name");
    let remedy = match known {
        [] => "end the address before it".to_owned(),
        known => {
            let near = did_you_mean(step, known.iter().map(String::as_str));
            format!("{near}; a number that the file leaves to its default is written there first")
        }
    };
    (what, remedy)
}

/// Scales the declared noise of a sensor, or of all if `wanted` is empty.
fn scale_noise(model: &mut Value, wanted: &str, change: &mut Edit<'_>) -> Result<(), Refusal> {
    let factor = change(0, 1.0);
    let sensors = model.get_mut("sensor").and_then(Value::as_array_mut);
    let (mut names, mut scaled) = (Vec::new(), false);
    for sensor in sensors.into_iter().flatten() {
        let name = sensor.get("name").and_then(Value::as_str);
        let name = name.unwrap_or_default().to_owned();
        let own = wanted.is_empty() || wanted == name;
        let keys = sensor.as_table_mut().filter(|_| own).into_iter().flatten();
        for (_, value) in keys.filter(|(key, _)| NOISY.iter().any(|n| key.starts_with(n))) {
            change_leaves(value, &mut |_, x| factor * x)?;
            scaled = true;
        }
        names.push(name);
    }
    let (what, remedy) = match wanted {
        "" => (
            "no sensor declares noise".to_owned(),
            "add [[sensor]] with its noise to the model".to_owned(),
        ),
        name => (
            format!("no sensor \"{name}\" that declares noise"),
            did_you_mean(name, names.iter().map(String::as_str)),
        ),
    };
    scaled.then_some(()).ok_or((what, remedy))
}

/// Changes every number of a value: a number, a list, a table, or nested lists.
fn change_leaves(value: &mut Value, change: &mut Edit<'_>) -> Result<(), Refusal> {
    let mut count = 0;
    visit(value, &mut count, change);
    if count == 0 {
        let what = format!("there is no number here but {}", value.type_str());
        return Err((what, "end the address at a number".to_owned()));
    }
    Ok(())
}

fn visit(value: &mut Value, count: &mut usize, change: &mut Edit<'_>) {
    match value {
        Value::Integer(old) => {
            let new = change(*count, *old as f64);
            *count += 1;
            // A seed or a count stays an integer.
            *value = match new.fract() == 0.0 && new.abs() < 1.0e15 {
                true => Value::Integer(new as i64),
                false => Value::Float(new),
            };
        }
        Value::Float(old) => {
            *old = change(*count, *old);
            *count += 1;
        }
        Value::Array(items) => items.iter_mut().for_each(|v| visit(v, count, change)),
        Value::Table(table) => table.iter_mut().for_each(|(_, v)| visit(v, count, change)),
        _ => {}
    }
}

/// Number of numbers that an address names.
///
/// # Errors
/// As [`edit`].
pub(crate) fn count(documents: &Documents, address: &str, of: OfFile) -> Result<usize, Refusal> {
    let (mut most, mut copy) = (0, documents.clone());
    edit(&mut copy, address, of, &mut |k, x| {
        most = most.max(k + 1);
        x
    })?;
    Ok(most)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const BOTH: OfFile = OfFile::Both;

    fn documents() -> Documents {
        let model: Value = toml::from_str(
            r#"
name = "made"
[[body]]
name = "bus"
mass_kg = 5
com_m = [1.0, 2.0, 3.0]
inertia_kg_m2 = { xx = 1.0, yy = 2.0 }
[[body]]
name = "arm"
mass_kg = 2.5
[[joint]]
name = "arm"
origin_m = [0.0, 0.0, 1.0]
[[sensor]]
name = "gyro"
noise_rad_s = [1e-4, 2e-4, 3e-4]
quantisation_rad_s = 1e-5
[[sensor]]
name = "tracker"
noise_rad = 1e-3
"#,
        )
        .unwrap();
        let case: Value = toml::from_str(
            r#"
duration_s = 10.0
[[firing]]
thruster = "t"
on_s = 1.0
[[firing]]
thruster = "t"
on_s = 2.0
[[joint_motion]]
joint = "arm"
sine_rad = [0.1, 0.2]
[output]
rate_hz = 10
[[output.sensor]]
name = "gyro"
bias_rad_s = [0.0, 0.0, 0.0]
"#,
        )
        .unwrap();
        let document = |table| Document {
            table: Some(table),
            ..Document::new(PathBuf::new(), String::new())
        };
        Documents {
            case: Some(document(case)),
            truth: document(model.clone()),
            nominal: document(model),
            changed: false,
        }
    }

    fn set(address: &str, x: f64) -> Documents {
        let mut all = documents();
        edit(&mut all, address, BOTH, &mut |_, _| x).unwrap();
        all
    }

    #[test]
    fn unit_addresses_reach_their_numbers() {
        let model = |address: &str| set(address, 7.5).truth.table.unwrap();
        assert_eq!(
            model("body.bus.mass_kg")["body"][0]["mass_kg"].as_float(),
            Some(7.5)
        );
        assert_eq!(
            model("bus.mass_kg")["body"][0]["mass_kg"].as_float(),
            Some(7.5)
        );
        assert_eq!(
            model("bus.com_m.y")["body"][0]["com_m"][1].as_float(),
            Some(7.5)
        );
        assert_eq!(
            model("bus.inertia_kg_m2.yy")["body"][0]["inertia_kg_m2"]["yy"].as_float(),
            Some(7.5)
        );
        assert_eq!(
            model("arm.mass_kg")["body"][1]["mass_kg"].as_float(),
            Some(7.5)
        );
        assert_eq!(
            model("arm.origin_m.z")["joint"][0]["origin_m"][2].as_float(),
            Some(7.5)
        );
        assert_eq!(
            model("body.1.mass_kg")["body"][1]["mass_kg"].as_float(),
            Some(7.5)
        );
        let noisy = set("noise", 2.0).nominal.table.unwrap();
        assert_eq!(noisy["sensor"][0]["noise_rad_s"][2].as_float(), Some(6e-4));
        assert_eq!(
            noisy["sensor"][0]["quantisation_rad_s"].as_float(),
            Some(2e-5)
        );
        let gyro = set("gyro.noise", 2.0).truth.table.unwrap();
        assert_eq!(gyro["sensor"][1]["noise_rad"].as_float(), Some(1e-3));
        let case = |address: &str| set(address, 7.5).case.unwrap().table.unwrap();
        assert_eq!(case("duration_s")["duration_s"].as_float(), Some(7.5));
        assert_eq!(
            case("firing.1.on_s")["firing"][1]["on_s"].as_float(),
            Some(7.5)
        );
        assert_eq!(
            case("joint_motion.arm.sine_rad.1")["joint_motion"][0]["sine_rad"][1].as_float(),
            Some(7.5)
        );
        let bias = &case("gyro.bias_rad_s.y")["output"]["sensor"][0]["bias_rad_s"];
        assert_eq!(bias[1].as_float(), Some(7.5));
        assert_eq!(count(&documents(), "bus.com_m", BOTH), Ok(3));
    }

    #[test]
    fn unit_an_address_without_a_number_says_what_to_do() {
        for (address, what, remedy) in [
            ("bas.mass_kg", "no key, body", "did you mean \"bus\"?"),
            ("arm.about_kg", "a body and a joint", "body.arm.about_kg"),
            ("bus.mas_kg", "no \"mas_kg\"", "did you mean \"mass_kg\"?"),
            ("firing.t.on_s", "several elements", "written there first"),
            (
                "bus.name",
                "no number here but string",
                "end the address at a number",
            ),
            ("giro.noise", "no sensor \"giro\"", "did you mean \"gyro\"?"),
            ("bus.mass_kg.x", "no \"x\"", "end the address before it"),
        ] {
            let (said, advice) = edit(&mut documents(), address, BOTH, &mut |_, x| x).unwrap_err();
            assert!(
                said.contains(what) && advice.contains(remedy),
                "{address}: {said}; {advice}"
            );
        }
    }

    #[test]
    fn unit_one_side_leaves_the_other() {
        let mut all = documents();
        let truth = OfFile::Truth;
        edit(&mut all, "bus.mass_kg", truth, &mut |_, x| 1.1 * x).unwrap();
        assert_eq!(
            all.truth.table.unwrap()["body"][0]["mass_kg"].as_float(),
            Some(5.5)
        );
        assert_eq!(
            all.nominal.table.unwrap()["body"][0]["mass_kg"].as_integer(),
            Some(5)
        );
    }
}
