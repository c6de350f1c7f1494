//! Lists every message of the program, and checks their words and the length of their sentences.

use crate::fault::Fault;
use crate::repository::{files_below, name_of, pattern, read, root};
use crate::rust_text::Reader;
use crate::words::Words;
use regex::Regex;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// The book, the fuzzing targets, the test kit and these commands print nothing for users.
const NO_USERS: [&str; 4] = ["poinsot-book", "poinsot-fuzz", "poinsot-testkit", "xtask"];
/// Help of the command line and meanings of keys are taken from comments for documentation in these files.
const HELP: &str =
    r"^crates/(poinsot-cli/src/arguments|poinsot-model/src/file/\w+|poinsot-formats/src/\w+)\.rs$";
/// Words in a sentence: the average over all messages is below this.
const AVERAGE_SENTENCE: usize = 18;
/// No sentence reaches this number of words.
const LONGEST_SENTENCE: usize = 25;
/// Characters; longer texts are models and programs that the program writes.
const LONGEST_MESSAGE: usize = 1000;
/// Shorter texts are names and units.
const FEWEST_WORDS: usize = 3;

/// A text for a person, with its place.
struct Message {
    name: String,
    line: usize,
    text: String,
}

/// What tells messages and their sentences.
struct Rules {
    word: Regex,
    code: Regex,
    help: Regex,
    value: Regex,
    quoted: Regex,
    /// A table's columns are separated by bars, a place and its message by a colon.
    sentence_end: Regex,
    counted: Regex,
}

impl Rules {
    fn new() -> Result<Self, Fault> {
        Ok(Self {
            word: pattern(r"[A-Za-z][a-z']+")?,
            code: pattern(r"^\s*[<\[#]|</|==|\bimport \b|^[\w.]+ = ")?,
            help: pattern(HELP)?,
            value: pattern(r"\{[^{}]*\}")?,
            quoted: pattern(r"`[^`]*`")?,
            sentence_end: pattern(r"[.;:!?|](?:\s|$)|\n")?,
            counted: pattern(r"[\w{][\w'%/+.}-]*")?,
        })
    }

    fn is_message(&self, text: &str) -> bool {
        self.word.find_iter(text).count() >= FEWEST_WORDS
            && text.trim().contains(' ')
            && text.chars().count() <= LONGEST_MESSAGE
            && !self.code.is_match(text)
    }

    /// A message with "X" for each value and each quotation.
    fn plain(&self, text: &str) -> String {
        let text = self.value.replace_all(text, "X");
        self.quoted.replace_all(&text, "X").into_owned()
    }
}

/// Prints all messages, or checks them.
pub fn run(check: bool) -> Result<(), Fault> {
    let rules = Rules::new()?;
    let found = messages(&rules)?;
    if check {
        let wrong = faults(&rules, &found)?;
        return match wrong.is_empty() {
            true => Ok(()),
            false => Err(Fault::Failed(wrong.join("\n"))),
        };
    }
    let mut list = String::new();
    for Message { name, line, text } in &found {
        let _ = writeln!(list, "{name}:{line}: {}", in_quotes(text));
    }
    // A pager may close its end early.
    let _ = std::io::stdout().write_all(list.as_bytes());
    Ok(())
}

fn messages(rules: &Rules) -> Result<Vec<Message>, Fault> {
    let reader = Reader::new()?;
    let mut found = Vec::new();
    for path in files_below(&root().join("crates"))? {
        let name = name_of(&path);
        if !is_for_users(&name) {
            continue;
        }
        let texts = match path.extension().and_then(|end| end.to_str()) {
            Some("rs") => {
                let source = read(&path)?;
                let mut texts = reader.texts(&source);
                if rules.help.is_match(&name) {
                    texts.extend(reader.comments(&source));
                }
                texts
            }
            Some("html") => reader.templates(&read(&path)?),
            _ => continue,
        };
        let texts = texts.into_iter().filter(|(_, text)| rules.is_message(text));
        found.extend(texts.map(|(line, text)| Message {
            name: name.clone(),
            line,
            text,
        }));
    }
    Ok(found)
}

/// Whether a file is a source of the program, outside tests.
fn is_for_users(name: &str) -> bool {
    let Some(inside) = name.strip_prefix("crates/") else {
        return false;
    };
    let mut parts = inside.split('/');
    let (package, folder) = (parts.next().unwrap_or_default(), parts.next());
    let stem = Path::new(name)
        .file_stem()
        .is_some_and(|stem| stem.to_string_lossy().contains("tests"));
    let folders = name.rsplit('/').skip(1).take(2);
    let tests = stem || folders.into_iter().any(|folder| folder.contains("tests"));
    folder == Some("src") && !NO_USERS.contains(&package) && !tests
}

fn faults(rules: &Rules, found: &[Message]) -> Result<Vec<String>, Fault> {
    let words = Words::of_messages()?;
    let mut lengths = Vec::new();
    let mut wrong = Vec::new();
    for Message { name, line, text } in found {
        let plain = rules.plain(text);
        for (used, write) in words.found_in(&plain) {
            wrong.push(format!("{name}:{line}: '{used}'; write: {write}"));
        }
        for sentence in rules.sentence_end.split(&plain) {
            let length = rules.counted.find_iter(sentence).count();
            // One word is a label.
            if length > 1 {
                lengths.push(length);
            }
            if length >= LONGEST_SENTENCE {
                let sentence = sentence.trim();
                wrong.push(format!(
                    "{name}:{line}: {length} words in a sentence; shorten to below {LONGEST_SENTENCE}: {sentence}"
                ));
            }
        }
    }
    let mean = lengths.iter().sum::<usize>() as f64 / lengths.len().max(1) as f64;
    let longest = lengths.iter().max().copied().unwrap_or_default();
    println!(
        "{} messages, {} sentences, {mean:.1} words a sentence, longest {longest}",
        found.len(),
        lengths.len()
    );
    if mean >= AVERAGE_SENTENCE as f64 {
        wrong.push(format!(
            "{mean:.1} words a sentence; shorten to below {AVERAGE_SENTENCE}"
        ));
    }
    Ok(wrong)
}

/// A text on one line, in quotes, with signs for what is not seen.
fn in_quotes(text: &str) -> String {
    let quote = if text.contains('\'') && !text.contains('"') {
        '"'
    } else {
        '\''
    };
    let mut out = String::from(quote);
    for letter in text.chars() {
        match letter {
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            '\\' => out.push_str("\\\\"),
            _ if letter == quote => out.extend(['\\', letter]),
            _ if letter != ' ' && (letter.is_control() || letter.is_whitespace()) => {
                let _ = write!(out, "\\u{{{:x}}}", u32::from(letter));
            }
            _ => out.push(letter),
        }
    }
    out.push(quote);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_messages_are_told_from_names_and_code() {
        let rules = Rules::new().unwrap();
        assert!(rules.is_message("no such file {}"));
        assert!(!rules.is_message("two words"));
        assert!(!rules.is_message("# a line of comment"));
        assert!(!rules.is_message("mass = the value of it"));
    }

    #[test]
    fn unit_quotes_are_chosen_by_the_text() {
        assert_eq!(in_quotes("it's\n"), "\"it's\\n\"");
        assert_eq!(in_quotes("it's \"x\""), "'it\\'s \"x\"'");
    }

    #[test]
    fn unit_tests_and_tools_have_no_users() {
        assert!(is_for_users("crates/poinsot/src/verbs/identify.rs"));
        assert!(!is_for_users("crates/poinsot/src/verbs/map_tests.rs"));
        assert!(!is_for_users("crates/poinsot/src/map_tests/a.rs"));
        assert!(!is_for_users("crates/poinsot/tests/all/main.rs"));
        assert!(!is_for_users("crates/xtask/src/main.rs"));
    }
}
