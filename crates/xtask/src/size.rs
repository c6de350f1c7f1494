//! Lines of code of each crate, counted by tokei.

use crate::fault::Fault;
use crate::repository::{
    files_below, name_of, on_path, read, root, scratch, status, stdout_of, write,
};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Prints the lines of one crate, file by file, or of all crates.
pub fn run(name: Option<&str>) -> Result<(), Fault> {
    if !on_path("tokei") {
        return Err(Fault::Use("needs tokei: cargo install tokei".to_owned()));
    }
    let work = scratch()?;
    match name {
        Some(name) => one(name, work.path()),
        None => all(work.path()),
    }
}

fn one(name: &str, work: &Path) -> Result<(), Fault> {
    let folder = format!("crates/{name}");
    if !root().join(&folder).is_dir() {
        return Err(Fault::Use(format!(
            "{folder}: no such crate; see the folder crates"
        )));
    }
    without_tests(&folder, work)?;
    let mut tokei = Command::new("tokei");
    let ended = status(
        tokei
            .args(["--types", "Rust", "--files", &folder])
            .current_dir(work),
    )?;
    ended.success().then_some(()).ok_or(Fault::Ended(1))
}

fn all(work: &Path) -> Result<(), Fault> {
    println!("crate,source,tests");
    for folder in crates()? {
        without_tests(&folder, work)?;
        let here = root().join(&folder);
        let source = code(&work.join(&folder))?;
        let mut tests = code(&here.join("src"))?.saturating_sub(source);
        if here.join("tests").is_dir() {
            tests += code(&here.join("tests"))?;
        }
        println!("{},{source},{tests}", folder.trim_start_matches("crates/"));
    }
    Ok(())
}

fn crates() -> Result<Vec<String>, Fault> {
    let folder = root().join("crates");
    let entries = fs::read_dir(&folder).map_err(|why| Fault::file(&folder, why))?;
    let mut names: Vec<_> = entries
        .flatten()
        .map(|entry| name_of(&entry.path()))
        .collect();
    names.sort();
    Ok(names)
}

/// Lines of Rust below a folder; 0 for a folder that is not there.
fn code(folder: &Path) -> Result<u64, Fault> {
    if !folder.is_dir() {
        return Ok(0);
    }
    let counted = stdout_of(
        Command::new("tokei")
            .args(["--types", "Rust", "--output", "json"])
            .arg(folder),
    )?;
    let counted: serde_json::Value = serde_json::from_str(&counted)
        .map_err(|why| Fault::Failed(format!("tokei: output is not JSON: {why}")))?;
    Ok(counted["Rust"]["code"].as_u64().unwrap_or_default())
}

/// Copies the sources of a crate, without tests, into a folder.
fn without_tests(folder: &str, to: &Path) -> Result<(), Fault> {
    for path in files_below(&root().join(folder).join("src"))? {
        let name = name_of(&path);
        if name.ends_with(".rs") && !name.ends_with("_tests.rs") && !name.contains("_tests/") {
            write(&to.join(&name), source_alone(&read(&path)?))?;
        }
    }
    Ok(())
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
    }
}
