//! The words of the command line.

use clap::{Args, Parser, Subcommand};
use poinsot::Coordinates;
use std::path::PathBuf;

/// Mass, centre of mass and inertia of spacecraft and space robots, from telemetry.
#[derive(Debug, Parser)]
#[command(name = "poinsot", version, about)]
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
    /// Simulate a case: joints led or driven by torques, springs, wheels, thrusters, sensors with noise.
    Simulate(Simulate),
    /// Say how accurate a planned manoeuvre will be, before it is flown (Cramer-Rao bound).
    ///
    /// Exit code 0: every number asked for will be determined. 1: not all of it. 2: bad usage, case or model.
    Predict(Predict),
    /// Compare the motion of a model, or of an estimate, with another model or with telemetry.
    ///
    /// With a case: both sides under its torques, wheels and thrust; or its motion beside the telemetry. Without:
    /// what the vehicle predicts for a record that was held back. Exit code 0: compared, within the limits or the
    /// declared noise. 1: beyond them, or the motion depends on what the estimate leaves open. 2: bad usage, model,
    /// case or telemetry. 3: disk or permission.
    Validate(Validate),
    /// Make the answer of `identify` in a folder into one page, report.html, that needs no network.
    Report(Report),
    /// Say what a telemetry file holds and whether its conventions fit the gyro.
    Inspect(Inspect),
    /// Check a model file and say what it describes.
    Check(Check),
    /// Print the JSON Schema of the model file.
    Schema,
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
    /// kim2010, ma2008, xu2017.
    #[arg(long, default_value = "auto")]
    pub method: String,
    /// Variant of a method. Of maximum likelihood: gaussian (default), huber, student_t, the loss of a
    /// reading. Of kim2010: suggested (default), batch, conventional, pre-estimate, iterated. Of ma2008:
    /// unknown-momentum (default), known-momentum. Of xu2017: swarm (default), linear, swarm-inward,
    /// linear-inward.
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
    /// One sigma, relative to the nominal value, up to which a direction counts as identifiable.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// Coordinates of the fit's steps: log-cholesky keeps every unknown body physical, linear lets an impossible
    /// tensor pass.
    #[arg(long, default_value = Coordinates::NAMES[0], value_parser = Coordinates::NAMES, value_name = "COORDINATES")]
    pub coordinates: String,
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
    /// Print nothing but errors.
    #[arg(long)]
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
}

/// Arguments of `validate`.
#[derive(Debug, Args)]
pub struct Validate {
    /// Case (TOML, poinsot.case/1) that says what drives the vehicle; not needed for held-back telemetry.
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

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct Report {
    /// Folder with estimate.json and report_data.json, as `identify --out` writes them.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Print nothing but errors.
    #[arg(long)]
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
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// Model of the vehicle (TOML, poinsot.model/1).
    pub model: PathBuf,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}
