//! proselint and codespell on the prose alone.

use super::Pages;
use super::prose::Prose;
use crate::fault::Fault;
use crate::repository::{captured, pattern, root, succeed, write};
use crate::rust_text::one_line;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Versions are fixed, so that a new one finds no fault in old pages.
const PACKAGES: [&str; 2] = ["proselint==0.16.0", "codespell==2.4.1"];
/// Checks of proselint that judge typography of print (quotes, dashes, signs) have no use in Markdown. "skunked_terms" and
/// "uncomparables" refuse terms of the field such as "unique minimum".
const PROSELINT_OFF: [&str; 6] = [
    "typography",
    "skunked_terms",
    "uncomparables",
    "restricted",
    "dates_times",
    "annotations",
];
/// Terms of the field that proselint takes for other words: a revolute joint, the body B4.
const PROSELINT_TERMS: [&str; 2] = ["'revolt'", "'B4'"];
/// Names and symbols that a spell checker takes for faults.
const CODESPELL_IGNORE: &str = "nees,mis,te,ans,fo,ist,als,pris";
/// Letters of a repeated sign, such as a symbol of a formula.
const LONGEST_SIGN: usize = 2;

/// Faults of style and spelling.
pub fn check(pages: &Pages, prose: &Prose) -> Result<Vec<String>, Fault> {
    let programs = programs()?;
    let folder = root().join("target/pages");
    let mut files = BTreeMap::new();
    let mut paths = Vec::new();
    for (name, text) in pages {
        let file = name.replace('/', "_");
        write(&folder.join(&file), prose.of(text, true))?;
        paths.push(folder.join(&file));
        files.insert(file, name.as_str());
    }
    let said = captured(
        Command::new(programs.join("proselint"))
            .arg("check")
            .args(&paths),
    )?;
    let mut faults = style(&String::from_utf8_lossy(&said.stdout), &files)?;
    let ignored = ["--ignore-words-list", CODESPELL_IGNORE];
    let said = captured(
        Command::new(programs.join("codespell"))
            .args(ignored)
            .args(&paths),
    )?;
    faults.extend(spelling(&String::from_utf8_lossy(&said.stdout), &files));
    Ok(faults)
}

/// Folder of proselint and codespell, installed once.
fn programs() -> Result<PathBuf, Fault> {
    let folder = root().join("target/pages-venv");
    let done = folder.join("installed.json");
    let installed = std::fs::read_to_string(&done).ok();
    let installed: Option<Vec<String>> =
        installed.and_then(|text| serde_json::from_str(&text).ok());
    if installed.is_none_or(|packages| packages != PACKAGES) {
        succeed(
            Command::new("python3")
                .args(["-m", "venv", "--clear"])
                .arg(&folder),
        )?;
        succeed(
            Command::new(folder.join("bin/pip"))
                .args(["install", "--quiet"])
                .args(PACKAGES),
        )?;
        write(&done, serde_json::json!(PACKAGES).to_string())?;
    }
    Ok(folder.join("bin"))
}

fn page<'a>(path: &'a str, files: &BTreeMap<String, &'a str>) -> &'a str {
    let name = Path::new(path)
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    files.get(name.as_ref()).copied().unwrap_or(path)
}

/// Findings of proselint. One may go over several lines: its text quotes the page.
fn style(said: &str, files: &BTreeMap<String, &str>) -> Result<Vec<String>, Fault> {
    let start = pattern(r"(?m)^\S+\.md:\d+")?;
    let finding = pattern(r"(?s)^(\S+/[^/\s]+\.md):\d+:\d+: ([\w.]+): (.*)$")?;
    let mut places: Vec<_> = start.find_iter(said).map(|place| place.start()).collect();
    places.push(said.len());
    let mut faults = Vec::new();
    for place in places.windows(2) {
        let Some(found) = finding.captures(&said[place[0]..place[1]]) else {
            continue;
        };
        let [_, check, quoted] = found.extract::<3>().1;
        let words = one_line(quoted);
        let repeated = check == "lexical_illusions"
            && (quoted.trim().contains('\n') || repeats_a_sign(&words));
        let off = PROSELINT_OFF.iter().any(|off| check.starts_with(off));
        let term = PROSELINT_TERMS.iter().any(|term| words.contains(term));
        if !repeated && !off && !term {
            faults.push(format!("{}: {check}: {words}", page(&found[1], files)));
        }
    }
    Ok(faults)
}

/// Whether the words hold a quotation of one sign several times, such as 'x x'.
fn repeats_a_sign(words: &str) -> bool {
    let quotations = words
        .match_indices('\'')
        .map(|(at, quote)| &words[at + quote.len()..]);
    let ends = |rest: &str| (1..=LONGEST_SIGN).any(|letters| repeats(rest, letters));
    quotations.into_iter().any(ends)
}

/// Whether a text begins with a sign of so many letters, repeated until a quote.
fn repeats(rest: &str, letters: usize) -> bool {
    let sign: String = rest.chars().take(letters).collect();
    if sign.chars().count() < letters || sign.contains(char::is_whitespace) {
        return false;
    }
    let again = format!(" {sign}");
    let after = rest[sign.len()..].trim_start_matches(&again);
    after.len() < rest.len() - sign.len() && after.starts_with('\'')
}

fn spelling(said: &str, files: &BTreeMap<String, &str>) -> Vec<String> {
    let lines = said
        .lines()
        .map(|line| line.split_once(": ").unwrap_or((line, "")));
    let path = |place: &str| {
        place
            .rsplit_once(':')
            .map_or(place.to_owned(), |(path, _)| path.to_owned())
    };
    lines
        .map(|(place, words)| format!("{}: spelling: {words}", page(&path(place), files)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_findings_of_proselint_are_read() {
        let files = BTreeMap::from([("docs_a.md".to_owned(), "docs/a.md")]);
        let said = "/t/docs_a.md:1:2: cliches.misc: 'at the\nend' is a cliche\n/t/docs_a.md:3:1: typography.x: no\n\
                    /t/docs_a.md:4:1: lexical_illusions: 'x x' is repeated\n/t/docs_a.md:5:1: lexical_illusions: 'the the' is repeated\n";
        let expected = [
            "docs/a.md: cliches.misc: 'at the end' is a cliche",
            "docs/a.md: lexical_illusions: 'the the' is repeated",
        ];
        assert_eq!(style(said, &files).unwrap(), expected);
    }

    #[test]
    fn unit_findings_of_codespell_are_read() {
        let files = BTreeMap::from([("docs_a.md".to_owned(), "docs/a.md")]);
        assert_eq!(
            spelling("/t/docs_a.md:7: teh ==> the\n", &files),
            ["docs/a.md: spelling: teh ==> the"]
        );
    }
}
