//! The files of an estimate.

use crate::error::Error;
use crate::estimate_file::estimate_file;
use crate::identify::Identified;
use crate::report::{figure_files, html_file, page_of, report_data};
use crate::written::{OutputFile, result_json, write_file, write_files};
use poinsot_figures::FigureFormat;
use poinsot_formats::sha256;
use std::path::{Path, PathBuf};

/// Writes `estimate.json` into a folder, which is created if missing. Returns the path.
///
/// # Errors
/// Writing fails; an earlier file is then kept.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-estimate-{}", std::process::id()));
/// let path = write_estimate(&out, &identified)?;
/// let (_, read) = poinsot_formats::read_estimate(&path)?;
/// assert_eq!(read, estimate_file(&identified));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_estimate(folder: &Path, identified: &Identified) -> Result<PathBuf, Error> {
    let path = folder.join("estimate.json");
    write_file(&path, estimate_text(folder, identified)?.as_bytes())?;
    Ok(path)
}

/// `report_data.json`, on request `report.html` and its figures in the given formats, and `estimate.json`, in this
/// order, for a folder.
///
/// # Errors
/// The page cannot be built.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// let files = result_files("out".as_ref(), &identified, &["poinsot".to_owned()], true, &[])?;
/// let names = files.iter().map(|(name, _)| name.to_str().unwrap_or_default());
/// assert_eq!(names.collect::<Vec<_>>(), ["report_data.json", "report.html", "estimate.json"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn result_files(
    folder: &Path,
    identified: &Identified,
    command: &[String],
    page: bool,
    figures: &[FigureFormat],
) -> Result<Vec<OutputFile>, Error> {
    let estimate = estimate_text(folder, identified)?;
    let mut data = report_data(identified, command);
    let sum = sha256(estimate.as_bytes());
    data.files.insert("estimate.json".to_owned(), sum);
    let data = result_json(folder, &data, false)?;
    let mut files: Vec<OutputFile> = Vec::new();
    if page || !figures.is_empty() {
        let made = page_of(folder, estimate.as_bytes(), data.as_bytes())?;
        if page {
            files.push(html_file(folder, &made)?);
        }
        files.extend(figure_files(folder, &made, figures)?);
    }
    files.insert(0, ("report_data.json".into(), data.into_bytes()));
    // The result comes last: if it exists, the other files do too.
    files.push(("estimate.json".into(), estimate.into_bytes()));
    Ok(files)
}

/// Writes `estimate.json` and `report_data.json`, on request `report.html` and its figures in the given formats: all
/// or none. Returns the requested paths.
///
/// # Errors
/// Writing fails, or the page cannot be built; earlier files are then kept.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-result-{}", std::process::id()));
/// let command = ["poinsot".to_owned(), "identify".to_owned()];
/// // With the page `report.html`, without figures in separate files.
/// let paths = write_result(&out, &identified, &command, true, &[])?;
/// assert!(paths.contains(&out.join("report.html")) && paths.contains(&out.join("estimate.json")));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_result(
    folder: &Path,
    identified: &Identified,
    command: &[String],
    page: bool,
    figures: &[FigureFormat],
) -> Result<Vec<PathBuf>, Error> {
    let files = result_files(folder, identified, command, page, figures)?;
    write_files(folder, &files)?;
    let mut asked: Vec<PathBuf> = files.iter().skip(1).map(|f| folder.join(&f.0)).collect();
    asked.rotate_right(1);
    Ok(asked)
}

/// The text of `estimate.json` for a folder.
///
/// # Errors
/// The result cannot be written as JSON.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// let text = estimate_text("out".as_ref(), &identified)?;
/// assert_eq!(poinsot_formats::parse_estimate("estimate.json".as_ref(), text.as_bytes())?, estimate_file(&identified));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate_text(folder: &Path, identified: &Identified) -> Result<String, Error> {
    result_json(folder, &estimate_file(identified), true)
}
