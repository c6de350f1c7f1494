//! Published methods: what a method is, and the list of all of them. No other file of the program names one.

use crate::setting::{SettingText, Settings};
use crate::study::Study;
use poinsot_files::Faults;
use poinsot_identify::{Estimate, Problem};
use poinsot_spatial::MassProperties;
use std::ops::Range;

/// Every published method, by name.
pub static METHODS: [&Method; 3] = [
    &crate::kim2010::METHOD,
    &crate::ma2008::METHOD,
    &crate::xu2017::METHOD,
];

/// A published method.
pub struct Method {
    /// Name on the command line: author and year.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Citation.
    pub citation: &'static str,
    /// Number of numbered equations, tables and figures in the paper; its page has a row for each.
    pub numbered: [usize; 3],
    /// Variants; the first is the default.
    pub variants: fn() -> Vec<VariantText>,
    /// Settings for `--set`.
    pub settings: &'static [SettingText],
    /// Whether it uses measured accelerations, which no other method does.
    pub reads_accelerations: bool,
    /// Texts of the error codes that it alone has ([`explanations!`](crate::explanations)).
    pub codes: &'static [&'static str],
    /// Identifies by the named variant, or by the first, with settings that are already checked, see [`identify_by`].
    /// Undetermined numbers are part of the estimate, not an error.
    pub identify: fn(&Problem, Option<&str>, &Settings) -> Result<Estimate, Faults>,
    /// The kernel of this problem, whose samples have no noise; `None` if the method has none for it.
    pub kernel: fn(&Problem, Option<&str>) -> Result<Option<Kernel>, Faults>,
    /// Studies of its paper, see [`crate::study`].
    pub studies: &'static [Study],
}

/// Trials that a method draws and solves itself: estimates of the first body, one per number and in order, from a seed
/// and the numbers of the trials alone. They are much cheaper than a draw and [`Method::identify`], have the noise that
/// the kernel documents, and state no sigma.
pub type Kernel = Box<dyn Fn(u64, Range<u64>) -> Vec<MassProperties> + Send + Sync>;

/// Texts of error codes: the files `explanations/CODE.md` of the crate that calls it.
#[macro_export]
macro_rules! explanations {
    ($($code:literal),* $(,)?) => {
        [$(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/explanations/", $code, ".md"))),*]
    };
}

/// Description of a variant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VariantText {
    /// Name on the command line.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
}

/// Variants of a method with their unique names and summaries; the first is the default.
pub trait Named: Copy + PartialEq + 'static {
    /// Every variant, its name on the command line, and its summary.
    const ALL: &'static [(Self, &'static str, &'static str)];

    /// Name on the command line.
    fn name(self) -> &'static str {
        let own = Self::ALL.iter().find(|v| v.0 == self);
        own.map_or("", |v| v.1)
    }

    /// Descriptions of all variants.
    fn texts() -> Vec<VariantText> {
        let text = |&(_, name, summary): &(Self, _, _)| VariantText { name, summary };
        Self::ALL.iter().map(text).collect()
    }

    /// The variant of this name, or the default without a name.
    fn named(method: &'static str, name: Option<&str>) -> Result<Self, Faults> {
        let mut all = Self::ALL.iter();
        let found = all.find(|v| name.is_none_or(|name| name == v.1));
        found.map(|v| v.0).ok_or_else(|| {
            let known: Vec<&str> = Self::ALL.iter().map(|v| v.1).collect();
            Faults::usage(
                "--variant",
                name.unwrap_or_default(),
                format!("{method} has no such variant"),
                format!("use one of {}", known.join(", ")),
            )
        })
    }
}

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
