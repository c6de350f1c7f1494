use crate::vehicle::asked;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether, or which, numbers are unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "{P}Estimate")]
pub enum Which<P> {
    /// All or nothing.
    All(bool),
    /// These.
    Some(Vec<P>),
}

impl<P: PartialEq> Which<P> {
    /// Whether a file asks for a number.
    pub(crate) fn asks(file: Option<&Self>, what: &P) -> bool {
        match file {
            None => false,
            Some(Self::All(all)) => *all,
            Some(Self::Some(list)) => list.contains(what),
        }
    }

    /// Those of some numbers that are unknown; `None` where none is.
    pub(crate) fn of<const N: usize>(numbers: [(P, bool); N]) -> Option<Self> {
        let asked = asked(numbers);
        match asked.len() {
            0 => None,
            all if all == N => Some(Self::All(true)),
            _ => Some(Self::Some(asked)),
        }
    }
}
