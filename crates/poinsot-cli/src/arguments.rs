//! The command line.

use crate::words::Words;
use clap::{Args, Parser, Subcommand};
use poinsot::{Coordinates, Modes};
use poinsot_telemetry::Encoding;
use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::str::FromStr;

/// Exit codes with their meaning.
pub const EXIT_CODES: [(u8, &str); 5] = [
    (
        0,
        "every requested parameter is identified and every check passed",
    ),
    (
        1,
        "answered, but some parameter is not identified or some check failed",
    ),
    (2, "invalid arguments, model, case or telemetry"),
    (3, "disk or permission"),
    (4, "internal error"),
];

/// Mass, centre of mass and inertia of spacecraft and space robots, from telemetry.
#[derive(Debug, Parser)]
#[command(
    name = "poinsot",
    version,
    after_help = "Examples:\n  poinsot init flight.csv -o model.toml\n  poinsot identify model.toml flight.csv --out answer --report\n  poinsot identify --help"
)]
pub struct Arguments {
    /// Memory that the work may need by its estimate, MiB. Default: 80 % of what is free.
    #[arg(long, value_name = "MIB", global = true, value_parser = clap::value_parser!(u64).range(1..=1 << 32))]
    pub limit_memory: Option<u64>,
    /// Hours that the work may take: it ends where it has taken longer, or will by the least estimate of its time.
    #[arg(long, value_name = "HOURS", global = true, default_value_t = 24.0, value_parser = hours)]
    pub limit_hours: f64,
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

fn hours(text: &str) -> Result<f64, String> {
    let hours = text.parse().ok().filter(|h| (0.0..=1e6).contains(h));
    hours.ok_or_else(|| "write a number of hours, at most 1e6".to_owned())
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Identify the unknown mass properties of a vehicle from its telemetry.
    ///
    /// Exit code 0: every requested parameter is identified and every check passed. 1: some parameter is not identified or
    /// some check failed. 2: invalid arguments, model or telemetry. 3: disk or permission. 4: internal error.
    #[command(
        after_help = "Examples:\n  poinsot identify model.toml flight.csv\n  poinsot identify -m model.toml day1.csv day2.csv --out answer --report"
    )]
    Identify(Identify),
    /// Estimate recursively while rows of telemetry arrive: one line of JSON per second of the record.
    ///
    /// Rows come from standard input or a file, in the formats and maps of `identify`. The health word of a line is converging,
    /// determined, inconsistent or stale; an undetermined value is null. At the end, or on Ctrl-C, --out gets the files of
    /// `identify` for all that was read. Exit code 0: determined at the end. 1: not. 2: invalid arguments, model or telemetry.
    /// 3: disk or permission.
    #[command(
        after_help = "Examples:\n  tail -n +1 -f flight.csv | poinsot follow model.toml\n  poinsot follow model.toml flight.csv --wait --out answer"
    )]
    Follow(Follow),
    /// Simulate a case: prescribed and driven joints, springs, wheels, thrusters, sensors with noise.
    #[command(after_help = "Example: poinsot simulate case.toml --out flight")]
    Simulate(Simulate),
    /// Predict the accuracy of a planned manoeuvre before it is flown (Cramer-Rao bound).
    ///
    /// Exit code 0: every requested parameter will be identified. 1: some will not. 2: invalid arguments, case or model.
    #[command(after_help = "Example: poinsot predict case.toml --durations")]
    Predict(Predict),
    /// Design a manoeuvre that reaches the wanted sigmas of a case within its limits.
    ///
    /// Exit code 0: every wanted sigma is reached, and trial flights (--verify) agree. 1: otherwise; the answer names the
    /// active limits. 2: invalid arguments, case or model. 3: disk or permission. An interruption (Ctrl-C) ends the search with the
    /// best manoeuvre so far; a second one ends the program.
    #[command(after_help = "Example: poinsot design case.toml --minutes 2 --out manoeuvre")]
    Design(Design),
    /// Compare the motion of a model, or of an estimate, with another model or with telemetry.
    ///
    /// With a case: both vehicles move under its torques, wheels and thrust, or its motion is compared with telemetry.
    /// Without a case: the vehicle predicts a held-back record. Exit code 0: the differences are within the limits or the
    /// declared noise. 1: they are larger, or the motion depends on undetermined numbers. 2: invalid arguments, model,
    /// case or telemetry. 3: disk or permission.
    #[command(
        after_help = "Example: poinsot validate --model model.toml --estimate answer --against held_back.csv"
    )]
    Validate(Validate),
    /// Compare answers of one vehicle: before and after refuelling, two nights, two methods.
    ///
    /// Exit code 0: they agree. 1: they differ, share telemetry, or one of them is not reliable. 2: invalid arguments or
    /// files.
    #[command(after_help = "Example: poinsot compare before after")]
    Compare(Compare),
    /// Repeat experiments with new noise many times: bias, error over bound, coverage, failures.
    ///
    /// The plan has experiments, methods, varied numbers and random numbers. Exit code 0: every trial was run.
    /// 1: shards are missing, a trial crashed, or `--until` was not reached. 2: invalid plan, or shards of another plan. 3:
    /// disk or permission.
    #[command(after_help = "Example: poinsot campaign plan.toml --out trials")]
    Campaign(Campaign),
    /// Vary numbers of one case and compare methods: errors, bounds, figures. A campaign of one case.
    #[command(after_help = "Example: poinsot sweep case.toml --vary noise=1,3 --trials 20")]
    Sweep(Sweep),
    /// Write a result of identify, validate, predict, compare, design or campaign as one page, report.html, without network.
    #[command(after_help = "Example: poinsot report answer")]
    Report(Report),
    /// Summarise a telemetry file, propose its map, and test its conventions against the gyro.
    #[command(
        after_help = "Examples:\n  poinsot inspect flight.csv\n  poinsot inspect flight.csv --model model.toml"
    )]
    Inspect(Inspect),
    /// Draft a model file from telemetry: channels, units, conventions and noise from the files, a question for the rest.
    ///
    /// In a terminal it asks the questions; otherwise they are marked lines of the file, which `check` and `identify` refuse
    /// until they are answered. Exit code 0: every question is answered. 1: the printed ones are open. 2: invalid arguments
    /// or telemetry. 3: disk or permission.
    #[command(
        after_help = "Examples:\n  poinsot init flight.csv\n  poinsot init aocs.csv tracker.csv -o model.toml\n  poinsot init arm.csv --urdf robot.urdf"
    )]
    Init(Init),
    /// Check a model, map, case, plan or answer, and print its content.
    #[command(after_help = "Example: poinsot check model.toml")]
    Check(Check),
    /// Convert a URDF file into a model file (poinsot.model/1), or a table of modes into its `[[mode]]` tables.
    #[command(
        after_help = "Examples:\n  poinsot import robot.urdf -o model.toml\n  poinsot import modes.csv --body bus >> model.toml"
    )]
    Import(Import),
    /// Write the answer of `identify` into the file of another program.
    ///
    /// Exit code 1: some bodies are not fully determined and keep their values.
    #[command(
        after_help = "Example: poinsot export answer --to urdf --onto robot.urdf -o robot_identified.urdf"
    )]
    Export(Export),
    /// Explain an error code: meaning, usual cause and remedy. Without a code, explain all.
    #[command(after_help = "Example: poinsot explain E0203")]
    Explain(Explain),
    /// List the units of a telemetry map, by quantity.
    #[command(after_help = "Example: poinsot units --json")]
    Units(Units),
    /// List the methods of `identify` with their variants and papers.
    #[command(after_help = "Example: poinsot methods xu2017")]
    Methods(Methods),
    /// Reproduce the tables, figures and claims of a published paper. Without a name, list the studies.
    ///
    /// Exit code 0: computed. 2: no such study, or no folder of data. 3: disk or permission.
    #[command(after_help = "Example: poinsot study ma2008 exact --out tables")]
    Study(Study),
    /// Print the JSON Schema of a file format.
    #[command(after_help = "Example: poinsot schema plan > plan.schema.json")]
    Schema(Schema),
    /// Print a shell completion script.
    #[command(after_help = "Example: poinsot completions zsh > ~/.zfunc/_poinsot")]
    Completions(Completions),
    /// Write the manual pages, one per command.
    #[command(after_help = "Example: poinsot man ~/.local/share/man/man1")]
    Man(Man),
}

/// How a result is printed.
#[derive(Debug, Args)]
pub struct Print {
    /// Print the result, or what was written, as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Print only errors; the exit code tells the result. Excludes --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `identify`.
#[derive(Debug, Args)]
pub struct Identify {
    /// Telemetry of one segment (CSV or Parquet); files of one segment joined by commas. Give more for more
    /// segments: the bodies are shared, each has its own initial momentum. Without `--model` a file .toml among them is the model.
    #[arg(value_name = "FILE[,FILE]", required_unless_present = "telemetry")]
    pub files: Vec<OsString>,
    /// Model of the vehicle (TOML, poinsot.model/1); `poinsot init` drafts one. Required.
    #[arg(long, short = 'm', value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// Telemetry of one more segment, before those without a name of an option.
    #[arg(long, short = 't', value_name = "FILE[,FILE]")]
    pub telemetry: Vec<OsString>,
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
    /// Folder for estimate.json; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also write the report, DIR/report.html.
    #[arg(long, requires = "out")]
    pub report: bool,
    /// Also write every figure as a file in DIR/figures: svg, or png if built with the feature `png`.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT", value_parser = ["svg", "png"], requires = "out")]
    pub figures: Vec<String>,
    /// Largest half-width of the 95 % interval, relative to nominal, of a number that is printed.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// Coordinates of the fit: physical keeps every unknown body physical, linear allows a tensor that is not physical
    #[arg(long, default_value = Coordinates::NAMES[0], value_parser = Coordinates::NAMES, value_name = "COORDINATES")]
    pub coordinates: String,
    /// Flexible modes that the model does not declare: found adds those that the data show, none keeps it rigid
    #[arg(long, default_value = Modes::NAMES[0], value_parser = Modes::NAMES, value_name = "MODES")]
    pub modes: String,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
    /// Also print the fit and every check.
    #[arg(long, conflicts_with_all = ["json", "quiet"])]
    pub verbose: bool,
    /// Treat every repair as an error.
    #[arg(long)]
    pub strict: bool,
    /// Apply the lines of a map that a check or the diagnosis proposes, identify again, and list them among the repairs. The model file
    /// stays as it is.
    #[arg(long, conflicts_with = "strict")]
    pub repair: bool,
    /// Keep the complete rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
    /// Policy for a failed telemetry check. held, stuck, saturation, outlier: exclude, report, refuse. placeholder: report,
    /// exclude, refuse. gap, lag, motor_torque: report, refuse. units, wrap: refuse, report.
    #[arg(long, value_name = "CHECK=POLICY")]
    pub policy: Vec<String>,
    /// How telemetry is read from its files.
    #[command(flatten)]
    pub rows: Rows,
}

/// Which rows of telemetry are read, and in which encoding.
#[derive(Debug, Args)]
pub struct Rows {
    /// Read the rows between these times, s: those of the files, or since the first sample where the files count from 1e7 s
    /// or more.
    #[arg(long, value_name = "FROM,TO", value_parser = span)]
    pub time_s: Option<[f64; 2]>,
    /// Read every n-th row; 1 reads all.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub every: usize,
    /// Memory limit for the samples of one file, MiB. Default: 256; 64 for `identify`, which needs about ten times as much
    /// in total. `inspect` reads larger files in parts.
    #[arg(long, value_name = "MIB")]
    pub memory_mib: Option<usize>,
    /// Encoding of CSV text.
    #[arg(long, default_value = Encoding::NAMES[0], value_parser = Encoding::NAMES, value_name = "ENCODING")]
    pub encoding: String,
}

fn span(text: &str) -> Result<[f64; 2], String> {
    let [from, to] = pair(text, ',').unwrap_or([f64::NAN; 2]);
    let wanted = "give two increasing times in seconds: FROM,TO";
    if from < to {
        Ok([from, to])
    } else {
        Err(wanted.to_owned())
    }
}

/// Two numbers.
fn pair<T: FromStr>(text: &str, between: char) -> Option<[T; 2]> {
    let (a, b) = text.split_once(between)?;
    Some([a.trim().parse().ok()?, b.trim().parse().ok()?])
}

/// Arguments of `import`.
#[derive(Debug, Args)]
pub struct Import {
    /// Robot (URDF), or a table of modes (CSV) as finite-element programs print it: frequency and mass-normalised participation
    /// factors T1, T2, T3, R1, R2, R3 about the origin of the body's frame, the body held.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Model file to write. Default: standard output.
    #[arg(long, short = 'o', value_name = "MODEL.toml")]
    pub out: Option<PathBuf>,
    /// Link to be the base, for example that of the gyro: its frame is that of the body axes. Joints between it and the root are
    /// reversed and keep their positions; one that moves gets a new link without mass, named NAME_frame. Default: the root.
    #[arg(long, value_name = "LINK")]
    pub base: Option<String>,
    /// Body that carries the modes of a table.
    #[arg(long, value_name = "BODY", conflicts_with_all = ["base", "allow_massless"])]
    pub body: Option<String>,
    /// Fix links to their parents that move without mass (dummy links), instead of refusing them.
    #[arg(long)]
    pub allow_massless: bool,
    /// Print what was written as JSON on standard output.
    #[arg(long, requires = "out")]
    pub json: bool,
    /// Print only errors, and the file without --out; excludes --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `follow`.
#[derive(Debug, Args)]
pub struct Follow {
    /// Model file.
    pub model: PathBuf,
    /// File of rows (CSV); `-` reads standard input.
    #[arg(default_value = "-")]
    pub file: PathBuf,
    /// File whose `[telemetry]` table replaces that of the model.
    #[arg(long, value_name = "FILE")]
    pub map: Option<PathBuf>,
    /// Time of the record between two lines, s.
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0)]
    pub line_s: f64,
    /// Wait at the end of the file for rows that are appended, until Ctrl-C.
    #[arg(long)]
    pub wait: bool,
    /// Wanted half-width of the 95 % intervals, relative to mass, radius of gyration and mean moment of inertia.
    #[arg(long, value_name = "SHARE", default_value_t = 0.01)]
    pub relative_accuracy: f64,
    /// Show a page with live curves at this address, as 127.0.0.1:8000; port 0 takes a free one. Beyond this computer, the
    /// address of the page has a secret word.
    #[arg(long, value_name = "ADDRESS")]
    pub serve: Option<SocketAddr>,
    /// Identify all rows so far every so many seconds of the record, in the background, and give the verdict beside the filter's.
    #[arg(long, value_name = "SECONDS")]
    pub certify: Option<f64>,
    /// Folder for the files of `identify` at the end, with a copy of the rows from standard input.
    #[arg(long, short = 'o', value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print no assumptions.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct Export {
    /// Folder with estimate.json; or a model file, for the table of the on-board filter.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Kind of file.
    #[arg(long, value_name = "FORMAT", value_parser = Words::targets())]
    pub to: String,
    /// Source file of the vehicle, for model, urdf, sdf and mjcf. Only the mass properties of bodies with equal names
    /// change. For onboard: the model whose filter begins with this answer.
    #[arg(long, value_name = "FILE")]
    pub onto: Option<PathBuf>,
    /// Export numbers that are not reliable too; the file says why they are not.
    #[arg(long)]
    pub accept_unreliable: bool,
    /// File to write. Default: standard output.
    #[arg(long, short = 'o', value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print what was written as JSON on standard output.
    #[arg(long, requires = "out")]
    pub json: bool,
    /// Print only errors, and the file without --out; excludes --json.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
}

/// Arguments of `explain`.
#[derive(Debug, Args)]
pub struct Explain {
    /// Code, for example E0203.
    pub code: Option<String>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `methods`.
#[derive(Debug, Args)]
pub struct Methods {
    /// One method; all without it.
    pub name: Option<String>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `study`.
#[derive(Debug, Args)]
pub struct Study {
    /// Method of one paper; without it, all papers.
    #[arg(value_parser = Words::papers(), hide_possible_values = true)]
    pub paper: Option<String>,
    /// One of its studies, or `all`; without it, their list.
    #[arg(value_parser = Words::studies(), hide_possible_values = true)]
    pub name: Option<String>,
    /// Folder of the project's data.
    #[arg(long, value_name = "DIR", default_value = "data", alias = "examples")]
    pub data: PathBuf,
    /// Folder for every table as CSV and every figure; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Formats of the figures: svg, or png if built with the feature `png`.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT", value_parser = ["svg", "png"], requires = "out")]
    pub figures: Vec<String>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// Case (TOML, poinsot.case/2).
    pub case: PathBuf,
    /// Folder for telemetry and truth.json; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `predict`.
#[derive(Debug, Args)]
pub struct Predict {
    /// Cases (TOML, poinsot.case/2); their models are the truth. Several are compared.
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Folder for prediction.json, of several cases in a folder with the name of each; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Give the sigmas also for the record ended after each twelfth of its time.
    #[arg(long)]
    pub durations: bool,
    /// Largest half-width of the 95 % interval, relative to nominal, of a number that is printed.
    #[arg(long, default_value_t = 1.0)]
    pub relative_accuracy: f64,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `design`.
#[derive(Debug, Args)]
pub struct Design {
    /// Case (TOML, poinsot.case/2) with the tables want, limits and design.
    pub case: PathBuf,
    /// Folder for case.toml (the manoeuvre), model.toml, commands.csv, firings.csv and design.json; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Answer after which the manoeuvre is flown (folder of identify --out, or estimate.json): its values are the nominal ones,
    /// its covariance is what is known so far.
    #[arg(long, value_name = "DIR")]
    pub after: Option<PathBuf>,
    /// Design after an answer that is not reliable too.
    #[arg(long)]
    pub accept_unreliable: bool,
    /// Stop the search after N minutes with the best manoeuvre so far.
    #[arg(long, value_name = "N")]
    pub minutes: Option<f64>,
    /// Print each better manoeuvre while the search runs, as a line of JSON: largest ratio, duration, active limits.
    #[arg(long)]
    pub follow: bool,
    /// Simulate and identify N trial flights with vehicles drawn from the prior, and compare with the prediction.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub verify: u64,
    /// Also the largest ratio with one or two kinds of limits tighter and looser: duration, joint-rates, wheel-speeds, body-rate,
    /// propellant, ...; with the factors on the limit: wheel-speeds=0.5,1,2. Repeat it for a second limit.
    #[arg(long, value_name = "LIMIT[=FACTOR,...]")]
    pub front: Vec<String>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `validate`.
#[derive(Debug, Args)]
pub struct Validate {
    /// Case (TOML, poinsot.case/2) that drives the vehicle; not needed for held-back telemetry.
    pub case: Option<PathBuf>,
    /// Model of the vehicle (TOML, poinsot.model/1). Default: the model of the case.
    #[arg(long, short = 'm', value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// Estimate made with this model (folder of identify --out, or estimate.json): its numbers replace the nominal
    /// ones. Undetermined numbers are allowed if the motion does not depend on them, which is tested.
    #[arg(long, value_name = "DIR")]
    pub estimate: Option<PathBuf>,
    /// Another model (.toml), or telemetry of one record (CSV or Parquet, files joined by commas).
    #[arg(long, value_name = "MODEL.toml|FILE[,FILE]")]
    pub against: OsString,
    /// File whose `[telemetry]` table replaces that of the model.
    #[arg(long, value_name = "MAP.toml")]
    pub map: Option<PathBuf>,
    /// Largest acceptable difference of base position and prismatic joints, m.
    #[arg(long, value_name = "METRES")]
    pub within_m: Option<f64>,
    /// Largest acceptable difference of attitude and revolute joints, rad.
    #[arg(long, value_name = "RADIANS")]
    pub within_rad: Option<f64>,
    /// Folder for validation.json and histories.csv; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
    /// Treat every repair as an error.
    #[arg(long)]
    pub strict: bool,
    /// Keep the complete rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
}

/// Arguments of `campaign`.
#[derive(Debug, Args)]
pub struct Campaign {
    /// Plan (TOML, poinsot.plan/1).
    #[arg(value_name = "PLAN.toml")]
    pub plan: PathBuf,
    /// Folder for shards, campaign.json and campaign.html; created if missing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Trials of every cell, instead of the plan's number. Existing shards count.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub trials: Option<u64>,
    /// Run only the missing shards. Without it, a folder with shards of this plan is refused.
    #[arg(long)]
    pub resume: bool,
    /// Run part I of N of the shards without merging: 1/4 to 4/4.
    #[arg(long, value_name = "I/N", value_parser = share, conflicts_with_all = ["until", "follow", "merge", "processes"])]
    pub shard: Option<(u64, u64)>,
    /// Merge the existing shards, and those in these folders, into the result.
    #[arg(long, value_name = "DIR", num_args = 0.., conflicts_with_all = ["until", "follow", "resume"])]
    pub merge: Option<Vec<PathBuf>>,
    /// Merge the existing shards, and list the missing ones.
    #[arg(long, requires = "merge")]
    pub partial: bool,
    /// Stop when the half-width of every 95 % interval of coverage is below this: coverage=0.5%. It tests after 1000, 2000,
    /// 4000 ... trials and splits the error probability among the tests.
    #[arg(long, value_name = "coverage=PERCENT", value_parser = until)]
    pub until: Option<f64>,
    /// Show the statistics during the run.
    #[arg(long)]
    pub follow: bool,
    /// Run the shards in N processes; a crashed process is reported and restarted.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=4096))]
    pub processes: Option<u64>,
    /// Time a few trials, and print core-hours, disk and memory for this plan, 10^6 and 10^9 trials.
    #[arg(long)]
    pub estimate: bool,
    /// Write scheduler scripts into DIR/slurm without running anything.
    #[arg(long, value_parser = ["slurm"], value_name = "SCHEDULER", requires = "out")]
    pub emit: Option<String>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

fn share(text: &str) -> Result<(u64, u64), String> {
    match pair(text, '/') {
        Some([i, n]) if 1 <= i && i <= n => Ok((i, n)),
        _ => Err("write I/N, for example 1/4: the first of four shares".to_owned()),
    }
}

fn until(text: &str) -> Result<f64, String> {
    let (what, value) = text.split_once('=').unwrap_or_default();
    let percent = value.trim().strip_suffix('%').unwrap_or_default();
    match percent.trim().parse::<f64>() {
        Ok(p) if what.trim() == "coverage" && p > 0.0 && p < 50.0 => Ok(p / 100.0),
        _ => Err("write coverage=0.5%: half the width of the interval".to_owned()),
    }
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub struct Sweep {
    /// Case (TOML, poinsot.case/2); its model is the truth.
    pub case: PathBuf,
    /// Nominal model for the identification. Default: the model of the case.
    #[arg(long, short = 'm', value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// A number of case or model with its values: noise=1,2,5 (a factor on all declared noise), gyro.noise=1,2,
    /// body.arm.mass_kg=10:20:6, output.rate_hz=1:100:5:log. Repeat for a grid.
    #[arg(long, value_name = "ADDRESS=VALUES")]
    pub vary: Vec<String>,
    /// Method, or METHOD/VARIANT; all use the same trials. Repeat to compare.
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    pub method: Vec<String>,
    /// Setting of a published method, or METHOD.KEY=VALUE; `poinsot methods NAME` lists them.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Trials of every point.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub trials: u64,
    /// Seed. Default: the seed of the case.
    #[arg(long)]
    pub seed: Option<u64>,
    /// Folder for shards, campaign.json and campaign.html; without it, no file is written.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Run only the missing shards.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// Folders of identify --out, or their estimate.json; two or more. Telemetry of different answers must be different.
    #[arg(value_name = "ANSWER", required = true)]
    pub answers: Vec<PathBuf>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
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
    /// Folder of `identify`, `validate`, `design` or `campaign --out`; or the JSON of `predict` or `compare`, saved as
    /// prediction.json or comparison.json.
    #[arg(value_name = "DIR|FILE")]
    pub result: PathBuf,
    /// Earlier answer of the same vehicle, compared in an extra section. Repeatable.
    #[arg(long, value_name = "DIR")]
    pub compare: Vec<PathBuf>,
    /// Also write every figure as a file in DIR/figures: svg, or png if built with the feature `png`.
    #[arg(long, value_delimiter = ',', value_name = "FORMAT", value_parser = ["svg", "png"])]
    pub figures: Vec<String>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct Inspect {
    /// Telemetry (CSV or Parquet); files of one segment joined by commas.
    pub telemetry: OsString,
    /// Model with the `[telemetry]` table and the sensor mountings to use.
    #[arg(long, short = 'm', value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// File whose `[telemetry]` table replaces that of the model.
    #[arg(long, value_name = "MAP.toml")]
    pub map: Option<PathBuf>,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
    /// Keep the complete rows of a file that ends inside a row.
    #[arg(long)]
    pub recover: bool,
    /// How telemetry is read from its files.
    #[command(flatten)]
    pub rows: Rows,
}

/// Arguments of `init`.
#[derive(Debug, Args)]
pub struct Init {
    /// Telemetry of one record (CSV or Parquet).
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<OsString>,
    /// Robot of the joints (URDF).
    #[arg(long, value_name = "ROBOT.urdf")]
    pub urdf: Option<PathBuf>,
    /// Model file to write; it must not exist.
    #[arg(
        long,
        short = 'o',
        value_name = "MODEL.toml",
        default_value = "model.toml"
    )]
    pub out: PathBuf,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
    /// How telemetry is read from its files.
    #[command(flatten)]
    pub rows: Rows,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// Model (TOML or URDF), map of telemetry, case, plan, or answer of `identify`.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}

/// Arguments of `units`.
#[derive(Debug, Args)]
pub struct Units {
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
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
    /// Folder for poinsot.1 and the pages of its commands; created if missing.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// How the answer is printed.
    #[command(flatten)]
    pub print: Print,
}
