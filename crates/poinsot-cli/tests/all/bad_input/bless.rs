//! Compares what the program prints with the case files.

use crate::bad_input::bench::Problem;
use crate::bad_input::case::File;
use crate::bad_input::check;

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
        std::fs::write(&file.path, blessed(file, &lines)).unwrap();
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

#[test]
fn unit_what_is_printed_replaces_the_list_of_a_case() {
    let text = "id = \"T1\"\nfault = \"x\"\nexit = 2\n\n[[remove]]\nfile = \"t.csv\"\n";
    let with = |text: &str| -> Result<File, Problem> {
        Ok(File {
            stem: String::new(),
            path: std::path::PathBuf::new(),
            text: text.to_owned(),
            case: crate::bad_input::case::Case::parse(text)?,
        })
    };
    let first = blessed(&with(text).unwrap(), &["a".to_owned()]);
    assert!(first.contains("exit = 2\nprinted = [\n    \"a\",\n]\n\n[[remove]]"));
    let again = blessed(&with(&first).unwrap(), &["b".to_owned()]);
    assert_eq!(again, first.replace("\"a\"", "\"b\""));
}
