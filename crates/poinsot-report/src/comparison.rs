//! A comparison as text.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::Document;
use poinsot_formats::{ComparisonFile, DIFFER_BELOW};

/// The comparison as a document.
///
/// ```
/// use poinsot_formats::ComparisonFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/comparison.json"));
/// let comparison: ComparisonFile = serde_json::from_str(text)?;
/// let document = poinsot_report::comparison_document(&comparison);
/// assert!(document.verdict.contains("agree"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn comparison_document(c: &ComparisonFile) -> Document {
    let context = context! { differ_below => DIFFER_BELOW, ..Value::from_serialize(c) };
    TEMPLATES.document("comparison.txt", context)
}
