//! Runs the commands that pages quote, and fills in what they print.

use crate::fault::Fault;
use crate::repository::{
    build_programs, captured, code, files_below, name_of, pattern, read, root, write,
};
use regex::{Captures, Regex};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;

const SENTENCES: &str = "docs/reference/output_lines.txt";
/// Folders with pages, beside README.md.
const FOLDERS: [&str; 2] = ["docs", "examples"];
const BLOCK: &str = concat!(
    r"(?s)<!-- output of: (?P<command>.+?) -->\n```text\n(?P<output>.*?)```\n",
    r"|<!-- run: (?P<run>.+?) -->\n```console\n(?P<console>.*?)```\n",
    r"|<!-- lines of: (?P<explained>.+?) -->\n(?P<sentences>.*?)<!-- end of lines -->\n",
);
/// Characters of a line of a command; a longer one does not fit a page of the book.
const LONGEST: usize = 110;
/// The program ends with 1 where the data determine a part only; above it, it has failed.
const PARTLY: u8 = 1;

/// Fills the blocks of all pages.
pub fn run(check: bool, poinsot: Option<PathBuf>) -> Result<(), Fault> {
    let mut filler = Filler::new(&program(poinsot)?)?;
    let mut stale = Vec::new();
    for page in pages()? {
        let text = read(&page)?;
        if !filler.block.is_match(&text) {
            continue;
        }
        let filled = filler.fill(&text)?;
        println!(
            "{}: {} outputs, {} changed",
            name_of(&page),
            filled.blocks,
            filled.stale.len()
        );
        stale.extend(filled.stale);
        if !check {
            write(&page, filled.text)?;
        }
    }
    if check && !stale.is_empty() {
        return Err(Fault::Failed(format!(
            "out of date, run scripts/outputs:\n  {}",
            stale.join("\n  ")
        )));
    }
    Ok(())
}

/// Absolute path of the program: the one that is given, or target/release/poinsot, built first.
fn program(given: Option<PathBuf>) -> Result<PathBuf, Fault> {
    let path = match given {
        Some(path) => path,
        None => {
            build_programs()?;
            root().join("target/release/poinsot")
        }
    };
    path.canonicalize()
        .map_err(|why| Fault::Use(format!("--poinsot {}: {why}", path.display())))
}

fn pages() -> Result<Vec<PathBuf>, Fault> {
    let mut found = vec![root().join("README.md")];
    for folder in FOLDERS {
        let files = files_below(&root().join(folder))?;
        found.extend(
            files
                .into_iter()
                .filter(|path| path.extension().is_some_and(|end| end == "md")),
        );
    }
    Ok(found)
}

struct Filled {
    text: String,
    blocks: usize,
    /// Commands whose output has changed.
    stale: Vec<String>,
}

struct Filler {
    program: String,
    block: Regex,
    option: Regex,
    rules: Vec<(Regex, String)>,
    known: HashMap<String, String>,
}

impl Filler {
    fn new(program: &Path) -> Result<Self, Fault> {
        Ok(Self {
            program: program.display().to_string(),
            block: pattern(BLOCK)?,
            option: pattern(r" (--[a-z])")?,
            rules: rules(&read(&root().join(SENTENCES))?)?,
            known: HashMap::new(),
        })
    }

    fn fill(&mut self, text: &str) -> Result<Filled, Fault> {
        let mut filled = Filled {
            text: String::new(),
            blocks: 0,
            stale: Vec::new(),
        };
        let mut end = 0;
        for block in self.block.clone().captures_iter(text) {
            let Some(place) = block.get(0) else { continue };
            let (command, kept, before, now, after) = self.renewed(&block)?;
            if now != kept {
                filled.stale.push(command.to_owned());
            }
            filled.text.push_str(&text[end..place.start()]);
            filled.text.push_str(&[before, &now, after].concat());
            filled.blocks += 1;
            end = place.end();
        }
        filled.text.push_str(&text[end..]);
        Ok(filled)
    }

    /// Command, contents on the page, text before, contents now, text after.
    fn renewed<'a>(
        &mut self,
        block: &Captures<'a>,
    ) -> Result<(&'a str, &'a str, &'a str, String, &'a str), Fault> {
        let part = |name| block.name(name).map(|part| part.as_str());
        let all = block.get(0).map_or("", |all| all.as_str());
        let (command, kept, now) =
            if let (Some(command), Some(kept)) = (part("command"), part("output")) {
                (command, kept, self.output(command)?)
            } else if let (Some(command), Some(kept)) = (part("run"), part("console")) {
                (command, kept, self.shown(command) + &self.output(command)?)
            } else {
                let (command, kept) = (
                    part("explained").unwrap_or_default(),
                    part("sentences").unwrap_or_default(),
                );
                let printed = self.output(command)?;
                (command, kept, explained(&self.rules, &printed)?)
            };
        // The contents are the last part but for the closing line.
        let closing = if part("explained").is_some() {
            "<!-- end of lines -->\n"
        } else {
            "```\n"
        };
        let before = &all[..all.len() - closing.len() - kept.len()];
        Ok((
            command,
            kept,
            before,
            now,
            &all[all.len() - closing.len()..],
        ))
    }

    /// Standard output of a command, run once; trailing blanks and blank lines at the end are dropped.
    fn output(&mut self, command: &str) -> Result<String, Fault> {
        if let Some(known) = self.known.get(command) {
            return Ok(known.clone());
        }
        let script = format!("poinsot() {{ {} \"$@\"; }}\n{command}", self.program);
        let done = captured(
            Command::new("bash")
                .args(["-c", &script])
                .current_dir(root()),
        )?;
        let ended = code(done.status);
        if ended > PARTLY {
            return Err(Fault::Failed(format!(
                "outputs: exit code {ended}: {command}"
            )));
        }
        let printed = String::from_utf8_lossy(&done.stdout);
        let lines: Vec<_> = printed.trim_end().lines().map(str::trim_end).collect();
        let printed = lines.join("\n") + "\n";
        self.known.insert(command.to_owned(), printed.clone());
        Ok(printed)
    }

    /// A command as a person types it, options on lines of their own where it is long.
    fn shown(&self, command: &str) -> String {
        let parts = command
            .strip_suffix(" 2>&1")
            .unwrap_or(command)
            .split(" && ");
        let lines = parts.map(|part| match part.chars().count() <= LONGEST {
            true => format!("$ {part}\n"),
            false => format!("$ {}\n", self.option.replace_all(part, " \\\n    $1")),
        });
        lines.collect()
    }
}

/// Patterns of whole lines, and their sentences.
fn rules(list: &str) -> Result<Vec<(Regex, String)>, Fault> {
    let lines = list.lines().filter(|line| !line.starts_with('#'));
    let rules = lines.filter_map(|line| line.split_once(" => "));
    rules
        .map(|(line, sentence)| Ok((pattern(&format!("^(?:{line})$"))?, sentence.to_owned())))
        .collect()
}

/// Every line of an output, those of one sentence together, then the sentence.
fn explained(rules: &[(Regex, String)], printed: &str) -> Result<String, Fault> {
    let mut groups: Vec<(Vec<&str>, &str)> = Vec::new();
    for line in printed.lines().filter(|line| !line.is_empty()) {
        let rule = rules
            .iter()
            .find(|(pattern, _)| pattern.is_match(line.trim()));
        let (_, sentence) = rule.ok_or_else(|| {
            Fault::Failed(format!(
                "outputs: no pattern of {SENTENCES} explains the line\n  {line}"
            ))
        })?;
        match groups.last_mut() {
            Some((lines, last)) if last == sentence => lines.push(line),
            _ => groups.push((vec![line], sentence)),
        }
    }
    let blocks = groups
        .iter()
        .map(|(lines, sentence)| format!("\n```text\n{}\n```\n\n{sentence}\n", lines.join("\n")));
    Ok(blocks.chain(["\n".to_owned()]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filler() -> Filler {
        Filler::new(Path::new("echo")).unwrap()
    }

    #[test]
    fn unit_blocks_are_filled_and_counted() {
        let page = "a\n<!-- output of: poinsot x -->\n```text\nold\n```\nb\n<!-- run: poinsot y 2>&1 -->\n```console\n$ poinsot y\ny\n```\nc\n";
        let filled = filler().fill(page).unwrap();
        assert_eq!(filled.text, page.replace("old", "x"));
        assert_eq!(
            (filled.blocks, filled.stale),
            (2, vec!["poinsot x".to_owned()])
        );
    }

    #[test]
    fn unit_long_commands_are_broken_before_options() {
        let long = format!("poinsot {} --one a --two", "x".repeat(LONGEST));
        let expected = format!(
            "$ poinsot {} \\\n    --one a \\\n    --two\n$ ls\n",
            "x".repeat(LONGEST)
        );
        assert_eq!(filler().shown(&format!("{long} && ls")), expected);
    }

    #[test]
    fn unit_lines_of_one_sentence_stand_together() {
        let rules = rules("# none => no\na.* => A.\nb|c => B.\n").unwrap();
        let text = explained(&rules, "a1\n  a2\n\nc\n").unwrap();
        assert_eq!(
            text,
            "\n```text\na1\n  a2\n```\n\nA.\n\n```text\nc\n```\n\nB.\n\n"
        );
        assert!(explained(&rules, "bc").is_err());
    }
}
