//! Reading, writing, resampling and checking telemetry through the public interface.

mod checks;
mod conventions;
mod exports;
mod faults;
mod inspection;
mod newcomers;
mod noise;
mod parquet_files;
mod real_data;
mod resampling;
mod round_trip;
mod segments;
mod unusual_exports;

use poinsot_telemetry::{ColumnMap, ReadOptions, Table, TelemetryMap, read};
use std::path::PathBuf;
use tempfile::TempDir;

/// An error begins with code and place; its text has the value.
#[track_caller]
fn assert_told(message: &str, place: &str, value: &str) {
    let begins = message.starts_with(&format!("{place}: "));
    assert!(begins && message.contains(value), "{message}");
}

/// A map with columns and a row filter for every file.
fn map_of(columns: Vec<ColumnMap>, row_filter: Vec<(String, String)>) -> TelemetryMap {
    let mut map = TelemetryMap::default();
    (map.all.columns, map.all.row_filter) = (columns, row_filter);
    map
}

/// A temporary folder of files.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// The complete message of an error, without the folder's path.
    fn message(&self, error: &poinsot_files::Faults) -> String {
        let folder = format!("{}/", self.0.path().display());
        error.to_string().replace(&folder, "")
    }
}

fn read_text(text: impl AsRef<[u8]>, options: &ReadOptions) -> Result<Table, String> {
    let folder = Folder::new();
    let path = folder.file("run.csv", text);
    let mut table = read(&[path], options).map_err(|e| {
        assert!(e.to_string().starts_with(e.code()), "{e}");
        assert!(!e.to_string().contains('\n'), "{e}");
        folder.message(&e)
    })?;
    let prefix = format!("{}/", folder.0.path().display());
    for repair in &mut table.repairs {
        *repair = repair.replace(&prefix, "");
    }
    Ok(table)
}
