//! Mass, centre of mass and inertia of spacecraft and space robots, from telemetry. One function per command, shared by
//! the command line, Python and the tests.
//!
//! # The flow
//! A model file describes the vehicle: bodies, joints, wheels, thrusters, sensors, and which numbers are unknown.
//! Telemetry is a table of channels. [`identify()`] combines both:
//!
//! ```text
//! model.toml --.
//!              |--> identify --> Identified --> estimate.json, report.html
//! telemetry ---'
//! case.toml --> simulate --> telemetry, truth.json
//! case.toml --> predict ---> sigmas before the manoeuvre is flown
//! plan.toml --> campaign --> error, bias and coverage over many trials
//! ```
//!
//! | task | function | with data in memory |
//! |---|---|---|
//! | identify mass properties | [`identify()`] | [`identify_tables`], [`identify_records`] |
//! | simulate a case | [`simulate::simulate`] | [`simulate::simulate_case`] |
//! | predict the accuracy of a manoeuvre | [`predict::predict`] | [`predict::predict_case`] |
//! | compare the motion with another model or with telemetry | [`validate::validate`] | [`validate::compare_motion`] |
//! | compare answers | [`compare::compare`] | [`compare::compare_estimates`] |
//! | repeat experiments with new noise | [`campaign::campaign`] | [`campaign::campaign_in_memory`] |
//! | write the answer | [`write_estimate`], [`write_result`], [`write_report`] | [`estimate_file()`], [`result_files`] |
//! | write it for another program | [`export::export`] | [`export::export_estimate`] |
//! | check a file, inspect telemetry, draft a model | [`check::check`], [`inspect`], [`init`] | |
//! | reproduce a paper | [`study::find`], [`study::run`] | |
//!
//! The command `design`, which searches for a manoeuvre, is the crate `poinsot-design`.
//!
//! # Example
//! A box of 10 kg with three wheels. A case spins the wheels one after the other; the gyro measures how the box answers:
//!
//! ```
//! use poinsot::case::read_case;
//! use poinsot::simulate::simulate_case;
//! use poinsot::{Question, identify_tables};
//! use poinsot_identify::Status;
//! use std::path::Path;
//!
//! let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
//! let model = poinsot_model::read_model(folder.join("model.toml"))?;
//! let telemetry = simulate_case(&read_case(&folder.join("case.toml"))?, &model)?.table;
//!
//! let identified = identify_tables(model, vec![telemetry], &Question::default())?;
//! assert_eq!(identified.estimate.status, Status::Converged);
//!
//! // The true moments are 1, 2 and 2.5 kg m2.
//! let [I_xx, _, I_yy, _, _, I_zz] = identified.estimate.bodies[0].inertia;
//! for (number, truth) in [(I_xx, 1.0), (I_yy, 2.0), (I_zz, 2.5)] {
//!     let (value, sigma) = (number.value.unwrap(), number.sigma.unwrap());
//!     assert!((value - truth).abs() < 3.0 * sigma && sigma < 1.0e-3);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A number that the data do not determine has no value, and the answer says what would determine it. An invalid model,
//! case or telemetry is an [`Error`] with a code; [`explain::explain`] gives its cause and remedy.
//!
//! # Where to go next
//!
//! | crate | content |
//! |---|---|
//! | [`poinsot_model`] | the vehicle: model file, URDF |
//! | [`poinsot_telemetry`] | channels with unit, axes and time; CSV, Parquet, memory |
//! | [`poinsot_identify`] | estimators, identifiability, information |
//! | [`poinsot_dynamics`], [`poinsot_spatial`] | kinematics, momentum, regressors, motion; one rigid body |
//! | `poinsot-solve` | least squares, independent of spacecraft |
//! | [`poinsot_formats`], [`poinsot_report`], [`poinsot_figures`] | result files, what a reader sees of them, plots and pages |
//! | [`poinsot_papers`] | published methods, reproduced |
//!
//! The book of the project (`scripts/book build`) has tutorials, and the reference of commands and files.
//!
//! # Files
//! - `methods.rs`, `study.rs`, `identify.rs`, `simulate.rs`, `predict.rs`, `validate.rs`, `report.rs`: the commands.
//!   `report/` fills what a page draws.
//! - `trials.rs`, `trials/`: many trials of one set-up. `row.rs`: one trial by one method. `sums.rs`: statistics of rows.
//! - `campaign/`: many trials of many experiments. `plan.rs`: the checked plan. `address.rs`: numbers of case or model
//!   by address. `trial.rs`, `shard.rs`, `engine.rs`: one trial, a block of trials, all cores. `result.rs`: the result
//!   from the sums of shards. `run.rs`: resume and merge, around any engine; `python/poinsot/_cluster.py` is that of Dask and of
//!   object stores.
//! - `sweep.rs`: a plan of one case. `import.rs`: the command `import`. `progress.rs`: progress, and its listener.
//! - `check.rs`: the command `check`. `propose.rs`, `propose_sensors.rs`: the command `inspect`. `init.rs`, `draft.rs`: the command `init`.
//!   `file_head.rs`, `proposal.rs`, `survey.rs`: the map of files without one, for both.
//! - `bind/`: table and model become samples and noise. `bind/cut.rs`: pieces between gaps. `bind/free_fall.rs`:
//!   positions on an orbit.
//! - `case/`: the case file.
//! - `estimate_file.rs`: the answer as result file.
//! - `output.rs`: files of an estimate. `written.rs`: files of one answer, put in place together.
//! - `channel_names.rs`: standard names of a sensor. `threads.rs`: at most one thread per core.
//! - `guard.rs`: panics as errors. `error.rs`, `error/`: errors of the commands. `explain.rs`: every error code with cause and remedy.
//! - `export/`: the answer as a file of another program, one file per format. `onboard.rs`, `follow.rs`: the recursive filter
//!   for a model, and on a stream.
//! - `mass_numbers.rs`: mass, mass centre and inertia of a body, in one order.
//! - `mixups.rs`: unit errors that only the answer reveals. `identify/repair.rs`: repairs of the map, tried before they are advised.
#![allow(non_snake_case)]

#[doc(hidden)]
pub mod bind;
pub mod campaign;
pub mod case;
mod channel_names;
pub mod check;
pub mod compare;
mod draft;
mod error;
mod estimate_file;
pub mod explain;
pub mod export;
mod file_head;
mod follow;
mod guard;
pub mod identify;
mod import;
mod init;
mod mass_numbers;
pub mod methods;
mod mixups;
mod mode_table;
mod motor_torque;
pub mod onboard;
mod output;
pub mod posterior;
pub mod predict;
mod progress;
mod proposal;
mod propose;
mod propose_sensors;
pub mod report;
mod schema;
pub mod simulate;
pub mod study;
mod survey;
pub mod sweep;
mod threads;
#[doc(hidden)]
pub mod trials;
mod units;
pub mod validate;
mod written;

pub use draft::Draft;
pub use error::{Error, ErrorKind, Fault};
pub use estimate_file::estimate_file;
pub use follow::{Followed, Follower};
pub use guard::{guarded, panic_error};
#[doc(hidden)]
pub use identify::{Gated, gated};
pub use identify::{
    IDENTIFY_MIB, Identified, IdentifyRequest, Question, Reading, identify, identify_records,
    identify_tables, row_step, segment_files,
};
pub use import::import;
pub use init::init;
pub use mode_table::{ModeTable, import_modes};
pub use onboard::FollowedNumber;
pub use output::{estimate_text, result_files, write_estimate, write_result};
pub use poinsot_formats::EstimateFile;
pub use poinsot_identify::{Coordinates, Modes};
pub use progress::{Listener, Step, TRIALS};
pub use propose::{InspectionAnswer, inspect, inspection_file};
pub use report::write_report;
pub use schema::{schema, schema_names};
pub use threads::{start_threads, thread_count};
pub use units::units_file;
pub use written::{OutputFile, check_outputs, digests, result_json, write_file, write_files};
