//! A designed manoeuvre as text: one sentence, then the numbers.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_formats::DesignFile;

/// Round-off tolerance of a limit, relative.
pub(crate) const ROUNDED: f64 = 1.0e-4;

/// The design as a document.
///
/// ```
/// use poinsot_formats::{DesignFile, ShorterFile};
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/design.json"));
/// let design: DesignFile = serde_json::from_str(text)?;
/// let document = poinsot_report::design_document(&design);
/// assert_eq!(document.verdict, design.in_words);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn design_document(design: &DesignFile) -> Document {
    let agrees = design.verification.as_ref().is_none_or(|v| v.agrees);
    let tone = match design.verdict == "reached" && agrees {
        true => Tone::Good,
        false => Tone::Fair,
    };
    let context = context! { rounded => ROUNDED, ..Value::from_serialize(design) };
    TEMPLATES.document("design.txt", context).toned(tone)
}

/// The result in one sentence.
///
/// ```
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/design.json"));
/// let design: poinsot_formats::DesignFile = serde_json::from_str(text)?;
/// assert_eq!(poinsot_report::design_sentence(&design), design.in_words);
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn design_sentence(design: &DesignFile) -> String {
    let context = context! { rounded => ROUNDED, ..Value::from_serialize(design) };
    TEMPLATES.lines("design_sentence.txt", context).concat()
}
