//! A validation as JSON and its histories as CSV.

use super::{Against, Validation};
use crate::error::Error;
use crate::output::write_files;
use poinsot_files::json_escaped;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The name of the format.
pub const VALIDATION_SCHEMA: &str = "poinsot.validation/1";

/// The machine-readable result.
pub fn validation_json(validation: &Validation) -> Value {
    let kind = match validation.kind {
        Against::Model => "model",
        Against::TelemetryOfCase => "telemetry_of_case",
        Against::HeldBack => "held_back_telemetry",
    };
    let compared: Vec<Value> = validation
        .compared
        .iter()
        .map(|c| {
            json!({
                "quantity": c.name,
                "unit": c.unit,
                "samples": c.time_s.len(),
                "largest": c.largest,
                "largest_at_s": c.largest_at_s,
                "rms": c.rms,
                "sigmas": c.sigmas.map(|s| json!({
                    "rms": s.rms,
                    "largest": s.largest,
                    "whiteness_p": s.whiteness_p,
                })),
            })
        })
        .collect();
    let completed = validation.completed.as_ref().map(|c| {
        let changes: Vec<Value> = c
            .effect
            .changes
            .iter()
            .map(|(name, unit, x)| json!({ "quantity": name, "unit": unit, "largest": x }))
            .collect();
        json!({
            "determined": c.determined,
            "open": c.open,
            "distance_natural": c.distance,
            "open_moved_by_natural": c.effect.moved,
            "prediction_changes": changes,
            "depends_on": c.effect.dependent,
        })
    });
    json!({
        "schema": VALIDATION_SCHEMA,
        "poinsot": env!("CARGO_PKG_VERSION"),
        "kind": kind,
        "verdict": validation.verdict.name(),
        "model": validation.model,
        "estimate": validation.estimate.as_ref().map(|(path, status)| json!({ "path": path, "status": status })),
        "against": validation.against,
        "case": validation.case,
        "limits": { "within_m": validation.limits.0, "within_rad": validation.limits.1 },
        "chi2_per_dof": validation.chi2_per_dof,
        "compared": compared,
        "completed": completed,
        "warnings": validation.warnings,
        "repairs": validation.repairs,
    })
}

/// The histories, one number of one side a row: `quantity,component,unit,time_s,model,against,difference`.
/// An attitude's quaternions have no difference of their own; its rotation vector has no sides.
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

/// Writes `validation.json` and `histories.csv` into a folder, which is made if it is not there.
///
/// # Errors
/// The disk refuses.
pub fn write_validation(folder: &Path, validation: &Validation) -> Result<Vec<PathBuf>, Error> {
    let text = format!("{:#}\n", validation_json(validation));
    let csv = validation_csv(validation).into_bytes();
    let json = json_escaped(&text).into_owned().into_bytes();
    let mut paths = write_files(
        folder,
        &[
            ("histories.csv".into(), csv),
            ("validation.json".into(), json),
        ],
    )?;
    paths.reverse();
    Ok(paths)
}
