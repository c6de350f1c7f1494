//! Every fault of the list: printed message, exit code, files left.
//!
//! `POINSOT_BLESS=1` rewrites `docs/validation/bad_input.md` and `docs/reference/errors.md` from the printed messages.

mod advice;
mod bench;
mod codes;
mod document;
mod files;
mod models;
mod results;
mod row;
mod security;
mod telemetry;

use row::{Printed, Row};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs the rows on a few threads; returns the output in order.
fn run(rows: &[Row]) -> Vec<Printed> {
    let next = AtomicUsize::new(0);
    let done: Mutex<BTreeMap<usize, (Vec<String>, Printed)>> = Mutex::new(BTreeMap::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((k, row)) = {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    rows.get(k).map(|r| (k, r))
                } {
                    let outcome = row.check();
                    done.lock().unwrap().insert(k, outcome);
                }
            });
        }
    });
    let mut wrong = String::new();
    let mut printed = Vec::new();
    for (faults, one) in done.into_inner().unwrap().into_values() {
        if !faults.is_empty() {
            wrong.push_str(&format!(
                "\n[{}] {}: {}\n",
                one.id,
                one.fault,
                faults.join("; ")
            ));
        }
        printed.push(one);
    }
    assert!(wrong.is_empty(), "{wrong}");
    printed
}

#[test]
fn cli_every_fault_of_the_list_and_every_code() {
    let parts = [
        ("Telemetry (2a)", telemetry::rows()),
        ("Results (2b)", results::rows()),
        ("Files (2c)", files::rows()),
        ("Models (2d)", models::rows()),
        ("Security (2e)", security::rows()),
        ("Codes that the list does not reach", codes::rows()),
    ];
    let sizes: Vec<usize> = parts.iter().map(|p| p.1.len()).collect();
    let names: Vec<&str> = parts.iter().map(|p| p.0).collect();
    let all: Vec<Row> = parts.into_iter().flat_map(|p| p.1).collect();
    let printed = run(&all);
    let mut sections = Vec::new();
    let mut rest = printed.as_slice();
    for (name, size) in names.into_iter().zip(sizes) {
        let (here, further) = rest.split_at(size);
        sections.push((name, here));
        rest = further;
    }
    document::compare(
        "docs/validation/bad_input.md",
        &document::bad_input(&sections),
    );
    let messages = messages(&printed);
    let codes = poinsot::explain::error_codes();
    let without: Vec<&str> = codes
        .iter()
        .map(|c| c.code)
        .filter(|c| !messages.contains_key(*c))
        .collect();
    assert!(without.is_empty(), "no row prints {without:?}");
    document::compare(
        "docs/reference/errors.md",
        &document::errors(&codes, &messages),
    );
}

/// The first complete message of each code, or the reason why no input causes it.
fn messages(printed: &[Printed]) -> BTreeMap<String, (String, Option<&'static str>)> {
    let mut all = BTreeMap::new();
    for line in printed
        .iter()
        .filter(|p| p.exit >= 2)
        .flat_map(|p| &p.lines)
    {
        if let Some(code) = line.get(..5).filter(|c| c.starts_with('E')) {
            all.entry(code.to_owned()).or_insert((line.clone(), None));
        }
    }
    for (code, message, why) in codes::of_the_library() {
        assert!(
            message.is_empty() || advice::says_what_to_do(&message),
            "no advice: {message}"
        );
        assert!(message.starts_with(code), "{message}");
        all.entry(code.to_owned()).or_insert((message, Some(why)));
    }
    // Needs standard output on a full device: tests/all/environment.rs.
    all.entry("E0003".to_owned()).or_insert((
        "E0003 standard output: No space left on device (os error 28); free space, or write to another place".to_owned(),
        None,
    ));
    all
}

/// Every source file of the crates, without tests.
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
            // Explanations, not uses.
            if path.ends_with("codes.rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            found.push((path, code.to_owned()));
        }
    }
    found
}

fn codes_in_sources() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (path, code) in sources() {
        if path.components().any(|c| c.as_os_str() == "explain") {
            continue;
        }
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
