//! What a reader sees of every result: its document in the terminal and its page, from the result file alone.
//!
//! | result | document | page |
//! |---|---|---|
//! | estimate | [`estimate_document`] | [`report_html`], [`report_page`] |
//! | prediction | [`prediction_document`], [`several_document`] | [`result_page`] |
//! | validation | [`validation_document`] | [`result_page`] |
//! | comparison | [`comparison_document`] | [`result_page`], [`comparison_part`] |
//! | design | [`design_document`] | [`result_page`] |
//! | campaign | [`table_document`] | [`campaign_page`] |
//!
//! [`VERDICTS`] lists the words of an answer.
//!
//! # Example
//! The files of `doc` are results of the case of `crates/poinsot/doc`, and of the design of `crates/poinsot-design/doc`.
//!
//! ```
//! use poinsot_report::{Detail, RESULTS, VERDICTS, estimate_document, result_page};
//!
#![doc = include_str!("../doc/estimate.txt")]
//! let document = estimate_document(&estimate, Detail::Answer);
//! assert!(document.to_string().starts_with("box: Determined."));
//! assert!(VERDICTS.iter().any(|v| v.word == "Determined" && v.passes));
//!
//! assert!(RESULTS.contains(&"prediction.json"));
//! let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/prediction.json"));
//! let html = result_page("prediction.json".as_ref(), bytes, |_| None)?.html()?;
//! assert!(html.contains("<html"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Files
//! - `estimate.rs`, `prediction.rs`, `several.rs`, `validation.rs`, `comparison.rs`, `design.rs`, `campaign.rs`: one
//!   result each, in the terminal.
//! - `trials.rs`, `study.rs`, `description.rs`, `prediction_sentence.rs`, `design_sentence.rs`: documents and sentences of
//!   the other results.
//! - `verdict.rs`, `summary.rs`, `checks.rs`: the words of an answer, for terminal and page.
//! - `page/`: the page, one file and one template per section. `page/results/`: pages of the other commands.
#![allow(non_snake_case)]

mod campaign;
mod checks;
mod comparison;
mod description;
mod design;
mod design_sentence;
mod estimate;
mod page;
mod prediction;
mod prediction_sentence;
mod several;
mod study;
mod summary;
mod trials;
mod validation;
mod verdict;

pub use campaign::{cost_document, table_document};
pub use comparison::comparison_document;
pub use description::{CheckedCase, case_lines, estimate_lines, plan_lines};
pub use design::design_document;
pub use design_sentence::design_sentence;
pub use estimate::{Detail, estimate_document};
pub use page::lights::{NOT_RIGID, OF_NOISE};
pub use page::{
    Flown, Motion, RESULTS, campaign_page, comparison_part, no_page, parse_report_data,
    report_html, report_page, result_page,
};
pub use prediction::prediction_document;
pub use prediction_sentence::prediction_sentence;
pub use several::several_document;
pub use study::study_document;
pub use trials::{campaign_document, statistics_document};
pub use validation::validation_document;
pub use verdict::{Standing, VERDICTS, Verdict};
