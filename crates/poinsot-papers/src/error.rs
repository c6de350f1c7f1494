//! Why a published method gives no estimate.

/// Why a method gives no estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// No such variant.
    #[error("E0001 --variant '{variant}': {method} has no such variant; use one of {}", known.join(", "))]
    Variant {
        /// Method.
        method: &'static str,
        /// Variant as given.
        variant: String,
        /// Its variants.
        known: Vec<&'static str>,
    },
    /// A setting that the method does not have, or a value that it does not take.
    #[error("E0001 --set '{text}': {why}")]
    Setting {
        /// As given.
        text: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// The method's own reason, with its code.
    #[error("{0}")]
    Refused(String),
}

impl MethodError {
    /// From the error of a method.
    pub fn refused(error: impl std::error::Error) -> Self {
        Self::Refused(error.to_string())
    }
}
