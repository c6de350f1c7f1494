//! A filter while it runs: a table for the terminal, and a page whose curves grow.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Page, PageError, Part, Tone};
use serde::Serialize;

/// What a filter knows, of one line of `poinsot follow`, as a table.
///
/// ```
/// let line = r#"{"time_s": 61.5, "health": "determined", "certified": null,
///     "gyro": {"accepted": 615, "gated": 0}, "attitude": {"accepted": 615, "gated": 0},
///     "position": {"accepted": 0, "gated": 0}, "numbers": {"bus.inertia_kg_m2.xx":
///         {"value": 20.0132, "sigma": 0.011, "wanted_sigma": 0.1, "reached_at_s": 32.5}}}"#;
/// let line: serde_json::Value = serde_json::from_str(line)?;
/// let document = poinsot_report::followed_document("cubesat", &line);
/// assert_eq!(document.verdict, "cubesat: determined at 61.5 s");
/// assert!(document.to_string().contains("20.01"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn followed_document(vehicle: &str, line: &impl Serialize) -> Document {
    let line = Value::from_serialize(line);
    let health = line.get_attr("health").unwrap_or_default();
    let context = context! { vehicle, this => line, ..line };
    let tone = match health.as_str() {
        Some("determined") => Tone::Good,
        Some("converging") => Tone::Plain,
        _ => Tone::Bad,
    };
    TEMPLATES.document("follow.txt", context).toned(tone)
}

/// The page of a vehicle that shows the lines which its server sends as events from `events`.
///
/// # Errors
/// The template is faulty.
///
/// ```
/// let page = poinsot_report::live_page("cubesat")?;
/// assert!(page.contains("connect-src 'self'"));
/// # Ok::<(), poinsot_figures::PageError>(())
/// ```
pub fn live_page(vehicle: &str) -> Result<String, PageError> {
    let body = TEMPLATES.html("live.html", context! {})?;
    let page = Page {
        title: format!("{vehicle}, live"),
        subtitle: "The recursive filter on the rows as they arrive; its sigmas are those of the declared noise.".to_owned(),
        footer: "Nothing can be changed from here. Curves begin where a value is determined; shaded: 95 %.".to_owned(),
        parts: vec![Part::new("now", "Now", body)],
    };
    page.html()
}
