//! Python that sets the hub of a Basilisk spacecraft.

use super::{Exported, Source, rendered};
use crate::error::Error;
use minijinja::context;
use poinsot_model::BodyProperties;

/// A module with the numbers of every determined body, and a function that copies one body into a hub.
pub(super) fn text(source: &Source) -> Result<Exported, Error> {
    let (bodies, left_out) = source.bodies();
    if bodies.is_empty() {
        return Err(source.nothing(&left_out, ""));
    }
    let plain = |line: &String| line.replace('\\', "/").replace('"', "'");
    let comments = source
        .origin()
        .iter()
        .chain(&left_out)
        .map(plain)
        .collect::<Vec<_>>();
    let numbers = |body: &BodyProperties| {
        let p = &body.properties;
        let row = |k: usize| format!("{:?}", [0, 1, 2].map(|j| p.I_BBcm_B[(k, j)]));
        context! {
            name => format!("{:?}", body.body),
            mass => format!("{:?}", p.mass),
            com => format!("{:?}", <[f64; 3]>::from(p.p_BoBcm_B)),
            inertia => [0, 1, 2].map(row),
        }
    };
    let bodies: Vec<_> = bodies.iter().map(numbers).collect();
    Ok(Exported {
        text: rendered(include_str!("basilisk.txt"), context! { comments, bodies })?,
        left_out,
        no_field: Vec::new(),
    })
}
