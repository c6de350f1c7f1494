//! The one type of error: what is wrong, where, what was read, and what to do, as data.

use crate::{escaped, excerpt};
use std::fmt;
use std::io;
use std::path::Path;

/// Most faults that are listed; the rest is counted.
const SHOWN: usize = 20;

/// Most faults of one file that are looked for.
pub const MOST_FAULTS: usize = 200;

/// Longest file name in a message, characters.
const LONGEST_NAME: usize = 300;

/// Origin of a fault; it decides the exit code of the command.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    /// Arguments, model or telemetry.
    #[default]
    Input,
    /// Operating system: disk, permission, a limit.
    System,
    /// The program itself.
    Internal,
}

/// Where a fault is. What does not apply is zero or empty.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// File as given, or the label of a segment.
    pub file: String,
    /// Line of a text, from one, or row of a table.
    pub line: u64,
    /// Column of a text in characters, from one.
    pub column: u64,
    /// Whether `line` is a row of a table that has no lines (1 = first).
    pub is_row: bool,
    /// Column of a table, as named in the file.
    pub name: String,
    /// Key path, for example `body[2].inertia_kg_m2.xx`, or an item, for example `wheel 'w1'`.
    pub key: String,
    /// Name of the entry that has the key, for example `body "link2"`.
    pub subject: String,
    /// Option of the command line.
    pub option: &'static str,
}

impl Place {
    /// A whole file.
    pub fn file(path: impl AsRef<Path>) -> Self {
        let name = path.as_ref().display().to_string();
        Self::label(&name)
    }

    /// A file or segment by its label.
    pub fn label(label: &str) -> Self {
        Self {
            file: excerpt(label, LONGEST_NAME),
            ..Self::default()
        }
    }

    /// An item of the model or of the data, for example `wheel 'w1'`.
    pub fn item(kind: &str, name: &str) -> Self {
        Self::default().key(&format!("{kind} '{name}'"))
    }

    /// An option of the command line.
    pub fn option(option: &'static str) -> Self {
        Self {
            option,
            ..Self::default()
        }
    }

    /// A cell of a table: the line of a text, or the row of a Parquet file or of columns in memory (`<name>`); 0 for
    /// the whole column.
    pub fn cell(path: &Path, line: u64, column: &str) -> Self {
        let parquet = path
            .extension()
            .is_some_and(|e| e == "parquet" || e == "pq");
        Self {
            line,
            is_row: parquet || path.to_string_lossy().starts_with('<'),
            name: column.to_owned(),
            ..Self::file(path)
        }
    }

    /// A whole row of a table.
    pub fn row(path: &Path, line: u64) -> Self {
        Self::cell(path, line, "")
    }

    /// The same place in another row.
    pub fn at(&self, line: u64) -> Self {
        Self {
            line,
            ..self.clone()
        }
    }

    /// The same place at a key.
    pub fn key(self, key: &str) -> Self {
        Self {
            key: key.to_owned(),
            ..self
        }
    }
}

/// As printed: `model.toml:3:9: body[0].mass_kg`, `run7.csv:1842 column 'omega_x'`, `run7.parquet row 12`, `--every`.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.option, escaped(&self.file))?;
        match (self.line, self.is_row) {
            (0, _) => {}
            (row, true) => write!(f, " row {row}")?,
            (line, false) => write!(f, ":{line}")?,
        }
        if self.line > 0 && self.column > 0 {
            write!(f, ":{}", self.column)?;
        }
        if !self.name.is_empty() {
            write!(f, " column '{}'", escaped(&self.name))?;
        }
        let is_alone = self.file.is_empty() && self.option.is_empty();
        if !self.key.is_empty() && !is_alone {
            write!(f, ": ")?;
        }
        write!(f, "{}", escaped(&self.key))
    }
}

/// One fault.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Fault {
    /// Stable code, `E0101` and up; see `poinsot explain`.
    pub code: &'static str,
    /// Origin.
    pub kind: FaultKind,
    /// Where.
    pub place: Place,
    /// The value as read; empty if there is none.
    pub value: String,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub advice: String,
}

impl Fault {
    /// A fault of an input.
    pub fn new(
        code: &'static str,
        place: Place,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            code,
            kind: FaultKind::Input,
            place,
            value: String::new(),
            problem: problem.into(),
            advice: advice.into(),
        }
    }

    /// The same with the value as read.
    pub fn with_value(self, value: impl Into<String>) -> Self {
        Self {
            value: value.into(),
            ..self
        }
    }

    /// The same with another origin.
    pub fn of_kind(self, kind: FaultKind) -> Self {
        Self { kind, ..self }
    }
}

/// `CODE place: problem; advice`, with the value behind the place, in one line.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, subject) = (&self.place.key, &self.place.subject);
        let option = self.place.option;
        write!(f, "{} ", self.code)?;
        let place = self.place.to_string();
        write!(f, "{place}")?;
        if !key.is_empty() && !subject.is_empty() {
            write!(f, " ({})", escaped(subject))?;
        }
        let value = escaped(&self.value);
        match (value.is_empty(), key.is_empty(), option.is_empty()) {
            (true, ..) if place.is_empty() => {}
            (true, ..) => write!(f, ": ")?,
            (false, false, _) => write!(f, " = {value}: ")?,
            (false, true, false) => write!(f, " '{value}': ")?,
            (false, true, true) => write!(f, ": '{value}' ")?,
        }
        write!(f, "{}", escaped(&self.problem))?;
        match self.advice.as_str() {
            "" => Ok(()),
            advice => write!(f, "; {}", escaped(advice)),
        }
    }
}

/// Why a command, or a part of it, gives no answer: at most 20 faults, sorted by place; others are counted.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Faults {
    /// The faults, never empty.
    pub list: Vec<Fault>,
    /// Number of further faults.
    pub omitted: usize,
}

impl Faults {
    /// A single fault of an input.
    pub fn one(
        code: &'static str,
        place: Place,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Fault::new(code, place, problem, advice).into()
    }

    /// All faults of a file, sorted by line and column.
    pub fn sorted(mut list: Vec<Fault>) -> Self {
        let at = |f: &Fault| (f.place.line, f.place.column, f.code);
        list.sort_by(|a, b| at(a).cmp(&at(b)));
        let omitted = list.len().saturating_sub(SHOWN);
        list.truncate(SHOWN);
        Self { list, omitted }
    }

    /// The value if there is no fault; otherwise all of them.
    ///
    /// # Errors
    /// The list is not empty.
    pub fn none_or<T>(list: Vec<Fault>, value: T) -> Result<T, Self> {
        match list.is_empty() {
            true => Ok(value),
            false => Err(Self::sorted(list)),
        }
    }

    /// Code of the first fault.
    pub fn code(&self) -> &'static str {
        self.list.first().map_or("", |f| f.code)
    }

    /// Gravest origin of the faults.
    pub fn kind(&self) -> FaultKind {
        self.list.iter().map(|f| f.kind).max().unwrap_or_default()
    }
}

/// Faults of the program as a whole.
impl Faults {
    /// E0001: an argument of the command line, with its value as read.
    pub fn usage(
        option: &'static str,
        value: impl fmt::Display,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        let fault = Fault::new("E0001", Place::option(option), problem, advice);
        fault.with_value(value.to_string()).into()
    }

    /// A fault of the operating system.
    fn system(code: &'static str, place: Place, problem: String, advice: &str) -> Self {
        let fault = Fault::new(code, place, problem, advice);
        fault.of_kind(FaultKind::System).into()
    }

    /// E0002: the operating system refused `what`.
    pub fn io(path: &Path, what: &str, source: &io::Error) -> Self {
        let problem = format!("{what}: {source}");
        Self::system("E0002", Place::file(path), problem, io_advice(source))
    }

    /// E0003: standard output cannot be written.
    pub fn output(source: &io::Error) -> Self {
        let place = Place::label("standard output");
        let advice = "free space, or write to another place";
        Self::system("E0003", place, source.to_string(), advice)
    }

    /// E0004: files were partly put in place; the earlier ones are in the folder `kept`.
    pub fn kept(path: &Path, source: &io::Error, kept: &Path) -> Self {
        let problem = format!("only a part of the answer is in place: {source}");
        let advice = format!("move the earlier files back from {}", kept.display());
        Self::system("E0004", Place::file(path), problem, &advice)
    }

    /// E0005: the system starts no thread.
    pub fn threads(why: impl fmt::Display) -> Self {
        let problem = format!("the system cannot start a thread: {why}");
        let advice =
            "raise the limit of processes or memory (ulimit -u, ulimit -v), or end other programs";
        Self::system("E0005", Place::default(), problem, advice)
    }

    /// E0006: out of memory, or above its limit.
    pub fn memory(problem: String) -> Self {
        let advice = "ask for less, end other programs, or raise --limit-memory and ulimit -v";
        Self::system("E0006", Place::default(), problem, advice)
    }

    /// E0006: more time than its limit.
    pub fn time(problem: String) -> Self {
        let advice = "ask for less, or raise --limit-hours";
        Self::system("E0006", Place::default(), problem, advice)
    }

    /// E0009: a bug, with its message and place in the source.
    pub fn internal(what: impl fmt::Display) -> Self {
        let problem = format!("internal error: {what}: this is a bug in poinsot");
        let advice = "please report it with the command and, if possible, the input";
        let fault = Fault::new("E0009", Place::default(), problem, advice);
        fault.of_kind(FaultKind::Internal).into()
    }

    /// E0601: no report or export can be made of a file or folder.
    pub fn report(path: &Path, problem: impl fmt::Display, advice: impl Into<String>) -> Self {
        let problem = format!("no report or export can be made of this: {problem}");
        Self::one("E0601", Place::file(path), problem, advice)
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self {
            list: vec![fault],
            omitted: 0,
        }
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, fault) in self.list.iter().enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            write!(f, "{fault}")?;
        }
        match self.omitted {
            0 => Ok(()),
            more if more + SHOWN >= MOST_FAULTS => write!(f, "\nand at least {more} more"),
            more => write!(f, "\nand {more} more"),
        }
    }
}

impl std::error::Error for Faults {}

/// Advice for an error of the operating system.
///
/// ```
/// use std::io::{Error, ErrorKind};
///
/// assert_eq!(poinsot_files::io_advice(&Error::from(ErrorKind::NotFound)), "check the path");
/// ```
pub fn io_advice(source: &io::Error) -> &'static str {
    use io::ErrorKind as Kind;
    match source.kind() {
        Kind::NotFound => "check the path",
        Kind::PermissionDenied => "correct the permission, or name another place",
        Kind::StorageFull | Kind::QuotaExceeded => "free space, or write to another place",
        Kind::ReadOnlyFilesystem => "write to another place",
        Kind::IsADirectory => "move the folder at this path, or name another place",
        Kind::AlreadyExists | Kind::NotADirectory => {
            "move the file at this path, or name another folder"
        }
        Kind::InvalidData | Kind::UnexpectedEof => "name a whole file of the right kind",
        _ => "check the path, the disk and its permissions",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_every_place_and_value_is_printed() {
        let place = |file: &str, line, column, name: &str, key: &str| Place {
            line,
            column,
            name: name.to_owned(),
            ..Place::label(file).key(key)
        };
        let said = |place, value: &str| {
            let fault = Fault::new("E0103", place, "is wrong", "correct it").with_value(value);
            fault.to_string()
        };
        for (place, value, line) in [
            (Place::default(), "", "E0103 is wrong; correct it"),
            (
                place("m", 3, 7, "", "a.b"),
                "1",
                "E0103 m:3:7: a.b = 1: is wrong; correct it",
            ),
            (
                place("c", 3, 0, "", ""),
                "",
                "E0103 c:3: is wrong; correct it",
            ),
            (
                place("t", 5, 0, "x", ""),
                "abc",
                "E0103 t:5 column 'x': 'abc' is wrong; correct it",
            ),
            (
                Place::option("--every"),
                "0",
                "E0103 --every '0': is wrong; correct it",
            ),
            (
                Place::item("wheel", "w"),
                "",
                "E0103 wheel 'w': is wrong; correct it",
            ),
        ] {
            assert_eq!(said(place, value), line);
        }
    }

    #[test]
    fn unit_the_first_twenty_in_the_order_of_the_file_are_listed() {
        let at = |line| Place {
            line,
            ..Place::label("m.toml")
        };
        let list = (1..=30)
            .rev()
            .map(|line| Fault::new("E0103", at(line), "x", "y"));
        let faults = Faults::sorted(list.collect());
        assert_eq!((faults.list.len(), faults.omitted), (20, 10));
        assert_eq!(faults.list[0].place.line, 1);
        assert!(faults.to_string().ends_with("\nand 10 more"));
        assert_eq!(Faults::none_or(Vec::new(), 1), Ok(1));
    }
}
