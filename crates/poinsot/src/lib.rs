//! One function per command, shared by the command line, Python and the tests.
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
pub use output::{estimate_text, write_estimate, write_result};
pub use poinsot_formats::EstimateFile;
pub use poinsot_identify::Coordinates;
pub use propose::{InspectionAnswer, inspect, inspection_file, proposed_map};
pub use report::write_report;
pub use schema::{schema, schema_names};
pub use threads::start_threads;
pub use units::units_file;
pub use written::{OutputFile, check_outputs, write_file, write_files};
