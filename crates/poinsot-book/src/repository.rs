//! Paths of the repository.

use std::path::{Path, PathBuf};

/// The folder with `book.toml`.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_owned()
}

/// Pages of the book whose text is a file in the repository root: file, page.
pub const ROOT_PAGES: [(&str, &str); 5] = [
    ("NOTATION.md", "reference/notation.md"),
    ("DESIGN.md", "explanation/design.md"),
    ("ARCHITECTURE.md", "architecture.md"),
    ("CONTRIBUTING.md", "contributing.md"),
    ("CHANGELOG.md", "changelog.md"),
];

/// Folders with one file for each heading of the page of error codes.
const EXPLANATIONS: [&str; 2] = [
    "crates/poinsot/explanations",
    "crates/poinsot-papers/explanations",
];

/// Where the book shows a file that is the source of a page, or a part of one.
pub fn shown_at(file: &Path) -> Option<String> {
    if let Some((_, page)) = ROOT_PAGES.iter().find(|(f, _)| Path::new(f) == file) {
        return Some((*page).to_owned());
    }
    if file == Path::new("validation/bad_input/README.md") {
        return Some("validation/bad_input.md".to_owned());
    }
    let part = EXPLANATIONS
        .iter()
        .find_map(|f| file.strip_prefix(f).ok())?;
    let heading = match part.file_stem().and_then(|s| s.to_str()) {
        Some(code) => format!("#{}", code.to_lowercase()),
        None => String::new(),
    };
    Some(format!("reference/errors.md{heading}"))
}

/// The folder to which links on a page are relative, from the repository root.
pub fn base_of(page: &Path) -> PathBuf {
    let included = ROOT_PAGES.iter().any(|(_, p)| Path::new(p) == page);
    if included {
        return PathBuf::new();
    }
    Path::new("docs").join(page.parent().unwrap_or(Path::new("")))
}

/// A path without `.` and `..`; `None` if it leaves the repository.
pub fn normal(path: &Path) -> Option<PathBuf> {
    use std::path::Component;
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                if !out.pop() {
                    return None;
                }
            }
            Component::Normal(name) => out.push(name),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_paths_stay_inside() {
        let same = |a: &str| normal(Path::new(a)).map(|p| p.display().to_string());
        assert_eq!(same("docs/../NOTATION.md").as_deref(), Some("NOTATION.md"));
        assert_eq!(same("docs/../../secret"), None);
        assert_eq!(same("/etc/hosts"), None);
    }
}
