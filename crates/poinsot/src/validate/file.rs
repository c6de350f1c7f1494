//! A validation as a file and its histories as CSV.

use super::{Against, Compared, Completed, Validation};
use crate::error::Error;
use crate::written::{json, write_files};
use poinsot_formats::{
    ComparedQuantityFile, CompletedFile, EstimateRefFile, InSigmasFile, PredictionChangeFile,
    VALIDATION, ValidationFile, ValidationLimitsFile,
};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The result file.
///
/// ```
/// use poinsot::validate::{ValidateRequest, validate, validation_file};
///
/// let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
/// let request = ValidateRequest {
///     case: Some(folder.join("case.toml")),
///     against: folder.join("model.toml").display().to_string(),
///     ..ValidateRequest::default()
/// };
/// // Without a limit the motions are compared, not judged.
/// assert_eq!(validation_file(&validate(&request)?).verdict, "compared");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn validation_file(validation: &Validation) -> ValidationFile {
    let kind = match validation.kind {
        Against::Model => "model",
        Against::TelemetryOfCase => "telemetry_of_case",
        Against::HeldBack => "held_back_telemetry",
    };
    let estimate = validation.estimate.clone();
    ValidationFile {
        schema: VALIDATION.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        kind: kind.to_owned(),
        verdict: validation.verdict.name().to_owned(),
        model: validation.model.clone(),
        estimate: estimate.map(|(path, status)| EstimateRefFile {
            path,
            status,
            covariance_trustworthy: validation.relied_on,
        }),
        against: validation.against.clone(),
        case: validation.case.clone(),
        limits: ValidationLimitsFile {
            within_m: validation.limits.0,
            within_rad: validation.limits.1,
        },
        chi2_per_dof: validation.chi2_per_dof,
        compared: validation.compared.iter().map(compared).collect(),
        completed: validation.completed.as_ref().map(completed),
        warnings: validation.warnings.clone(),
        repairs: validation.repairs.clone(),
    }
}

fn compared(c: &Compared) -> ComparedQuantityFile {
    ComparedQuantityFile {
        quantity: c.name.clone(),
        unit: c.unit.to_owned(),
        samples: c.time_s.len(),
        largest: c.largest,
        largest_at_s: c.largest_at_s,
        rms: c.rms,
        sigmas: c.sigmas.map(|s| InSigmasFile {
            rms: s.rms,
            largest: s.largest,
            whiteness_p: s.whiteness_p,
        }),
    }
}

fn completed(c: &Completed) -> CompletedFile {
    let change = |(quantity, unit, largest): &(String, &'static str, f64)| PredictionChangeFile {
        quantity: quantity.clone(),
        unit: (*unit).to_owned(),
        largest: *largest,
    };
    CompletedFile {
        determined: c.determined,
        open: c.open,
        distance_natural: c.distance,
        open_moved_by_natural: c.effect.moved,
        prediction_changes: c.effect.changes.iter().map(change).collect(),
        depends_on: c.effect.dependent.clone(),
    }
}

/// The histories, one number per row: `quantity,component,unit,time_s,model,against,difference`. Quaternions have no
/// difference; rotation vectors have no values of the two sides.
///
/// ```
/// use poinsot::validate::{ValidateRequest, validate, validation_csv};
///
/// let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
/// let request = ValidateRequest {
///     case: Some(folder.join("case.toml")),
///     against: folder.join("model.toml").display().to_string(),
///     ..ValidateRequest::default()
/// };
/// let rows = validation_csv(&validate(&request)?);
/// assert!(rows.starts_with("quantity,component,unit,time_s,model,against,difference"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn validation_csv(validation: &Validation) -> String {
    let mut text = String::from("quantity,component,unit,time_s,model,against,difference\n");
    for c in &validation.compared {
        let (name, unit) = (quoted(&c.name), c.unit);
        let same = c.components == c.difference_components;
        let sides = c.model.iter().zip(&c.against).zip(&c.components);
        for (row, ((model, against), component)) in sides.enumerate() {
            let component = quoted(component);
            let unit = if same { unit } else { "1" };
            let difference = c.difference.get(row).filter(|_| same);
            for (k, (a, b)) in model.iter().zip(against).enumerate() {
                let t = c.time_s.get(k).copied().unwrap_or(f64::NAN);
                let d = difference.and_then(|d| d.get(k));
                let d = d.map_or(String::new(), |d| format!("{d:e}"));
                let _ = writeln!(text, "{name},{component},{unit},{t},{a:e},{b:e},{d}");
            }
        }
        for (row, component) in c.difference.iter().zip(&c.difference_components) {
            let component = quoted(component);
            for (d, t) in row.iter().zip(&c.time_s).filter(|_| !same) {
                let _ = writeln!(text, "{name},{component},{unit},{t},,,{d:e}");
            }
        }
    }
    text
}

/// A CSV field.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Writes `validation.json` and `histories.csv` into a folder, which is created if missing.
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
///     against: folder.join("model.toml").display().to_string(),
///     ..ValidateRequest::default()
/// };
/// write_validation(&out, &validate(&request)?)?;
/// assert!(out.join("validation.json").exists() && out.join("histories.csv").exists());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_validation(folder: &Path, validation: &Validation) -> Result<Vec<PathBuf>, Error> {
    let text = serde_json::to_string_pretty(&validation_file(validation));
    let text = json(folder, text)?;
    let csv = validation_csv(validation).into_bytes();
    let mut paths = write_files(
        folder,
        &[
            ("histories.csv".into(), csv),
            ("validation.json".into(), text.into_bytes()),
        ],
    )?;
    paths.reverse();
    Ok(paths)
}
