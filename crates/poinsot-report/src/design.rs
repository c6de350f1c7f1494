//! A designed manoeuvre as text: one sentence, then the numbers.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_files::significant;
use poinsot_formats::DesignFile;

/// Round-off tolerance of a limit, relative.
pub(crate) const ROUNDED: f64 = 1.0e-4;

/// The design as a document.
///
/// ```
/// use poinsot_formats::DesignFile;
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
    let seconds = significant(design.duration_s, 4);
    let of = format!("{} wanted numbers of {}", design.wants.len(), design.model);
    if let Some(hidden) = design.wants.iter().find(|r| r.sigma.is_none()) {
        return format!(
            "No manoeuvre of this kind determines {} within the limits ({seconds} s, {of}).",
            hidden.name
        );
    }
    if let Some(broken) = design.limits.iter().find(|l| l.margin < -ROUNDED) {
        return format!(
            "No manoeuvre was found within the limits: {} is broken.",
            broken.what
        );
    }
    let ratio = significant(design.worst_ratio.unwrap_or(f64::INFINITY), 3);
    if design.verdict == "reached" {
        return format!(
            "{seconds} s reach all {of}: the largest sigma is {ratio} of the wanted one."
        );
    }
    let active = design.limits.iter().filter(|l| l.active).take(3);
    let active: Vec<&str> = active.map(|l| l.what.as_str()).collect();
    let by = match active.is_empty() {
        true => "the duration".to_owned(),
        false => active.join(", "),
    };
    format!(
        "{seconds} s do not reach all {of}: the largest sigma is {ratio} of the wanted one. Active limits: {by}."
    )
}
