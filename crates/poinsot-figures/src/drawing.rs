//! The templates, SVG elements of a picture from one of them, and its legend entries.

use crate::error::PageError;
use crate::template::{Html, Templates};
use minijinja::Value;
use serde::Serialize;
use std::sync::LazyLock;

/// Every template of pages, plots and scenes.
pub(crate) static TEMPLATES: LazyLock<Templates> = LazyLock::new(|| {
    Templates::new(&[
        ("figure.html", include_str!("../templates/figure.html")),
        ("figure.svg", include_str!("../templates/figure.svg")),
        ("opening.html", include_str!("../templates/opening.html")),
        ("page.html", include_str!("../templates/page.html")),
        ("plot.svg", include_str!("../templates/plot.svg")),
        ("scene.svg", include_str!("../templates/scene.svg")),
        ("tables.html", include_str!("../templates/tables.html")),
    ])
});

/// A legend entry.
#[derive(Serialize)]
pub(crate) struct Key<'a> {
    pub name: &'a str,
    pub mark: &'static str,
    pub colour: usize,
}

impl<'a> Key<'a> {
    pub fn new(name: &'a str, (mark, colour): (&'static str, usize)) -> Self {
        Self { name, mark, colour }
    }
}

/// SVG elements of a picture and their size, px.
pub(crate) struct Drawing {
    pub size: [f64; 2],
    pub elements: Html,
}

impl Drawing {
    pub fn new(size: [f64; 2], template: &str, context: Value) -> Result<Self, PageError> {
        let elements = TEMPLATES.html(template, context)?;
        Ok(Self { size, elements })
    }
}

/// A place in a drawing, px.
pub(crate) fn px(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
