//! A finished shard: sums for merging, and rows for other programs, in separate files.

use super::plan::{Plan, Shard};
use super::recount;
use super::sums::CellSums;
use super::trial::CRASHED;
use crate::error::Error;
use crate::trials::{Row, RowNumber, position};
use indexmap::IndexSet;
use poinsot_files::{InputError, Stage, open, read_text};
use poinsot_formats::{LARGEST_RESULT, ResultFile, checksum, parse_result, result_text, sha256_of};
use poinsot_identify::Status;
use poinsot_telemetry::{ROWS_EXTENSION, RowCells, RowColumn, read_rows, write_rows};
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::collections::BTreeSet;
use std::io::Seek;
use std::path::{Path, PathBuf};

/// Schema of the file.
const SCHEMA: &str = "poinsot.shard/3";
/// Digits of the digest in file names.
const SHORT: usize = 12;
/// Number of shards per folder.
const IN_FOLDER: u64 = 1000;
/// Ending of a file of no content but the size of rows that are kept elsewhere, for example in an object store.
const ELSEWHERE: &str = "elsewhere";

/// Sums of a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShardSums {
    /// "poinsot.shard/3".
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
    /// SHA-256 of the file of rows.
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
    pub(super) fn new(plan: &Plan, shard: &Shard, rows: &[Row]) -> Self {
        Self {
            sums: ShardSums {
                schema: SCHEMA.to_owned(),
                digest: plan.digest.clone(),
                shard: shard.number,
                cell: shard.cell,
                trials: (shard.trials.start, shard.trials.end),
                sums: CellSums::of(plan, rows),
                rows_bytes: 0,
                rows_sha256: String::new(),
            },
            rows: columns(plan, shard, rows),
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

impl ResultFile for ShardSums {
    const SCHEMA: &'static str = SCHEMA;
    const EARLIER: &'static [&'static str] = &["poinsot.shard/2"];
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

    /// Checks that these are the sums of this shard of the plan: its methods, each with every trial once.
    ///
    /// # Errors
    /// What differs.
    pub(super) fn check(&self, plan: &Plan, number: u64) -> Result<(), String> {
        let Shard { cell, trials, .. } = plan.shard(number);
        let own = (self.shard, self.cell, self.trials);
        if own != (number, cell, (trials.start, trials.end)) || self.digest != plan.digest {
            return Err("it is of another plan or another shard".to_owned());
        }
        let sums = &self.sums;
        let methods = sums.methods.iter().map(|m| m.setup.as_str());
        if !methods.eq(plan.method_labels()) || sums.seconds.len() != plan.methods.len() {
            return Err("its methods are not those of the plan".to_owned());
        }
        let count = trials.end - trials.start;
        match sums.methods.iter().all(|m| m.is_of(count)) {
            true => Ok(()),
            false => Err("its counts are not those of its trials".to_owned()),
        }
    }

    /// Checks size, checksum and sums of the rows; of rows elsewhere, their size.
    fn check_rows(&self, plan: &Plan, rows: &Path) -> Result<(), String> {
        let own = open(rows);
        let here = own.is_ok();
        let found = own.or_else(|_| open(&rows.with_extension(ELSEWHERE)));
        let (mut file, metadata) = found.map_err(|_| "its rows are not there")?;
        let bytes = metadata.len();
        if bytes != self.rows_bytes {
            let wanted = self.rows_bytes;
            return Err(format!("its rows have {bytes} bytes instead of {wanted}"));
        }
        if !here {
            return Ok(());
        }
        if sha256_of(&mut file).map_err(|e| e.to_string())? != self.rows_sha256 {
            return Err("its rows were changed: their checksum differs".to_owned());
        }
        let columns = read_rows(rows, file).map_err(|e| e.to_string())?;
        recount::check(plan, &self.sums, &columns)
    }
}

/// A shard that is not there, or is damaged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingShard {
    /// Number.
    pub number: u64,
    /// Why it is damaged; `None` where there is no file.
    pub damage: Option<String>,
}

impl MissingShard {
    /// Why the shard cannot be used.
    pub fn why(&self) -> &str {
        self.damage.as_deref().unwrap_or("it is not there")
    }
}

/// The sums of a shard, or why they are missing.
pub(super) type Found = Result<ShardSums, MissingShard>;

/// Looks for a shard in the folder of a campaign.
///
/// # Errors
/// Reading fails.
pub(super) fn find(plan: &Plan, out: &Path, number: u64) -> Result<Found, Error> {
    let missing = |damage| Ok(Err(MissingShard { number, damage }));
    let path = sums_path(out, &plan.digest, number);
    let text = match read_text(&path, LARGEST_RESULT) {
        Ok(text) => text,
        Err(InputError::Missing(_)) => return missing(None),
        Err(own @ (InputError::System(_) | InputError::Memory(_))) => {
            return Err(own.of_result(&path));
        }
        Err(other) => return missing(Some(other.to_string())),
    };
    let Shard { trials, .. } = plan.shard(number);
    let parsed = ShardSums::parse(&text);
    // A plan with another number of trials may have a different last shard.
    let is_other = |s: &ShardSums| s.trials.0 == trials.start && s.trials.1 != trials.end;
    if parsed.as_ref().is_ok_and(is_other) {
        return missing(None);
    }
    let whole = parsed.and_then(|sums| {
        sums.check(plan, number)?;
        sums.check_rows(plan, &rows_path(&path))?;
        Ok(sums)
    });
    whole.map_or_else(|why| missing(Some(why)), |sums| Ok(Ok(sums)))
}

type Of<T> = fn(&T) -> Option<f64>;

/// Rows as columns: what the row is, where its shard is, what was drawn, and every number that an answer may have.
fn columns(plan: &Plan, shard: &Shard, rows: &[Row]) -> Vec<RowColumn> {
    let experiment = plan.experiment(shard.cell);
    let (labels, seed) = (plan.method_labels(), plan.file.seed.unwrap_or(0));
    let mut columns = Vec::new();
    let mut add = |name: String, cells| columns.push(RowColumn { name, cells });
    let label = |k: usize| labels[k % labels.len()].to_owned();
    let labels = (0..rows.len()).map(label).collect();
    let text = |f: &dyn Fn(&Row) -> String| RowCells::Text(rows.iter().map(f).collect());
    let count = |f: &dyn Fn(&Row) -> u64| RowCells::Count(rows.iter().map(f).collect());
    let number = |f: &dyn Fn(&Row) -> Option<f64>| RowCells::Number(rows.iter().map(f).collect());
    add("experiment".to_owned(), text(&|_| experiment.name.clone()));
    add("trial".to_owned(), count(&|r| r.trial));
    add("method".to_owned(), RowCells::Text(labels));
    add("status".to_owned(), text(&status));
    add("passes".to_owned(), count(&passes));
    add("why".to_owned(), text(&|r| r.evidence.join("; ")));
    add("seed".to_owned(), count(&|_| seed));
    let numbers: [(&str, Of<Row>); 5] = [
        ("seconds", |r| Some(r.seconds)),
        ("iterations", |r| r.status.map(|_| r.iterations as f64)),
        ("chi2_per_dof", |r| r.chi2_per_dof),
        ("nees", |r| r.nees.map(|n| n.square)),
        ("nees_dof", |r| r.nees.map(|n| n.dof as f64)),
    ];
    for (name, of) in numbers {
        add(name.to_owned(), number(&of));
    }
    for (address, value) in plan.point(shard.cell) {
        add(format!("at.{address}"), number(&|_| Some(value)));
    }
    // A number has the same place in most rows.
    let place = Cell::new(0);
    let drawn = rows.iter().flat_map(|r| &r.drawn);
    for name in drawn.map(|d| &d.0).collect::<IndexSet<_>>() {
        let value = |r: &Row| Some(found(&r.drawn, &place, |d| d.0 == *name)?.1);
        add(format!("drawn.{name}"), number(&value));
    }
    // All shards of a cell begin with the requested numbers, determined or not.
    let mut names: IndexSet<String> = experiment.asked.iter().cloned().collect();
    let determined = rows.iter().flat_map(|r| r.determined().map(|n| &n.name));
    names.extend(determined.collect::<BTreeSet<_>>().into_iter().cloned());
    let kinds: [(&str, Of<RowNumber>); 4] = [
        ("truth", |n| Some(n.truth)),
        ("estimate", |n| n.estimate),
        ("sigma", |n| n.sigma),
        ("z", RowNumber::z),
    ];
    for name in &names {
        for (kind, of) in kinds {
            let value = |r: &Row| of(found(&r.numbers, &place, |n| n.name == *name)?);
            add(format!("{kind}.{name}"), number(&value));
        }
    }
    columns
}

fn status(row: &Row) -> String {
    let crashed = || row.evidence.iter().any(|why| why.starts_with(CRASHED));
    match row.status {
        Some(status) => status.name().to_owned(),
        None if crashed() => "crashed".to_owned(),
        None => "refused".to_owned(),
    }
}

fn passes(row: &Row) -> u64 {
    u64::from(row.status == Some(Status::Converged) && row.evidence.is_empty())
}

/// The item that is meant; `place` is where the last one was.
fn found<'a, T>(list: &'a [T], place: &Cell<usize>, is: impl Fn(&T) -> bool) -> Option<&'a T> {
    place.set(position(list, place.get(), is)?);
    list.get(place.get())
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
                methods: vec![crate::trials::Sums::default()],
                seconds: vec![1.0],
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
