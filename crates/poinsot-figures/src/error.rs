//! Error of building a page.

/// Fault of a template or of its data.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A template does not render.
    #[error("template {name}: {source}")]
    Template {
        /// Name of the template.
        name: String,
        /// Error of the template engine.
        source: minijinja::Error,
    },
    /// Data that cannot be written as JSON.
    #[error("figure data: {0}")]
    Json(#[from] serde_json::Error),
    /// A figure cannot be drawn.
    #[error("a figure cannot be drawn: {0}")]
    Figure(String),
}
