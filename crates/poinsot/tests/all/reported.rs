//! Records of `data/reports`.

use poinsot::{Identified, IdentifyRequest, identify};
use std::path::{Path, PathBuf};

/// Largest distance of a number from the truth, sigmas.
pub const AGREES: f64 = 4.0;

/// A record with its model, changed by these replacements and lines.
pub struct Record {
    folder: tempfile::TempDir,
    name: &'static str,
}

impl Record {
    pub fn new(name: &'static str, replaced: &[(&str, &str)], more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut text = std::fs::read_to_string(Self::file(name, "model.toml")).unwrap();
        for (old, new) in replaced {
            assert!(text.contains(old), "{name} has no {old}");
            text = text.replace(old, new);
        }
        std::fs::write(folder.path().join("model.toml"), text + more).unwrap();
        Self { folder, name }
    }

    pub fn file(name: &str, file: &str) -> PathBuf {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/reports");
        data.join(name).join(file)
    }

    pub fn request(&self) -> IdentifyRequest {
        let is_telemetry = |f: &PathBuf| {
            let kind = f.extension().and_then(|e| e.to_str());
            kind.is_some_and(|kind| ["csv", "zst", "parquet"].contains(&kind))
        };
        let folder = std::fs::read_dir(Self::file(self.name, "")).unwrap();
        let mut files: Vec<PathBuf> = folder.map(|f| f.unwrap().path()).collect();
        files.retain(is_telemetry);
        files.sort();
        let mut request = IdentifyRequest::new(self.folder.path().join("model.toml"), [""]);
        request.segments = vec![files];
        request
    }

    pub fn answer(&self) -> Identified {
        identify(&self.request()).unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    pub fn refusal(&self) -> String {
        match identify(&self.request()) {
            Ok(_) => panic!("{} is not refused", self.name),
            Err(error) => error.to_string(),
        }
    }
}
