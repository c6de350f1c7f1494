//! The scratch copy of the sources, with every bug behind its switch.

use super::{Bug, LIST};
use crate::fault::Fault;
use crate::repository::{files_below, listed, root, write};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// No kernels: in the copy they may be slow, and are built in half the time.
const QUICK: [&str; 5] = [
    "poinsot-telemetry",
    "poinsot-model",
    "poinsot-figures",
    "poinsot",
    "poinsot-cli",
];
const DEPENDENCIES: &str = "\n[dependencies]\n";
const SWITCH: &str = r#"#![allow(missing_docs)]
//! Which planted bug is on.
use std::sync::OnceLock;

static ON: OnceLock<String> = OnceLock::new();

/// Whether this bug is on.
#[inline]
pub fn is(name: &str) -> bool {
    ON.get_or_init(|| std::env::var("POINSOT_PLANTED").unwrap_or_default()) == name
}
"#;
const SWITCH_MANIFEST: &str =
    "[package]\nname = \"planted\"\nversion = \"0.0.0\"\nedition = \"2024\"\n";

/// Files by name.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Folder of the copy, its build and the results.
pub fn scratch() -> PathBuf {
    root().join("target/planted")
}

/// Folder of the copy.
pub fn tree() -> PathBuf {
    scratch().join("tree")
}

/// Every file of the copy with its contents.
pub fn sources(bugs: &[Bug]) -> Result<Files, Fault> {
    let mut files = Files::new();
    for name in listed(&[])? {
        let path = root().join(&name);
        if path.is_file() {
            let contents = fs::read(&path).map_err(|why| Fault::file(&path, why))?;
            files.insert(name, contents);
        }
    }
    for bug in bugs {
        let contents = files
            .get_mut(&bug.file)
            .ok_or_else(|| lost(bug, "there is no such file"))?;
        *contents = planted(&String::from_utf8_lossy(contents), bug)?.into_bytes();
    }
    let touched: BTreeSet<_> = bugs
        .iter()
        .filter_map(|bug| bug.file.split('/').nth(1))
        .collect();
    for package in touched {
        add_switch(&mut files, package)?;
    }
    if let Some(manifest) = files.get_mut("Cargo.toml") {
        *manifest = quick(&String::from_utf8_lossy(manifest))?.into_bytes();
    }
    files.insert("crates/planted/src/lib.rs".to_owned(), SWITCH.into());
    files.insert(
        "crates/planted/Cargo.toml".to_owned(),
        SWITCH_MANIFEST.into(),
    );
    Ok(files)
}

/// The manifest of the workspace, with quick compiling of what is not a kernel.
fn quick(manifest: &str) -> Result<String, Fault> {
    let wrong = |why: &dyn std::fmt::Display| Fault::Failed(format!("Cargo.toml: {why}"));
    let mut manifest: Table = manifest.parse().map_err(|why| wrong(&why))?;
    let mut packages = &mut manifest;
    for key in ["profile", "release", "package"] {
        packages =
            table_in(packages, key).ok_or_else(|| wrong(&format!("{key} is not a table")))?;
    }
    for package in QUICK {
        if let Some(profile) = table_in(packages, package) {
            profile.insert("opt-level".to_owned(), 1.into());
        }
    }
    toml::to_string(&manifest).map_err(|why| wrong(&why))
}

/// A table within a table, made where it is missing.
fn table_in<'a>(table: &'a mut Table, key: &str) -> Option<&'a mut Table> {
    let empty = || Value::Table(Table::new());
    table.entry(key).or_insert_with(empty).as_table_mut()
}

fn lost(bug: &Bug, why: &str) -> Fault {
    Fault::Use(format!(
        "planted: {}: {why} in {}; correct {LIST}",
        bug.name, bug.file
    ))
}

/// The text of a file with this bug behind its switch.
fn planted(text: &str, bug: &Bug) -> Result<String, Fault> {
    let (right, wrong) = (bug.right.as_str(), bug.wrong.as_str());
    let count = text.matches(right).count();
    if count != 1 {
        return Err(lost(
            bug,
            &format!("'{right}' stands {count} times, not once,"),
        ));
    }
    let is_on = format!("planted::is(\"{}\")", bug.name);
    let arm = right
        .strip_suffix(',')
        .and_then(|arm| arm.split_once(" => "));
    let switched = if let Some((pattern, right)) = arm {
        format!("{pattern} => if {is_on} {{ {wrong} }} else {{ {right} }},")
    } else if right.ends_with(';') {
        format!("if {is_on} {{ {wrong} }} else {{ {right} }}")
    } else {
        format!("(if {is_on} {{ {wrong} }} else {{ {right} }})")
    };
    Ok(text.replace(right, &switched))
}

fn add_switch(files: &mut Files, package: &str) -> Result<(), Fault> {
    let name = format!("crates/{package}/Cargo.toml");
    let manifest = files
        .get_mut(&name)
        .map(|contents| (String::from_utf8_lossy(contents).into_owned(), contents));
    match manifest {
        Some((text, contents)) if text.matches(DEPENDENCIES).count() == 1 => {
            let with_switch = format!("{DEPENDENCIES}planted = {{ path = \"../planted\" }}\n");
            *contents = text.replace(DEPENDENCIES, &with_switch).into_bytes();
            Ok(())
        }
        _ => Err(Fault::Failed(format!(
            "planted: {name}: one line [dependencies] is needed"
        ))),
    }
}

/// Writes what differs, so that cargo builds no more than it must; removes what is no longer there.
pub fn write_tree(files: &Files) -> Result<(), Fault> {
    for (name, contents) in files {
        let path = tree().join(name);
        // Cargo has added the switch to its lock file.
        let kept = name == "Cargo.lock" && path.exists();
        if !kept && fs::read(&path).ok().as_ref() != Some(contents) {
            write(&path, contents)?;
            set_mode(&path, contents)?;
        }
    }
    for path in files_below(&tree())? {
        let inside = path.strip_prefix(tree()).unwrap_or(&path);
        let name = inside
            .iter()
            .map(|part| part.to_string_lossy())
            .collect::<Vec<_>>()
            .join("/");
        if !files.contains_key(&name) {
            fs::remove_file(&path).map_err(|why| Fault::file(&path, why))?;
        }
    }
    Ok(())
}

/// Scripts stay executable.
#[cfg(unix)]
fn set_mode(path: &Path, contents: &[u8]) -> Result<(), Fault> {
    use std::os::unix::fs::PermissionsExt;
    let mode = if contents.starts_with(b"#!") {
        0o755
    } else {
        0o644
    };
    fs::set_permissions(path, fs::Permissions::from_mode(mode))
        .map_err(|why| Fault::file(path, why))
}

#[cfg(not(unix))]
fn set_mode(_: &Path, _: &[u8]) -> Result<(), Fault> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bug(right: &str, wrong: &str) -> Bug {
        Bug {
            name: "b".to_owned(),
            what: String::new(),
            file: "crates/x/src/a.rs".to_owned(),
            right: right.to_owned(),
            wrong: wrong.to_owned(),
            tests: Vec::new(),
        }
    }

    #[test]
    fn unit_a_bug_gets_its_switch() {
        let expression = planted("let a = b + c;", &bug("b + c", "b - c")).unwrap();
        assert_eq!(
            expression,
            "let a = (if planted::is(\"b\") { b - c } else { b + c });"
        );
        let statement = planted("x += 1;\n", &bug("x += 1;", "")).unwrap();
        assert_eq!(statement, "if planted::is(\"b\") {  } else { x += 1; }\n");
        let arm = planted("A => 1,\n", &bug("A => 1,", "2")).unwrap();
        assert_eq!(arm, "A => if planted::is(\"b\") { 2 } else { 1 },\n");
    }

    #[test]
    fn unit_profiles_of_the_manifest_are_kept() {
        let before = "[workspace]\nmembers = [\"crates/*\"]\n[profile.release.package]\npoinsot-cli = { codegen-units = 1 }\n";
        let after: Table = quick(before).unwrap().parse().unwrap();
        let packages = &after["profile"]["release"]["package"];
        assert_eq!(packages["poinsot-cli"]["codegen-units"], Value::from(1));
        assert_eq!(packages["poinsot-cli"]["opt-level"], Value::from(1));
        assert_eq!(packages["poinsot"]["opt-level"], Value::from(1));
        assert!(after["workspace"]["members"].is_array());
    }

    #[test]
    fn unit_a_bug_without_one_place_is_refused() {
        let fault = planted("a a", &bug("a", "b")).unwrap_err();
        assert_eq!(fault.code(), 2);
        let text = "planted: b: 'a' stands 2 times, not once, in crates/x/src/a.rs; correct validation/planted/bugs.toml";
        assert_eq!(fault.text(), Some(text));
    }
}
