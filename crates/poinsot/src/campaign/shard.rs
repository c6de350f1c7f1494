//! A finished shard: sums for merging, and rows for other programs, in separate files.

use super::pairs::PairSums;
use super::plan::{Plan, Shard};
use super::trial::{Bound, Done};
use crate::digest::sha256;
use crate::error::Error;
use crate::trials::{Answer, Sums, position};
use poinsot_files::{InputError, Stage, read_text};
use poinsot_formats::finite;
use poinsot_telemetry::{ROWS_EXTENSION, RowCells, RowColumn, write_rows};
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Schema of the file.
const SCHEMA: &str = "poinsot.shard/1";
/// Size limit of a file of sums, bytes.
const LARGEST: u64 = 256 << 20;
/// Digits of the digest in file names.
const SHORT: usize = 12;
/// Number of shards per folder.
const IN_FOLDER: u64 = 1000;
/// Text before the checksum at the end of the file.
const SEAL: &str = ",\"sha256\":\"";

/// Sums of a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardSums {
    /// "poinsot.shard/1".
    pub schema: String,
    /// Digest of the plan.
    pub digest: String,
    /// Number of the shard.
    pub shard: u64,
    /// Cell.
    pub cell: u64,
    /// First trial, and end of the range (exclusive).
    pub trials: (u64, u64),
    /// One entry per method.
    pub methods: Vec<Sums>,
    /// Every method compared with the first.
    pub pairs: Vec<PairSums>,
    /// CPU time of each method, s; not reproducible.
    pub seconds: Vec<f64>,
    /// Size of the file of rows.
    pub rows_bytes: u64,
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
        let mut methods: Vec<Sums> = plan
            .methods
            .iter()
            .map(|m| Sums::with_bound(&m.label, bound))
            .collect();
        let mut pairs = vec![PairSums::default(); plan.methods.len().saturating_sub(1)];
        let mut seconds = vec![0.0; plan.methods.len()];
        for trial in done {
            for (k, one) in trial.trials.iter().enumerate() {
                methods[k].add(one);
                if let Some(bound) = &trial.bound {
                    methods[k].add_bound(bound);
                }
                seconds[k] += trial.seconds[k];
            }
            let answers: Vec<_> = trial
                .trials
                .iter()
                .map(|t| t.outcome.as_ref().ok())
                .collect();
            for (k, pair) in pairs.iter_mut().enumerate() {
                if let (Some(a), Some(b)) = (answers[0], answers[k + 1]) {
                    pair.add(trial.trials[0].number, a, b);
                }
            }
        }
        Self {
            sums: ShardSums {
                schema: SCHEMA.to_owned(),
                digest: plan.digest.clone(),
                shard: shard.number,
                cell: shard.cell,
                trials: (shard.trials.start, shard.trials.end),
                methods,
                pairs,
                seconds,
                rows_bytes: 0,
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
        let target = rows.clone();
        let (columns, bytes) = (&self.rows, &mut self.sums.rows_bytes);
        stage.fill(Path::new(rows.file_name().unwrap_or_default()), |file| {
            write_rows(file, columns)
                .and_then(|()| file.metadata())
                .map(|written| *bytes = written.len())
                .map_err(|source| Error::Io {
                    path: target,
                    what: "cannot be written",
                    source,
                })
        })?;
        let text = self.sums.text();
        let name = sums.file_name().unwrap_or_default();
        stage.add(Path::new(name), text.as_bytes())?;
        Ok(stage.commit().map(|_| ())?)
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
    /// JSON that ends with the SHA-256 of the preceding text.
    pub fn text(&self) -> String {
        let whole = serde_json::to_string(self).unwrap_or_default();
        let open = whole.trim_end_matches('}');
        format!("{open}{SEAL}{}\"}}\n", sha256(open.as_bytes()))
    }

    /// Reads the text of [`Self::text`].
    ///
    /// # Errors
    /// The text is truncated, changed or of another format.
    pub fn parse(text: &str) -> Result<Self, String> {
        let damaged = "it is cut or was changed";
        let (open, seal) = text.rsplit_once(SEAL).ok_or(damaged)?;
        if seal.trim_end().strip_suffix("\"}") != Some(sha256(open.as_bytes()).as_str()) {
            return Err(damaged.to_owned());
        }
        let sums: Self = serde_json::from_str(&format!("{open}}}")).map_err(|e| e.to_string())?;
        match sums.schema.as_str() {
            SCHEMA => Ok(sums),
            other => Err(format!("its schema is \"{other}\", not {SCHEMA}")),
        }
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
            return Err(Error::Io {
                path,
                what: "cannot be read",
                source,
            });
        }
        Err(other) => return Ok(Found::Damaged(other.to_string())),
    };
    Ok(match ShardSums::parse(&text) {
        Err(why) => Found::Damaged(why),
        Ok(sums) if sums.digest != plan.digest || sums.shard != shard.number => {
            Found::Damaged("it is of another plan or another shard".to_owned())
        }
        // A plan with another number of trials may have a different last shard.
        Ok(sums) if sums.trials != (shard.trials.start, shard.trials.end) => Found::Missing,
        Ok(sums) => match std::fs::metadata(rows_path(&path)) {
            Ok(rows) if rows.len() == sums.rows_bytes => Found::Whole(Box::new(sums)),
            Ok(rows) => Found::Damaged(format!(
                "its rows have {} bytes instead of {}",
                rows.len(),
                sums.rows_bytes
            )),
            Err(_) => Found::Damaged("its rows are not there".to_owned()),
        },
    })
}

/// Makes columns with one cell per trial and method.
struct Cells<'a> {
    done: &'a [Done],
    methods: usize,
}

impl Cells<'_> {
    fn all(&self) -> impl Iterator<Item = (&Done, usize)> {
        let of_trial = |d| (0..self.methods).map(move |m| (d, m));
        self.done.iter().flat_map(of_trial)
    }

    fn text(&self, name: &str, f: impl Fn(&Done, usize) -> String) -> RowColumn {
        RowColumn {
            name: name.to_owned(),
            cells: RowCells::Text(self.all().map(|(d, m)| f(d, m)).collect()),
        }
    }

    fn count(&self, name: &str, f: impl Fn(&Done, usize) -> u64) -> RowColumn {
        RowColumn {
            name: name.to_owned(),
            cells: RowCells::Count(self.all().map(|(d, m)| f(d, m)).collect()),
        }
    }

    fn number(&self, name: String, f: impl Fn(&Done, usize) -> Option<f64>) -> RowColumn {
        RowColumn {
            name,
            cells: RowCells::Number(self.all().map(|(d, m)| f(d, m)).collect()),
        }
    }
}

fn answer(d: &Done, m: usize) -> Option<&Answer> {
    d.trials[m].outcome.as_ref().ok()
}

/// Rows of a shard, one per trial and method.
fn rows(plan: &Plan, shard: &Shard, done: &[Done]) -> Vec<RowColumn> {
    let experiment = &plan.experiment(shard.cell).name;
    let labels = plan.method_labels();
    let cells = Cells {
        done,
        methods: labels.len(),
    };
    let mut columns = vec![
        cells.text("experiment", |_, _| experiment.clone()),
        cells.count("trial", |d, m| d.trials[m].number),
        cells.text("method", |_, m| labels[m].to_owned()),
        cells.text("status", |d, m| match &d.trials[m].outcome {
            Ok(a) => a.status.name().to_owned(),
            Err(why) if why.starts_with(super::trial::CRASHED) => "crashed".to_owned(),
            Err(_) => "refused".to_owned(),
        }),
        cells.count("passes", |d, m| {
            let outcome = d.trials[m].outcome.as_ref();
            u64::from(outcome.is_ok_and(|a| {
                a.status == poinsot_identify::Status::Converged && a.doubts.is_empty()
            }))
        }),
        cells.text("why", |d, m| match &d.trials[m].outcome {
            Ok(a) => a.doubts.join("; "),
            Err(why) => why.clone(),
        }),
        cells.count("seed", |_, _| plan.file.seed.unwrap_or(0)),
        cells.number("seconds".to_owned(), |d, m| Some(d.seconds[m])),
        cells.number("iterations".to_owned(), |d, m| {
            answer(d, m).map(|a| a.iterations as f64)
        }),
        cells.number("chi2_per_dof".to_owned(), |d, m| {
            answer(d, m).and_then(|a| finite(a.chi2_per_dof))
        }),
        cells.number("nees".to_owned(), |d, m| answer(d, m)?.nees.map(|n| n.0)),
        cells.number("nees_dof".to_owned(), |d, m| {
            answer(d, m)?.nees.map(|n| n.1 as f64)
        }),
    ];
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
    for name in names(done, |d| d.drawn.iter().map(|(n, _)| n).collect()) {
        columns.push(cells.number(format!("drawn.{name}"), |d, _| named(&d.drawn, &name)));
    }
    let estimated = |d: &Done, m: usize, name: &str| {
        let numbers = &answer(d, m)?.numbers;
        let n = found(numbers, &place, |n| n.name == name)?;
        Some([n.value, n.sigma, n.error / n.sigma])
    };
    for name in asked(plan, shard, done) {
        columns.push(cells.number(format!("truth.{name}"), |d, _| named(&d.truth, &name)));
        columns.push(cells.number(format!("estimate.{name}"), |d, m| {
            estimated(d, m, &name).map(|n| n[0])
        }));
        columns.push(cells.number(format!("sigma.{name}"), |d, m| {
            estimated(d, m, &name).map(|n| n[1])
        }));
        columns.push(cells.number(format!("z.{name}"), |d, m| {
            estimated(d, m, &name).map(|n| n[2])
        }));
    }
    columns
}

/// The item that is meant; `place` is where the last one was.
fn found<'a, T>(list: &'a [T], place: &Cell<usize>, is: impl Fn(&T) -> bool) -> Option<&'a T> {
    place.set(position(list, place.get(), is)?);
    list.get(place.get())
}

/// Names in the order of first appearance.
fn names(done: &[Done], of: impl Fn(&Done) -> Vec<&String>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for name in done.iter().flat_map(of) {
        if !all.contains(name) {
            all.push(name.clone());
        }
    }
    all
}

/// Numbers with columns: requested numbers of every body, whether determined or not, then biases and other nuisance
/// parameters. All shards of a cell have the same first columns.
fn asked(plan: &Plan, shard: &Shard, done: &[Done]) -> Vec<String> {
    let mut all = plan.experiment(shard.cell).asked();
    let known: BTreeSet<String> = all.iter().cloned().collect();
    let outcomes = done.iter().flat_map(|d| &d.trials).flat_map(|t| &t.outcome);
    let others: BTreeSet<String> = outcomes
        .flat_map(|a| a.numbers.iter().map(|n| &n.name))
        .filter(|n| !known.contains(*n))
        .cloned()
        .collect();
    all.extend(others);
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
            methods: vec![Sums::new("auto", None)],
            pairs: Vec::new(),
            seconds: vec![1.0],
            rows_bytes: 5,
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
