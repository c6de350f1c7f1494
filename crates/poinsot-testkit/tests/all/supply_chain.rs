//! What the workflows, scripts and pages fetch: nothing runs that was not pinned or checked.

use std::fs;
use std::path::{Path, PathBuf};

/// Files below a folder of the repository.
fn files(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut folders, mut found) = (vec![root.join(folder)], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => found.push(path),
            }
        }
    }
    found
}

/// Lines of those of the files that are text, each with its place.
fn lines(files: Vec<PathBuf>) -> Vec<(String, String)> {
    let texts = files.into_iter().filter_map(|path| {
        let text = fs::read_to_string(&path).ok()?;
        Some((path, text))
    });
    let numbered = texts.flat_map(|(path, text)| {
        let lines = text.lines().zip(1..).map(|(line, number)| {
            let place = format!("{}:{number}", path.display());
            (place, line.trim().to_owned())
        });
        lines.collect::<Vec<_>>()
    });
    numbered.collect()
}

#[test]
fn regress_actions_are_pinned_by_commit() {
    let mut count = 0;
    for (place, line) in lines(files(".github/workflows")) {
        let Some(action) = line.trim_start_matches("- ").strip_prefix("uses: ") else {
            continue;
        };
        let (_, commit) = action.split_once('@').unwrap_or_default();
        let (commit, tag) = commit.split_once(" # v").unwrap_or_default();
        let hex = commit.len() == 40 && commit.bytes().all(|b| b.is_ascii_hexdigit());
        assert!(hex && !tag.is_empty(), "{place}: {line}");
        count += 1;
    }
    assert!(count > 20, "only {count} actions");
}

#[test]
fn regress_every_job_states_its_permissions() {
    for path in files(".github/workflows") {
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("\npermissions: {}\n"), "{}", path.display());
        let (_, jobs) = text.split_once("\njobs:\n").unwrap();
        let is_job = |line: &&str| line.starts_with("  ") && !line[2..].starts_with([' ', '#']);
        let count = jobs.lines().filter(is_job).count();
        let stated = jobs.matches("\n    permissions:\n").count();
        assert_eq!(count, stated, "{}", path.display());
        let writes = text.matches(": write").count();
        let most = if path.ends_with("release.yml") { 3 } else { 0 };
        assert!(
            writes <= most,
            "{}: {writes} rights to write",
            path.display()
        );
    }
}

#[test]
fn regress_what_is_installed_is_locked_or_pinned() {
    let folders = [
        ".github",
        ".ci",
        "scripts",
        "docs",
        "examples",
        "validation",
    ];
    let mut all: Vec<PathBuf> = folders.into_iter().flat_map(files).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    all.extend(["README.md", "CONTRIBUTING.md"].map(|name| root.join(name)));
    let mut count = 0;
    for (place, line) in lines(all) {
        let piped = ["| sh", "| bash", "|sh", "|bash"]
            .iter()
            .any(|p| line.contains(p));
        let fetched = ["curl ", "wget "].iter().any(|p| line.contains(p));
        assert!(!(piped && fetched), "{place}: {line}");
        if line.contains("cargo install ") {
            assert!(line.contains("--locked"), "{place}: {line}");
            count += 1;
        }
        if let Some((_, package)) = line.split_once("npm install ") {
            assert!(package.contains('@'), "{place}: {line}");
            count += 1;
        }
    }
    assert!(count > 5, "only {count} installations");
}
