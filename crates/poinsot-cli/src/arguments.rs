//! The words of the command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Exit codes with their meaning.
pub const EXIT_CODES: [(u8, &str); 5] = [
    (0, "answered: every number asked for is determined"),
    (
        1,
        "answered, but not acceptable: partial, not identifiable, rejected, not settled, or too many samples left out",
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
    /// Exit code 0: every number asked for is determined. 1: answered, but not all of it is (partial, not
    /// identifiable, rejected). 2: bad usage, model or telemetry. 3: disk or permission.
    Identify(Identify),
    /// Simulate a case: prescribed joint motion, wheels, thrusters, sensors with noise.
    Simulate(Simulate),
    /// Say how accurate a planned manoeuvre will be, before it is flown (Cramer-Rao bound).
    ///
    /// Exit code 0: every number asked for will be determined. 1: not all of it. 2: bad usage, case or model.
    Predict(Predict),
    /// Make the answer of `identify` in a folder into one page, report.html, that needs no network.
    Report(Report),
    /// Say what a telemetry file holds and whether its conventions fit the gyro.
    Inspect(Inspect),
    /// Check a model file and say what it describes.
    Check(Check),
    /// Print the JSON Schema of the model file.
    Schema,
    /// Print the completions of a shell, to be read by it at its start.
    Completions(Completions),
    /// Write the manual pages, one per command.
    Man(Man),
}

/// A format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
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
    /// Method: auto (linear, then maximum likelihood), linear, maximum_likelihood; published methods:
    /// kim2010, ma2008.
    #[arg(long, default_value = "auto")]
    pub method: String,
    /// Variant of a method. Of maximum likelihood: gaussian (default), huber, student_t, the loss of a
    /// reading. Of kim2010: suggested (default), batch, conventional, pre-estimate, iterated. Of ma2008:
    /// unknown-momentum (default), known-momentum.
    #[arg(long)]
    pub variant: Option<String>,
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
    pub figures: Vec<Format>,
    /// One sigma, relative to the nominal value, up to which a direction counts as identifiable.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// Print the result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// No repairs: what would be repaired is an error.
    #[arg(long)]
    pub strict: bool,
    /// Read the whole rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// Case (TOML, poinsot.case/1).
    pub case: PathBuf,
    /// Folder for telemetry and truth.json; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Print what was written as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `predict`.
#[derive(Debug, Args)]
pub struct Predict {
    /// Case (TOML, poinsot.case/1); the numbers of its model are taken as the truth.
    pub case: PathBuf,
    /// One sigma, relative to the nominal value, up to which a direction counts as identifiable.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct Report {
    /// Folder with estimate.json and report_data.json, as `identify --out` writes them.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Also write every figure of the page as a file of its own, DIR/figures: svg, png, or both.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT")]
    pub figures: Vec<Format>,
    /// Print what was written as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct Inspect {
    /// Telemetry (CSV or Parquet); files of one segment joined by commas.
    pub telemetry: String,
    /// File with a `[telemetry]` table: columns that are not standard names, rows to keep.
    #[arg(long, value_name = "MAP.toml")]
    pub map: Option<PathBuf>,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// Model of the vehicle (TOML, poinsot.model/1).
    pub model: PathBuf,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors: the exit code is the answer.
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
    /// Print nothing but errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}
