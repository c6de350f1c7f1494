//! The command `export`: writes the result of `identify` into the file of another program.
//!
//! An undetermined number is never written: the body keeps the numbers of the file and is listed, or the export fails.

mod basilisk;
mod ccsds;
mod onboard;
mod table;

use crate::error::{Error, unknown};
use crate::onboard::OnBoard;
use crate::posterior::reliable;
use minijinja::{Environment, Value};
use poinsot_formats::{Address, BodyFile, EstimateFile, all_known, read_estimate};
use poinsot_model::{
    BodyProperties, Measured, PartNumber, Patch, parse_urdf, patch_mjcf, patch_model, patch_sdf,
    patch_urdf, read_model, read_model_text,
};
use poinsot_spatial::{MassProperties, Matrix3};
use std::collections::BTreeSet;
use std::path::Path;
use std::str::FromStr;

/// Begins a mark of unreliable numbers.
const MARK: &str = "poinsot: not reliable:";

/// Formats of [`export`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Model file of Poinsot, patched.
    Model,
    /// Robot description of ROS, patched.
    Urdf,
    /// Robot description of Gazebo and Drake, patched.
    Sdf,
    /// Model of MuJoCo, patched.
    Mjcf,
    /// Python for Basilisk.
    Basilisk,
    /// CCSDS attitude parameter message (504.0-B-2), KVN.
    Apm,
    /// CCSDS attitude comprehensive message (504.0-B-2), KVN.
    Acm,
    /// Table, one row per number.
    Csv,
    /// On-board table with covariance, JSON.
    Onboard,
}

impl Target {
    /// All formats.
    pub const ALL: [Self; 9] = {
        use Target::*;
        [Model, Urdf, Sdf, Mjcf, Basilisk, Apm, Acm, Csv, Onboard]
    };

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Urdf => "urdf",
            Self::Sdf => "sdf",
            Self::Mjcf => "mjcf",
            Self::Basilisk => "basilisk",
            Self::Apm => "apm",
            Self::Acm => "acm",
            Self::Csv => "csv",
            Self::Onboard => "onboard",
        }
    }

    /// One line of help.
    pub fn about(self) -> &'static str {
        match self {
            Self::Model => "Model file of Poinsot, changed in place",
            Self::Urdf => "Robot description of ROS, changed in place",
            Self::Sdf => "Robot description of Gazebo and Drake, changed in place",
            Self::Mjcf => "Model of MuJoCo, changed in place",
            Self::Basilisk => "Python that sets the hub of a Basilisk spacecraft",
            Self::Apm => "Attitude parameter message, CCSDS 504.0-B-2: inertia",
            Self::Acm => "Attitude comprehensive message, CCSDS 504.0-B-2: mass and inertia",
            Self::Csv => "Table, one row a number",
            Self::Onboard => "On-board table with covariance, JSON",
        }
    }

    /// How an existing file is patched; `None` for a new file.
    fn patch(self) -> Option<Patch> {
        match self {
            Self::Model => Some(patch_model),
            Self::Urdf => Some(patch_urdf),
            Self::Sdf => Some(patch_sdf),
            Self::Mjcf => Some(patch_mjcf),
            _ => None,
        }
    }
}

impl FromStr for Target {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let found = Self::ALL.into_iter().find(|t| t.name() == name);
        if name.eq_ignore_ascii_case("ccsds") {
            let problem = "CCSDS has two formats: apm with the inertia, acm with mass and inertia";
            return Err(Error::usage("--to", name, problem, "use apm or acm"));
        }
        found.ok_or_else(|| unknown("--to", name, "format", Self::ALL.map(Self::name)))
    }
}

/// An exported file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Exported {
    /// The text.
    pub text: String,
    /// Requested numbers that are not exported, with the reason.
    pub left_out: Vec<String>,
    /// Numbers without a field in the format.
    pub no_field: Vec<String>,
    /// Modes, joints and other parts beside bodies whose numbers are in the text.
    pub parts: BTreeSet<String>,
}

/// Exports `folder/estimate.json`. `onto` is the source file of the vehicle, for formats that are patched. Unreliable
/// numbers are exported on request only, and marked in the file.
///
/// # Errors
/// The files cannot be read, `onto` is missing or not allowed, or nothing is determined.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// use poinsot::export::{Target, export};
///
/// # let out = std::env::temp_dir().join(format!("poinsot-export-{}", std::process::id()));
/// write_estimate(&out, &identified)?;
/// // One row per number.
/// let table = export(&out, Target::Csv, None, false)?;
/// assert!(table.text.contains("\nbus,inertia_kg_m2.zz,kg m2,2.5"));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn export(
    folder: &Path,
    to: Target,
    onto: Option<&Path>,
    accept_unreliable: bool,
) -> Result<Exported, Error> {
    let (path, estimate) = read_estimate(&folder.join("estimate.json"))?;
    export_estimate(&estimate, &path, to, onto, accept_unreliable)
}

/// The table of the on-board filter for a model file ([`poinsot_onboard::Configuration::to_table`]), and what it assumes. The
/// numbers of an answer replace nominal numbers and priors where it has them.
///
/// # Errors
/// A file cannot be read, the answer is not reliable, or the filter does not support the model.
///
/// ```
/// use poinsot_onboard::{Configuration, TABLE};
/// # let model = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/cases/pyramid_truth.toml");
/// let (bytes, assumed) = poinsot::export::export_table(model.as_ref(), None, false)?;
/// assert_eq!(bytes.len(), TABLE);
/// assert!(Configuration::from_table(&bytes).is_ok() && !assumed.is_empty());
/// # Ok::<(), poinsot::Error>(())
/// ```
pub fn export_table(
    model: &Path,
    answer: Option<&Path>,
    accept_unreliable: bool,
) -> Result<(Vec<u8>, Vec<String>), Error> {
    let answer = match answer {
        Some(folder) => {
            let (path, estimate) = read_estimate(folder)?;
            reliable(&estimate, &path, accept_unreliable)?;
            Some(estimate)
        }
        None => None,
    };
    let on_board = OnBoard::new(&read_model(model)?, answer.as_ref())?;
    let bytes = on_board.configuration.to_table().to_vec();
    Ok((bytes, on_board.assumed))
}

/// Exports an estimate in memory; errors name it `path`.
///
/// # Errors
/// As [`export`].
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// use poinsot::export::{Target, export_estimate};
///
/// let file = estimate_file(&identified);
/// // The model file with the new inertia; all else stays.
/// let onto = folder.join("model.toml");
/// let exported = export_estimate(&file, "estimate.json".as_ref(), Target::Model, Some(&onto), false)?;
/// assert!(exported.text.contains("mass_kg = 10.0") && !exported.text.contains("zz = 2.5 }"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn export_estimate(
    estimate: &EstimateFile,
    path: &Path,
    to: Target,
    onto: Option<&Path>,
    accept_unreliable: bool,
) -> Result<Exported, Error> {
    let source = Source { estimate, path };
    reliable(estimate, path, accept_unreliable)?;
    let mut exported = match (to.patch(), onto) {
        (Some(patch), Some(onto)) => patched(&source, to, patch, onto),
        (Some(_), None) => Err(Error::usage(
            "--to",
            to.name(),
            "this format changes a file",
            "name it by --onto",
        )),
        (None, Some(onto)) => Err(Error::usage(
            "--onto",
            onto.display(),
            format!("{} is written as a new file", to.name()),
            "leave --onto out",
        )),
        (None, None) => match to {
            Target::Basilisk => basilisk::text(&source),
            Target::Apm => ccsds::apm(&source),
            Target::Acm => ccsds::acm(&source),
            Target::Csv => Ok(table::text(&source)),
            _ => onboard::text(&source),
        },
    }?;
    if !matches!(to, Target::Csv | Target::Onboard) {
        let parts: Vec<String> = unplaced(estimate, &exported).collect();
        exported.no_field.extend(parts);
    }
    Ok(exported)
}

/// A line for the modes, and one for the springs, that the written file has no place for.
fn unplaced(estimate: &EstimateFile, exported: &Exported) -> impl Iterator<Item = String> {
    let all: Vec<Address> = estimate
        .nuisance
        .keys()
        .map(|key| Address::parse(key))
        .collect();
    let owners = |begins: &[&str]| {
        let own = |a: &&Address| begins.iter().any(|b| a.quantity().starts_with(b));
        let owners = all.iter().filter(own).map(|a| a.owner());
        let owners: BTreeSet<&str> = owners.filter(|o| !exported.parts.contains(*o)).collect();
        owners.into_iter().collect::<Vec<_>>().join(", ")
    };
    let parts = [
        (
            owners(&["frequency_Hz"]),
            "flexible modes",
            "the mass properties are those of the undeformed vehicle",
        ),
        (
            owners(&["stiffness_", "damping_N", "rest_"]),
            "springs of",
            "the file has no place for them; copy their numbers from nuisance",
        ),
    ];
    let named = parts.into_iter().filter(|(names, ..)| !names.is_empty());
    named.map(|(names, what, why)| format!("not exported: {what} {names}: {why}"))
}

/// A text from its template.
fn rendered(template: &str, values: Value) -> Result<String, Error> {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_keep_trailing_newline(true);
    environment
        .render_str(template, values)
        .map_err(Error::internal)
}

/// Estimate to be exported, and its name in messages.
struct Source<'a> {
    estimate: &'a EstimateFile,
    path: &'a Path,
}

impl Source<'_> {
    fn fault(&self, problem: &str, advice: &str) -> Error {
        Error::report(self.path, problem, advice)
    }

    /// Requested bodies: the determined ones, and a line for each of the others.
    fn bodies(&self) -> (Vec<BodyProperties>, Vec<String>) {
        let (mut determined, mut left_out) = (Vec::new(), Vec::new());
        let asked = self.estimate.bodies.iter().filter(|(_, b)| b.is_asked());
        for (name, body) in asked {
            match properties(body) {
                Some(properties) => determined.push(BodyProperties {
                    body: name.clone(),
                    properties,
                }),
                None => left_out.push(format!(
                    "not exported: {name}: not all of its mass, mass centre and inertia are determined"
                )),
            }
        }
        (determined, left_out)
    }

    /// Determined numbers of modes, joints and other parts.
    fn numbers(&self) -> Vec<PartNumber> {
        let all = self.estimate.nuisance.iter();
        let numbers = all.filter_map(|(address, number)| {
            let address = Address::parse(address);
            Some(PartNumber {
                part: address.owner().to_owned(),
                key: address.quantity().to_owned(),
                component: address.component().map(str::to_owned),
                value: number.value?,
            })
        });
        numbers.collect()
    }

    /// Why the numbers are not reliable, one line each.
    fn marks(&self) -> impl Iterator<Item = String> {
        let reasons = self.estimate.unreliable().into_iter();
        reasons.map(|why| format!("{MARK} {why}"))
    }

    /// The error if no body can be exported.
    fn nothing(&self, left_out: &[String], also: &str) -> Error {
        let problem = format!("no body can be exported ({})", left_out.join("; "));
        self.fault(&problem, &format!("identify with more data{also}"))
    }

    /// Comment lines about the origin of the numbers.
    fn origin(&self) -> Vec<String> {
        let e = self.estimate;
        let inputs = e
            .inputs
            .iter()
            .map(|i| format!("{} (sha256 {})", i.path, i.sha256));
        let (version, model, method) = (&e.poinsot, &e.model, e.method_in_words());
        let mut lines = vec![format!(
            "Poinsot {version}: {model}, {method}, {}",
            e.status
        )];
        lines.extend(inputs);
        lines.extend(self.marks());
        lines
    }
}

fn patched(source: &Source, to: Target, patch: Patch, onto: &Path) -> Result<Exported, Error> {
    let text = read_model_text(onto)?;
    // The mark of an earlier export goes.
    let lines = text.split_inclusive('\n');
    let text: String = lines.filter(|line| !line.contains(MARK)).collect();
    if to == Target::Urdf {
        parse_urdf(&text, &onto.display().to_string()).model?;
    }
    let (bodies, mut left_out) = source.bodies();
    left_out
        .iter_mut()
        .for_each(|line| line.push_str("; the file's numbers stay"));
    let numbers = source.numbers();
    let measured = Measured { bodies, numbers };
    let patched = patch(&text, &measured).map_err(|why| Error::report(onto, why, ""))?;
    let missing = patched.missing.iter();
    left_out.extend(missing.map(|name| {
        let what = match to {
            Target::Model | Target::Mjcf => "body",
            _ => "link",
        };
        format!("not exported: {name}: the file has not exactly one {what} of this name")
    }));
    if measured.bodies.len() == patched.missing.len() {
        let also = format!(", or give the {} file of the model", to.name());
        return Err(source.nothing(&left_out, &also));
    }
    Ok(Exported {
        text: marked(source, to, patched.text),
        left_out,
        parts: patched.parts,
        ..Exported::default()
    })
}

/// The text with a comment for each mark: at the top, in XML after the declaration.
fn marked(source: &Source, to: Target, text: String) -> String {
    let comment = |mark: String| match to {
        Target::Model => format!("# {mark}\n"),
        // Two hyphens end a comment of XML.
        _ => format!("<!-- {} -->\n", mark.replace("--", "- -")),
    };
    let comments: String = source.marks().map(comment).collect();
    if comments.is_empty() {
        return text;
    }
    // Nothing stands before a byte order mark or a declaration.
    let declaration = text.find("?>").map_or(0, |at| at + 2);
    let begin = text.trim_start_matches('\u{feff}');
    let (end, gap) = match begin.starts_with("<?xml") {
        true => (declaration, "\n"),
        false => (text.len() - begin.len(), ""),
    };
    let (before, after) = text.split_at(end);
    format!("{before}{gap}{comments}{}", after.trim_start())
}

fn properties(body: &BodyFile) -> Option<MassProperties> {
    let numbers = all_known(body.map(|n| n.value))?;
    Some(MassProperties::from_array(&numbers))
}

fn tensor(body: &BodyFile) -> Option<Matrix3> {
    let elements = all_known(body.inertia_kg_m2.map(|n| n.value));
    elements.map(poinsot_spatial::tensor)
}
