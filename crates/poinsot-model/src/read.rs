//! Reads a file into a [`Model`]: limits, syntax, version, structure, meaning.

use crate::check::check_model;
use crate::check_telemetry::check_telemetry;
use crate::document::{Document, KeyPath};
use crate::file::{ModelFile, TelemetryMapFile};
use crate::finding::{Findings, Key};
use crate::model_text::read_model_text;
use crate::schema::{MAP_KEYS, MODEL_KEYS};
use crate::shape::{Format, MODEL, MODEL_SCHEMA, check_shape};
use crate::vehicle::Model;
use poinsot_files::{Fault, Faults, MOST_FAULTS, Place};
use poinsot_telemetry::TelemetryMap;
use serde::Deserialize;
use std::path::Path;
use toml::de::DeValue;

/// Checks a vehicle given as text; `file` is its name in messages.
///
/// # Errors
/// All faults of the text, each with line and column.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// assert_eq!(model.bodies[0].nominal.mass, 10.0);
/// // A key that does not exist is an error with its line.
/// let wrong = parse_model(&text.replace("mass_kg", "mass_lb"), "box.toml").unwrap_err();
/// assert!(wrong.to_string().contains("mass_lb"));
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn parse_model(text: &str, file: &str) -> Result<Model, Faults> {
    let (document, syntax) = Document::new(text, file);
    let mut findings = Findings::new(&document);
    report_syntax(&MODEL, syntax, &mut findings);
    check_version(&mut findings);
    if findings.count() > 0 {
        return Err(findings.into_error());
    }
    let clean = check_shape(&MODEL, &MODEL_KEYS, &mut findings);
    let model = match ModelFile::deserialize(clean.clone()) {
        Ok(raw) => check_model(&raw, &clean, &mut findings),
        Err(error) => {
            report_misfit(&error, &mut findings);
            None
        }
    };
    if model.is_none() && findings.count() == 0 {
        refuse_file("E0106", "there is no body", "add [[body]]", &mut findings);
    }
    let notes = findings.finish()?;
    let (place, problem) = (Place::label(file), "there is no model");
    let model = model.ok_or_else(|| Faults::one("E0101", place, problem, "add [[body]]"))?;
    Ok(Model { notes, ..model })
}

/// Reads a file with only a `[telemetry]` table (`--map`).
///
/// # Errors
/// All faults of the file, each with line and column.
///
/// ```
/// use poinsot_model::read_telemetry_map;
///
/// # let path = std::env::temp_dir().join(format!("poinsot-map-{}.toml", std::process::id()));
/// std::fs::write(&path, "[telemetry.columns]\nomega_x = { column = \"GYR_X\", unit = \"deg/s\" }\n")?;
/// let map = read_telemetry_map(&path)?;
/// assert_eq!(map.all.columns[0].channel, "omega_x");
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_telemetry_map(path: impl AsRef<Path>) -> Result<TelemetryMap, Faults> {
    let path = path.as_ref();
    let text = read_model_text(path)?;
    parse_telemetry_map(&text, &path.display().to_string())
}

/// Checks a `[telemetry]` table given as text; `file` is its name in messages.
///
/// # Errors
/// As [`read_telemetry_map`].
///
/// ```
/// use poinsot_model::parse_telemetry_map;
///
/// let map = |unit: &str| {
///     let text = format!("[telemetry.columns]\nomega_x = {{ column = \"GYR_X\", unit = \"{unit}\" }}\n");
///     parse_telemetry_map(&text, "map.toml")
/// };
/// assert_eq!(map("deg/s")?.all.columns[0].column, "GYR_X");
/// assert!(map("furlong").is_err());
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn parse_telemetry_map(text: &str, file: &str) -> Result<TelemetryMap, Faults> {
    let (document, syntax) = Document::new(text, file);
    let mut findings = Findings::new(&document);
    report_syntax(&MODEL, syntax, &mut findings);
    if findings.count() > 0 {
        return Err(findings.into_error());
    }
    let clean = check_shape(&MODEL, &MAP_KEYS, &mut findings);
    let map = match TelemetryMapFile::deserialize(toml::Value::Table(clean)) {
        Ok(raw) => check_telemetry(raw.telemetry, None, &mut findings),
        Err(error) => {
            report_misfit(&error, &mut findings);
            TelemetryMap::default()
        }
    };
    findings.finish()?;
    Ok(map)
}

/// Checks the text of a file against the table of keys of its format.
///
/// # Errors
/// All faults of its keys, with line, column and value.
///
/// ```
/// use poinsot_model::{Format, check_keys};
/// use std::sync::LazyLock;
///
/// static FORMAT: Format = Format {
///     name: "pump/1", syntax: "P1", version: "P2", unknown: "P3", unit: "P4", missing: "P5", kind: "P6", range: "P7", unfit: "P8",
/// };
/// static ROWS: LazyLock<serde_json::Value> = LazyLock::new(|| {
///     serde_json::json!({ "properties": { "speed_rad_s": { "type": "number" } } })
/// });
/// assert!(check_keys("speed_rad_s = 3.0", "pump.toml", &FORMAT, &ROWS).is_ok());
/// let error = check_keys("sped_rad_s = 3.0", "pump.toml", &FORMAT, &ROWS).unwrap_err();
/// assert!(error.to_string().starts_with("P3 pump.toml:1:1: sped_rad_s"), "{error}");
/// ```
pub fn check_keys(
    text: &str,
    file: &str,
    format: &'static Format,
    rows: &'static serde_json::Value,
) -> Result<(), Faults> {
    let (document, syntax) = Document::new(text, file);
    let mut findings = Findings::new(&document);
    report_syntax(format, syntax, &mut findings);
    if findings.count() == 0 {
        check_shape(format, rows, &mut findings);
    }
    findings.finish().map(|_| ())
}

/// Gives faults of a file the line and the value of their key.
///
/// ```
/// use poinsot_files::{Fault, Place};
///
/// let place = Place::file("pump.toml").key("pump.speed_rad_s");
/// let mut faults = [Fault::new("E0505", place, "too fast", "slow down")];
/// poinsot_model::locate("[pump]\nspeed_rad_s = 900.0", &mut faults);
/// assert_eq!((faults[0].place.line, faults[0].value.as_str()), (2, "900.0"));
/// ```
pub fn locate(text: &str, faults: &mut [Fault]) {
    let (document, _) = Document::new(text, "");
    for fault in faults {
        let (byte, value) = document.place(&KeyPath::parse(&fault.place.key));
        fault.place.line = document.line_column(byte).0 as u64;
        if fault.value.is_empty() {
            fault.value = value;
        }
    }
}

fn report_syntax(format: &Format, errors: Vec<toml::de::Error>, findings: &mut Findings<'_>) {
    for error in errors.into_iter().take(MOST_FAULTS) {
        let at = error.span().map_or(0, |span| span.start);
        let words: Vec<&str> = error.message().split_whitespace().collect();
        let problem = format!("not valid TOML: {}", words.join(" "));
        let (key, remedy) = (Key::default(), "correct it here".to_owned());
        findings.push(format.syntax, &key, at, String::new(), problem, remedy);
    }
}

/// A fault that the structure check missed: a bug, reported without panic.
fn report_misfit(error: &toml::de::Error, findings: &mut Findings<'_>) {
    if findings.count() == 0 {
        let text = error.message().to_owned();
        refuse_file("E0107", &text, "compare with `poinsot schema`", findings);
    }
}

fn refuse_file(code: &'static str, problem: &str, remedy: &str, findings: &mut Findings<'_>) {
    findings.refuse(code, &Key::default(), problem, remedy);
}

/// Reports an empty file, or a file of another format.
fn check_version(findings: &mut Findings<'_>) {
    let table = &findings.document.table;
    if findings.document.text.trim().is_empty() {
        let remedy = "begin with schema = \"poinsot.model/1\"; `poinsot schema` prints all keys";
        refuse_file("E0103", "the file is empty", remedy, findings);
        return;
    }
    let Some(value) = table.get("schema") else {
        return;
    };
    if !matches!(value.get_ref(), DeValue::String(text) if text == MODEL_SCHEMA) {
        let problem = "this program does not support this format";
        let remedy = format!("write schema = \"{MODEL_SCHEMA}\"");
        findings.refuse("E0103", &Key::top("schema"), problem, remedy);
    }
}
