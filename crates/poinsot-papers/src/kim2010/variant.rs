//! Names of the estimators.

use crate::method::Named;

/// The five estimators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Nine elements together, (2)-(4).
    Batch,
    /// Each element separately, (8)-(10), (14).
    Conventional,
    /// Products from the moments and the other product of the row, (15).
    PreEstimate,
    /// Products from the moments only, (14)-(16).
    Suggested,
    /// (14)-(16) iterated: announced in the paper as future work.
    Iterated,
}

impl Named for Variant {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (
            Self::Suggested,
            "suggested",
            "products of inertia from the moments alone, (14)-(16)",
        ),
        (Self::Batch, "batch", "nine elements at once, (2)-(4)"),
        (
            Self::Conventional,
            "conventional",
            "every element alone, (8)-(10), (14)",
        ),
        (
            Self::PreEstimate,
            "pre-estimate",
            "each product with the other one of its row as (15) gives it",
        ),
        (
            Self::Iterated,
            "iterated",
            "(14)-(16) repeated, the paper's future work",
        ),
    ];
}
