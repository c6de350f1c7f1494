//! A validation as text: one sentence, then the numbers.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_formats::ValidationFile;

/// The validation as a document.
///
/// ```
/// use poinsot_formats::ValidationFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/validation.json"));
/// let validation: ValidationFile = serde_json::from_str(text)?;
/// let document = poinsot_report::validation_document(&validation);
/// assert!(document.verdict.contains("no limit given"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn validation_document(validation: &ValidationFile) -> Document {
    let estimate = validation.estimate.as_ref();
    let reliable = estimate.is_none_or(|e| e.covariance_trustworthy);
    let tone = match validation.verdict.as_str() {
        _ if !reliable => Tone::Bad,
        "compared" => Tone::Plain,
        "agrees" => Tone::Good,
        "undetermined" => Tone::Fair,
        _ => Tone::Bad,
    };
    let context = context! { reliable, ..Value::from_serialize(validation) };
    TEMPLATES.document("validation.txt", context).toned(tone)
}
