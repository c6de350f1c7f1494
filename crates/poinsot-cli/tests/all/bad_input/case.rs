//! A case file of `validation/bad_input/`; `validation/bad_input/README.md` describes the keys.

use crate::bad_input::bench::{Bench, Problem};
use crate::bad_input::cells::{Cells, Rows};
use crate::bad_input::changes::{Append, Bytes, Copy, Prepare, Remove, Replace, Write};
use crate::bad_input::code::Code;
use crate::bad_input::faults::{Fill, filled, folder, names};
use serde::Deserialize;
use std::path::PathBuf;
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
        filled(run.iter().chain(&self.more), &self.fill)
    }
}

/// Applies `shared/setup/NAME.toml`.
pub fn set_up(bench: &Bench, name: &str) -> Result<(), Problem> {
    let path = folder().join("shared/setup").join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    Case::parse(&text)?.spoil(bench)
}

/// A case file: name without extension, path, text, content.
pub struct File {
    pub stem: String,
    pub path: PathBuf,
    pub text: String,
    pub case: Case,
}

/// All cases of a section.
pub fn of_section(section: &str) -> Vec<File> {
    let all = names(section).unwrap().into_iter();
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
