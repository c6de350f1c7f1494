//! Compares what the program prints with the case files, and the pages with them.

use crate::bad_input::bench::Problem;
use crate::bad_input::case::{File, SECTIONS, folder, of_section};
use crate::bad_input::{advice, check, document, library};
use std::collections::BTreeMap;
use std::path::PathBuf;

pub fn wanted() -> bool {
    std::env::var_os("POINSOT_BLESS").is_some()
}

/// Runs a case; compares its `printed`, or writes it anew. Returns what is wrong.
pub fn check(file: &File) -> Vec<String> {
    let (mut wrong, lines) = match check::check(&file.case) {
        Ok(done) => done,
        Err(problem) => return vec![problem],
    };
    if wrong.is_empty() && wanted() {
        alone(|| std::fs::write(&file.path, blessed(file, &lines)).unwrap());
    } else if wrong.is_empty() {
        wrong.extend(difference(file, &lines));
    }
    wrong
}

/// Numbers of an answer may change with the estimator; those of an error may not.
fn difference(file: &File, lines: &[String]) -> Option<String> {
    let committed = match &file.case.printed {
        Some(printed) => printed.get_ref().as_slice(),
        None => &[],
    };
    let exact = file.case.exit >= Some(2);
    let plain = |lines: &[String]| lines.iter().map(|l| plain(l)).collect::<Vec<_>>();
    let same = committed == lines || (!exact && plain(committed) == plain(lines));
    let (old, new) = (committed.join("\n- "), lines.join("\n+ "));
    let how = format!("POINSOT_CASE={} POINSOT_BLESS=1 writes it anew", file.stem);
    (!same).then(|| format!("prints something else; {how}\n- {old}\n+ {new}"))
}

/// The text of the case file with these lines.
fn blessed(file: &File, lines: &[String]) -> String {
    let value = |l: &String| format!("    {},\n", toml::Value::String(l.clone()));
    let list = format!("[\n{}]", lines.iter().map(value).collect::<String>());
    let mut text = file.text.clone();
    match &file.case.printed {
        Some(printed) => text.replace_range(printed.span(), &list),
        None => {
            let before_changes = text.find("\n[[").unwrap_or(text.len());
            text.insert_str(before_changes, &format!("printed = {list}\n"));
        }
    }
    text
}

/// Text without numbers.
fn plain(line: &str) -> String {
    let mut out = String::new();
    let mut number = false;
    for c in line.chars() {
        let part = c.is_ascii_digit() || (number && matches!(c, '.' | 'e' | '-' | '+'));
        if part && !number {
            out.push('#');
        }
        if !part {
            out.push(c);
        }
        number = part;
    }
    out.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Does something while no test of another process writes case files or pages.
fn alone<T>(what: impl FnOnce() -> T) -> T {
    let lock = std::fs::File::open(folder()).unwrap();
    lock.lock().unwrap();
    what()
}

/// Writes both pages from the case files.
pub fn pages() {
    alone(|| {
        for (path, text) in made() {
            std::fs::write(path, text).unwrap();
        }
    });
}

/// Paths and texts of both pages.
fn made() -> [(PathBuf, String); 2] {
    let repository = folder().join("../..");
    let sections = SECTIONS.map(|(section, title)| (title, of_section(section)));
    let messages = messages(&sections);
    let codes = poinsot::explain::error_codes();
    let bad_input = document::bad_input(&sections).unwrap();
    let errors = document::errors(&codes, &messages);
    [
        (repository.join("docs/validation/bad_input.md"), bad_input),
        (repository.join("docs/reference/errors.md"), errors),
    ]
}

/// The first complete message of each code, or the reason why no input causes it.
fn messages(sections: &[(&str, Vec<File>)]) -> BTreeMap<String, (String, Option<&'static str>)> {
    let mut all = BTreeMap::new();
    let files = sections.iter().flat_map(|s| &s.1);
    let mut failing: Vec<_> = files.filter(|f| f.case.exit >= Some(2)).collect();
    failing.sort_by_key(|f| !f.case.example);
    for line in failing
        .iter()
        .filter_map(|f| f.case.printed.as_ref())
        .flat_map(|p| p.get_ref())
    {
        if let Some(code) = line.get(..5).filter(|c| c.starts_with('E')) {
            all.entry(code.to_owned()).or_insert((line.clone(), None));
        }
    }
    for (code, message, why) in library::messages() {
        let advised = message.is_empty() || advice::says_what_to_do(&message);
        assert!(advised, "no advice: {message}");
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

#[test]
fn exact_the_pages_are_made_of_the_case_files() {
    if wanted() {
        return pages();
    }
    for (path, text) in made() {
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        let mut lines = committed.lines().zip(text.lines());
        let other = lines.find(|(old, new)| old != new);
        let name = path.display();
        assert!(
            committed == text,
            "{name} differs from validation/bad_input/; POINSOT_BLESS=1 writes it anew: {other:?}"
        );
    }
}

#[test]
fn exact_every_code_has_an_example() {
    let sections = SECTIONS.map(|(section, title)| (title, of_section(section)));
    let messages = messages(&sections);
    let codes = poinsot::explain::error_codes();
    let without = codes
        .iter()
        .map(|c| c.code)
        .filter(|c| !messages.contains_key(*c));
    let without: Vec<&str> = without.collect();
    assert!(without.is_empty() || wanted(), "no case prints {without:?}");
}

#[test]
fn unit_what_is_printed_replaces_the_list_of_a_case() {
    let text = "id = \"T1\"\nfault = \"x\"\nexit = 2\n\n[[remove]]\nfile = \"t.csv\"\n";
    let with = |text: &str| -> Result<File, Problem> {
        Ok(File {
            stem: String::new(),
            path: PathBuf::new(),
            text: text.to_owned(),
            case: crate::bad_input::case::Case::parse(text)?,
        })
    };
    let first = blessed(&with(text).unwrap(), &["a".to_owned()]);
    assert!(first.contains("exit = 2\nprinted = [\n    \"a\",\n]\n\n[[remove]]"));
    let again = blessed(&with(&first).unwrap(), &["b".to_owned()]);
    assert_eq!(again, first.replace("\"a\"", "\"b\""));
}
