//! One function per command, shared by the command line, Python and the tests.
//!
//! # Files
//! - `methods.rs`, `study.rs`, `identify.rs`, `simulate.rs`, `predict.rs`, `validate.rs`, `report.rs`: the commands.
//!   `report/` fills what a page draws.
//! - `trials.rs`, `trials/`: many trials of one set-up, their sums, bands and intervals.
//! - `campaign/`: many trials of many experiments. `plan.rs`: the checked plan. `address.rs`: numbers of case or model
//!   by address. `trial.rs`, `shard.rs`, `engine.rs`: one trial, a block of trials, all cores. `result.rs`: statistics
//!   from sums. `run.rs`: resume and merge, around any engine; `python/poinsot/_cluster.py` is that of Dask and of
//!   object stores.
//! - `sweep.rs`: a plan of one case.
//! - `check.rs`: the command `check`. `propose.rs`, `propose_sensors.rs`: the command `inspect`.
//! - `bind/`: table and model become samples and noise. `bind/cut.rs`: pieces between gaps. `bind/free_fall.rs`:
//!   positions on an orbit.
//! - `case/`: the case file.
//! - `estimate_file.rs`, `diagnostics_file.rs`: the answer as result file.
//! - `output.rs`: files of an estimate. `written.rs`: files of one answer, put in place together.
//! - `channel_names.rs`: standard names of a sensor. `threads.rs`: at most one thread per core.
//! - `error.rs`, `error/`: errors of the commands. `explain.rs`: every error code with cause and remedy.
//! - `export/`: the answer as a file of another program, one file per format.
//! - `mixups.rs`: unit and axis errors that only the answer reveals.
#![allow(non_snake_case)]

pub mod bind;
pub mod campaign;
pub mod case;
mod channel_names;
pub mod check;
pub mod compare;
mod diagnostics_file;
mod digest;
mod error;
mod estimate_file;
pub mod explain;
pub mod export;
mod fault_file;
pub mod identify;
mod import;
pub mod methods;
mod mixups;
mod motor_torque;
mod output;
pub mod predict;
mod progress;
mod propose;
mod propose_sensors;
pub mod report;
mod schema;
pub mod simulate;
pub mod study;
pub mod sweep;
mod threads;
pub mod trials;
mod units;
pub mod validate;
mod written;

pub use error::{Error, ErrorKind};
pub use estimate_file::estimate_file;
pub use identify::{
    Gated, Identified, IdentifyRequest, Question, Reading, gated, identify, identify_records,
    identify_tables, segment_files,
};
pub use import::import;
pub use output::{estimate_text, write_estimate, write_result};
pub use poinsot_formats::EstimateFile;
pub use poinsot_identify::Coordinates;
pub use progress::{Listener, Step};
pub use propose::{InspectionAnswer, inspect, inspection_file, proposed_map};
pub use report::write_report;
pub use schema::{schema, schema_names};
pub use threads::start_threads;
pub use units::units_file;
pub use written::{OutputFile, check_outputs, write_file, write_files};
