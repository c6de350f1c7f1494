//! The model file of Poinsot: comments, order and all other keys stay unchanged.

use super::{Measured, PartNumber, Patched, SPRING_KEYS};
use poinsot_spatial::{MassProperties, TENSOR, tensor_name};
use std::collections::BTreeSet;
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// Writes mass properties into the text of a model file, and numbers of other parts: of modes and springs, and those that it states.
///
/// # Errors
/// The text is not TOML, or has no `[[body]]`.
///
/// ```
#[doc = include_str!("../../doc/measured.txt")]
/// let text = r#"
/// [[body]]
/// name = "bus"
/// mass_kg = 9.0                 # of the drawing
/// com_m = [0.0, 0.0, 0.0]
/// inertia_kg_m2 = { xx = 1.0, yy = 1.0, zz = 1.0 }
/// "#;
/// let patched = patch_model(text, &measured)?;
/// // All else stays, comments too.
/// assert!(patched.text.contains("mass_kg = 10.0") && patched.text.contains("# of the drawing"));
/// # Ok::<(), String>(())
/// ```
pub fn patch_model(text: &str, measured: &Measured) -> Result<Patched, String> {
    let mut document: DocumentMut = text
        .parse()
        .map_err(|error| format!("this is not TOML: {error}; give the model file"))?;
    let tables = document
        .get_mut("body")
        .and_then(Item::as_array_of_tables_mut)
        .ok_or("it has no [[body]]; give the model file of the vehicle")?;
    let mut missing = Vec::new();
    for new in &measured.bodies {
        let mut same = tables
            .iter_mut()
            .filter(|t| t.get("name").and_then(Item::as_str) == Some(&new.body));
        match (same.next(), same.next()) {
            (Some(table), None) => edit_body(table, &new.properties),
            _ => missing.push(new.body.clone()),
        }
    }
    let mut parts = BTreeSet::new();
    for number in &measured.numbers {
        if let Some(table) = holder(&mut document, number) {
            edit_number(table, number);
            parts.insert(number.part.clone());
        }
    }
    Ok(Patched {
        text: document.to_string(),
        missing,
        parts,
    })
}

/// The table that states a number of a part, is a mode, or is the spring of a joint. No two parts have the name.
fn holder<'t>(document: &'t mut DocumentMut, number: &PartNumber) -> Option<&'t mut dyn TableLike> {
    let arrays = document.iter_mut().filter(|(key, _)| *key != "body");
    let all = arrays.flat_map(|(key, item)| {
        let is_mode = key == "mode";
        let tables = item.as_array_of_tables_mut().into_iter();
        tables
            .flat_map(ArrayOfTables::iter_mut)
            .map(move |table| (is_mode, table))
    });
    let mut same = all.filter(|(_, t)| t.get("name").and_then(Item::as_str) == Some(&number.part));
    let (is_mode, table) = same.next().filter(|_| same.next().is_none())?;
    if is_mode || table.contains_key(&number.key) {
        return Some(table);
    }
    let is_springs = SPRING_KEYS.iter().flatten().any(|key| *key == number.key);
    let spring = table.get_mut("spring_damper").filter(|_| is_springs)?;
    spring.as_table_like_mut()
}

fn edit_number(table: &mut dyn TableLike, number: &PartNumber) {
    let entry = table.entry(&number.key);
    let Some(component) = &number.component else {
        return set(entry, number.value.into());
    };
    let axis = ["x", "y", "z"].iter().position(|axis| axis == component);
    let item = entry.or_insert_with(|| {
        Item::Value(match axis {
            Some(_) => Array::from_iter([0.0; 3]).into(),
            None => InlineTable::new().into(),
        })
    });
    if let (Some(array), Some(axis)) = (item.as_array_mut(), axis)
        && axis < array.len()
    {
        array.replace(axis, number.value);
    } else if let Some(elements) = item.as_table_like_mut() {
        set(elements.entry(component), number.value.into());
    }
}

fn edit_body(table: &mut Table, new: &MassProperties) {
    set(table.entry("mass_kg"), new.mass.into());
    let centre = Array::from_iter(new.p_BoBcm_B.iter().copied());
    set(table.entry("com_m"), centre.into());
    let inertia = table
        .entry("inertia_kg_m2")
        .or_insert_with(|| Item::Value(InlineTable::new().into()));
    if let Some(elements) = inertia.as_table_like_mut() {
        for (k, at) in TENSOR.into_iter().enumerate() {
            let value = Value::from(new.I_BBcm_B[at]);
            set(elements.entry(tensor_name(k)), value);
        }
    }
}

/// Sets a value; blanks and comments around the old one are kept.
fn set(entry: toml_edit::Entry<'_>, mut new: Value) {
    match entry {
        toml_edit::Entry::Occupied(mut old) => {
            if let Some(value) = old.get().as_value() {
                *new.decor_mut() = value.decor().clone();
            }
            old.insert(Item::Value(new));
        }
        toml_edit::Entry::Vacant(vacant) => {
            vacant.insert(Item::Value(new));
        }
    }
}
