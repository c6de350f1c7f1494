//! Table of contents: `docs/SUMMARY.md`, and every page of a folder below the chapter of the folder.

use crate::error::BookError;
use crate::repository::root;
use std::path::Path;

/// Chapters with all pages of a folder: page, folder.
const FOLDERS: [(&str, &str); 2] = [("methods.md", "methods"), ("validation.md", "validation")];

/// `SUMMARY.md` plus the pages of the folders, so that a new method needs no line in it.
///
/// # Errors
/// Reading fails, or a page has no heading.
pub fn summary() -> Result<String, BookError> {
    let docs = root().join("docs");
    let path = docs.join("SUMMARY.md");
    let written = std::fs::read_to_string(&path).map_err(BookError::io(&path))?;
    let mut out = String::new();
    for line in written.lines() {
        out.push_str(line);
        out.push('\n');
        for (page, folder) in FOLDERS {
            if line.contains(&format!("({page})")) {
                let indent = line.len() - line.trim_start().len() + 2;
                for (title, file) in pages(&docs, folder)? {
                    out.push_str(&format!("{:indent$}- [{title}]({folder}/{file})\n", ""));
                }
            }
        }
    }
    Ok(out)
}

/// Title and file of the pages of a folder, by name.
fn pages(docs: &Path, folder: &str) -> Result<Vec<(String, String)>, BookError> {
    let place = docs.join(folder);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(&place).map_err(BookError::io(&place))? {
        let path = entry.map_err(BookError::io(&place))?.path();
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_file() && file.ends_with(".md") {
            let text = std::fs::read_to_string(&path).map_err(BookError::io(&path))?;
            let heading = text.lines().next().and_then(|l| l.strip_prefix("# "));
            let heading = heading.ok_or_else(|| BookError::Heading(format!("{folder}/{file}")))?;
            let title = heading.split(':').next().unwrap_or(heading).trim();
            found.push((title.to_owned(), file.into_owned()));
        }
    }
    found.sort_by(|a, b| a.1.cmp(&b.1));
    Ok(found)
}
