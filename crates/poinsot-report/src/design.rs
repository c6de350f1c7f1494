//! A designed manoeuvre as text: one sentence, then the numbers.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_files::significant;
use poinsot_formats::{DesignFile, ShorterFile};

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
    if design.verdict != "not_reached" {
        let shortest = design.shorter.as_ref().map_or_else(String::new, shortest);
        return format!(
            "{seconds} s reach all {of}: the largest sigma is {ratio} of the wanted one.{shortest}"
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

/// The bracket of the shortest duration.
fn shortest(shorter: &ShorterFile) -> String {
    let missed = |s: f64| format!("{} s do not", significant(s, 4));
    match (shorter.missed_s.map(missed), shorter.stopped) {
        (Some(missed), false) => format!(" {missed}."),
        (Some(missed), true) => format!(" {missed}; the search was stopped between them."),
        (None, true) => " The search was stopped before any shorter one was tried.".to_owned(),
        (None, false) => " Every shorter one that was tried does too.".to_owned(),
    }
}
