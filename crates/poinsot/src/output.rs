//! Files appear under their name only when they are whole and on disk.

use crate::error::Error;
use crate::estimate_file::estimate_json;
use crate::identify::Identified;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes `estimate.json` into a folder, which is made if it is not there. Returns the path.
///
/// # Errors
/// The disk refuses; nothing is left under the final name then.
pub fn write_estimate(folder: &Path, identified: &Identified) -> Result<PathBuf, Error> {
    let text = serde_json::to_string_pretty(&estimate_json(identified)).map_err(|e| Error::Io {
        path: folder.to_owned(),
        what: "the result cannot be written as JSON",
        source: e.into(),
    })?;
    let path = folder.join("estimate.json");
    write_file(&path, format!("{text}\n").as_bytes())?;
    Ok(path)
}

/// Writes a file atomically: temporary file beside it, flushed to disk, renamed, folder flushed.
///
/// # Errors
/// The disk refuses; nothing is left under the final name then.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let io = |what: &'static str| {
        let path = path.to_owned();
        move |source| Error::Io { path, what, source }
    };
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
    file.persist(path)
        .map_err(|e| io("cannot be put in place")(e.error))?;
    // The rename itself lasts only once the folder is on disk; some systems cannot flush folders.
    if let Ok(handle) = std::fs::File::open(folder) {
        let _ = handle.sync_all();
    }
    Ok(())
}
