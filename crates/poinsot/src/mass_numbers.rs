//! Mass, mass centre and central inertia of a body: addresses and values in one order.

use poinsot_formats::address;
use poinsot_identify::{TENSOR, axis_name, tensor_name};
use poinsot_spatial::MassProperties;

/// Mass, mass centre and central inertia in the order of [`names`].
pub(crate) fn values(body: &MassProperties) -> impl Iterator<Item = f64> {
    let centre = body.p_BoBcm_B.iter().copied();
    let inertia = TENSOR.into_iter().map(|at| body.I_BBcm_B[at]);
    std::iter::once(body.mass).chain(centre).chain(inertia)
}

/// Addresses of mass, mass centre and central inertia of a body.
pub(crate) fn names(body: &str) -> Vec<String> {
    let com = (0..3).map(|k| format!("com_{}", axis_name(k)));
    let inertia = (0..6).map(|k| format!("inertia_{}", tensor_name(k)));
    let all = std::iter::once("mass".to_owned()).chain(com).chain(inertia);
    all.map(|name| address(&format!("{body}.{name}"), ""))
        .collect()
}
