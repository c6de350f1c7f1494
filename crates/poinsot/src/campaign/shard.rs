//! A finished shard: sums for merging, and rows for other programs, in separate files.

use super::plan::{Plan, Shard};
use super::sums::CellSums;
use super::trial::{Bound, Done};
use crate::error::Error;
use crate::trials::{Answer, position};
use indexmap::IndexSet;
use poinsot_files::{InputError, Stage, open, read_text};
use poinsot_formats::{ResultFile, checksum, finite, parse_result, result_text, sha256_of};
use poinsot_identify::Status;
use poinsot_telemetry::{ROWS_EXTENSION, RowCells, RowColumn, write_rows};
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::collections::BTreeSet;
use std::io::Seek;
use std::path::{Path, PathBuf};

/// Schema of the file.
const SCHEMA: &str = "poinsot.shard/2";
/// Size limit of a file of sums, bytes.
const LARGEST: u64 = 256 << 20;
/// Digits of the digest in file names.
const SHORT: usize = 12;
/// Number of shards per folder.
const IN_FOLDER: u64 = 1000;
/// Ending of a file of no content but the size of rows that are kept elsewhere, for example in an object store.
const ELSEWHERE: &str = "elsewhere";

/// Sums of a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShardSums {
    /// "poinsot.shard/2".
    pub schema: String,
    /// Digest of the plan.
    pub digest: String,
    /// Number of the shard.
    pub shard: u64,
    /// Cell.
    pub cell: u64,
    /// First trial, and end of the range (exclusive).
    pub trials: (u64, u64),
    /// Its sums.
    #[serde(flatten)]
    pub sums: CellSums,
    /// Size of the file of rows.
    pub rows_bytes: u64,
    /// SHA-256 of the file of rows; empty in `poinsot.shard/1`.
    #[serde(default)]
    pub rows_sha256: String,
}

/// A finished shard.
pub struct ShardResult {
    /// Its sums.
    pub sums: ShardSums,
    /// One row per trial and method.
    pub rows: Vec<RowColumn>,
}

impl ShardResult {
    pub(super) fn new(plan: &Plan, shard: &Shard, bound: &Bound, done: &[Done]) -> Self {
        let mut sums = CellSums::new(plan, bound);
        done.iter().for_each(|trial| sums.add(trial));
        Self {
            sums: ShardSums {
                schema: SCHEMA.to_owned(),
                digest: plan.digest.clone(),
                shard: shard.number,
                cell: shard.cell,
                trials: (shard.trials.start, shard.trials.end),
                sums,
                rows_bytes: 0,
                rows_sha256: String::new(),
            },
            rows: rows(plan, shard, done),
        }
    }

    /// Writes both files into the folder of a campaign. The sums come last: if they exist, the rows do too.
    ///
    /// # Errors
    /// Writing fails; no file of the shard is left.
    pub fn write(&mut self, out: &Path) -> Result<(), Error> {
        let sums = sums_path(out, &self.sums.digest, self.sums.shard);
        let mut stage = Stage::new(poinsot_files::folder_of(&sums))?;
        let rows = rows_path(&sums);
        let (columns, sums_of) = (&self.rows, &mut self.sums);
        let name = Path::new(rows.file_name().unwrap_or_default());
        stage.fill(name, |file| {
            let mut written = || {
                write_rows(file, columns)?;
                sums_of.rows_bytes = file.metadata()?.len();
                file.rewind()?;
                sums_of.rows_sha256 = sha256_of(&mut *file)?;
                Ok(())
            };
            written().map_err(|source| Error::io(&rows, "cannot be written", &source))
        })?;
        let text = self.sums.text();
        let name = sums.file_name().unwrap_or_default();
        stage.add(Path::new(name), text.as_bytes())?;
        stage.commit().map(|_| ())
    }
}

pub(super) fn sums_path(out: &Path, digest: &str, shard: u64) -> PathBuf {
    let short = digest.get(..SHORT).unwrap_or(digest);
    out.join("shards")
        .join(format!("{:06}", shard / IN_FOLDER))
        .join(format!("{short}_{shard:09}.json"))
}

pub(super) fn rows_path(sums: &Path) -> PathBuf {
    sums.with_extension(ROWS_EXTENSION)
}

impl ShardSums {
    /// JSON that ends with its checksum.
    pub fn text(&self) -> String {
        result_text(self, false).unwrap_or_default()
    }

    /// Reads the text of [`Self::text`].
    ///
    /// # Errors
    /// The text is truncated, changed or of another format.
    pub fn parse(text: &str) -> Result<Self, String> {
        checksum(text).ok_or("it is cut or was changed: it has no checksum")?;
        parse_result(Path::new("sums"), text.as_bytes()).map_err(|e| e.to_string())
    }
}

impl ResultFile for ShardSums {
    const SCHEMA: &'static str = SCHEMA;
    const EARLIER: &'static [&'static str] = &["poinsot.shard/1"];
}

impl ShardSums {
    /// Checks that these are the sums of a shard of the plan: its methods, each with every trial once.
    ///
    /// # Errors
    /// What differs.
    pub(super) fn check(&self, plan: &Plan, shard: &Shard) -> Result<(), String> {
        let range = (shard.trials.start, shard.trials.end);
        let own = (self.shard, self.cell, self.trials) == (shard.number, shard.cell, range);
        if !own || self.digest != plan.digest {
            return Err("it is of another plan or another shard".to_owned());
        }
        let sums = &self.sums;
        let methods = sums.methods.iter().map(|m| m.setup.as_str());
        let lists = [sums.seconds.len(), sums.pairs.len() + 1];
        if !methods.eq(plan.method_labels()) || lists.iter().any(|n| *n != plan.methods.len()) {
            return Err("its methods are not those of the plan".to_owned());
        }
        match sums.methods.iter().all(|m| m.is_of(range)) {
            true => Ok(()),
            false => Err("its counts are not those of its trials".to_owned()),
        }
    }

    /// Checks size and checksum of the rows; of rows elsewhere, their size.
    fn check_rows(&self, rows: &Path) -> Result<(), String> {
        let (file, metadata, here) = match open(rows) {
            Ok((file, metadata)) => (file, metadata, true),
            Err(_) => match open(&rows.with_extension(ELSEWHERE)) {
                Ok((file, metadata)) => (file, metadata, false),
                Err(_) => return Err("its rows are not there".to_owned()),
            },
        };
        let bytes = metadata.len();
        if bytes != self.rows_bytes {
            let wanted = self.rows_bytes;
            return Err(format!("its rows have {bytes} bytes instead of {wanted}"));
        }
        let known = here && !self.rows_sha256.is_empty();
        if known && sha256_of(file).map_err(|e| e.to_string())? != self.rows_sha256 {
            return Err("its rows were changed: their checksum differs".to_owned());
        }
        Ok(())
    }
}

/// Content of a shard's path.
pub(super) enum Found {
    /// Nothing.
    Missing,
    /// Not a valid shard of this plan, with the reason.
    Damaged(String),
    /// The shard.
    Whole(Box<ShardSums>),
}

/// Looks for a shard in the folder of a campaign.
///
/// # Errors
/// Reading fails.
pub(super) fn find(plan: &Plan, out: &Path, shard: &Shard) -> Result<Found, Error> {
    let path = sums_path(out, &plan.digest, shard.number);
    let text = match read_text(&path, LARGEST) {
        Ok(text) => text,
        Err(InputError::Missing(_)) => return Ok(Found::Missing),
        Err(InputError::System(source)) => {
            return Err(Error::io(&path, "cannot be read", &source));
        }
        Err(other) => return Ok(Found::Damaged(other.to_string())),
    };
    let sums = match ShardSums::parse(&text) {
        Ok(sums) => sums,
        Err(why) => return Ok(Found::Damaged(why)),
    };
    // A plan with another number of trials may have a different last shard.
    if sums.trials.0 == shard.trials.start && sums.trials.1 != shard.trials.end {
        return Ok(Found::Missing);
    }
    let rows = match sums.check(plan, shard) {
        Ok(()) => sums.check_rows(&rows_path(&path)),
        Err(why) => Err(why),
    };
    Ok(match rows {
        Ok(()) => Found::Whole(Box::new(sums)),
        Err(why) => Found::Damaged(why),
    })
}

/// Makes columns with one cell per trial and method.
struct Cells<'a> {
    done: &'a [Done],
    methods: usize,
}

impl Cells<'_> {
    fn of<T>(&self, f: impl Fn(&Done, usize) -> T) -> Vec<T> {
        let of_trial = |d| (0..self.methods).map(move |m| (d, m));
        let all = self.done.iter().flat_map(of_trial);
        all.map(|(d, m)| f(d, m)).collect()
    }

    fn number(&self, name: String, f: impl Fn(&Done, usize) -> Option<f64>) -> RowColumn {
        let cells = RowCells::Number(self.of(f));
        RowColumn { name, cells }
    }
}

fn answer(d: &Done, m: usize) -> Option<&Answer> {
    d.trials[m].outcome.as_ref().ok()
}

fn status(d: &Done, m: usize) -> String {
    match &d.trials[m].outcome {
        Ok(a) => a.status.name().to_owned(),
        Err(why) if why.starts_with(super::trial::CRASHED) => "crashed".to_owned(),
        Err(_) => "refused".to_owned(),
    }
}

fn why(d: &Done, m: usize) -> String {
    match &d.trials[m].outcome {
        Ok(a) => a.doubts.join("; "),
        Err(why) => why.clone(),
    }
}

/// Rows of a shard, one per trial and method.
fn rows(plan: &Plan, shard: &Shard, done: &[Done]) -> Vec<RowColumn> {
    let experiment = &plan.experiment(shard.cell).name;
    let labels = plan.method_labels();
    let cells = Cells {
        done,
        methods: labels.len(),
    };
    let passes = |d: &Done, m: usize| {
        let passed = |a: &Answer| a.status == Status::Converged && a.doubts.is_empty();
        u64::from(answer(d, m).is_some_and(passed))
    };
    let seed = plan.file.seed.unwrap_or(0);
    let words = [
        (
            "experiment",
            RowCells::Text(cells.of(|_, _| experiment.clone())),
        ),
        (
            "trial",
            RowCells::Count(cells.of(|d, m| d.trials[m].number)),
        ),
        (
            "method",
            RowCells::Text(cells.of(|_, m| labels[m].to_owned())),
        ),
        ("status", RowCells::Text(cells.of(status))),
        ("passes", RowCells::Count(cells.of(passes))),
        ("why", RowCells::Text(cells.of(why))),
        ("seed", RowCells::Count(cells.of(|_, _| seed))),
    ];
    let words = words.into_iter().map(|(name, cells)| RowColumn {
        name: name.to_owned(),
        cells,
    });
    let number = |name: &str, f: &dyn Fn(&Answer) -> Option<f64>| {
        cells.number(name.to_owned(), |d, m| answer(d, m).and_then(f))
    };
    let mut columns: Vec<RowColumn> = words.collect();
    columns.extend([
        cells.number("seconds".to_owned(), |d, m| Some(d.seconds[m])),
        number("iterations", &|a| Some(a.iterations as f64)),
        number("chi2_per_dof", &|a| finite(a.chi2_per_dof)),
        number("nees", &|a| a.nees.map(|n| n.0)),
        number("nees_dof", &|a| a.nees.map(|n| n.1 as f64)),
    ]);
    columns.extend(number_columns(plan, shard, &cells));
    columns
}

/// Where a shard is, what was drawn, and every number that an answer may have.
fn number_columns(plan: &Plan, shard: &Shard, cells: &Cells) -> Vec<RowColumn> {
    let done = cells.done;
    let mut columns = Vec::new();
    for (address, value) in plan.point(shard.cell) {
        columns.push(cells.number(format!("at.{address}"), |_, _| Some(value)));
    }
    // A number has the same place in most trials.
    let place = Cell::new(0);
    let named = |list: &[(String, f64)], name: &str| {
        found(list, &place, |(n, _)| n == name).map(|(_, x)| *x)
    };
    let drawn = done.iter().flat_map(|d| &d.drawn);
    let drawn: IndexSet<&String> = drawn.map(|(name, _)| name).collect();
    for name in drawn {
        columns.push(cells.number(format!("drawn.{name}"), |d, _| named(&d.drawn, name)));
    }
    let estimated = |d: &Done, m: usize, name: &str, k: usize| {
        let numbers = &answer(d, m)?.numbers;
        let n = found(numbers, &place, |n| n.name == name)?;
        Some([n.value, n.sigma, n.error / n.sigma][k])
    };
    for name in asked(plan, shard, done) {
        columns.push(cells.number(format!("truth.{name}"), |d, _| named(&d.truth, &name)));
        for (k, kind) in ["estimate", "sigma", "z"].into_iter().enumerate() {
            let cell = |d: &Done, m| estimated(d, m, &name, k);
            columns.push(cells.number(format!("{kind}.{name}"), cell));
        }
    }
    columns
}

/// The item that is meant; `place` is where the last one was.
fn found<'a, T>(list: &'a [T], place: &Cell<usize>, is: impl Fn(&T) -> bool) -> Option<&'a T> {
    place.set(position(list, place.get(), is)?);
    list.get(place.get())
}

/// Numbers with columns: requested numbers of every body, whether determined or not, then biases and other nuisance
/// parameters. All shards of a cell have the same first columns.
fn asked(plan: &Plan, shard: &Shard, done: &[Done]) -> IndexSet<String> {
    let mut all: IndexSet<String> = plan.experiment(shard.cell).asked().into_iter().collect();
    let answers = done.iter().flat_map(|d| &d.trials).flat_map(|t| &t.outcome);
    let others: BTreeSet<&String> = answers
        .flat_map(|a| a.numbers.iter().map(|n| &n.name))
        .collect();
    all.extend(others.into_iter().cloned());
    all
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn sums() -> ShardSums {
        ShardSums {
            schema: SCHEMA.to_owned(),
            digest: "ab".to_owned(),
            shard: 3,
            cell: 1,
            trials: (10, 20),
            sums: CellSums {
                methods: vec![crate::trials::Sums::new("auto", None)],
                seconds: vec![1.0],
                ..CellSums::default()
            },
            rows_bytes: 5,
            rows_sha256: String::new(),
        }
    }

    #[test]
    fn exact_sums_read_equal_and_nothing_cut_or_changed_is_read() {
        let text = sums().text();
        assert_eq!(ShardSums::parse(&text).unwrap(), sums());
        serde_json::from_str::<serde_json::Value>(&text).unwrap();
        for cut in 0..text.len() - 1 {
            let read = ShardSums::parse(&text[..cut]);
            assert!(read.is_err(), "cut at {cut}");
        }
        let other = text.replacen("\"cell\":1", "\"cell\":2", 1);
        assert!(ShardSums::parse(&other).unwrap_err().contains("changed"));
    }
}
