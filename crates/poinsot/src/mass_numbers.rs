//! Mass, mass centre and central inertia of a body, in the order of [`MASS_PROPERTY_NAMES`]: addresses, and values of an answer.

use poinsot_formats::{EstimateFile, address};
use poinsot_model::Body;
use poinsot_spatial::{MASS_PROPERTY_NAMES, MassProperties};

/// The addresses of a body.
pub(crate) fn names(body: &str) -> [String; 10] {
    MASS_PROPERTY_NAMES.map(|name| address(&format!("{body}.{name}"), ""))
}

/// The nominal numbers, with those that an answer determines.
pub(crate) fn with_answer(body: &Body, answer: Option<&EstimateFile>) -> MassProperties {
    let found = answer.and_then(|a| a.bodies.get(&body.name));
    let Some(found) = found else {
        return body.nominal;
    };
    let (nominal, found) = (body.nominal.to_array(), found.map(|n| n.value));
    MassProperties::from_array(&std::array::from_fn(|k| found[k].unwrap_or(nominal[k])))
}
