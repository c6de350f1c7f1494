//! Error codes of this method.

pub(super) const CODES: &[&str] =
    &crate::explanations!["E0420", "E0421", "E0422", "E0423", "E0424", "E0425"];
