//! Data that are not shipped: files of other authors, in a folder that the environment names.

use std::path::{Path, PathBuf};

/// The variable that names the folder; `scripts/test data` wants it.
pub const FOLDER: &str = "POINSOT_DATA";

/// A file or folder below the one that `POINSOT_DATA` names.
///
/// A test that calls this is marked `#[ignore = "needs POINSOT_DATA"]`, so that it never passes without its data.
///
/// # Panics
/// The variable is not set, or there is no such file.
#[allow(clippy::panic)]
#[must_use]
pub fn outside(path: &str) -> PathBuf {
    let Some(folder) = std::env::var_os(FOLDER) else {
        panic!("{FOLDER} is not set: give the folder of the data that are not shipped");
    };
    let path = Path::new(&folder).join(path);
    assert!(path.exists(), "{FOLDER}: {} is not there", path.display());
    path
}
