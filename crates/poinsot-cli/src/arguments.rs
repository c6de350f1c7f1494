//! The words of the command line.

use crate::words::Words;
use clap::{Args, Parser, Subcommand, ValueEnum};
use poinsot::Coordinates;
use std::path::PathBuf;

/// Exit codes with their meaning.
pub const EXIT_CODES: [(u8, &str); 5] = [
    (
        0,
        "answered: every number asked for is determined, and nothing speaks against it",
    ),
    (
        1,
        "answered, but not acceptable: partial, not identifiable, rejected, not settled, not to be relied on, or too many samples left out",
    ),
    (
        2,
        "the question cannot be asked: usage, model, case or telemetry",
    ),
    (3, "disk or permission"),
    (4, "an error of the program"),
];

/// Mass, centre of mass and inertia of spacecraft and space robots, from telemetry.
#[derive(Debug, Parser)]
#[command(name = "poinsot", version)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

/// What can be done.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Identify the unknown mass properties of a vehicle from its telemetry.
    ///
    /// Exit code 0: every number asked for is determined, and nothing speaks against it. 1: answered, but not all of it is
    /// (partial, not identifiable, rejected), or it is not to be relied on. 2: bad usage, model or telemetry. 3: disk or permission. 4: internal error.
    Identify(Identify),
    /// Simulate a case: joints led or driven by torques, springs, wheels, thrusters, sensors with noise.
    Simulate(Simulate),
    /// Say how accurate a planned manoeuvre will be, before it is flown (Cramer-Rao bound).
    ///
    /// Exit code 0: every number asked for will be determined. 1: not all of it. 2: bad usage, case or model.
    Predict(Predict),
    /// Design the manoeuvre that gives what a case wants, within its limits.
    ///
    /// Exit code 0: every wanted sigma is reached, and trial flights (--verify) agree. 1: not, with the limits that hold
    /// it back. 2: bad usage, case or model. 3: disk or permission. An interruption (Ctrl-C) ends the search with the
    /// best manoeuvre so far; a second one ends the program.
    Design(Design),
    /// Compare the motion of a model, or of an estimate, with another model or with telemetry.
    ///
    /// With a case: both sides under its torques, wheels and thrust; or its motion beside the telemetry. Without:
    /// what the vehicle predicts for a record that was held back. Exit code 0: compared, within the limits or the
    /// declared noise. 1: beyond them, or the motion depends on what the estimate leaves open. 2: bad usage, model,
    /// case or telemetry. 3: disk or permission.
    Validate(Validate),
    /// Compare answers of one vehicle: before and after refuelling, two nights, two methods.
    ///
    /// Exit code 0: they agree. 1: they differ, share telemetry, or one of them is not to be relied on. 2: invalid
    /// arguments or files.
    Compare(Compare),
    /// Repeat experiments with new noise many times: bias, error over bound, coverage, failures.
    ///
    /// The plan names experiments, methods, numbers that vary and numbers that are drawn. Exit code 0: every trial was run.
    /// 1: shards are missing, a trial crashed, or `--until` was not reached. 2: invalid plan, or shards of another plan. 3:
    /// disk or permission.
    Campaign(Campaign),
    /// Vary numbers of one case and compare methods: errors, bounds, figures. A campaign of one case.
    Sweep(Sweep),
    /// Make a result into one page, report.html, that needs no network: of identify, validate, predict, compare, design or
    /// campaign.
    Report(Report),
    /// Say what a telemetry file holds and whether its conventions fit the gyro.
    Inspect(Inspect),
    /// Check a model, map, case, plan or answer, and say what it holds.
    Check(Check),
    /// Make a model file (poinsot.model/1) of a URDF file.
    Import(Import),
    /// Write the answer of `identify` into the file of another program.
    ///
    /// Exit code 1: some bodies are not fully determined and were left as they are.
    Export(Export),
    /// Say what an error code means, its usual cause and what to do; all codes without one.
    Explain(Explain),
    /// List the units that a map of telemetry may name, by quantity.
    Units(Units),
    /// List the methods of `identify` with their variants and papers.
    Methods(Methods),
    /// Compute again what a published paper states: tables, figures, claims; the list of studies without a name.
    ///
    /// Exit code 0: computed. 2: no such study, or no folder of examples. 3: disk or permission.
    Study(Study),
    /// Print the JSON Schema of a file format.
    Schema(Schema),
    /// Print the completions of a shell, to be read by it at its start.
    Completions(Completions),
    /// Write the manual pages, one per command.
    Man(Man),
}

/// A format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FigureFile {
    /// Scalable.
    Svg,
    /// Pixels.
    Png,
}

/// Arguments of `identify`.
#[derive(Debug, Args)]
pub struct Identify {
    /// Model of the vehicle (TOML, poinsot.model/1).
    #[arg(long, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Telemetry of one segment (CSV or Parquet); files of one segment joined by commas. Repeat for more
    /// segments: the bodies are shared, each has its own initial momentum.
    #[arg(long, value_name = "FILE[,FILE]", required = true)]
    pub telemetry: Vec<String>,
    /// Method; `poinsot methods` lists them.
    #[arg(long, default_value = "auto", value_parser = Words::methods())]
    pub method: String,
    /// Variant of the method; `poinsot methods` lists them.
    #[arg(long, value_parser = Words::variants(), hide_possible_values = true)]
    pub variant: Option<String>,
    /// Setting of a published method; `poinsot methods NAME` lists them.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// File whose `[telemetry]` table replaces that of the model.
    #[arg(long, value_name = "MAP.toml")]
    pub map: Option<PathBuf>,
    /// Folder for estimate.json; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also write DIR/report.html, the answer as a page.
    #[arg(long, requires = "out")]
    pub report: bool,
    /// Also write every figure of the page as a file of its own, DIR/figures: svg, png, or both.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT", requires = "out")]
    pub figures: Vec<FigureFile>,
    /// One sigma, relative to the nominal value, up to which a direction counts as identifiable.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// Where the fit may step: physical keeps every unknown body one of positive mass, linear lets an impossible tensor
    /// pass
    #[arg(long, default_value = Coordinates::NAMES[0], value_parser = Coordinates::NAMES, value_name = "COORDINATES")]
    pub coordinates: String,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Print the fit and every check besides.
    #[arg(long, conflicts_with_all = ["json", "quiet"])]
    pub verbose: bool,
    /// No repairs: what would be repaired is an error.
    #[arg(long)]
    pub strict: bool,
    /// Read the whole rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
    /// What is done about a finding of a telemetry check: held, stuck, saturation, outlier (exclude, report,
    /// refuse), placeholder (report, exclude, refuse), gap, lag, motor_torque
    /// (report, refuse), units (refuse, report).
    #[arg(long, value_name = "CHECK=POLICY")]
    pub policy: Vec<String>,
    /// How telemetry is taken out of its files.
    #[command(flatten)]
    pub rows: Rows,
}

/// Which rows of telemetry are taken, and how their text is read.
#[derive(Debug, Args)]
pub struct Rows {
    /// Take the rows between these times, s.
    #[arg(long, value_name = "FROM,TO", value_parser = span)]
    pub time_s: Option<[f64; 2]>,
    /// Take every n-th row; 1 takes all.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub every: usize,
    /// Most memory for the samples of one file, MiB: 256, of `identify` 64, which needs about ten times as much
    /// in all. `inspect` looks at larger files in parts.
    #[arg(long, value_name = "MIB")]
    pub memory_mib: Option<usize>,
    /// Encoding of CSV text.
    #[arg(long, value_enum, default_value_t = TextEncoding::Utf8)]
    pub encoding: TextEncoding,
}

/// Encodings of CSV text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum TextEncoding {
    /// UTF-8.
    Utf8,
    /// ISO 8859-1.
    Latin1,
}

impl From<TextEncoding> for poinsot_telemetry::Encoding {
    fn from(encoding: TextEncoding) -> Self {
        match encoding {
            TextEncoding::Utf8 => Self::Utf8,
            TextEncoding::Latin1 => Self::Latin1,
        }
    }
}

fn span(text: &str) -> Result<[f64; 2], String> {
    let wanted = || "two times in seconds, the first before the second: FROM,TO".to_owned();
    let (from, to) = text.split_once(',').ok_or_else(wanted)?;
    let parse = |t: &str| t.trim().parse::<f64>().map_err(|_| wanted());
    let (from, to) = (parse(from)?, parse(to)?);
    if from < to {
        Ok([from, to])
    } else {
        Err(wanted())
    }
}

/// Arguments of `import`.
#[derive(Debug, Args)]
pub struct Import {
    /// Robot (URDF).
    #[arg(value_name = "ROBOT.urdf")]
    pub urdf: PathBuf,
    /// Model file to write; standard output without.
    #[arg(long, short = 'o', value_name = "MODEL.toml")]
    pub out: Option<PathBuf>,
    /// Print what was written as JSON on standard output.
    #[arg(long, requires = "out")]
    pub json: bool,
    /// Print nothing but errors, and the file where no --out is given; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct Export {
    /// Folder with estimate.json.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Kind of file.
    #[arg(long, value_name = "FORMAT", value_parser = Words::targets())]
    pub to: String,
    /// The file that the vehicle came from, for model, urdf, sdf and mjcf: bodies are found by their names, and nothing
    /// but their mass properties changes.
    #[arg(long, value_name = "FILE")]
    pub onto: Option<PathBuf>,
    /// File to write; standard output without.
    #[arg(long, short = 'o', value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print what was written as JSON on standard output.
    #[arg(long, requires = "out")]
    pub json: bool,
    /// Print nothing but errors, and the file where no --out is given; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `explain`.
#[derive(Debug, Args)]
pub struct Explain {
    /// Code, for example E0203.
    pub code: Option<String>,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code says whether there is such a code; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `methods`.
#[derive(Debug, Args)]
pub struct Methods {
    /// One method; all without it.
    pub name: Option<String>,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code says whether there is such a method; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `study`.
#[derive(Debug, Args)]
pub struct Study {
    /// One paper, by its method; all without it.
    #[arg(value_parser = Words::papers(), hide_possible_values = true)]
    pub paper: Option<String>,
    /// One of its studies, or `all`; their list without it.
    #[arg(value_parser = Words::studies(), hide_possible_values = true)]
    pub name: Option<String>,
    /// Folder of the project's examples, which the studies read.
    #[arg(long, value_name = "DIR", default_value = "examples")]
    pub examples: PathBuf,
    /// Folder for every table as CSV and every figure; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Formats of the figures: svg, png, or both.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT", requires = "out")]
    pub figures: Vec<FigureFile>,
    /// Print as JSON, numbers with all their digits.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// Case (TOML, poinsot.case/2).
    pub case: PathBuf,
    /// Folder for telemetry and truth.json; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Print what was written as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `predict`.
#[derive(Debug, Args)]
pub struct Predict {
    /// Cases (TOML, poinsot.case/2); the numbers of their models are taken as the truth. Several are compared.
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Folder for prediction.json, of several cases in a folder with the name of each; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Give the sigmas also for the record ended after each twelfth of its time.
    #[arg(long)]
    pub durations: bool,
    /// One sigma, relative to the nominal value, up to which a direction counts as identifiable.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `design`.
#[derive(Debug, Args)]
pub struct Design {
    /// Case (TOML, poinsot.case/2) with the tables want, limits and design.
    pub case: PathBuf,
    /// Folder for case.toml (the manoeuvre), model.toml, commands.csv, firings.csv and design.json; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// End the search after this many minutes with the best manoeuvre so far.
    #[arg(long, value_name = "N")]
    pub minutes: Option<f64>,
    /// Fly the manoeuvre N times with vehicles of the prior and sensor noise, identify, and compare with the prediction.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub verify: u64,
    /// Also the largest ratio with one kind of limit tighter and looser: duration, joint-rates, wheel-speeds, body-rate,
    /// propellant, ...
    #[arg(long, value_name = "LIMIT")]
    pub front: Option<String>,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `validate`.
#[derive(Debug, Args)]
pub struct Validate {
    /// Case (TOML, poinsot.case/2) that says what drives the vehicle; not needed for held-back telemetry.
    pub case: Option<PathBuf>,
    /// Model of the vehicle (TOML, poinsot.model/1); that of the case where it is not given.
    #[arg(long, value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// Estimate made with this model (folder of identify --out, or estimate.json): its numbers replace the nominal
    /// ones. Where it leaves some open, the combinations it determines are enough, and whether they are is tried.
    #[arg(long, value_name = "DIR")]
    pub estimate: Option<PathBuf>,
    /// Another model (.toml), or telemetry of one record (CSV or Parquet, files joined by commas).
    #[arg(long, value_name = "MODEL.toml|FILE[,FILE]")]
    pub against: String,
    /// File whose `[telemetry]` table replaces that of the model.
    #[arg(long, value_name = "MAP.toml")]
    pub map: Option<PathBuf>,
    /// Largest acceptable difference of base position and prismatic joints, m.
    #[arg(long, value_name = "METRES")]
    pub within_m: Option<f64>,
    /// Largest acceptable difference of attitude and revolute joints, rad.
    #[arg(long, value_name = "RADIANS")]
    pub within_rad: Option<f64>,
    /// Folder for validation.json and histories.csv; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// No repairs: what would be repaired is an error.
    #[arg(long)]
    pub strict: bool,
    /// Read the whole rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
}

/// For whom scripts are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// Slurm: an array of tasks and a merge.
    Slurm,
}

/// Arguments of `campaign`.
#[derive(Debug, Args)]
pub struct Campaign {
    /// Plan (TOML, poinsot.plan/1).
    #[arg(value_name = "PLAN.toml")]
    pub plan: PathBuf,
    /// Folder for shards, campaign.json and campaign.html; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Trials of every cell, instead of those of the plan. Shards that are there count.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub trials: Option<u64>,
    /// Run what is missing in the folder; without it a folder that has shards of this plan is refused.
    #[arg(long)]
    pub resume: bool,
    /// Run one of n shares of the shards and merge nothing: 1/4 to 4/4.
    #[arg(long, value_name = "I/N", value_parser = share, conflicts_with_all = ["until", "follow", "merge", "processes"])]
    pub shard: Option<(u64, u64)>,
    /// Merge shards that are there, and those in these folders, into the result.
    #[arg(long, value_name = "DIR", num_args = 0.., conflicts_with_all = ["until", "follow", "resume"])]
    pub merge: Option<Vec<PathBuf>>,
    /// Merge what is there, and name what is missing.
    #[arg(long, requires = "merge")]
    pub partial: bool,
    /// Stop where every 95 % interval of coverage is this near to its value: coverage=0.5%. Looks at 1000, 2000, 4000 ...
    /// complete trials, the error of the interval split among the looks.
    #[arg(long, value_name = "coverage=PERCENT", value_parser = until)]
    pub until: Option<f64>,
    /// Show the statistics while trials are run.
    #[arg(long)]
    pub follow: bool,
    /// Run the shards in this many processes; one that crashes is named and started again.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    pub processes: Option<u64>,
    /// Measure a few trials and print core-hours, disk and memory of this plan, of 10^6 and of 10^9 trials.
    #[arg(long)]
    pub estimate: bool,
    /// Write scripts for a scheduler into DIR/slurm, and run nothing.
    #[arg(long, value_enum, value_name = "SCHEDULER", requires = "out")]
    pub emit: Option<Emit>,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

fn share(text: &str) -> Result<(u64, u64), String> {
    let wanted = || "write I/N, for example 1/4: the first of four shares".to_owned();
    let (i, n) = text.split_once('/').ok_or_else(wanted)?;
    match (i.trim().parse(), n.trim().parse()) {
        (Ok(i), Ok(n)) if 1 <= i && i <= n => Ok((i, n)),
        _ => Err(wanted()),
    }
}

fn until(text: &str) -> Result<f64, String> {
    let wanted = || "write coverage=0.5%: half the width of the interval".to_owned();
    let (what, value) = text.split_once('=').ok_or_else(wanted)?;
    let percent = value
        .trim()
        .strip_suffix('%')
        .and_then(|v| v.trim().parse::<f64>().ok());
    match percent {
        Some(p) if what.trim() == "coverage" && p > 0.0 && p < 50.0 => Ok(p / 100.0),
        _ => Err(wanted()),
    }
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub struct Sweep {
    /// Case (TOML, poinsot.case/2); the numbers of its model are the truth.
    pub case: PathBuf,
    /// Model as the identification knows it; that of the case where it is not given.
    #[arg(long, value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// A number of case or model with its values: noise=1,2,5 (a factor on all declared noise), gyro.noise=1,2,
    /// body.arm.mass_kg=10:20:6, output.rate_hz=1:100:5:log. Repeat for a grid.
    #[arg(long, value_name = "ADDRESS=VALUES")]
    pub vary: Vec<String>,
    /// Method, or METHOD/VARIANT; all are put to the same trials. Repeat to compare.
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    pub method: Vec<String>,
    /// Setting of a published method, or METHOD.KEY=VALUE; `poinsot methods NAME` lists them.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Trials of every point.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub trials: u64,
    /// Seed; that of the case where it is not given.
    #[arg(long)]
    pub seed: Option<u64>,
    /// Folder for shards, campaign.json and campaign.html; without it nothing is kept.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Run what is missing in the folder.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// Folders of identify --out, or their estimate.json; two or more. Telemetry of different answers must be different.
    #[arg(value_name = "ANSWER", required = true)]
    pub answers: Vec<PathBuf>,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `schema`.
#[derive(Debug, Args)]
pub struct Schema {
    /// Format: model, map, case, plan, estimate, truth, prediction, validation, comparison, design, campaign, onboard; an
    /// unknown name lists all.
    #[arg(value_name = "NAME", default_value = "model")]
    pub name: String,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct Report {
    /// Folder of `identify --out`, `validate --out`, `design --out` or `campaign --out`, or the file of a result: what `predict --json`
    /// and `compare --json` print, kept as prediction.json or comparison.json.
    #[arg(value_name = "DIR|FILE")]
    pub result: PathBuf,
    /// Earlier answer of the same vehicle to compare with, in a section of its own; may be given several times.
    #[arg(long, value_name = "DIR")]
    pub compare: Vec<PathBuf>,
    /// Also write every figure of the page as a file of its own, DIR/figures: svg, png, or both.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT")]
    pub figures: Vec<FigureFile>,
    /// Print what was written as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct Inspect {
    /// Telemetry (CSV or Parquet); files of one segment joined by commas.
    pub telemetry: String,
    /// Model whose `[telemetry]` table and mountings of sensors are used.
    #[arg(long, value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// File with a `[telemetry]` table: columns that are not standard names, rows to keep. It replaces that of the model.
    #[arg(long, value_name = "MAP.toml")]
    pub map: Option<PathBuf>,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Read the whole rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
    /// How telemetry is taken out of its files.
    #[command(flatten)]
    pub rows: Rows,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// Model (TOML or URDF), map of telemetry, case, plan, or answer of `identify`.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `units`.
#[derive(Debug, Args)]
pub struct Units {
    /// Print as JSON, with the factors to SI.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell.
    pub shell: clap_complete::Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
pub struct Man {
    /// Folder for poinsot.1 and the pages of its commands; made if it is not there.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Print what was written as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors; not together with --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}
