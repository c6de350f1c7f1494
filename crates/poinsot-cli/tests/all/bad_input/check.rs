//! Runs a case and judges what the program did.

use crate::bad_input::bench::{Bench, Done, Problem};
use crate::bad_input::case::Case;
use poinsot_files::{LONGEST_LINE, is_unprintable};

/// Runs the case. Returns what is wrong, and the lines for the page.
pub fn check(case: &Case) -> Result<(Vec<String>, Vec<String>), Problem> {
    let bench = Bench::good();
    case.spoil(&bench)?;
    let before = bench.files();
    let done = bench.run(&case.arguments()?);
    let new: Vec<String> = bench
        .files()
        .difference(&before)
        .map(|p| p.display().to_string())
        .collect();
    let mut wrong = texts(case, &done);
    wrong.extend(manners(&done, &new));
    if done.exit >= 2 {
        wrong.extend(refusal(&done, &new));
    }
    if !wrong.is_empty() {
        wrong.push(format!("printed:\n{}{}", done.stdout, done.stderr));
    }
    Ok((wrong, shown(case, &done)))
}

/// Text in one line: tables wrap as in a terminal.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Exit code and texts that the case expects.
fn texts(case: &Case, done: &Done) -> Vec<String> {
    let mut wrong = Vec::new();
    if Some(done.exit) != case.exit {
        wrong.push(format!("exit {}", done.exit));
    }
    let all = flat(&format!("{}{}", done.stdout, done.stderr));
    let missing = case.says.iter().filter(|t| !all.contains(*t));
    wrong.extend(missing.map(|t| format!("does not say '{t}'")));
    let said = case.never.iter().filter(|t| all.contains(*t));
    wrong.extend(said.map(|t| format!("says '{t}'")));
    wrong
}

/// What no run may do.
fn manners(done: &Done, new: &[String]) -> Vec<String> {
    let mut wrong = Vec::new();
    if new.iter().any(|f| f.contains(".poinsot-")) {
        wrong.push(format!("leaves a temporary file: {new:?}"));
    }
    if done.stderr.contains("panicked") || done.exit == 4 || done.exit == 101 {
        wrong.push("panics".to_owned());
    }
    if done.exit < 0 {
        wrong.push("is killed: it took more than 60 s of processor time".to_owned());
    }
    let lengths = done.stderr.lines().map(|l| l.chars().count());
    if let Some(long) = lengths.into_iter().find(|n| *n > LONGEST_LINE) {
        wrong.push(format!("a line of {long} characters"));
    }
    let all = format!("{}{}", done.stdout, done.stderr);
    if all.contains(|c: char| is_unprintable(c) && !matches!(c, '\n' | '\t')) {
        wrong.push("prints what a terminal obeys".to_owned());
    }
    wrong
}

/// What a run that fails may not do.
fn refusal(done: &Done, new: &[String]) -> Vec<String> {
    let mut wrong = Vec::new();
    if !new.is_empty() {
        wrong.push(format!("leaves {new:?}"));
    }
    if !done.stdout.is_empty() {
        wrong.push("prints an answer on standard output".to_owned());
    }
    for line in done.stderr.lines() {
        let digits = line.strip_prefix('E').and_then(|l| l.get(..4));
        let coded = digits.is_some_and(|d| d.bytes().all(|b| b.is_ascii_digit()));
        let counted = line.starts_with("and ") && line.ends_with(" more");
        if !coded && !counted && !done.stderr.starts_with("error:") {
            wrong.push(format!("a line without code: {line}"));
        }
    }
    wrong
}

/// The lines for the page: two of an error; of an answer the verdict and what the case expects.
fn shown(case: &Case, done: &Done) -> Vec<String> {
    if done.exit >= 2 {
        return done.stderr.lines().take(2).map(str::to_owned).collect();
    }
    let mut all = done.stdout.lines().chain(done.stderr.lines());
    let verdict = all.next().map(str::to_owned);
    let told = all.filter(|l| case.says.iter().any(|s| flat(l).contains(s)));
    let told = told.map(|l| l.trim().to_owned());
    verdict.into_iter().chain(told).take(4).collect()
}
