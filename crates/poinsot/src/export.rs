//! The verb `export`: the answer of `identify` in the file of another program.

use crate::error::{Error, unreadable};
use crate::report::LARGEST_RESULT;
use poinsot_model::{LinkInertial, export_urdf, parse_urdf, read_model_text};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use serde_json::Value;
use std::path::Path;

/// A file with what was identified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The text.
    pub text: String,
    /// Bodies that were not exported, and why.
    pub left_out: Vec<String>,
}

/// Puts every fully determined body of `folder/estimate.json` into the URDF file; every other byte stays.
/// A body of which a number is not identifiable keeps its old ones and is named.
///
/// # Errors
/// The files cannot be read, or no body is determined.
pub fn export_into_urdf(folder: &Path, urdf: &Path) -> Result<Exported, Error> {
    let path = folder.join("estimate.json");
    let fault = |path: &Path, why: String| Error::Report {
        path: path.to_owned(),
        why,
    };
    let bytes = poinsot_files::read(&path, LARGEST_RESULT).map_err(|e| unreadable(&path, e))?;
    let estimate: Value = serde_json::from_slice(&bytes).map_err(|e| {
        fault(
            &path,
            format!("{e}; write it anew with `poinsot identify --out DIR`"),
        )
    })?;
    if estimate["schema"] != "poinsot.estimate/1" {
        return Err(fault(
            &path,
            "it is no poinsot.estimate/1; give the folder of identify --out".to_owned(),
        ));
    }
    let text = read_model_text(urdf)?;
    parse_urdf(&text, &urdf.display().to_string()).model?;
    let mut links = Vec::new();
    let mut left_out = Vec::new();
    for (name, body) in estimate["bodies"].as_object().into_iter().flatten() {
        if !asked(body) {
            continue;
        }
        match properties(body) {
            Some(properties) => links.push(LinkInertial {
                link: name.clone(),
                properties,
            }),
            None => left_out.push(format!(
                "not exported: {name}: not all of its mass, mass centre and inertia are determined; the file's numbers stay"
            )),
        }
    }
    let exported = export_urdf(&text, &links);
    left_out.extend(
        exported
            .missing
            .iter()
            .map(|name| format!("not exported: {name}: the file has no link of this name")),
    );
    if links.len() == exported.missing.len() {
        let why = format!(
            "no body can be exported ({}); identify with more data, or give the URDF file of the model",
            left_out.join("; ")
        );
        return Err(fault(&path, why));
    }
    Ok(Exported {
        text: exported.text,
        left_out,
    })
}

/// Whether any number of the body was to be found.
fn asked(body: &Value) -> bool {
    let known = |v: &Value| v == "known";
    let inertia = body["inertia_kg_m2"]["source"].as_object();
    !(known(&body["mass_kg"]["source"])
        && body["com_m"]["source"]
            .as_array()
            .is_some_and(|s| s.iter().all(known))
        && inertia.is_some_and(|s| s.values().all(known)))
}

fn properties(body: &Value) -> Option<MassProperties> {
    let com = body["com_m"]["value"].as_array()?;
    let at = |k: usize| com.get(k).and_then(Value::as_f64);
    let i = |name: &str| body["inertia_kg_m2"]["value"][name].as_f64();
    let (xy, xz, yz) = (i("xy")?, i("xz")?, i("yz")?);
    Some(MassProperties {
        mass: body["mass_kg"]["value"].as_f64()?,
        p_BoBcm_B: Vector3::new(at(0)?, at(1)?, at(2)?),
        I_BBcm_B: Matrix3::new(i("xx")?, xy, xz, xy, i("yy")?, yz, xz, yz, i("zz")?),
    })
}
