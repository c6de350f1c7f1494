//! Files of one answer appear under their names together, when all are complete and on disk. Every verb writes here.

use crate::error::{Error, no_page};
use crate::estimate_file::estimate_file;
use crate::identify::Identified;
use crate::report::{figure_files, page_of, report_data};
use poinsot_files::{Stage, check_target, folder_of, is_same_file, json_escaped};
use poinsot_report::FigureFormat;
use std::path::{Path, PathBuf};

/// A file of an answer: its path below the answer's folder, and its bytes.
pub type OutputFile = (PathBuf, Vec<u8>);

/// Writes `estimate.json` into a folder, which is made if it is not there. Returns the path.
///
/// # Errors
/// The disk refuses; an earlier file stays then.
pub fn write_estimate(folder: &Path, identified: &Identified) -> Result<PathBuf, Error> {
    let path = folder.join("estimate.json");
    write_file(&path, estimate_text(folder, identified)?.as_bytes())?;
    Ok(path)
}

/// Writes `estimate.json`, `report_data.json`, if asked `report.html`, and its figures in the formats given: all of
/// them or none. Returns the paths that a user asked for.
///
/// # Errors
/// The disk refuses, or no page can be made of the answer; earlier files stay then.
pub fn write_result(
    folder: &Path,
    identified: &Identified,
    command: &[String],
    page: bool,
    figures: &[FigureFormat],
) -> Result<Vec<PathBuf>, Error> {
    let estimate = estimate_text(folder, identified)?;
    let data = json(
        folder,
        serde_json::to_string(&report_data(identified, command)),
    )?;
    let mut shown: Vec<OutputFile> = Vec::new();
    if page || !figures.is_empty() {
        let made = page_of(folder, estimate.as_bytes(), data.as_bytes())?;
        if page {
            let html = made.html().map_err(|e| Error::Report {
                path: folder.to_owned(),
                why: no_page(&e),
            })?;
            shown.push(("report.html".into(), html.into_bytes()));
        }
        shown.extend(figure_files(folder, &made, figures)?);
    }
    let asked: Vec<PathBuf> = std::iter::once(Path::new("estimate.json"))
        .chain(shown.iter().map(|f| f.0.as_path()))
        .map(|name| folder.join(name))
        .collect();
    let mut files: Vec<OutputFile> = vec![("report_data.json".into(), data.into_bytes())];
    files.extend(shown);
    // The answer last: where it stands, the others do.
    files.push(("estimate.json".into(), estimate.into_bytes()));
    write_files(folder, &files)?;
    Ok(asked)
}

/// The text of `estimate.json` as it is written into a folder.
///
/// # Errors
/// The answer cannot be written as JSON.
pub fn estimate_text(folder: &Path, identified: &Identified) -> Result<String, Error> {
    json(
        folder,
        serde_json::to_string_pretty(&estimate_file(identified)),
    )
}

/// A document as JSON, with a last line end, for a file of a folder.
pub(crate) fn json(folder: &Path, text: serde_json::Result<String>) -> Result<String, Error> {
    let text = text.map_err(|e| Error::Io {
        path: folder.to_owned(),
        what: "the result cannot be written as JSON",
        source: e.into(),
    })?;
    Ok(json_escaped(&text).into_owned() + "\n")
}

/// Writes one file: the earlier one stays until the new one is complete and on disk.
///
/// # Errors
/// The disk refuses; an earlier file stays then.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let Some(name) = path.file_name() else {
        return Err(Error::Io {
            path: path.to_owned(),
            what: "cannot be written",
            source: std::io::ErrorKind::IsADirectory.into(),
        });
    };
    write_files(folder_of(path), &[(name.into(), bytes.to_vec())])?;
    Ok(())
}

/// Writes the files of one answer below a folder, which is made if it is not there: all of them or none. Returns
/// their paths.
///
/// # Errors
/// The disk refuses; earlier files stay then.
pub fn write_files(folder: &Path, files: &[(PathBuf, Vec<u8>)]) -> Result<Vec<PathBuf>, Error> {
    let mut stage = Stage::new(folder)?;
    for (name, bytes) in files {
        stage.add(name, bytes)?;
    }
    Ok(stage.commit()?)
}

/// Checks, before a verb works, that its answer can be put in place: no output is an input, and nothing but an
/// earlier file stands where one goes.
///
/// # Errors
/// The option with the file that is in the way.
pub fn check_outputs(
    option: &'static str,
    outputs: &[PathBuf],
    inputs: &[&Path],
) -> Result<(), Error> {
    for output in outputs {
        if inputs.iter().any(|input| is_same_file(output, input)) {
            return Err(Error::Usage {
                option,
                value: output.display().to_string(),
                why: "this is an input of the command; name another place".to_owned(),
            });
        }
        check_target(output)?;
    }
    Ok(())
}
