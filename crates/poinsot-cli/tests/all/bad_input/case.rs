//! A case file of `validation/bad_input/`; `validation/bad_input/README.md` describes the keys.

use crate::bad_input::bench::{Bench, Problem};
use crate::bad_input::cells::{Cells, Rows};
use crate::bad_input::changes::{Append, Bytes, Copy, Fill, Prepare, Remove, Replace, Write, fill};
use crate::bad_input::code::Code;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// The default command.
pub const IDENTIFY: &[&str] = &[
    "identify",
    "--model",
    "m.toml",
    "--telemetry",
    "t.csv",
    "--out",
    "out",
];

/// A section of the page: folder, heading.
pub const SECTIONS: [(&str, &str); 6] = [
    ("telemetry", "Telemetry (2a)"),
    ("results", "Results (2b)"),
    ("files", "Files (2c)"),
    ("models", "Models (2d)"),
    ("security", "Security (2e)"),
    ("codes", "Codes that the list does not reach"),
];

/// A fault and the expected reaction, or shared changes (`shared/setup/`).
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Case {
    /// Number in the list of faults, or the code.
    pub id: String,
    pub fault: String,
    /// The command.
    pub run: Option<Vec<String>>,
    /// Further arguments.
    pub more: Vec<String>,
    /// Long texts of the command.
    fill: Vec<Fill>,
    pub exit: Option<i32>,
    /// Texts that must be in the output.
    pub says: Vec<String>,
    /// Texts that must not be in the output.
    pub never: Vec<String>,
    /// Whether `docs/reference/errors.md` shows this message rather than the first one of the code.
    pub example: bool,
    /// What the page shows.
    pub printed: Option<Spanned<Vec<String>>>,
    /// A file of `shared/setup/` whose changes come first.
    setup: Option<String>,
    write: Vec<Spanned<Write>>,
    append: Vec<Spanned<Append>>,
    replace: Vec<Spanned<Replace>>,
    copy: Vec<Spanned<Copy>>,
    remove: Vec<Spanned<Remove>>,
    bytes: Vec<Spanned<Bytes>>,
    cells: Vec<Spanned<Cells>>,
    rows: Vec<Spanned<Rows>>,
    prepare: Vec<Spanned<Prepare>>,
    code: Vec<Spanned<Code>>,
}

/// One change of the folder in which a case runs.
pub trait Change {
    fn apply(&self, bench: &Bench) -> Result<(), Problem>;
}

impl Case {
    pub fn parse(text: &str) -> Result<Self, Problem> {
        toml::from_str(text).map_err(|e| e.to_string())
    }

    /// The changes in the order of the file.
    fn changes(&self) -> Vec<&dyn Change> {
        fn list<T: Change>(of: &[Spanned<T>]) -> impl Iterator<Item = (usize, &dyn Change)> {
            of.iter()
                .map(|c| (c.span().start, c.get_ref() as &dyn Change))
        }
        let mut all: Vec<_> = list(&self.write)
            .chain(list(&self.append))
            .chain(list(&self.replace))
            .chain(list(&self.copy))
            .chain(list(&self.remove))
            .chain(list(&self.bytes))
            .chain(list(&self.cells))
            .chain(list(&self.rows))
            .chain(list(&self.prepare))
            .chain(list(&self.code))
            .collect();
        all.sort_by_key(|(at, _)| *at);
        all.into_iter().map(|(_, change)| change).collect()
    }

    /// Brings the fault into the folder.
    pub fn spoil(&self, bench: &Bench) -> Result<(), Problem> {
        if let Some(name) = &self.setup {
            set_up(bench, name)?;
        }
        self.changes().into_iter().try_for_each(|c| c.apply(bench))
    }

    /// All arguments of the command.
    pub fn arguments(&self) -> Result<Vec<String>, Problem> {
        let run = self.run.clone();
        let run = run.unwrap_or_else(|| IDENTIFY.iter().map(|a| (*a).to_owned()).collect());
        self.filled(run.iter().chain(&self.more))
    }

    /// What the page shows of the command: the further arguments of the default command, or all.
    pub fn shown(&self) -> Result<String, Problem> {
        let run = self.run.iter().flatten();
        Ok(self.filled(run.chain(&self.more))?.join(" "))
    }

    fn filled<'a>(&self, all: impl Iterator<Item = &'a String>) -> Result<Vec<String>, Problem> {
        let all: Vec<String> = all.cloned().collect();
        let joined = fill(&all.join("\n"), &self.fill)?;
        Ok(joined.split('\n').map(str::to_owned).collect())
    }
}

/// Applies `shared/setup/NAME.toml`.
pub fn set_up(bench: &Bench, name: &str) -> Result<(), Problem> {
    let path = folder().join("shared/setup").join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    Case::parse(&text)?.spoil(bench)
}

/// `validation/bad_input`.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/bad_input")
}

/// A case file: name without extension, path, text, content.
pub struct File {
    pub stem: String,
    pub path: PathBuf,
    pub text: String,
    pub case: Case,
}

/// The case files of a section, in the order of the page: names without extension, paths.
pub fn names(section: &str) -> Vec<(String, PathBuf)> {
    let entries = std::fs::read_dir(folder().join(section)).unwrap();
    let paths = entries.map(|e| e.unwrap().path());
    let stem = |path: &PathBuf| path.file_stem().unwrap().to_str().unwrap().to_owned();
    let mut all: Vec<_> = paths.map(|p| (stem(&p), p)).collect();
    all.sort_by_key(|(stem, _)| natural(stem));
    all
}

/// All cases of a section.
pub fn of_section(section: &str) -> Vec<File> {
    let all = names(section).into_iter();
    all.map(|(stem, path)| file(stem, path)).collect()
}

/// Reads a case file.
pub fn file(stem: String, path: PathBuf) -> File {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(&path).unwrap();
    let case = Case::parse(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(name.ends_with(".toml"), "{name}: not a .toml file");
    assert!(
        stem.starts_with(&format!("{}_", case.id)),
        "{name}: the name must begin with the id {:?} and '_'",
        case.id
    );
    assert!(!case.fault.is_empty(), "{name}: no fault");
    assert!(case.exit.is_some(), "{name}: no exit");
    File {
        stem,
        path,
        text,
        case,
    }
}

/// A key that sorts T2 before T10: texts, and the numbers behind them.
fn natural(name: &str) -> Vec<(String, Option<u64>)> {
    let mut key: Vec<(String, Option<u64>)> = vec![(String::new(), None)];
    for c in name.chars() {
        let (text, number) = key.last_mut().unwrap();
        match (c.to_digit(10), &number) {
            (Some(d), n) => {
                *number = Some(n.unwrap_or(0).saturating_mul(10).saturating_add(d.into()))
            }
            (None, None) => text.extend(c.to_lowercase()),
            (None, Some(_)) => key.push((c.to_lowercase().collect(), None)),
        }
    }
    key
}

#[test]
fn unit_names_sort_by_their_numbers() {
    let mut names = ["T10_a", "T2_b", "kim2010_x", "T2_a", "E0001_a", "T0_z"];
    names.sort_by_key(|n| natural(n));
    assert_eq!(
        names,
        ["E0001_a", "kim2010_x", "T0_z", "T2_a", "T2_b", "T10_a"]
    );
}
