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
//! | line of a filter | [`followed_document`] | [`live_page`] |
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
//! - `templates/`: words and layout, `NAME.txt` of the terminal, `NAME.html` of a section of the page.
//! - `estimate.rs`, `prediction.rs`, `several.rs`, `validation.rs`, `comparison.rs`, `design.rs`, `campaign.rs`,
//!   `study.rs`: one result each; what its template shows, and its sentence.
//! - `description.rs`: a checked case, plan or result in statements.
//! - `live.rs`: a filter while it runs.
//! - `verdict.rs`, `summary.rs`, `checks.rs`: the words of an answer and its causes, for terminal and page.
//! - `page/`: the page of an estimate, one file per section. `page/results/`: pages of the other results.
#![allow(non_snake_case)]

mod campaign;
mod checks;
mod comparison;
mod description;
mod design;
mod estimate;
mod live;
mod page;
mod prediction;
mod several;
mod study;
mod summary;
mod templates;
mod validation;
mod verdict;

pub use campaign::{campaign_document, cost_document, statistics_document, table_document};
pub use comparison::comparison_document;
pub use description::{CheckedCase, case_lines, estimate_lines, plan_lines};
pub use design::{design_document, design_sentence};
pub use estimate::{Detail, estimate_document};
pub use live::{followed_document, live_page};
pub use page::lights::{NOT_RIGID, OF_NOISE};
pub use page::{
    Flown, Motion, RESULTS, campaign_page, comparison_part, no_page, parse_report_data,
    report_html, report_page, result_page,
};
pub use prediction::{prediction_document, prediction_sentence};
pub use several::several_document;
pub use study::study_document;
pub use validation::validation_document;
pub use verdict::{Standing, VERDICTS, Verdict};
