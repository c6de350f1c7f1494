//! Error codes of this method.

pub(super) const CODES: &[&str] = &crate::explanations![
    "E0531", "E0532", "E0533", "E0534", "E0535", "E0536", "E0537", "E0538", "E0539", "E0540"
];
