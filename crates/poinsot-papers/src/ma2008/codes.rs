//! Error codes of this method.

pub(super) const CODES: &[&str] = &crate::explanations![
    "E0521", "E0522", "E0523", "E0524", "E0525", "E0526", "E0527", "E0528", "E0529"
];
