//! The case files of `validation/bad_input/`: their sections, their long texts.

use serde::Deserialize;
use std::io::Error;
use std::path::{Path, PathBuf};

/// Folders of the cases.
pub const SECTIONS: [&str; 6] = [
    "telemetry",
    "results",
    "files",
    "models",
    "security",
    "codes",
];

/// `validation/bad_input`.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/bad_input")
}

/// The case files of a section, by name: names without extension, paths.
pub fn names(section: &str) -> Result<Vec<(String, PathBuf)>, Error> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder().join(section))? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        all.push((stem.into_owned(), path));
    }
    all.sort();
    Ok(all)
}

/// A long text in place of a mark. `{n}` counts from `first`; `{n-1}` is the number before it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fill {
    mark: String,
    text: String,
    times: usize,
    #[serde(default)]
    first: usize,
}

/// Puts long texts in place of their marks.
pub fn fill(text: &str, fills: &[Fill]) -> Result<String, String> {
    let mut text = text.to_owned();
    for f in fills {
        if !text.contains(&f.mark) {
            return Err(format!("there is no mark {:?} to fill", f.mark));
        }
        let long: String = (f.first..f.first + f.times)
            .map(|n| {
                let before = n.wrapping_sub(1).to_string();
                let text = f.text.replace("{n-1}", &before);
                text.replace("{n}", &n.to_string())
            })
            .collect();
        text = text.replace(&f.mark, &long);
    }
    Ok(text)
}

/// All words of a command, with its long texts.
pub fn filled<'a>(
    words: impl Iterator<Item = &'a String>,
    fills: &[Fill],
) -> Result<Vec<String>, String> {
    let all: Vec<String> = words.cloned().collect();
    let joined = fill(&all.join("\n"), fills)?;
    Ok(joined.split('\n').map(str::to_owned).collect())
}
