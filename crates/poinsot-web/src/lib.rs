//! Poinsot in the browser: a model and telemetry in memory, and the answer of the command as text.
//!
//! `scripts/web` compiles this crate to WebAssembly and makes one HTML file of it and of the folder `page`; the folder
//! `bindgen` writes the JavaScript that calls it. [`check`] and [`identify`] are ordinary functions; what they take
//! and give crosses the border in `border.rs`, which is compiled for WebAssembly alone.
//!
//! ```
//! use poinsot_web::{Named, check, identify};
//!
//! let model = Named { name: "model.toml".to_owned(), content: "[[body]]\nname = \"bus\"\n".to_owned() };
//! // The line of the body without a mass.
//! assert!(check(&model).errors.iter().any(|e| e.line > 0 && e.code.starts_with("E01")));
//! let errors = identify(&model, Vec::new(), false).unwrap_err();
//! assert_eq!(errors.code(), check(&model).errors[0].code);
//! ```
//!
//! # Files
//! - `answer.rs`: [`identify`]. `check.rs`: [`check`], errors with lines.
//! - `border.rs`: both for JavaScript; progress; panics as errors.

mod answer;
#[cfg(target_arch = "wasm32")]
mod border;
mod check;

pub use answer::{Answer, OutputText, identify};
pub use check::{Checked, LineError, check, line_errors};

/// The content of an input, and its name in messages and results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named<T> {
    /// Name, that of a file.
    pub name: String,
    /// Content.
    pub content: T,
}
