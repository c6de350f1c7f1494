//! The one writer and the one reader of result files: schema, checksum, structure, contradictions.
//!
//! A file ends with the SHA-256 of the text before it. A change of any byte is an error. Files of earlier versions have
//! no checksum; they are read, and say that they are unchecked.

use crate::check::contradictions;
use crate::estimate::{ESTIMATE, EstimateFile, UNCHECKED};
use crate::truth::{TRUTH, TruthFile};
use crate::upgrade;
use indexmap::IndexMap;
use poinsot_files::{Fault, Faults, Place, json_escaped, open};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Number of contradictions reported per file.
const SHOWN: usize = 10;

/// E0601: the file does not match the structure of its format, or was changed.
fn not_written(path: &Path, problem: impl std::fmt::Display) -> Faults {
    Faults::report(path, problem, "give a file as poinsot writes it")
}

/// The first contradictions of a file.
fn contradictory(path: &Path, mut found: Vec<Fault>) -> Faults {
    found.truncate(SHOWN);
    found
        .iter_mut()
        .for_each(|f| f.place.file = Place::file(path).file);
    Faults::sorted(found)
}
/// Size limit of a file, bytes.
pub const LARGEST_RESULT: u64 = 256 << 20;
/// Key of the checksum, the last of a file.
const SEAL: &str = "\"sha256\"";
/// Bytes hashed at once.
const BLOCK: usize = 1 << 16;

/// A file that the program writes and reads again.
pub trait ResultFile: Serialize + DeserializeOwned {
    /// Name and version of the format.
    const SCHEMA: &'static str;
    /// Earlier versions that are read; their files have no checksum.
    const EARLIER: &'static [&'static str];

    /// Converts the structure of the first of the earlier versions.
    fn upgrade(_file: &mut Value) {}

    /// What contradicts itself.
    fn contradictions(&self) -> Vec<Fault> {
        Vec::new()
    }

    /// Notes in the file that it has no checksum.
    fn note(&mut self, _unchecked: String) {}
}

impl ResultFile for EstimateFile {
    const SCHEMA: &'static str = ESTIMATE;
    const EARLIER: &'static [&'static str] = &["poinsot.estimate/1", "poinsot.estimate/2"];

    fn upgrade(file: &mut Value) {
        upgrade::estimate_1(file);
    }

    fn contradictions(&self) -> Vec<Fault> {
        contradictions(self)
    }

    fn note(&mut self, unchecked: String) {
        self.warnings.push(unchecked);
    }
}

impl ResultFile for TruthFile {
    const SCHEMA: &'static str = TRUTH;
    const EARLIER: &'static [&'static str] = &["poinsot.truth/1", "poinsot.truth/2"];

    fn upgrade(file: &mut Value) {
        upgrade::truth_1(file);
    }
}

/// SHA-256 in lower-case hexadecimal.
///
/// ```
/// assert!(poinsot_formats::sha256(b"").starts_with("e3b0c442"));
/// ```
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(digest: Sha256) -> String {
    let bytes = digest.finalize();
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// SHA-256 of a file or stream.
///
/// # Errors
/// Reading fails.
///
/// ```
/// assert_eq!(poinsot_formats::sha256_of(&b"x"[..])?, poinsot_formats::sha256(b"x"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn sha256_of(mut bytes: impl Read) -> io::Result<String> {
    let (mut digest, mut block) = (Sha256::new(), vec![0; BLOCK]);
    loop {
        match bytes.read(&mut block)? {
            0 => return Ok(hexadecimal(digest)),
            n => digest.update(&block[..n]),
        }
    }
}

/// Checks the files that a result lists as written with it (`files`), where they still lie in its folder.
///
/// # Errors
/// A file was changed, or is that of another run.
///
/// ```
/// use poinsot_formats::{check_files, sha256};
///
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/doc");
/// let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/estimate.json"));
/// let with = |sum| check_files(folder.as_ref(), &[("estimate.json".to_owned(), sum)].into());
/// assert!(with(sha256(bytes)).is_ok());
/// assert!(with(sha256(b"of another run")).is_err());
/// ```
pub fn check_files(folder: &Path, files: &IndexMap<String, String>) -> Result<(), String> {
    let other = |(name, sum): &(&String, &String)| {
        let found = open(&folder.join(name)).map(|(file, _)| sha256_of(file).ok());
        found.is_ok_and(|found| found.as_ref() != Some(sum))
    };
    match files.iter().find(other) {
        Some((name, _)) => Err(format!(
            "{name} beside it was changed or is that of another run; run the command again"
        )),
        None => Ok(()),
    }
}

/// The text of a file: JSON, indented if `pretty`, that ends with its checksum.
///
/// # Errors
/// A number or name that JSON cannot hold.
///
/// ```
#[doc = include_str!("../doc/estimate.txt")]
/// let text = poinsot_formats::result_text(&estimate, true)?;
/// assert!(parse_estimate("estimate.json".as_ref(), text.as_bytes()).is_ok());
/// let changed = text.replacen("2.5", "2.6", 1);
/// assert!(parse_estimate("estimate.json".as_ref(), changed.as_bytes()).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn result_text<T: Serialize>(file: &T, pretty: bool) -> serde_json::Result<String> {
    let text = match pretty {
        true => serde_json::to_string_pretty(file)?,
        false => serde_json::to_string(file)?,
    };
    let mut text = match json_escaped(&text) {
        Cow::Owned(escaped) => escaped,
        Cow::Borrowed(_) => text,
    };
    let body = text.strip_suffix('}').unwrap_or(&text).trim_end();
    let sum = sha256(body.as_bytes());
    text.truncate(body.len());
    text.push_str(&format!(",\n  {SEAL}: \"{sum}\"\n}}\n"));
    Ok(text)
}

/// The checksum at the end of a text and whether it is that of the text before it; `None` without one.
///
/// ```
/// assert_eq!(poinsot_formats::checksum("{}"), None);
/// ```
pub fn checksum(text: &str) -> Option<(&str, bool)> {
    let (before, sum) = text.rsplit_once(SEAL)?;
    let sum = sum.trim().strip_prefix(':')?.strip_suffix('}')?.trim();
    let sum = sum.strip_prefix('"')?.strip_suffix('"')?;
    let body = before.trim_end().strip_suffix(',')?;
    (!sum.contains('"')).then(|| (sum, sha256(body.as_bytes()) == sum))
}

/// Reads `estimate.json`, or the folder that holds it; returns also the path of the file.
///
/// # Errors
/// The file is missing, unreadable, of another format or damaged.
///
/// ```
/// use poinsot_formats::read_estimate;
///
/// // The folder of `identify --out`, or the file in it.
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/doc");
/// let (path, estimate) = read_estimate(folder.as_ref())?;
/// assert!(path.ends_with("estimate.json"));
/// let I_zz = &estimate.bodies["bus"].inertia_kg_m2.zz;
/// let (value, sigma) = (I_zz.value.unwrap(), I_zz.sigma.unwrap());
/// // The true value is 2.5 kg m2.
/// assert!((value - 2.5).abs() < 3.0 * sigma);
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn read_estimate(path: &Path) -> Result<(PathBuf, EstimateFile), Faults> {
    let path = match path.is_dir() {
        true => path.join("estimate.json"),
        false => path.to_owned(),
    };
    let file = read_result(&path)?;
    Ok((path, file))
}

/// Reads the bytes of an `estimate.json`; errors name it `path`.
///
/// # Errors
/// The file has another format or is damaged.
///
/// ```
/// use poinsot_formats::parse_estimate;
///
/// let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/estimate.json"));
/// let estimate = parse_estimate("estimate.json".as_ref(), bytes)?;
/// assert_eq!(estimate.status, "converged");
/// assert!(parse_estimate("estimate.json".as_ref(), b"{}").is_err());
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn parse_estimate(path: &Path, bytes: &[u8]) -> Result<EstimateFile, Faults> {
    parse_result(path, bytes)
}

/// Reads a `truth.json`.
///
/// # Errors
/// The file is missing, unreadable, of another format or damaged.
///
/// ```
/// use poinsot_formats::read_truth;
///
/// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/ma2008/traj1/truth.json");
/// let truth = read_truth(path.as_ref())?;
/// assert_eq!(truth.bodies["base"].mass.mass_kg.value, 1000.0);
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn read_truth(path: &Path) -> Result<TruthFile, Faults> {
    read_result(path)
}

/// Reads a result file.
///
/// # Errors
/// The file is missing or unreadable, or as [`parse_result`].
///
/// ```
/// use poinsot_formats::{TruthFile, read_result};
///
/// assert!(read_result::<TruthFile>("/nowhere/truth.json".as_ref()).is_err());
/// ```
pub fn read_result<T: ResultFile>(path: &Path) -> Result<T, Faults> {
    let bytes = poinsot_files::read(path, LARGEST_RESULT);
    parse_result(path, &bytes.map_err(|e| e.of_result(path))?)
}

/// Reads the bytes of a result file: its schema, checksum, structure and contradictions. Errors name it `path`.
///
/// # Errors
/// The file has another format, was changed, or contradicts itself.
///
/// ```
/// use poinsot_formats::{PredictionFile, parse_result};
///
/// let other = parse_result::<PredictionFile>("prediction.json".as_ref(), b"{}");
/// assert!(other.unwrap_err().to_string().contains("it has no key \"schema\""));
/// ```
pub fn parse_result<T: ResultFile>(path: &Path, bytes: &[u8]) -> Result<T, Faults> {
    let refuse = |why: String| not_written(path, why);
    let changed = "it was cut or changed: its checksum (sha256) is not that of its content";
    let shape = |e: serde_json::Error| refuse(e.to_string());
    let text = std::str::from_utf8(bytes).map_err(|e| refuse(e.to_string()))?;
    let sum = checksum(text).map(|(_, whole)| whole);
    if sum == Some(false) {
        return Err(refuse(changed.to_owned()));
    }
    let mut value: Value = serde_json::from_str(text).map_err(shape)?;
    let found = value.get("schema").and_then(Value::as_str).unwrap_or("");
    let found = found.to_owned();
    let current = found == T::SCHEMA;
    if !current && !T::EARLIER.contains(&found.as_str()) {
        return Err(refuse(match found.as_str() {
            "" => "it has no key \"schema\"".to_owned(),
            found => format!("its schema is \"{found}\", not {}", T::SCHEMA),
        }));
    }
    if current && sum.is_none() {
        return Err(refuse(changed.to_owned()));
    }
    if members(&value) != colons(text) {
        return Err(refuse("a key is there twice".to_owned()));
    }
    let mut file: T = match current {
        // Parse the text again: only then does the error have line and column.
        true => serde_json::from_str(text).map_err(shape)?,
        false => {
            if T::EARLIER.first() == Some(&found.as_str()) {
                T::upgrade(&mut value);
            }
            if let Some(schema) = value.get_mut("schema") {
                *schema = T::SCHEMA.into();
            }
            serde_json::from_value(value).map_err(shape)?
        }
    };
    let contradictions = file.contradictions();
    if !contradictions.is_empty() {
        return Err(contradictory(path, contradictions));
    }
    if sum.is_none() {
        file.note(format!("{UNCHECKED}{found} has no checksum"));
    }
    Ok(file)
}

/// Number of members of all objects; a key that is there twice counts once.
fn members(value: &Value) -> usize {
    match value {
        Value::Object(list) => list.len() + list.values().map(members).sum::<usize>(),
        Value::Array(list) => list.iter().map(members).sum(),
        _ => 0,
    }
}

/// Number of colons outside strings: one for each member as written.
fn colons(text: &str) -> usize {
    let (mut inside, mut escaped, mut count) = (false, false, 0);
    for byte in text.bytes() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = inside,
            b'"' => inside = !inside,
            b':' if !inside => count += 1,
            _ => {}
        }
    }
    count
}
