//! Why a page cannot be put together.

/// A fault of a template or of the data handed to it.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A template does not render.
    #[error("template {name}: {source}")]
    Template {
        /// Name of the template.
        name: String,
        /// What the engine says.
        source: minijinja::Error,
    },
    /// Data that cannot be written as JSON.
    #[error("figure data: {0}")]
    Json(#[from] serde_json::Error),
    /// A figure cannot be drawn.
    #[error("a figure cannot be drawn: {0}")]
    Figure(String),
}
