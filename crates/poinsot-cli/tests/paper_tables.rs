//! The tables of the three papers' pages: complete, and every command in them exists and runs.
#![allow(clippy::unwrap_used, clippy::panic)]

use clap::CommandFactory;
use poinsot_cli::arguments::Arguments;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

#[path = "../../poinsot/examples/kim2010_studies/names.rs"]
mod kim2010;
#[path = "../../poinsot/examples/ma2008_studies/names.rs"]
mod ma2008;
#[path = "../../poinsot/examples/xu2017_studies/names.rs"]
mod xu2017;

/// Page, and how many equations, tables and figures the paper numbers.
const PAPERS: [(&str, [usize; 3]); 3] = [
    ("kim2010", [17, 3, 4]),
    ("ma2008", [45, 1, 14]),
    ("xu2017", [75, 13, 13]),
];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn studies(paper: &str) -> &'static [(&'static str, &'static str, bool)] {
    match paper {
        "kim2010" => &kim2010::STUDIES,
        "ma2008" => &ma2008::STUDIES,
        _ => &xu2017::STUDIES,
    }
}

/// First and last cell of every row of the last table of a page.
fn rows(paper: &str) -> Vec<(String, String)> {
    let path = repository().join(format!("docs/methods/{paper}.md"));
    let text = std::fs::read_to_string(path).unwrap();
    let (_, table) = text.split_once("Every equation, table, figure").unwrap();
    let lines = table.lines().skip_while(|l| !l.starts_with('|'));
    let table = lines.take_while(|l| l.starts_with('|')).skip(2);
    table
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            assert_eq!(cells.len(), 4, "{line}");
            (cells[0].to_owned(), cells[3].to_owned())
        })
        .collect()
}

/// Numbers after `from`, as `1`, `1, 2`, `1-3`, with the brackets of equations taken off.
fn numbers(list: &str) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    for part in list.split(',') {
        let part = part.trim().replace(['(', ')'], "");
        let ends: Vec<usize> = part
            .split('-')
            .map_while(|n| n.trim().parse().ok())
            .collect();
        match ends.as_slice() {
            [one] => {
                found.insert(*one);
            }
            [a, b] => found.extend(*a..=*b),
            _ => break,
        }
    }
    found
}

/// The part of a cell that lists numbers: digits, brackets, commas and dashes at its start.
fn head(cell: &str) -> &str {
    let end = cell.find(|c: char| !"()0123456789,- ".contains(c));
    cell[..end.unwrap_or(cell.len())]
        .trim()
        .trim_end_matches(',')
}

#[test]
fn paper_tables_name_every_equation_table_and_figure() {
    for (paper, counts) in PAPERS {
        let rows = rows(paper);
        let mut found = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
        for (cell, _) in &rows {
            if cell.starts_with('(') {
                found[0].extend(numbers(head(cell)));
            } else if let Some(rest) = cell.strip_prefix("Table ").or(cell.strip_prefix("Tables "))
            {
                found[1].extend(numbers(head(rest)));
            } else if let Some(rest) = cell.strip_prefix("Fig. ") {
                found[2].extend(numbers(head(rest)));
            }
        }
        for (found, (count, what)) in found
            .iter()
            .zip(counts.into_iter().zip(["equation", "table", "figure"]))
        {
            let missing: Vec<usize> = (1..=count).filter(|n| !found.contains(n)).collect();
            assert!(missing.is_empty(), "{paper}: no row for {what} {missing:?}");
        }
    }
}

/// Every command of a cell.
fn commands(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// Whether a test file of a crate has a test whose name begins so.
fn has_test(package: &str, test: &str, filter: Option<&str>) -> bool {
    let tests = repository().join("crates").join(package).join("tests");
    let mut files = vec![tests.join(format!("{test}.rs"))];
    if let Ok(entries) = std::fs::read_dir(tests.join(test)) {
        files.extend(entries.map(|e| e.unwrap().path()));
    }
    let mut texts = files
        .iter()
        .filter_map(|f| std::fs::read_to_string(f).ok())
        .peekable();
    texts.peek().is_some()
        && filter.is_none_or(|name| texts.any(|t| t.contains(&format!("fn {name}"))))
}

#[test]
fn cli_every_command_of_the_papers_tables_exists() {
    for (paper, _) in PAPERS {
        for (what, cell) in rows(paper) {
            let commands = commands(&cell);
            assert!(!commands.is_empty(), "{paper}, {what}: no command");
            for command in commands {
                let words: Vec<&str> = command.split_whitespace().collect();
                let studies_of = words[0].strip_suffix("_studies");
                match (words.as_slice(), studies_of) {
                    (["poinsot", ..], _) => {
                        let parsed = Arguments::command().try_get_matches_from(&words);
                        assert!(parsed.is_ok(), "{command}: {}", parsed.unwrap_err());
                        for path in words.iter().filter(|w| w.starts_with("examples/")) {
                            assert!(repository().join(path).exists(), "{command}: {path}");
                        }
                    }
                    (["cargo", "test", "-p", package, "--test", test, filter @ ..], _) => {
                        let filter = filter.first().copied();
                        assert!(has_test(package, test, filter), "{command}");
                    }
                    ([_, study, ..], Some(of)) => {
                        let known = studies(of).iter().any(|s| s.0 == *study);
                        assert!(known, "{paper}, {what}: {command}");
                    }
                    _ => panic!("{paper}, {what}: '{command}' is no command of a known kind"),
                }
            }
        }
    }
}

/// The program of the studies of a paper, built where it is missing.
fn program(paper: &str) -> PathBuf {
    let name = format!("{paper}_studies");
    let beside = Path::new(env!("CARGO_BIN_EXE_poinsot")).parent().unwrap();
    let program = beside.join("examples").join(&name);
    if !program.exists() {
        let cargo = option_env!("CARGO").unwrap_or("cargo");
        let built = Command::new(cargo)
            .current_dir(repository())
            .args(["build", "--release", "-p", "poinsot", "--example", &name])
            .status();
        assert!(built.unwrap().success(), "{name}");
    }
    program
}

/// Runs the studies of the pages that end within seconds, or the others.
fn run(quick: bool) {
    let out = tempfile::tempdir().unwrap();
    for (paper, _) in PAPERS {
        for (study, _, ends_soon) in studies(paper).iter().filter(|s| s.0 != "all") {
            if *ends_soon != quick {
                continue;
            }
            let mut command = Command::new(program(paper));
            let done = command.arg(study).arg(out.path()).output().unwrap();
            let said = String::from_utf8_lossy(&done.stdout).into_owned();
            let wrong = String::from_utf8_lossy(&done.stderr).into_owned();
            assert!(done.status.success(), "{paper} {study}: {wrong}");
            assert!(said.lines().count() > 1, "{paper} {study}: {said}");
        }
    }
}

#[test]
fn cli_quick_studies_of_the_papers_run() {
    run(true);
}

#[test]
#[ignore = "minutes of processor time: nightly"]
fn cli_slow_studies_of_the_papers_run() {
    run(false);
}

/// The commands `poinsot` of the tables answer; a paper's question that is not wholly answered ends with 1.
#[test]
fn cli_poinsot_commands_of_the_papers_tables_answer() {
    let mut done = BTreeSet::new();
    for (paper, _) in PAPERS {
        for (_, cell) in rows(paper) {
            for command in commands(&cell)
                .into_iter()
                .filter(|c| c.starts_with("poinsot "))
            {
                if !done.insert(command.to_owned()) {
                    continue;
                }
                let arguments = command.split_whitespace().skip(1);
                let out = Command::new(env!("CARGO_BIN_EXE_poinsot"))
                    .current_dir(repository())
                    .args(arguments)
                    .output()
                    .unwrap();
                let code = out.status.code().unwrap_or(9);
                assert!(
                    code <= 1,
                    "{command}: {}",
                    String::from_utf8_lossy(&out.stderr)
                );
            }
        }
    }
    assert!(!done.is_empty());
}
