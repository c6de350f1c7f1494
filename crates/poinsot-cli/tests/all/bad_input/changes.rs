//! Changes of whole files and of their text.

use crate::bad_input::bench::{Bench, Problem};
use crate::bad_input::case::Change;
use crate::bad_input::faults::{Fill, fill, folder};
use serde::Deserialize;

/// A whole file: `text`, `hex`, or `copy` of a file (path from `shared/`).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Write {
    file: String,
    text: Option<String>,
    hex: Option<String>,
    copy: Option<String>,
    #[serde(default)]
    fill: Vec<Fill>,
}

impl Change for Write {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let content = match (&self.text, &self.hex, &self.copy) {
            (Some(text), None, None) => fill(text, &self.fill)?.into_bytes(),
            (None, Some(hex), None) => bytes(hex)?,
            (None, None, Some(name)) => shared(name)?,
            _ => return Err(format!("{}: give one of text, hex, copy", self.file)),
        };
        if bench.read(&self.file).is_ok_and(|old| old == content) {
            return Err(format!("{}: already has this content", self.file));
        }
        bench.write(&self.file, content);
        Ok(())
    }
}

/// A file of `shared/`.
pub fn shared(name: &str) -> Result<Vec<u8>, Problem> {
    std::fs::read(folder().join("shared").join(name)).map_err(|e| format!("shared/{name}: {e}"))
}

fn bytes(hex: &str) -> Result<Vec<u8>, Problem> {
    let digits = hex.split_whitespace();
    let byte = |d| u8::from_str_radix(d, 16).map_err(|e| format!("hex {d:?}: {e}"));
    digits.map(byte).collect()
}

/// A text after the end of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Append {
    file: String,
    text: String,
    #[serde(default)]
    fill: Vec<Fill>,
}

impl Change for Append {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let more = fill(&self.text, &self.fill)?;
        bench.edit(&self.file, |old| Ok([old, more.into_bytes()].concat()))
    }
}

/// The first occurrence of a text, or all of them, becomes another text.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Replace {
    file: String,
    from: String,
    to: String,
    #[serde(default)]
    all: bool,
    #[serde(default)]
    fill: Vec<Fill>,
}

impl Change for Replace {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let to = fill(&self.to, &self.fill)?;
        bench.edit(&self.file, |old| {
            let old = String::from_utf8(old).map_err(|e| e.to_string())?;
            let times = if self.all { usize::MAX } else { 1 };
            Ok(old.replacen(&self.from, &to, times).into_bytes())
        })
    }
}

/// A second file with the content of the first.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Copy {
    file: String,
    to: String,
}

impl Change for Copy {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        bench.write(&self.to, bench.read(&self.file)?);
        Ok(())
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Remove {
    file: String,
}

impl Change for Remove {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let path = bench.path(&self.file);
        std::fs::remove_file(path).map_err(|e| format!("{}: {e}", self.file))
    }
}

/// A part of a file: its first `keep` bytes, or other bytes at a place. Negative numbers count from the end.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bytes {
    file: String,
    keep: Option<isize>,
    at: Option<isize>,
    #[serde(default)]
    remove: usize,
    #[serde(default)]
    put: String,
}

impl Change for Bytes {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let put = bytes(&self.put)?;
        bench.edit(&self.file, |mut all| {
            let place = |at: isize| {
                let from = if at < 0 { all.len() } else { 0 };
                let found = from.checked_add_signed(at).filter(|k| *k <= all.len());
                found.ok_or_else(|| format!("the file ends before byte {at}"))
            };
            let end = place(self.keep.unwrap_or(all.len() as isize))?;
            let at = place(self.at.unwrap_or(end as isize))?;
            all.truncate(end);
            all.splice(at..(at + self.remove).min(end), put);
            Ok(all)
        })
    }
}

/// A run of the program before the case's, which must succeed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prepare {
    run: Vec<String>,
}

impl Change for Prepare {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let done = bench.run(&self.run);
        if done.exit == 0 {
            return Ok(());
        }
        Err(format!("{:?} ends with {}", self.run, done.stderr))
    }
}
