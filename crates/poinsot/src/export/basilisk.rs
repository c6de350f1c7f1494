//! Python that sets the hub of a Basilisk spacecraft.

use super::{Exported, Source, rendered};
use crate::error::Error;
use minijinja::context;
use poinsot_model::BodyProperties;
use std::collections::BTreeMap;

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
    let springs = springs(source);
    let shown = |(joint, [k, c]): (&String, &[f64; 2])| {
        format!("{joint:?}: {{\"k\": {k:?}, \"c\": {c:?}}}")
    };
    let shown: Vec<String> = springs.iter().map(shown).collect();
    let context = context! { comments, bodies, springs => shown };
    Ok(Exported {
        text: rendered(include_str!("basilisk.txt"), context)?,
        left_out,
        parts: springs.into_keys().collect(),
        ..Exported::default()
    })
}

/// Stiffness and damping of joints with both.
fn springs(source: &Source) -> BTreeMap<String, [f64; 2]> {
    let numbers = source.numbers();
    let of = |begin: &str| -> BTreeMap<String, f64> {
        let own = numbers.iter().filter(|n| n.key.starts_with(begin));
        own.map(|n| (n.part.clone(), n.value)).collect()
    };
    let damping = of("damping_N");
    let both = of("stiffness_").into_iter();
    let both = both.filter_map(|(part, k)| Some((part.clone(), [k, *damping.get(&part)?])));
    both.collect()
}
