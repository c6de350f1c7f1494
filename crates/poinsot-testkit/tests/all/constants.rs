//! Names of constants, read from the sources: one name has one value in a crate.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Modules that tests alone use.
const OF_TESTS: &str = "information_tests";

#[test]
fn unit_a_constant_of_identify_has_one_value() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    rust_files(&root.join("poinsot-identify/src"), &mut files);
    let mut texts = Vec::new();
    for path in files {
        let name = path.to_string_lossy().into_owned();
        if !name.contains(OF_TESTS) {
            texts.push((name, fs::read_to_string(path).unwrap()));
        }
    }
    let read: usize = texts.iter().map(|(_, text)| constants(text).len()).sum();
    assert!(read > 80, "only {read} constants found");
    let doubled = doubled(&texts);
    assert!(
        doubled.is_empty(),
        "constants with two values:\n{}",
        doubled.join("\n")
    );
}

#[test]
fn unit_a_planted_second_value_is_found() {
    let one = "const LEAST: f64 = 1.0;\npub(crate) const SAME: usize = 2;\n";
    let other = "const LEAST: f64 =\n    2.0;\nconst SAME: usize = 2;\nimpl A {\n    const ALL: u8 = 1;\n}\n";
    let texts = [one, other].map(|text| ("file".to_owned(), text.to_owned()));
    let found = doubled(&texts);
    assert_eq!(found.len(), 1);
    assert!(found[0].starts_with("LEAST"), "{found:?}");
}

/// Names with more than one value, and where.
fn doubled(texts: &[(String, String)]) -> Vec<String> {
    let mut all: BTreeMap<String, Vec<(String, &str)>> = BTreeMap::new();
    for (file, text) in texts {
        for (name, value) in constants(text) {
            all.entry(name).or_default().push((value, file));
        }
    }
    let differ = all
        .into_iter()
        .filter(|(_, of)| of.iter().any(|one| one.0 != of[0].0));
    differ.map(|(name, of)| format!("{name}: {of:?}")).collect()
}

/// Constants of modules, which begin in the first column: name and value without spaces.
fn constants(text: &str) -> Vec<(String, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let starts = lines.iter().enumerate().filter_map(|(at, line)| {
        let (before, rest) = line.split_once("const ")?;
        let words = before.is_empty() || before.starts_with("pub");
        let (name, _) = rest.split_once(':')?;
        (words && !name.contains(' ')).then(|| (at, name.to_owned()))
    });
    let value = |at: usize| {
        let text = lines[at..].concat();
        let all = text.split_once('=').map_or("", |(_, value)| value);
        // An array type has a semicolon before the sign.
        let end = all.split_once(';').map_or(all, |(value, _)| value);
        end.split_whitespace().collect::<String>()
    };
    starts.map(|(at, name)| (name, value(at))).collect()
}

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}
