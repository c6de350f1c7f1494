//! Bytes as a telemetry file.

use poinsot_telemetry::checks::findings;
use poinsot_telemetry::{Encoding, ReadOptions, Table, inspect, read, suggestions};
use std::path::Path;
use tempfile::TempDir;

thread_local! {
    /// One folder for all files of a thread; file names are reused.
    static FOLDER: Option<TempDir> = TempDir::new().ok();
}

/// Bytes as a CSV file.
pub fn csv(bytes: &[u8]) {
    as_file("telemetry.csv", bytes, |path| {
        check(path, &ReadOptions::default());
        let forgiving = ReadOptions {
            recover: true,
            encoding: Encoding::Latin1,
            every: 2,
            ..ReadOptions::default()
        };
        check(path, &forgiving);
    });
}

/// Bytes as a Parquet file.
pub fn parquet(bytes: &[u8]) {
    as_file("telemetry.parquet", bytes, |path| {
        check(path, &ReadOptions::default());
    });
}

fn as_file(name: &str, bytes: &[u8], with: impl FnOnce(&Path)) {
    FOLDER.with(|folder| {
        let path = folder.as_ref().map(|f| f.path().join(name));
        let written = path
            .as_ref()
            .is_some_and(|p| std::fs::write(p, bytes).is_ok());
        assert!(written, "no temporary file to fuzz with");
        if let Some(path) = path {
            with(&path);
        }
    });
}

fn check(path: &Path, options: &ReadOptions) {
    match read(&[path], options) {
        Ok(table) => {
            check_table(&table);
            let _ = inspect(&table);
            let _ = findings(&table);
            let _ = suggestions(&table.ignored);
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(error.code()), "no code: {text}");
            assert!(!text.contains(['\n', '\r']), "not one line: {text:?}");
        }
    }
}

/// Invariants of every channel of a reader.
fn check_table(table: &Table) {
    for channel in &table.channels {
        let name = &channel.name;
        assert_eq!(channel.time_s.len(), channel.values.len(), "{name}");
        assert!(
            channel.values.iter().all(|x| x.is_finite()),
            "{name}: a value is not finite"
        );
        assert!(
            channel.time_s.iter().all(|t| t.is_finite()),
            "{name}: a time is not finite"
        );
        let increases = channel.time_s.windows(2).all(|w| w[0] < w[1]);
        assert!(increases, "{name}: times do not increase");
    }
}
