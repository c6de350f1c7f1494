//! The registry of codes against the sources, and which crate opens files.

use std::collections::BTreeSet;

/// Every source file of the crates, without tests and documentation.
fn sources() -> Vec<(std::path::PathBuf, String)> {
    let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    let mut folders: Vec<_> = std::fs::read_dir(crates)
        .unwrap()
        .flatten()
        .map(|e| e.path().join("src"))
        .collect();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            // The registry, not uses.
            if path.ends_with("codes.rs") || path.ends_with("explain.rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            let is_code = |line: &&str| !line.trim_start().starts_with("//");
            let code: Vec<&str> = code.lines().filter(is_code).collect();
            found.push((path, code.join("\n")));
        }
    }
    found
}

fn codes_in_sources() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, code) in sources() {
        for (at, _) in code.match_indices("\"E0") {
            let word = code.get(at + 1..at + 6).unwrap_or_default();
            if word.len() == 5 && word.bytes().skip(1).all(|b| b.is_ascii_digit()) {
                found.insert(word.to_owned());
            }
        }
    }
    found
}

/// Functions that access files without `poinsot-files`.
const PAST_THE_GATE: &[&str] = &[
    "fs::read(",
    "fs::read_to_string(",
    "File::open(",
    "OpenOptions",
    "fs::write(",
    "File::create",
    "fs::rename(",
    "fs::create_dir",
    "NamedTempFile",
    "tempdir",
];

/// Crates without user input, and `poinsot-files` itself.
const NOT_THE_PROGRAM: &[&str] = &[
    "poinsot-files",
    "poinsot-book",
    "poinsot-fuzz",
    "poinsot-testkit",
];

#[test]
fn exact_one_crate_opens_inputs_and_places_outputs() {
    let mut past = Vec::new();
    for (path, code) in sources() {
        let name = path.display().to_string();
        if NOT_THE_PROGRAM.iter().any(|c| name.contains(c)) {
            continue;
        }
        past.extend(
            PAST_THE_GATE
                .iter()
                .filter(|w| code.contains(**w))
                .map(|w| format!("{name}: {w}")),
        );
    }
    assert!(past.is_empty(), "{past:#?}");
}

#[test]
fn exact_every_explanation_is_registered_and_complete() {
    let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = ["poinsot/explanations", "poinsot-papers/explanations"];
    let files: BTreeSet<String> = folders
        .iter()
        .flat_map(|f| std::fs::read_dir(crates.join(f)).unwrap())
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    let codes = poinsot::explain::error_codes();
    let registered: BTreeSet<String> = codes.iter().map(|c| format!("{}.md", c.code)).collect();
    assert_eq!(files, registered);
    for c in &codes {
        let ends = [c.meaning, c.cause, c.remedy].map(|text| text.ends_with('.'));
        assert_eq!(
            ends, [true; 3],
            "{}: a text is missing or without a full stop",
            c.code
        );
    }
}

#[test]
fn exact_the_registry_holds_the_codes_of_the_sources() {
    let registry: Vec<&str> = poinsot::explain::error_codes()
        .iter()
        .map(|c| c.code)
        .collect();
    let unique: BTreeSet<String> = registry.iter().map(|c| (*c).to_owned()).collect();
    assert_eq!(unique.len(), registry.len(), "a code stands twice");
    let sources = codes_in_sources();
    let missing: Vec<_> = sources.difference(&unique).collect();
    let unused: Vec<_> = unique.difference(&sources).collect();
    assert!(missing.is_empty(), "not explained: {missing:?}");
    assert!(
        unused.is_empty(),
        "explained, but nowhere in use: {unused:?}"
    );
}
