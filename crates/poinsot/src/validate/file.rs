//! A validation as a file and its histories as CSV.

use super::Validation;
use crate::error::Error;
use crate::written::{csv_text, digests, result_json, write_files};
use std::path::{Path, PathBuf};

/// The histories, one number per row: `quantity,component,unit,time_s,model,against,difference`. Quaternions have no
/// difference; rotation vectors have no values of the two sides.
///
/// ```
/// use poinsot::validate::{ValidateRequest, validate, validation_csv};
///
/// let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
/// let request = ValidateRequest {
///     case: Some(folder.join("case.toml")),
///     against: folder.join("model.toml").into(),
///     ..ValidateRequest::default()
/// };
/// let rows = validation_csv(&validate(&request)?);
/// assert!(rows.starts_with("quantity,component,unit,time_s,model,against,difference"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn validation_csv(validation: &Validation) -> String {
    const HEAD: &str = "quantity,component,unit,time_s,model,against,difference";
    let mut rows = vec![HEAD.split(',').map(str::to_owned).collect()];
    let number = |x: Option<&f64>| x.map_or(String::new(), |x| format!("{x:e}"));
    for c in &validation.histories {
        let same = c.components == c.difference_components;
        let mut add = |component: &str, unit: &str, lists: [Option<&Vec<f64>>; 3]| {
            for (k, t) in c.time_s.iter().enumerate() {
                let place =
                    [c.file.quantity.as_str(), component, unit, &t.to_string()].map(str::to_owned);
                let values = lists.map(|list| number(list.and_then(|list| list.get(k))));
                rows.push(place.into_iter().chain(values).collect());
            }
        };
        let unit = if same { c.file.unit.as_str() } else { "1" };
        for (k, component) in c.components.iter().enumerate() {
            let difference = c.difference.get(k).filter(|_| same);
            add(
                component,
                unit,
                [c.model.get(k), c.against.get(k), difference],
            );
        }
        if !same {
            for (component, row) in c.difference_components.iter().zip(&c.difference) {
                add(component, &c.file.unit, [None, None, Some(row)]);
            }
        }
    }
    csv_text(rows)
}

/// Writes `validation.json` and `histories.csv` into a folder, which is created if missing. The validation then lists
/// the histories with their checksum.
///
/// # Errors
/// Writing fails.
///
/// ```
/// use poinsot::validate::{ValidateRequest, validate, write_validation};
///
/// # let out = std::env::temp_dir().join(format!("poinsot-validation-{}", std::process::id()));
/// let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
/// let request = ValidateRequest {
///     case: Some(folder.join("case.toml")),
///     against: folder.join("model.toml").into(),
///     ..ValidateRequest::default()
/// };
/// write_validation(&out, &mut validate(&request)?)?;
/// assert!(out.join("validation.json").exists() && out.join("histories.csv").exists());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_validation(folder: &Path, validation: &mut Validation) -> Result<Vec<PathBuf>, Error> {
    let csv = validation_csv(validation).into_bytes();
    let mut files = vec![("histories.csv".into(), csv)];
    validation.file.files = digests(&files);
    let text = result_json(folder, &validation.file, true)?;
    files.push(("validation.json".into(), text.into_bytes()));
    let mut paths = write_files(folder, &files)?;
    paths.reverse();
    Ok(paths)
}
