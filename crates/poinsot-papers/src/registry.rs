//! Registration of all published methods; no other file of the program names one.

use crate::method::Method;
use crate::setting::Settings;
use crate::study::Study;
use poinsot_files::Faults;
use poinsot_identify::{Estimate, Problem};

/// Every published method, by name.
pub static METHODS: [&Method; 3] = [
    &crate::kim2010::METHOD,
    &crate::ma2008::METHOD,
    &crate::xu2017::METHOD,
];

/// The published method of this name.
///
/// ```
/// use poinsot_papers::method;
///
/// assert!(method("ma2008").unwrap().citation.contains("Ma"));
/// assert!(method("newton1687").is_none());
/// ```
pub fn method(name: &str) -> Option<&'static Method> {
    METHODS.into_iter().find(|m| m.name == name)
}

/// Identifies by a published method with settings `key=value`.
///
/// # Errors
/// The variant is unknown, a setting is unknown or invalid, or the problem does not suit the method.
///
/// ```
#[doc = include_str!("../doc/record.txt")]
/// let input = record("ma2008", "ma2008/model.toml", "ma2008/traj1/telemetry.parquet")?;
/// let estimate = identify_by(method("ma2008").unwrap(), &problem(&input), None, &[])?;
/// // The true mass of the base is 1,000 kg.
/// let mass = estimate.bodies[0].mass;
/// assert!((mass.value.unwrap() - 1000.0).abs() < 3.0 * mass.sigma.unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify_by(
    method: &Method,
    problem: &Problem,
    variant: Option<&str>,
    settings: &[String],
) -> Result<Estimate, Faults> {
    let settings = Settings::parse(settings)?;
    settings.check(method.name, method.settings)?;
    (method.identify)(problem, variant, &settings)
}

/// Every study with its paper, in the order of [`METHODS`].
///
/// ```
/// let all: Vec<String> = poinsot_papers::studies()
///     .map(|(paper, study)| format!("poinsot study {paper} {}", study.name))
///     .collect();
/// assert!(all.iter().any(|s| s == "poinsot study kim2010 table2"));
/// ```
pub fn studies() -> impl Iterator<Item = (&'static str, &'static Study)> {
    let of = |m: &'static Method| m.studies.iter().map(move |s| (m.name, s));
    METHODS.into_iter().flat_map(of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Named;
    use std::collections::HashSet;

    fn exact<V: Named + PartialEq + std::fmt::Debug>() {
        for (variant, name, summary) in V::ALL {
            assert_eq!(
                (V::named("", Some(name)), variant.name()),
                (Ok(*variant), *name)
            );
            assert!(!summary.is_empty());
        }
        assert_eq!(V::named("", None), Ok(V::ALL[0].0));
        assert!(V::named("", Some("none of them")).is_err());
    }

    #[test]
    fn exact_every_variant_has_a_name_of_its_own_and_the_first_is_the_default() {
        exact::<crate::kim2010::Variant>();
        exact::<crate::ma2008::Variant>();
        exact::<crate::xu2017::Variant>();
    }

    #[test]
    fn exact_every_method_has_a_name_and_codes_of_its_own() {
        let mut names = HashSet::new();
        let mut codes = HashSet::new();
        for own in METHODS {
            assert!(names.insert(own.name) && method(own.name).is_some());
            assert!(own.citation.contains(&own.name[own.name.len() - 4..]));
            assert!(!(own.variants)().is_empty() && !own.summary.is_empty());
            assert!(own.codes.iter().all(|c| codes.insert(*c)));
        }
    }
}
