//! One function per verb, shared by the command line, Python and the tests.
#![allow(non_snake_case)]

pub mod bind;
pub mod case;
pub mod compare;
mod diagnostics_file;
mod error;
mod estimate_file;
mod estimate_text;
pub mod explain;
pub mod export;
pub mod identify;
pub mod methods;
mod mixups;
mod output;
pub mod predict;
mod progress;
pub mod report;
mod schema;
pub mod simulate;
pub mod trials;
pub mod validate;
mod verdict;

pub use error::Error;
pub use estimate_file::{estimate_file, estimate_json};
pub use estimate_text::estimate_document;
pub use identify::{
    Identified, IdentifyRequest, Question, Reading, identify, identify_tables, segment_files,
};
pub use output::{write_estimate, write_file, write_files, write_result};
pub use poinsot_formats::EstimateFile;
pub use poinsot_identify::Coordinates;
pub use report::{write_figures, write_report, write_report_data};
pub use schema::schema;
