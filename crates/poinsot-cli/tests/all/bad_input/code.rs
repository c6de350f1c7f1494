//! Changes that no data describe, by name.

use crate::bad_input::bench::{Bench, Problem};
use crate::bad_input::case::Change;
use serde::Deserialize;
use std::fs;

/// One of `TABLE`, done to a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Code {
    name: String,
    file: String,
    /// What a link names, or where the result goes.
    to: Option<String>,
}

type Function = fn(&Bench, &Code) -> Result<(), Problem>;

const TABLE: &[(&str, Function)] = &[
    ("dates", dates),
    ("folder", folder),
    ("hard_link", hard_link),
    ("latin1", latin1),
    ("line_ends_of_all_kinds", line_ends_of_all_kinds),
    ("parquet", parquet),
    ("pipe", pipe),
    ("sparse_file_of_10_GB", sparse_file_of_10_gb),
    ("symbolic_link", symbolic_link),
    ("touched_while_read", touched_while_read),
    ("utf16_big_endian", utf16_big_endian),
    ("utf16_little_endian", utf16_little_endian),
];

impl Change for Code {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        let found = TABLE.iter().find(|(name, _)| *name == self.name);
        let (_, function) = found.ok_or_else(|| format!("no code {:?}", self.name))?;
        function(bench, self).map_err(|e| format!("{} of {}: {e}", self.name, self.file))
    }
}

impl Code {
    fn to(&self) -> Result<&str, Problem> {
        self.to.as_deref().ok_or_else(|| "'to' is missing".into())
    }

    /// A free path for something that is not a regular file.
    fn place(&self, bench: &Bench) -> Result<std::path::PathBuf, Problem> {
        let path = bench.path(&self.file);
        if path.exists() {
            fs::remove_file(&path).map_err(said)?;
        }
        fs::create_dir_all(path.parent().ok_or("no folder")?).map_err(said)?;
        Ok(path)
    }
}

fn said(error: std::io::Error) -> Problem {
    error.to_string()
}

fn text(bench: &Bench, code: &Code) -> Result<String, Problem> {
    String::from_utf8(bench.read(&code.file)?).map_err(|e| e.to_string())
}

fn folder(bench: &Bench, code: &Code) -> Result<(), Problem> {
    fs::create_dir(code.place(bench)?).map_err(said)
}

/// A pipe without writer.
fn pipe(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let path = code.place(bench)?;
    let made = std::process::Command::new("mkfifo").arg(path).status();
    match made.map_err(said)?.success() {
        true => Ok(()),
        false => Err("mkfifo fails".to_owned()),
    }
}

fn symbolic_link(bench: &Bench, code: &Code) -> Result<(), Problem> {
    std::os::unix::fs::symlink(code.to()?, code.place(bench)?).map_err(said)
}

fn hard_link(bench: &Bench, code: &Code) -> Result<(), Problem> {
    fs::hard_link(bench.path(code.to()?), code.place(bench)?).map_err(said)
}

fn sparse_file_of_10_gb(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let file = fs::File::create(bench.path(&code.file)).map_err(said)?;
    file.set_len(10 << 30).map_err(said)
}

/// The modification time changes until the folder is removed; the content does not.
fn touched_while_read(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let path = bench.path(&code.file);
    std::thread::spawn(move || {
        let mut time = std::time::SystemTime::UNIX_EPOCH;
        while let Ok(file) = fs::File::options().append(true).open(&path) {
            time += std::time::Duration::from_secs(1);
            if file.set_modified(time).is_err() {
                break;
            }
        }
    });
    Ok(())
}

fn utf16(bench: &Bench, code: &Code, bytes: fn(u16) -> [u8; 2]) -> Result<(), Problem> {
    let text = text(bench, code)?;
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    bench.write(&code.file, units.flat_map(bytes).collect::<Vec<u8>>());
    Ok(())
}

fn utf16_little_endian(bench: &Bench, code: &Code) -> Result<(), Problem> {
    utf16(bench, code, u16::to_le_bytes)
}

fn utf16_big_endian(bench: &Bench, code: &Code) -> Result<(), Problem> {
    utf16(bench, code, u16::to_be_bytes)
}

fn latin1(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let bytes: Vec<u8> = text(bench, code)?.chars().map(|c| c as u8).collect();
    bench.write(&code.file, bytes);
    Ok(())
}

fn line_ends_of_all_kinds(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let text = text(bench, code)?;
    let lines = text.lines().zip(["\n", "\r\n", "\r"].iter().cycle());
    let new: String = lines.flat_map(|(line, end)| [line, end]).collect();
    bench.write(&code.file, new);
    Ok(())
}

/// The same telemetry as Parquet.
fn parquet(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let options = poinsot_telemetry::ReadOptions::default();
    let table = poinsot_telemetry::read(&[bench.path(&code.file)], &options);
    let channels = table.map_err(|e| e.to_string())?.channels;
    poinsot_telemetry::write(&bench.path(code.to()?), &channels).map_err(|e| e.to_string())
}

/// Dates in the first column: seconds after 2026-03-14, 18 h UTC.
fn dates(bench: &Bench, code: &Code) -> Result<(), Problem> {
    let date = |line: &str| {
        let (time, rest) = line.split_once(',')?;
        let tenths = (time.parse::<f64>().ok()? * 10.0).round() as i64;
        let (minute, second) = (tenths / 600, tenths / 10 % 60);
        let date = format!("2026-03-14T18:{minute:02}:{second:02}.{}Z", tenths % 10);
        Some(format!("{date},{rest}\n"))
    };
    let text = text(bench, code)?;
    let lines = text.lines();
    let new: String = lines
        .map(|l| date(l).unwrap_or_else(|| format!("{l}\n")))
        .collect();
    bench.write(&code.file, new);
    Ok(())
}
