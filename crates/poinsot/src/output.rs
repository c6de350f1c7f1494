//! Files appear under their name only when they are whole and on disk, and those of one answer together.

use crate::error::{Error, no_page};
use crate::estimate_file::estimate_file;
use crate::identify::Identified;
use crate::report::{page_of, report_data};
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Writes `estimate.json` into a folder, which is made if it is not there. Returns the path.
///
/// # Errors
/// The disk refuses; nothing is left under the final name then.
pub fn write_estimate(folder: &Path, identified: &Identified) -> Result<PathBuf, Error> {
    let path = folder.join("estimate.json");
    write_file(&path, estimate_text(folder, identified)?.as_bytes())?;
    Ok(path)
}

/// Writes `estimate.json`, `report_data.json` and, if asked, `report.html` into a folder: all of them or none.
/// Returns the paths that a user asked for.
///
/// # Errors
/// The disk refuses, or no page can be made of the answer.
pub fn write_result(
    folder: &Path,
    identified: &Identified,
    command: &[String],
    page: bool,
) -> Result<Vec<PathBuf>, Error> {
    let estimate = estimate_text(folder, identified)?;
    let data = json(
        folder,
        serde_json::to_string(&report_data(identified, command)),
    )?;
    let mut files = vec![("report_data.json", data)];
    if page {
        let made = page_of(folder, estimate.as_bytes(), files[0].1.as_bytes())?;
        let html = made.html().map_err(|e| Error::Report {
            path: folder.to_owned(),
            why: no_page(&e),
        })?;
        files.push(("report.html", html));
    }
    // The answer last: where it stands, the others do.
    files.push(("estimate.json", estimate));
    let files: Vec<(PathBuf, &[u8])> = files
        .iter()
        .map(|(name, text)| (folder.join(name), text.as_bytes()))
        .collect();
    write_files(&files)?;
    let mut written = vec![folder.join("estimate.json")];
    if page {
        written.push(folder.join("report.html"));
    }
    Ok(written)
}

fn estimate_text(folder: &Path, identified: &Identified) -> Result<String, Error> {
    json(
        folder,
        serde_json::to_string_pretty(&estimate_file(identified)),
    )
}

fn json(folder: &Path, text: serde_json::Result<String>) -> Result<String, Error> {
    let text = text.map_err(|e| Error::Io {
        path: folder.to_owned(),
        what: "the result cannot be written as JSON",
        source: e.into(),
    })?;
    Ok(text + "\n")
}

/// Writes a file atomically: temporary file beside it, flushed to disk, renamed, folder flushed.
///
/// # Errors
/// The disk refuses; nothing is left under the final name then.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_files(&[(path.to_owned(), bytes)])
}

/// Writes several files of one answer: none appears under its name before all are on disk, and none stays there
/// where one cannot be put in place.
///
/// # Errors
/// The disk refuses.
pub fn write_files(files: &[(PathBuf, &[u8])]) -> Result<(), Error> {
    let mut drafts = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        drafts.push((path, draft(path, bytes)?));
    }
    let mut placed: Vec<&Path> = Vec::new();
    for (path, file) in drafts {
        if let Err(error) = file.persist(path) {
            for done in placed {
                let _ = std::fs::remove_file(done);
            }
            return Err(Error::Io {
                path: path.clone(),
                what: "cannot be put in place",
                source: error.error,
            });
        }
        placed.push(path);
    }
    // The renames last only once their folder is on disk; some systems cannot flush folders.
    for folder in files.iter().map(|(path, _)| folder_of(path)) {
        if let Ok(handle) = std::fs::File::open(folder) {
            let _ = handle.sync_all();
        }
    }
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    }
}

/// The bytes in a temporary file beside the final one, on disk.
fn draft(path: &Path, bytes: &[u8]) -> Result<NamedTempFile, Error> {
    let io = |what: &'static str| {
        let path = path.to_owned();
        move |source| Error::Io { path, what, source }
    };
    let folder = folder_of(path);
    std::fs::create_dir_all(folder).map_err(io("its folder cannot be made"))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".poinsot-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any other new file: the process's umask decides.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder
        .tempfile_in(folder)
        .map_err(io("cannot be written"))?;
    file.write_all(bytes)
        .and_then(|()| file.as_file().sync_all())
        .map_err(io("cannot be written"))?;
    Ok(file)
}
