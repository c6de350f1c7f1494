//! Every public function that a user of the crates can call has an example that runs.
//!
//! The functions are those that a crate re-exports at its root, those of its public modules, and those that its public
//! modules re-export. The sources are read as text: an example is a code block of the documentation above the function
//! that is Rust and neither ignored nor only compiled.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Crates whose functions a researcher calls.
const CRATES: [&str; 12] = [
    "poinsot",
    "poinsot-design",
    "poinsot-dynamics",
    "poinsot-figures",
    "poinsot-formats",
    "poinsot-identify",
    "poinsot-model",
    "poinsot-papers",
    "poinsot-report",
    "poinsot-solve",
    "poinsot-spatial",
    "poinsot-telemetry",
];

/// Functions without an example: part of the place, and the reason.
const WITHOUT: [(&str, &str); 7] = [
    (
        "/error.rs:",
        "a fault with its code; `poinsot explain` shows the message",
    ),
    ("/studies/", "steps of a study; `study::run` has an example"),
    (": campaign_document", "text of a campaign, which has one"),
    (": cost_document", "text of a campaign's cost"),
    (": statistics_document", "text of a sweep, which has one"),
    (": study_document", "text of a study, which has one"),
    (": vector_reading", "a step of the sensor models"),
];

#[test]
fn unit_every_public_function_has_an_example_that_runs() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut missing = Vec::new();
    let mut read = 0;
    for name in CRATES {
        let source = crates.join(name).join("src");
        for function in public_functions(&files_in(&source)) {
            read += 1;
            let Function {
                file,
                line,
                name: function,
                has_example,
            } = function;
            let place = format!("{name}/{file}:{line}: {function}");
            if !has_example && !WITHOUT.iter().any(|(part, _)| place.contains(part)) {
                missing.push(place);
            }
        }
        let page = fs::read_to_string(source.join("lib.rs")).unwrap();
        let page = page.lines().take_while(|line| is_page(line));
        if !has_example(page.map(|line| line.trim_start_matches("//!"))) {
            missing.push(format!("{name}/lib.rs: the page of the crate"));
        }
    }
    assert!(read > 200, "only {read} functions found");
    assert!(
        missing.is_empty(),
        "no example that runs (`cargo test -p CRATE --doc`):\n{}",
        missing.join("\n")
    );
}

#[test]
fn unit_a_function_without_an_example_is_found() {
    let text = [
        (
            "lib.rs",
            "mod a;\npub mod b;\npub use a::{One, c::two};\n/// A\npub fn at_root() {}",
        ),
        ("a.rs", "pub fn hidden() {}"),
        (
            "a/c.rs",
            "/// Two.\n///\n/// ```\n/// a();\n/// ```\n#[inline]\npub fn two() {}",
        ),
        (
            "b.rs",
            "/// ```no_run\n/// x();\n/// ```\npub fn three() {}\nfn own() {}",
        ),
    ];
    let files = text.map(|(file, text)| (PathBuf::from(file), text.to_owned()));
    let found = public_functions(&files.into());
    let found: Vec<_> = found
        .iter()
        .map(|f| (f.name.as_str(), f.has_example))
        .collect();
    assert_eq!(found, [("two", true), ("three", false), ("at_root", false)]);
}

/// Text of every source file below `src`, by its path in it.
type Files = BTreeMap<PathBuf, String>;
/// Path from the crate root to a module.
type Module = Vec<String>;

/// A function that other crates can call.
struct Function {
    file: String,
    line: usize,
    name: String,
    has_example: bool,
}

fn files_in(source: &Path) -> Files {
    let mut files = Files::new();
    let mut folders = vec![source.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                files.insert(path.strip_prefix(source).unwrap().to_owned(), text);
            }
        }
    }
    files
}

/// The module of a file.
fn module_of(file: &Path) -> Module {
    let parts = file.with_extension("");
    let parts = parts.iter().map(|part| part.to_str().unwrap().to_owned());
    parts
        .filter(|part| part != "mod" && part != "lib")
        .collect()
}

/// Public functions at the left margin: those of public modules, and those that public modules re-export.
fn public_functions(files: &Files) -> Vec<Function> {
    let texts: BTreeMap<Module, &str> = files
        .iter()
        .map(|(file, text)| (module_of(file), text.as_str()))
        .collect();
    let mut public = BTreeSet::new();
    let mut shown = Vec::new();
    let mut next = vec![Module::new()];
    while let Some(module) = next.pop() {
        let Some(text) = texts.get(&module) else {
            continue;
        };
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("pub mod ") {
                let name = name.trim_end_matches(';').to_owned();
                next.push([module.as_slice(), &[name]].concat());
            }
        }
        for tree in text.split("\npub use ").skip(1) {
            re_exported(tree.split(';').next().unwrap(), &module, &mut shown);
        }
        public.insert(module);
    }
    let mut found = Vec::new();
    for (file, text) in files {
        let module = module_of(file);
        let lines: Vec<&str> = text.lines().collect();
        for (at, line) in lines.iter().enumerate() {
            let Some(name) = function_name(line) else {
                continue;
            };
            let is_shown = |(of, item): &(Module, String)| {
                module.starts_with(of) && (item == name || item == "*")
            };
            if public.contains(&module) || shown.iter().any(is_shown) {
                found.push(Function {
                    file: file.display().to_string(),
                    line: at + 1,
                    name: name.to_owned(),
                    has_example: has_example(documentation(&lines[..at])),
                });
            }
        }
    }
    found
}

/// Adds the items of one `pub use` tree, each with the module that it names.
fn re_exported(tree: &str, module: &Module, shown: &mut Vec<(Module, String)>) {
    let tree = tree.trim();
    let Some((first, rest)) = tree.split_once("::") else {
        let name = tree.split(" as ").next().unwrap();
        shown.push((module.clone(), name.to_owned()));
        return;
    };
    let inside = match first {
        "crate" => Module::new(),
        "self" => module.clone(),
        first => [module.as_slice(), &[first.to_owned()]].concat(),
    };
    let Some(list) = rest.trim().strip_prefix('{') else {
        re_exported(rest, &inside, shown);
        return;
    };
    let mut depth = 0;
    let mut start = 0;
    let list = list.trim_end();
    let list = list
        .strip_suffix('}')
        .unwrap_or(list)
        .trim_end()
        .trim_end_matches(',');
    for (at, c) in list.char_indices().chain([(list.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                re_exported(&list[start..at], &inside, shown);
                start = (at + 1).min(list.len());
            }
            _ => {}
        }
    }
}

fn function_name(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("pub const fn ");
    let rest = rest.or_else(|| line.strip_prefix("pub fn "))?;
    rest.split(['(', '<']).next()
}

/// The lines of documentation right above an item, without their slashes.
fn documentation<'a>(above: &[&'a str]) -> impl Iterator<Item = &'a str> {
    // A long attribute goes on over indented lines.
    let is_of_item = |line: &&&str| line.starts_with("///") || line.starts_with(['#', ' ', ')']);
    let count = above.iter().rev().take_while(is_of_item).count();
    let lines = above[above.len() - count..].to_vec();
    lines
        .into_iter()
        .filter_map(|line| line.strip_prefix("///"))
}

fn is_page(line: &str) -> bool {
    line.starts_with("//!") || line.starts_with("#![doc")
}

/// Whether a block of code is Rust that the documentation tests run.
fn has_example<'a>(lines: impl Iterator<Item = &'a str>) -> bool {
    let mut fences = lines.filter_map(|line| line.trim().strip_prefix("```"));
    while let (Some(begin), Some(_)) = (fences.next(), fences.next()) {
        if ["", "rust", "should_panic"].contains(&begin) {
            return true;
        }
    }
    false
}
