//! The papers' pages: they are complete, every command exists and runs, and every cell of a study agrees with its
//! present result; so do the figures.
//!
//! A table made by a study is below `<!-- study NAME.TABLE -->`, on the paper's page or on its page of tables. The last
//! table of a paper's page has a row for every equation, table, figure, claim and use. If its command is a study, the
//! study gives the number. `POINSOT_BLESS=1` rewrites these cells and the figures of the pages.

use clap::CommandFactory;
use poinsot::study::{Cell, Findings, FoundTable, Study, run, studies};
use poinsot_cli::arguments::Arguments;
use poinsot_papers::METHODS;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Papers by name, with their numbers of numbered equations, tables and figures: the page has a row for each.
const PAPERS: [(&str, [usize; 3]); 3] = [
    ("kim2010", [17, 3, 4]),
    ("ma2008", [45, 1, 14]),
    ("xu2017", [75, 13, 13]),
];

/// Every paper of the crate.
fn papers() -> impl Iterator<Item = (&'static str, [usize; 3])> {
    let of = |name| PAPERS.iter().find(|paper| paper.0 == name).unwrap();
    METHODS.iter().map(move |m| *of(m.name))
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn page(paper: &str) -> PathBuf {
    repository().join(format!("docs/methods/{paper}.md"))
}

/// The page of the tables that the paper's page does not show.
fn page_of_tables(paper: &str) -> PathBuf {
    repository().join(format!("docs/methods/{paper}/tables.md"))
}

/// Nightly job: of the commands in the tables it has the tests of whole crates, and this file.
const NIGHTLY: &str = include_str!("../../../../scripts/test");

/// Start of the last table of every page.
const LAST_TABLE: &str = "Every equation, table, figure";

/// The cells of a row of a table.
fn cells(line: &str) -> Vec<&str> {
    let inner = line.trim().strip_prefix('|').unwrap();
    let inner = inner.strip_suffix('|').unwrap();
    inner.split('|').map(str::trim).collect()
}

/// First, third and last cell of every row of the last table of a page: statement, number, command.
fn rows(text: &str) -> Vec<[String; 3]> {
    let (_, table) = text.split_once(LAST_TABLE).unwrap();
    let lines = table.lines().skip_while(|l| !l.starts_with('|'));
    let table = lines.take_while(|l| l.starts_with('|')).skip(2);
    table
        .map(|line| {
            let cells = cells(line);
            assert_eq!(cells.len(), 4, "{line}");
            [cells[0], cells[2], cells[3]].map(str::to_owned)
        })
        .collect()
}

fn rows_of(paper: &str) -> Vec<[String; 3]> {
    rows(&std::fs::read_to_string(page(paper)).unwrap())
}

/// Numbers after `from`, as `1`, `1, 2`, `1-3`, without the brackets of equations.
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

/// The start of a cell that lists numbers: digits, brackets, commas and dashes.
fn head(cell: &str) -> &str {
    let end = cell.find(|c: char| !"()0123456789,- ".contains(c));
    cell[..end.unwrap_or(cell.len())]
        .trim()
        .trim_end_matches(',')
}

#[test]
fn paper_tables_name_every_equation_table_and_figure() {
    for (paper, counts) in papers() {
        let rows = rows_of(paper);
        let mut found = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
        for [cell, ..] in &rows {
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

fn commands(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let paths = entries.map(|e| e.unwrap().path());
    paths
        .flat_map(|p| if p.is_dir() { files(&p) } else { vec![p] })
        .collect()
}

/// Whether a crate has a test with this prefix, or a test module of this name.
fn has_test(package: &str, name: &str) -> bool {
    let folder = repository().join("crates").join(package).join("tests");
    let mut files = files(&folder).into_iter();
    match name.strip_suffix("::") {
        Some(module) => files.any(|f| f.file_stem().is_some_and(|s| s == module)),
        None => files.any(|f| {
            let text = std::fs::read_to_string(f).unwrap_or_default();
            text.contains(&format!("fn {name}"))
        }),
    }
}

#[test]
fn cli_every_command_of_the_papers_tables_exists() {
    for (paper, _) in papers() {
        for [what, _, cell] in rows_of(paper) {
            let commands = commands(&cell);
            assert!(!commands.is_empty(), "{paper}, {what}: no command");
            for command in commands {
                let words: Vec<&str> = command.split_whitespace().collect();
                match words.as_slice() {
                    ["poinsot", "study", of, name] => {
                        assert!(paper == *of && study(of, name).is_some(), "{command}");
                    }
                    ["poinsot", ..] => {
                        let parsed = Arguments::command().try_get_matches_from(&words);
                        assert!(parsed.is_ok(), "{command}: {}", parsed.unwrap_err());
                        for path in words.iter().filter(|w| w.starts_with("data/")) {
                            assert!(repository().join(path).exists(), "{command}: {path}");
                        }
                    }
                    ["cargo", "test", "-p", package, test] => {
                        assert!(has_test(package, test), "{command}");
                        let nightly = format!("package({package})");
                        assert!(NIGHTLY.contains(&nightly), "{command}: not run each night");
                    }
                    _ => panic!("{paper}, {what}: '{command}' is no command of a known kind"),
                }
            }
        }
    }
}

fn study(paper: &str, name: &str) -> Option<&'static Study> {
    studies()
        .find(|s| s.0 == paper && s.1.name == name)
        .map(|s| s.1)
}

/// Text and numbers of a cell, each number with one unit of its last digit.
fn parts(cell: &str) -> (String, Vec<(f64, f64)>) {
    let (mut words, mut numbers) = (String::new(), Vec::new());
    let bytes = cell.as_bytes();
    let digit = |k: usize| bytes.get(k).is_some_and(u8::is_ascii_digit);
    let mut k = 0;
    while k < bytes.len() {
        let before = k.checked_sub(1).map(|b| bytes[b]);
        let sign = bytes[k] == b'-' && digit(k + 1) && before.is_none_or(|b| b" ,(".contains(&b));
        if !sign && !digit(k) {
            words.push(char::from(bytes[k]));
            k += 1;
            continue;
        }
        let start = k;
        k += usize::from(sign);
        while digit(k) {
            k += 1;
        }
        let mut decimals = 0;
        if bytes.get(k) == Some(&b'.') && digit(k + 1) {
            k += 1;
            while digit(k) {
                k += 1;
                decimals += 1;
            }
        }
        let mut exponent = 0;
        if bytes.get(k) == Some(&b'e') && (digit(k + 1) || digit(k + 2)) {
            let from = k + 1;
            k += 2;
            while digit(k) {
                k += 1;
            }
            exponent = cell[from..k].parse().unwrap();
        }
        numbers.push((
            cell[start..k].parse().unwrap(),
            10.0_f64.powi(exponent - decimals),
        ));
        words.push('#');
    }
    (words, numbers)
}

/// Smaller numbers are round-off and depend on the machine.
const ROUND_OFF: f64 = 1.0e-7;
/// Allowed ratio of the round-off of two machines.
const MACHINES: f64 = 100.0;

/// Whether a cell of a page agrees with a study: equal words, and numbers equal within one unit of the last digit.
fn agrees(page: &str, said: &str) -> bool {
    let ((words, ours), (other_words, theirs)) = (parts(page), parts(said));
    let near = |(a, b): (&(f64, f64), &(f64, f64))| {
        let small = a.0.abs() < ROUND_OFF && b.0.abs() < ROUND_OFF;
        (a.0 - b.0).abs() <= 1.001 * a.1 || small && b.0.abs() <= MACHINES * a.0.abs().max(1.0e-14)
    };
    words == other_words && ours.len() == theirs.len() && ours.iter().zip(&theirs).all(near)
}

#[test]
fn unit_cells_agree_by_words_and_digits() {
    assert!(agrees("1.7, 3.3 %", "1.7, 3.4 %"));
    assert!(!agrees("1.7, 3.3 %", "1.7, 3.5 %"));
    assert!(!agrees("1.7 %", "1.7 kg"));
    assert!(!agrees("1.7", "-"));
    assert!(agrees("-0.0019", "-0.0018") && !agrees("-0.0019", "0.0019"));
    assert!(agrees("2e-14", "5e-16") && !agrees("2e-14", "3e-5"));
    assert!(agrees("401.5 +- 7.7", "401.5 +- 7.6") && !agrees("1 of 6", "3 of 6"));
}

/// Position of the table below a mark.
fn below(text: &str, mark: &str) -> Option<std::ops::Range<usize>> {
    let start = text.find(mark)? + mark.len() + 1;
    let lines = text[start..].lines().take_while(|l| l.starts_with('|'));
    Some(start..start + lines.map(|l| l.len() + 1).sum::<usize>())
}

/// Markdown of a table, as on the page.
fn markdown(table: &FoundTable) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head = line(&table.head).replace("|  |", "| |");
    let rows = table.rows.iter();
    let rows = rows.map(|row| line(&row.iter().map(Cell::text).collect::<Vec<_>>()));
    let rule = format!("|{}\n", "---|".repeat(table.head.len()));
    head + &rule + &rows.collect::<String>()
}

/// Compares the tables of a page with the findings of a study, or rewrites them. Returns the differences.
fn compared(text: &mut String, name: &str, findings: &Findings, bless: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    for table in &findings.tables {
        let mark = format!("<!-- study {name}.{} -->", table.name);
        let Some(range) = below(text, &mark) else {
            continue;
        };
        let said = markdown(table);
        if bless {
            text.replace_range(range, &said);
            continue;
        }
        let ours: Vec<&str> = text[range].lines().collect();
        let theirs: Vec<&str> = said.lines().collect();
        if ours.len() != theirs.len() {
            wrong.push(format!("{mark}: {} rows, not {}", theirs.len(), ours.len()));
        }
        for (page, said) in ours.iter().zip(&theirs) {
            let (page, said) = (cells(page), cells(said));
            let same =
                page.len() == said.len() && page.iter().zip(&said).all(|(a, b)| agrees(a, b));
            if !same {
                wrong.push(format!("{mark}:\n  page {page:?}\n  now  {said:?}"));
            }
        }
    }
    wrong
}

/// Compares or rewrites the numbers of the last table.
fn statements(text: &mut String, name: &str, findings: &Findings, bless: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    let own = |command: &str| {
        command
            .split('`')
            .any(|c| c.ends_with(&format!(" {name}")) && c.starts_with("poinsot study "))
    };
    for [what, number, _] in rows(text).into_iter().filter(|r| own(&r[2])) {
        let said = findings.statements.iter().find(|s| s.0 == what);
        match said {
            None => wrong.push(format!("{name} says no number for '{what}'")),
            Some((_, said)) if bless => {
                let line = text
                    .lines()
                    .find(|l| l.starts_with(&format!("| {what} |")))
                    .unwrap();
                let anew = line.replace(&format!("| {number} |"), &format!("| {said} |"));
                *text = text.replace(&line.to_owned(), &anew);
            }
            Some((_, said)) if !agrees(&number, said) => {
                wrong.push(format!("'{what}':\n  page {number}\n  now  {said}"));
            }
            Some(_) => {}
        }
    }
    let listed = rows(text);
    for (what, _) in &findings.statements {
        if !listed.iter().any(|r| r[0] == *what && own(&r[2])) {
            wrong.push(format!(
                "no row '{what}' with the command `poinsot study ... {name}`"
            ));
        }
    }
    wrong
}

/// Every page agrees with the present findings of its quick or slow studies.
fn pages_are_what_studies_say(quick: bool) {
    let bless = std::env::var_os("POINSOT_BLESS").is_some();
    let only = std::env::var("POINSOT_STUDY").ok();
    let mut wrong = Vec::new();
    for (paper, study) in studies().filter(|s| s.1.quick == quick) {
        if only.as_ref().is_some_and(|o| o != study.name) {
            continue;
        }
        let findings = run(study, &repository().join("data")).unwrap();
        assert!(!findings.tables.is_empty(), "{paper} {}", study.name);
        let mut tables = std::fs::read_to_string(page_of_tables(paper)).unwrap();
        wrong.extend(compared(&mut tables, study.name, &findings, bless));
        let mut text = std::fs::read_to_string(page(paper)).unwrap();
        wrong.extend(compared(&mut text, study.name, &findings, bless));
        wrong.extend(statements(&mut text, study.name, &findings, bless));
        if bless {
            std::fs::write(page_of_tables(paper), &tables).unwrap();
            std::fs::write(page(paper), &text).unwrap();
        }
        for figure in &findings.figures {
            let name = format!("{paper}/{}.svg", figure.name);
            if !text.contains(&name) {
                continue;
            }
            let path = repository().join("docs/methods").join(&name);
            let drawn = figure.svg().unwrap().unwrap();
            if bless {
                std::fs::write(path, drawn).unwrap();
            } else if std::fs::read_to_string(path).unwrap_or_default() != drawn {
                wrong.push(format!("docs/methods/{name} is not what the study draws"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn paper_pages_have_what_the_quick_studies_say() {
    pages_are_what_studies_say(true);
}

#[test]
#[ignore = "minutes of processor time: nightly"]
fn paper_pages_have_what_the_slow_studies_say() {
    pages_are_what_studies_say(false);
}

/// Every mark of a paper's two pages names a table of an existing study; every table is below exactly one mark.
#[test]
fn paper_marks_of_the_pages_name_studies() {
    for (paper, _) in papers() {
        let pages = [page(paper), page_of_tables(paper)];
        let text = pages.map(|p| std::fs::read_to_string(p).unwrap()).concat();
        let mut seen = BTreeSet::new();
        for mark in text.split("<!-- study ").skip(1) {
            let name = mark.split(" -->").next().unwrap();
            let (of, _) = name.split_once('.').unwrap();
            assert!(study(paper, of).is_some(), "{paper}: {name}");
            assert!(seen.insert(name.to_owned()), "{paper}: {name} twice");
            let range = below(&text, &format!("<!-- study {name} -->")).unwrap();
            assert!(!range.is_empty(), "{paper}: no table below {name}");
        }
        assert!(!seen.is_empty(), "{paper}");
    }
}

/// The `poinsot` commands of the tables succeed; exit code 1 is allowed if not all numbers are determined.
#[test]
fn cli_poinsot_commands_of_the_papers_tables_answer() {
    let mut done = BTreeSet::new();
    for (paper, _) in papers() {
        for [_, _, cell] in rows_of(paper) {
            for command in commands(&cell)
                .into_iter()
                .filter(|c| c.starts_with("poinsot ") && !c.starts_with("poinsot study "))
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
