//! A checked plan with its cells, trials and shards.
//!
//! A cell is one experiment at one point of the grid. A shard is a block of trials of one cell. Shards are numbered
//! block by block: the first blocks of all cells come before the second ones.

use super::address::{Documents, Refusal, count, edit};
use super::experiment::{Experiment, FilesAt, name_or_stem};
use super::faults::PlanText;
use super::methods::MethodChoice;
use crate::case::{FITTED, FITTED_S};
use crate::error::Error;
use crate::threads::thread_count;
use crate::trials::Study;
use poinsot_formats::{DrawFile, NumbersFile, OfFile, PLAN, PlanFile, ScaleFile, VaryFile, sha256};
use serde::Serialize;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Default number of trials of a shard.
const TRIALS_PER_SHARD: u64 = 100;
/// Default number of trials.
const TRIALS: u64 = 1000;
/// Limit on trials: the trial number selects a random stream of 48 bits.
const MOST_TRIALS: u64 = 1 << 48;
/// Largest number of cells of a grid.
const MOST_CELLS: u64 = 1_000_000;

/// A checked plan.
pub struct Plan {
    /// The file.
    pub file: PlanFile,
    /// Name of the campaign.
    pub name: String,
    /// SHA-256 of all inputs of a trial: the plan without name and number of trials, its files, and the program
    /// version.
    pub digest: String,
    /// Trials of every cell.
    pub trials: u64,
    /// Trials of one shard.
    pub block: u64,
    /// Folder from which the plan names its files.
    pub folder: PathBuf,
    pub(crate) experiments: Vec<Experiment>,
    pub(crate) methods: Vec<MethodChoice>,
    /// The values of every varied number.
    pub(crate) grid: Vec<Vec<f64>>,
    /// Least time of a trial of any cell, s; zero where it is not known.
    pub(crate) seconds: f64,
}

/// A block of trials of one cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shard {
    /// Number, from zero.
    pub number: u64,
    /// Cell, from zero.
    pub cell: u64,
    /// Its trials.
    pub trials: Range<u64>,
}

/// Reads and checks a plan.
///
/// # Errors
/// All faults of the plan and its files.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// assert_eq!((plan.trials, plan.cells(), plan.method_labels()), (4, 1, vec!["maximum_likelihood"]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_plan(path: &Path) -> Result<Plan, Error> {
    let text = poinsot_files::read_tree(path).map_err(|e| e.fault("E0541", path))?;
    parse_plan(path, text)
}

/// Reads the text of a plan; `path` is used in messages and to locate the plan's files.
///
/// # Errors
/// As [`read_plan`].
///
/// ```
/// use poinsot::campaign::parse_plan;
///
/// let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/plan.toml");
/// let text = std::fs::read_to_string(&path)?.replace("trials = 4", "trials = 100");
/// assert_eq!(parse_plan(&path, text)?.trials, 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn parse_plan(path: &Path, text: String) -> Result<Plan, Error> {
    let text = PlanText::new(path, text);
    let file: PlanFile = text.parse()?;
    plan_of(file, text)
}

/// A plan made by a program; its files are located in `folder`.
///
/// # Errors
/// As [`read_plan`].
///
/// ```
/// use poinsot::campaign::made_plan;
/// use poinsot::sweep::{SweepRequest, sweep_plan};
///
/// // The box of the folder `doc` with two rates of its rows.
/// let request = SweepRequest {
///     case: "case.toml".into(),
///     vary: vec!["output.rate_hz=5,10".to_owned()],
///     methods: vec!["linear".to_owned()],
///     trials: 10,
///     ..SweepRequest::default()
/// };
/// let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
/// assert_eq!(made_plan(sweep_plan(&request)?, &folder)?.cells(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn made_plan(file: PlanFile, folder: &Path) -> Result<Plan, Error> {
    let path = folder.join("(plan)");
    // A seed may be too large for TOML.
    let rows = PlanFile {
        seed: None,
        ..file.clone()
    };
    let rows = toml::to_string(&rows).map_err(Error::internal)?;
    PlanText::new(&path, rows).parse().map_err(|mut error| {
        error.list.iter_mut().for_each(|f| f.place.line = 0);
        error
    })?;
    plan_of(file, PlanText::new(&path, String::new()))
}

fn plan_of(file: PlanFile, mut text: PlanText) -> Result<Plan, Error> {
    check_counts(&file, &mut text);
    let methods = MethodChoice::all(&file.method, &mut text);
    let varied = file.vary.iter().enumerate();
    let grid = varied.filter_map(|(k, vary)| axis(vary, k, &mut text));
    let grid = grid.collect();
    text.finish()?;
    let folder = text.path().parent().unwrap_or(Path::new("")).to_owned();
    let mut experiments = Vec::new();
    for (k, experiment) in file.experiment.iter().enumerate() {
        let made = Experiment::read(experiment, &folder, &file, k, &mut text)?;
        experiments.extend(made);
    }
    text.finish()?;
    let mut plan = Plan {
        name: name_or_stem(&file.name, text.path()),
        digest: digest(&file, &experiments),
        trials: file.trials.unwrap_or(TRIALS),
        block: file.trials_per_shard.unwrap_or(TRIALS_PER_SHARD),
        folder,
        file,
        experiments,
        methods,
        grid,
        seconds: f64::INFINITY,
    };
    check_addresses(&plan, &mut text);
    if plan.cells() > MOST_CELLS {
        let what = format!("the grid has {} cells", plan.cells());
        text.refuse("vary", what, "give fewer values, or sample the numbers");
    }
    text.finish()?;
    // Check every point of the grid before the first trial.
    for cell in 0..plan.cells() {
        let experiment = plan.experiment(cell);
        let files = plan.files_at(experiment, cell)?;
        let mut seconds = 0.0;
        if let Some(case) = &files.case {
            case.bind(&files.truth)?;
            let copies = FITTED * (1 + thread_count());
            case.check_memory(&files.truth, case.times().count(), copies)?;
            seconds = case.check_time(&files.truth, FITTED_S)?;
        }
        plan.seconds = plan.seconds.min(seconds);
    }
    Ok(plan)
}

fn check_counts(file: &PlanFile, text: &mut PlanText) {
    if file.schema != PLAN {
        let remedy = format!("write schema = \"{PLAN}\"");
        text.refuse("schema", "this is not the format of a plan", &remedy);
    }
    if file.experiment.is_empty() {
        let what = "there is no experiment";
        text.refuse("experiment", what, "add [[experiment]] with a case");
    }
}

/// One `[[vary]]`: values, or a range with a count; `None` if a fault was recorded.
fn axis(vary: &VaryFile, k: usize, text: &mut PlanText) -> Option<Vec<f64>> {
    let log = vary.scale == ScaleFile::Log;
    let found = match (&vary.values, vary.from, vary.to, vary.count) {
        (Some(values), None, None, None) if values.is_empty() => {
            Err(["values", "the list is empty", "write values = [1.0, 2.0]"])
        }
        (Some(values), None, None, None) => Ok(values.clone()),
        (None, Some(from), Some(to), _) if from >= to => {
            Err(["from", "from must be below to", "give both ends of a range"])
        }
        (None, Some(from), Some(_), _) if log && from <= 0.0 => Err([
            "scale",
            "equal ratios need positive ends",
            "write scale = \"linear\"",
        ]),
        (None, Some(from), Some(to), Some(n)) => Ok(range(from, to, n, log)),
        (None, Some(_), Some(_), None) => Err([
            "count",
            "a range needs a count",
            "add count = 10, or [[draw]] the number in every trial",
        ]),
        _ => Err([
            "number",
            "needs either values or one range",
            "give values = [...], or from and to with count",
        ]),
    };
    let refuse = |[key, what, remedy]: [&str; 3]| {
        text.refuse(&format!("vary[{k}].{key}"), what, remedy);
    };
    found.map_err(refuse).ok()
}

/// Values of a range, with exact ends.
fn range(from: f64, to: f64, count: u64, log: bool) -> Vec<f64> {
    let last = count - 1;
    let at = |k: u64| match k {
        0 => from,
        k if k == last => to,
        k => {
            let share = k as f64 / last as f64;
            match log {
                true => (from.ln() + share * (to.ln() - from.ln())).exp(),
                false => from + share * (to - from),
            }
        }
    };
    (0..count).map(at).collect()
}

/// Checks that every change and draw is one, and that every address names numbers in every experiment.
fn check_addresses(plan: &Plan, text: &mut PlanText) {
    let mut check = |key: String, number: &str, of, wanted: Option<usize>, fault: Option<&str>| {
        if let Some(what) = fault {
            text.refuse(&key, what, "give one of them");
        }
        for experiment in &plan.experiments {
            match (count(&experiment.documents, number, of), wanted) {
                (Err((what, remedy)), _) => {
                    let what = format!("{what} (experiment {})", experiment.name);
                    text.refuse_address(&key, what, &remedy);
                }
                (Ok(n), Some(wanted)) if wanted != n => {
                    let what = format!("the address names {n} numbers, not {wanted}");
                    let remedy =
                        "end the address at one number, as in com_m.x, or give one value for each";
                    text.refuse_address(&key, what, remedy);
                }
                (Ok(_), _) => {}
            }
        }
    };
    let key = |list: &str, k: usize| format!("{list}[{k}].number");
    for (k, vary) in plan.file.vary.iter().enumerate() {
        let of = vary.of.unwrap_or(OfFile::Both);
        check(key("vary", k), &vary.number, of, Some(1), None);
    }
    for (k, change) in plan.file.change.iter().enumerate() {
        let lists = change.value.iter().chain(&change.plus);
        let given = lists.clone().count() + usize::from(change.times.is_some());
        let wanted = lists.into_iter().find_map(|n| match n {
            NumbersFile::Each(list) => Some(list.len()),
            NumbersFile::One(_) => None,
        });
        let fault = (given != 1).then_some("exactly one of value, times, plus is needed");
        let of = change.of.unwrap_or(OfFile::Both);
        check(key("change", k), &change.number, of, wanted, fault);
    }
    for (k, draw) in plan.file.draw.iter().enumerate() {
        let fault = "exactly one of sigma, relative_sigma, or from below to is needed";
        let fault = (!drawable(draw)).then_some(fault);
        let of = draw.of.unwrap_or(OfFile::Truth);
        check(key("draw", k), &draw.number, of, None, fault);
    }
}

fn drawable(draw: &DrawFile) -> bool {
    match (draw.sigma, draw.relative_sigma, draw.from, draw.to) {
        (Some(_), None, None, None) | (None, Some(_), None, None) => true,
        (None, None, Some(a), Some(b)) => a < b,
        _ => false,
    }
}

fn digest(file: &PlanFile, experiments: &[Experiment]) -> String {
    let trial = PlanFile {
        name: String::new(),
        about: String::new(),
        trials: None,
        ..file.clone()
    };
    let whole = Digested {
        files: experiments.iter().flat_map(|e| &e.hashes).collect(),
        plan: trial,
        poinsot: env!("CARGO_PKG_VERSION"),
    };
    sha256(&serde_json::to_vec(&whole).unwrap_or_default())
}

/// All inputs of a trial.
#[derive(Serialize)]
struct Digested<'a> {
    files: Vec<&'a String>,
    plan: PlanFile,
    poinsot: &'static str,
}

impl Plan {
    /// Changes the number of trials per cell; trials and finished shards are not affected.
    pub fn set_trials(&mut self, trials: u64) {
        self.trials = trials.clamp(1, MOST_TRIALS);
    }

    /// Every file that the plan names, and the files that those name.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let paths = self.experiments.iter().flat_map(|e| &e.paths);
        paths.map(PathBuf::as_path)
    }

    /// Experiments times points of the grid.
    pub fn cells(&self) -> u64 {
        let points = self.grid.iter().map(|values| values.len() as u64);
        points.fold(self.experiments.len() as u64, u64::saturating_mul)
    }

    /// Number of shards of the plan.
    pub fn shards(&self) -> u64 {
        self.shards_up_to(self.trials)
    }

    /// Number of shards that hold the trials below this number in every cell.
    pub fn shards_up_to(&self, trials: u64) -> u64 {
        trials.div_ceil(self.block) * self.cells()
    }

    /// A shard by its number.
    pub fn shard(&self, number: u64) -> Shard {
        let (block, cell) = (number / self.cells(), number % self.cells());
        let first = block * self.block;
        Shard {
            number,
            cell,
            trials: first..(first + self.block).min(self.trials),
        }
    }

    pub(crate) fn experiment(&self, cell: u64) -> &Experiment {
        let points = self.cells() / self.experiments.len() as u64;
        &self.experiments[(cell / points) as usize]
    }

    /// Varied numbers of a cell, by address.
    pub fn point(&self, cell: u64) -> Vec<(&str, f64)> {
        let points = self.cells() / self.experiments.len() as u64;
        let mut rest = cell % points;
        let mut all: Vec<(&str, f64)> = Vec::new();
        for (vary, values) in self.file.vary.iter().zip(&self.grid).rev() {
            let n = values.len() as u64;
            all.push((&vary.number, values[(rest % n) as usize]));
            rest /= n;
        }
        all.reverse();
        all
    }

    /// The experiment of a cell as a separate study, without draws.
    ///
    /// # Errors
    /// It cannot be simulated.
    pub fn study(&self, cell: u64) -> Result<Study, Error> {
        let experiment = self.experiment(cell);
        experiment.study(self.files_at(experiment, cell)?)
    }

    /// Names of the methods, with variants and settings.
    pub fn method_labels(&self) -> Vec<&str> {
        self.methods.iter().map(|m| m.label.as_str()).collect()
    }

    /// The files of an experiment with the changes of a cell.
    ///
    /// # Errors
    /// A changed file is invalid.
    pub(crate) fn files_at(&self, experiment: &Experiment, cell: u64) -> Result<FilesAt, Error> {
        experiment.files(|documents| self.fixed(cell, documents))
    }

    /// Changes common to all trials of a cell.
    pub(crate) fn fixed(&self, cell: u64, documents: &mut Documents) -> Result<(), Refusal> {
        for change in &self.file.change {
            let of = change.of.unwrap_or(OfFile::Both);
            let pick = |n: &NumbersFile, k: usize| match n {
                NumbersFile::One(x) => *x,
                NumbersFile::Each(list) => list.get(k).copied().unwrap_or(f64::NAN),
            };
            let mut changed = |k: usize, x: f64| match (&change.value, change.times, &change.plus) {
                (Some(v), _, _) => pick(v, k),
                (_, Some(factor), _) => factor * x,
                (_, _, Some(v)) => x + pick(v, k),
                _ => x,
            };
            edit(documents, &change.number, of, &mut changed)?;
        }
        for (vary, (number, value)) in self.file.vary.iter().zip(self.point(cell)) {
            let of = vary.of.unwrap_or(OfFile::Both);
            edit(documents, number, of, &mut |_, _| value)?;
        }
        Ok(())
    }
}
