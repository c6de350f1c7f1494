//! Errors of published methods.

/// Why a method gives no estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// Unknown variant.
    #[error("E0001 --variant '{variant}': {method} has no such variant; use one of {}", known.join(", "))]
    Variant {
        /// Method.
        method: &'static str,
        /// Variant as given.
        variant: String,
        /// Valid variants.
        known: Vec<&'static str>,
    },
    /// An unknown setting, or an invalid value.
    #[error("E0001 --set '{text}': {why}")]
    Setting {
        /// As given.
        text: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// Error text of the method, with its code.
    #[error("{0}")]
    Refused(String),
}

impl MethodError {
    /// Wraps the error of a method.
    pub fn refused(error: impl std::error::Error) -> Self {
        Self::Refused(error.to_string())
    }
}
