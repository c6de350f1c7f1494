//! The verb `export`: the answer of `identify` in the file of another program.

use crate::compare::format_error;
use crate::error::Error;
use poinsot_formats::{BodyFile, EstimateFile, read_estimate};
use poinsot_model::{LinkInertial, export_urdf, parse_urdf, read_model_text};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
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
    let (path, estimate) = read_estimate(&folder.join("estimate.json")).map_err(format_error)?;
    export_estimate_into_urdf(&estimate, &path, urdf)
}

/// The same with an estimate in memory; messages call it `path`.
///
/// # Errors
/// As [`export_into_urdf`].
pub fn export_estimate_into_urdf(
    estimate: &EstimateFile,
    path: &Path,
    urdf: &Path,
) -> Result<Exported, Error> {
    let fault = |path: &Path, why: String| Error::Report {
        path: path.to_owned(),
        why,
    };
    let text = read_model_text(urdf)?;
    parse_urdf(&text, &urdf.display().to_string()).model?;
    let mut links = Vec::new();
    let mut left_out = Vec::new();
    for (name, body) in &estimate.bodies {
        if !body.is_asked() {
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
        return Err(fault(path, why));
    }
    Ok(Exported {
        text: exported.text,
        left_out,
    })
}

fn properties(body: &BodyFile) -> Option<MassProperties> {
    let [x, y, z] = body.com_m.value;
    let i = &body.inertia_kg_m2.value;
    let (xy, xz, yz) = (i.xy?, i.xz?, i.yz?);
    Some(MassProperties {
        mass: body.mass_kg.value?,
        p_BoBcm_B: Vector3::new(x?, y?, z?),
        I_BBcm_B: Matrix3::new(i.xx?, xy, xz, xy, i.yy?, yz, xz, yz, i.zz?),
    })
}
