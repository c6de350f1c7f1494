//! The case files of `validation/bad_input/`: their sections, their order, their long texts.

use serde::Deserialize;
use std::io::Error;
use std::path::{Path, PathBuf};

/// Sections of the page: folder, heading.
pub const SECTIONS: [(&str, &str); 6] = [
    ("telemetry", "Telemetry (2a)"),
    ("results", "Results (2b)"),
    ("files", "Files (2c)"),
    ("models", "Models (2d)"),
    ("security", "Security (2e)"),
    ("codes", "Codes that the list does not reach"),
];

/// `validation/bad_input`.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/bad_input")
}

/// The case files of a section in the order of the page: names without extension, paths.
///
/// # Errors
/// The folder cannot be read.
pub fn names(section: &str) -> Result<Vec<(String, PathBuf)>, Error> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder().join(section))? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        all.push((stem.into_owned(), path));
    }
    all.sort_by_key(|(stem, _)| natural(stem));
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
///
/// # Errors
/// A mark is not in the text.
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
///
/// # Errors
/// A mark is not in them.
pub fn filled<'a>(
    words: impl Iterator<Item = &'a String>,
    fills: &[Fill],
) -> Result<Vec<String>, String> {
    let all: Vec<String> = words.cloned().collect();
    let joined = fill(&all.join("\n"), fills)?;
    Ok(joined.split('\n').map(str::to_owned).collect())
}

/// A key that sorts T2 before T10: texts, and the numbers behind them.
fn natural(name: &str) -> Vec<(String, Option<u64>)> {
    let mut key = Vec::new();
    let (mut text, mut number) = (String::new(), None::<u64>);
    for c in name.chars() {
        if let Some(digit) = c.to_digit(10) {
            let before = number.unwrap_or(0).saturating_mul(10);
            number = Some(before.saturating_add(digit.into()));
            continue;
        }
        if number.is_some() {
            key.push((std::mem::take(&mut text), number.take()));
        }
        text.extend(c.to_lowercase());
    }
    key.push((text, number));
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_names_sort_by_their_numbers() {
        let mut names = ["T10_a", "T2_b", "kim2010_x", "T2_a", "E0001_a", "T0_z"];
        names.sort_by_key(|n| natural(n));
        assert_eq!(
            names,
            ["E0001_a", "kim2010_x", "T0_z", "T2_a", "T2_b", "T10_a"]
        );
    }
}
