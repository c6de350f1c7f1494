//! Addresses of mass, mass centre and central inertia of a body, in the order of [`MASS_PROPERTY_NAMES`].

use poinsot_formats::address;
use poinsot_spatial::MASS_PROPERTY_NAMES;

/// The addresses of a body.
pub(crate) fn names(body: &str) -> [String; 10] {
    MASS_PROPERTY_NAMES.map(|name| address(&format!("{body}.{name}"), ""))
}
