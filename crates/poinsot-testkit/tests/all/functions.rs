//! Lengths of functions, read from the sources: a short one has one purpose.

use std::fs;
use std::path::{Path, PathBuf};

/// Most lines of a function, from its first to its closing brace.
const MOST: usize = 80;
/// Crates and modules that tests alone use.
const OF_TESTS: [&str; 3] = ["poinsot-testkit", "information_tests", "tests.rs"];

#[test]
fn unit_functions_are_short() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut sources = Vec::new();
    for folder in fs::read_dir(crates).unwrap() {
        let source = folder.unwrap().path().join("src");
        if source.is_dir() {
            rust_files(&source, &mut sources);
        }
    }
    let mut read = 0;
    let mut long = Vec::new();
    for path in sources {
        let name = path.to_string_lossy();
        if OF_TESTS.iter().any(|part| name.contains(part)) {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let all = lengths(&text);
        read += all.len();
        let above = all.into_iter().filter(|(_, lines)| *lines > MOST);
        long.extend(above.map(|(function, lines)| format!("{name}: {function}, {lines} lines")));
    }
    assert!(read > 4000, "only {read} functions found");
    assert!(
        long.is_empty(),
        "longer than {MOST} lines:\n{}",
        long.join("\n")
    );
}

#[test]
fn unit_a_planted_long_function_is_found() {
    let body = "        let x = 1;\n".repeat(MOST);
    let text = format!(
        "impl A {{\n    pub(crate) fn long(\n        a: f64,\n    ) {{\n{body}    }}\n\n    fn short() {{\n    }}\n}}\nfn one() {{}}\n"
    );
    let found = lengths(&text);
    assert_eq!(
        found,
        [("long".to_owned(), MOST + 4), ("short".to_owned(), 2)]
    );
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

/// Names and lines of functions over more than one line, as the formatter lays them out: the closing brace is in the column of the
/// first word.
fn lengths(text: &str) -> Vec<(String, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let named = lines.iter().enumerate().filter_map(|(at, line)| {
        let indent = line.len() - line.trim_start().len();
        let (before, after) = line.split_once("fn ")?;
        let words = before.trim_start();
        let starts = words.is_empty() || words.starts_with("pub") || words.starts_with("const");
        // A function of a trait may have no body.
        let signature = lines[at..].iter().find(|l| l.ends_with(['{', ';', '}']))?;
        let end: String = std::iter::repeat_n(' ', indent).chain(['}']).collect();
        let length = lines[at..].iter().position(|l| *l == end)? + 1;
        let name: String = after
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        (starts && signature.ends_with('{')).then_some((name, length))
    });
    named.collect()
}
