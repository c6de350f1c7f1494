//! Writes the files of a result together, when all are complete and on disk. Used by every command.

use crate::error::Error;
use indexmap::IndexMap;
use poinsot_files::{Stage, check_target, folder_of, is_same_file};
use poinsot_formats::{Serialize, result_text, sha256};
use std::path::{Path, PathBuf};

/// A file of a result: path relative to the folder, and bytes.
pub type OutputFile = (PathBuf, Vec<u8>);

/// The text of a result file with its checksum; errors name the folder.
///
/// # Errors
/// The result cannot be written as JSON.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// let text = poinsot::result_json("out".as_ref(), &estimate_file(&identified), true)?;
/// assert!(poinsot_formats::checksum(&text).is_some_and(|(_, whole)| whole));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn result_json<T: Serialize>(folder: &Path, file: &T, pretty: bool) -> Result<String, Error> {
    result_text(file, pretty)
        .map_err(|e| Error::io(folder, "the result cannot be written as JSON", &e.into()))
}

/// SHA-256 of files by name, as the result that is written with them lists them.
///
/// ```
/// let files = poinsot::digests(&[("a.csv".into(), b"1".to_vec())]);
/// assert_eq!(files["a.csv"], poinsot_formats::sha256(b"1"));
/// ```
pub fn digests(files: &[OutputFile]) -> IndexMap<String, String> {
    let one = |(name, bytes): &OutputFile| (name.display().to_string(), sha256(bytes));
    files.iter().map(one).collect()
}

/// Rows as CSV (RFC 4180, lines end with LF).
pub(crate) fn csv_text(rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = csv::WriterBuilder::new()
        .flexible(true)
        .from_writer(Vec::new());
    // Memory does not refuse.
    let written = rows
        .into_iter()
        .try_for_each(|row| writer.write_record(row));
    let bytes = written.ok().and_then(|()| writer.into_inner().ok());
    String::from_utf8(bytes.unwrap_or_default()).unwrap_or_default()
}

/// Writes one file; the earlier one is kept until the new one is complete and on disk.
///
/// # Errors
/// Writing fails; an earlier file is then kept.
///
/// ```
/// # let out = std::env::temp_dir().join(format!("poinsot-file-{}", std::process::id()));
/// let path = out.join("note.txt");
/// poinsot::write_file(&path, b"measured")?;
/// assert_eq!(std::fs::read(&path)?, b"measured");
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let is_folder = std::io::ErrorKind::IsADirectory.into();
    let refuse = || Error::io(path, "cannot be written", &is_folder);
    let name = path.file_name().ok_or_else(refuse)?;
    write_files(folder_of(path), &[(name.into(), bytes.to_vec())])?;
    Ok(())
}

/// Writes the files of one result into a folder, which is created if missing: all or none. Returns their paths.
///
/// # Errors
/// Writing fails; earlier files are then kept.
///
/// ```
/// # let out = std::env::temp_dir().join(format!("poinsot-files-{}", std::process::id()));
/// let files = [("a.txt".into(), b"1".to_vec()), ("b.txt".into(), b"2".to_vec())];
/// assert_eq!(poinsot::write_files(&out, &files)?, [out.join("a.txt"), out.join("b.txt")]);
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_files(folder: &Path, files: &[(PathBuf, Vec<u8>)]) -> Result<Vec<PathBuf>, Error> {
    let mut stage = Stage::new(folder)?;
    for (name, bytes) in files {
        stage.add(name, bytes)?;
    }
    stage.commit()
}

/// Checks before a command starts that its result can be written. No output may be an input, and every target must be
/// free or a regular file.
///
/// # Errors
/// The option and the conflicting file.
///
/// ```
/// use poinsot::check_outputs;
/// use std::path::Path;
///
/// let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/model.toml");
/// // An input is never overwritten.
/// assert!(check_outputs("--out", &[model.clone()], &[&model]).is_err());
/// ```
pub fn check_outputs(
    option: &'static str,
    outputs: &[PathBuf],
    inputs: &[&Path],
) -> Result<(), Error> {
    for output in outputs {
        if inputs.iter().any(|input| is_same_file(output, input)) {
            let value = output.display();
            let problem = "this is an input of the command";
            return Err(Error::usage(option, value, problem, "name another place"));
        }
        check_target(output)?;
    }
    Ok(())
}
