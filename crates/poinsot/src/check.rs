//! The command `check`: checks and describes a model, map, case, plan or result.

use crate::campaign::read_plan;
use crate::case::{describe_case, shaped_case};
use crate::error::Error;
use poinsot_formats::{DESCRIPTION, LARGEST_RESULT, PLAN, StatedFile, case::CASE, parse_estimate};
use poinsot_model::{Description, describe, describe_map, parse_telemetry_map, read_model};
use poinsot_report::{estimate_lines, plan_lines};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// Description of a file.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Described {
    /// A model.
    Model(Box<Description>),
    /// Another file.
    Lines {
        /// "map", "case", "plan" or "estimate".
        file: &'static str,
        /// Its content, one statement a line.
        lines: Vec<String>,
    },
}

impl fmt::Display for Described {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(model) => write!(f, "{model}"),
            Self::Lines { lines, .. } => write!(f, "{}", lines.join("\n")),
        }
    }
}

/// Checks and describes a file. The key `schema` gives its format; a file with only a `[telemetry]` table is a map.
///
/// # Errors
/// All faults of the file and of the files that it names.
///
/// ```
/// use poinsot::check::check;
///
/// let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/model.toml");
/// assert!(check(&path)?.content.to_string().contains("bus"));
/// // A file of another format.
/// assert!(check(&path.with_file_name("answer.txt")).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check(path: &Path) -> Result<StatedFile<Described>, Error> {
    let content = described(path)?;
    Ok(StatedFile {
        schema: DESCRIPTION,
        content,
    })
}

fn described(path: &Path) -> Result<Described, Error> {
    let inside = path.join("estimate.json");
    let path = if path.is_dir() { &inside } else { path };
    let lines = |file, lines| Ok(Described::Lines { file, lines });
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    if ending == "json" {
        let text = poinsot_files::read_text(path, LARGEST_RESULT).map_err(|e| e.of_result(path))?;
        let file = parse_estimate(path, text.as_bytes())?;
        return lines("estimate", estimate_lines(&file));
    }
    if ["csv", "parquet", "pq"].iter().any(|e| ending == *e) {
        let shown = path.display();
        let advice = format!("'poinsot inspect {shown}' reads it");
        return Err(Error::usage("FILE", shown, "this is telemetry", advice));
    }
    let text = match ending == "urdf" {
        true => String::new(),
        false => poinsot_model::read_model_text(path)?,
    };
    let table: toml::Table = text.parse().unwrap_or_default();
    let schema = table.get("schema").and_then(toml::Value::as_str);
    let of = |format: &str| {
        let kind = |name: &str| name.split('/').next().map(str::to_owned);
        schema.is_some_and(|s| kind(s) == kind(format))
    };
    if of(CASE) {
        return lines("case", case(path, text)?);
    }
    if of(PLAN) {
        return lines("plan", plan(path)?);
    }
    if schema.is_none() && table.contains_key("telemetry") && !table.contains_key("body") {
        let map = parse_telemetry_map(&text, &path.display().to_string())?;
        return lines("map", describe_map(&map));
    }
    Ok(Described::Model(Box::new(describe(&read_model(path)?))))
}

/// Describes a case with its model; errors are all faults that `simulate`, `predict` and `design` would report.
fn case(path: &Path, text: String) -> Result<Vec<String>, Error> {
    let (case, faults) = shaped_case(path, text)?;
    let model = read_model(&case.model)?;
    describe_case(&case, &model, faults)
}

fn plan(path: &Path) -> Result<Vec<String>, Error> {
    let plan = read_plan(path)?;
    let sizes = [plan.trials, plan.cells(), plan.shards()];
    let methods = plan.method_labels();
    Ok(plan_lines(&plan.file, &plan.name, sizes, &methods))
}
