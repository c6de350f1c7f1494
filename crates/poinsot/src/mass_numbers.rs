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
    let mut all = body.nominal.to_array();
    let found = answer.and_then(|a| a.bodies.get(&body.name));
    let Some(found) = found else {
        return body.nominal;
    };
    let addresses = names(&body.name);
    for (address, _, number) in found.addressed(&body.name) {
        let at = addresses.iter().position(|a| *a == address);
        if let (Some(at), Some(value)) = (at, number.value) {
            all[at] = value;
        }
    }
    MassProperties::from_array(&all)
}
