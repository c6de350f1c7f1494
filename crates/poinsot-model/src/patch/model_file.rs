//! The model file of Poinsot: comments, order and all other keys stay unchanged.

use super::{BodyProperties, Patched};
use poinsot_spatial::{MassProperties, TENSOR, tensor_name};
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// Writes mass properties into the text of a model file.
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
pub fn patch_model(text: &str, bodies: &[BodyProperties]) -> Result<Patched, String> {
    let mut document: DocumentMut = text
        .parse()
        .map_err(|error| format!("this is not TOML: {error}; give the model file"))?;
    let tables = document
        .get_mut("body")
        .and_then(Item::as_array_of_tables_mut)
        .ok_or("it has no [[body]]; give the model file of the vehicle")?;
    let mut missing = Vec::new();
    for new in bodies {
        let mut same = tables
            .iter_mut()
            .filter(|t| t.get("name").and_then(Item::as_str) == Some(&new.body));
        match (same.next(), same.next()) {
            (Some(table), None) => edit_body(table, &new.properties),
            _ => missing.push(new.body.clone()),
        }
    }
    Ok(Patched {
        text: document.to_string(),
        missing,
    })
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
