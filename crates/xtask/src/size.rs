//! Lines of code: of each crate, of the files of one crate, and of each part against an earlier revision.

mod parts;

use crate::fault::Fault;
use crate::repository::{files_below, name_of, read, root, scratch, succeed};
use crate::rust_text::code_lines;
use parts::{PARTS, Part};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Lines of one file, by where it lies and what it holds.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Lines {
    source: usize,
    tests: usize,
}

/// Lines of each file, by its path from the root of its tree.
type Tree = BTreeMap<String, Lines>;

/// Prints the lines of one crate, file by file, of all crates, or of each part now and at a revision.
pub fn run(name: Option<&str>, since: Option<&str>) -> Result<(), Fault> {
    let now = tree(&root())?;
    if let Some(revision) = since {
        print!("{}", compared(&tree_of(revision)?, &now));
        return Ok(());
    }
    match name {
        Some(name) => one(name, &now),
        None => {
            all(&now);
            Ok(())
        }
    }
}

fn one(name: &str, tree: &Tree) -> Result<(), Fault> {
    let folder = format!("crates/{name}/");
    let mut found = tree
        .iter()
        .filter(|(path, _)| path.starts_with(&folder))
        .peekable();
    if found.peek().is_none() {
        return Err(Fault::Use(format!(
            "{folder}: no such crate; see the folder crates"
        )));
    }
    println!("file,source,tests");
    for (path, lines) in found {
        println!("{path},{},{}", lines.source, lines.tests);
    }
    Ok(())
}

fn all(tree: &Tree) {
    let mut crates: BTreeMap<&str, Lines> = BTreeMap::new();
    for (path, lines) in tree {
        let sum = crates.entry(crate_of(path)).or_default();
        sum.source += lines.source;
        sum.tests += lines.tests;
    }
    println!("crate,source,tests");
    for (name, lines) in crates {
        println!("{name},{},{}", lines.source, lines.tests);
    }
}

fn crate_of(path: &str) -> &str {
    path.split('/').nth(1).unwrap_or_default()
}

/// A table of the parts: before, now, the new capability in it, and the rest against before.
fn compared(before: &Tree, now: &Tree) -> String {
    let mut out =
        "| part | before | now | of it new | the rest against before |\n|---|---|---|---|---|\n"
            .to_owned();
    for part in &PARTS {
        let of_part = |path: &str| Part::of(path).is_some_and(|p| p.name == part.name);
        let old = sum(before, of_part);
        let current = sum(now, of_part);
        let new = sum(now, |path| of_part(path) && part.is_new(path));
        let change = 100.0 * (current.saturating_sub(new) as f64 / old.max(1) as f64 - 1.0);
        out += &format!(
            "| {} | {old} | {current} | {new} | {change:+.0} % |\n",
            part.name
        );
    }
    let beside = |path: &str| Part::of(path).is_none();
    out += &format!(
        "| tests, book, fuzzing, Python module, maintenance | {} | {} | | |\n",
        sum(before, beside),
        sum(now, beside)
    );
    let tests = |tree: &Tree| tree.values().map(|lines| lines.tests).sum::<usize>();
    out + &format!(
        "| tests of all crates | {} | {} | | |\n",
        tests(before),
        tests(now)
    )
}

fn sum(tree: &Tree, is_of: impl Fn(&str) -> bool) -> usize {
    let found = tree.iter().filter(|(path, _)| is_of(path));
    found.map(|(_, lines)| lines.source).sum()
}

/// The lines of a revision.
fn tree_of(revision: &str) -> Result<Tree, Fault> {
    let work = scratch()?;
    let archive = work.path().join("tree.tar");
    let mut git = Command::new("git");
    git.args(["archive", "--output"])
        .arg(&archive)
        .args([revision, "crates"]);
    succeed(git.current_dir(root()))?;
    let mut tar = Command::new("tar");
    succeed(tar.arg("xf").arg(&archive).current_dir(work.path()))?;
    tree(work.path())
}

/// The lines of every crate below a root; benchmarks are left out.
fn tree(root: &Path) -> Result<Tree, Fault> {
    let mut out = Tree::new();
    for path in files_below(&root.join("crates"))? {
        let name = match path.strip_prefix(root) {
            Ok(inside) => inside
                .iter()
                .map(|part| part.to_string_lossy())
                .collect::<Vec<_>>()
                .join("/"),
            Err(_) => name_of(&path),
        };
        let folder = name.split('/').nth(2).unwrap_or_default();
        if name.ends_with(".rs") && ["src", "tests", "examples"].contains(&folder) {
            let is_test =
                folder == "tests" || name.ends_with("_tests.rs") || name.contains("_tests/");
            out.insert(name, lines(&read(&path)?, is_test));
        }
    }
    Ok(out)
}

fn lines(text: &str, is_test: bool) -> Lines {
    let all = code_lines(text);
    let source = if is_test {
        0
    } else {
        code_lines(&source_alone(text))
    };
    Lines {
        source,
        tests: all - source,
    }
}

/// Inline tests begin with `#[cfg(test)]` before an opened module and end their file.
fn source_alone(text: &str) -> String {
    let mut out = String::new();
    let mut after_attribute = false;
    for line in text.lines() {
        if line == "#[cfg(test)]" {
            after_attribute = true;
            continue;
        }
        if after_attribute {
            if line.starts_with("mod ") && line.ends_with(" {") {
                break;
            }
            after_attribute = line.starts_with("#[");
        }
        out.push_str(line);
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_inline_tests_are_left_out() {
        let text = "fn a() {}\n#[cfg(test)]\nmod b;\nfn c() {}\n#[cfg(test)]\n#[allow(x)]\nmod tests {\n}\n";
        assert_eq!(
            source_alone(text),
            "fn a() {}\nmod b;\nfn c() {}\n#[allow(x)]\n"
        );
        let counted = lines(text, false);
        assert_eq!((counted.source, counted.tests), (4, 4));
        assert_eq!(lines(text, true).source, 0);
    }

    #[test]
    fn unit_new_files_are_counted_apart() {
        let tree = |files: &[(&str, usize)]| -> Tree {
            let file = |(path, source): &(&str, usize)| {
                let lines = Lines {
                    source: *source,
                    tests: 1,
                };
                ((*path).to_owned(), lines)
            };
            files.iter().map(file).collect()
        };
        let before = tree(&[("crates/poinsot-model/src/read.rs", 100)]);
        let now = tree(&[
            ("crates/poinsot-model/src/read.rs", 80),
            ("crates/poinsot-model/src/patch/mod.rs", 50),
        ]);
        let table = compared(&before, &now);
        assert!(
            table.contains("| model | 100 | 130 | 50 | -20 % |\n"),
            "{table}"
        );
        assert!(
            table.ends_with("| tests of all crates | 1 | 2 | | |\n"),
            "{table}"
        );
    }
}
