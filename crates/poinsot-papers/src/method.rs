//! What every published method is to the rest of the program.

use crate::kim2010::{Kim2010, Kim2010ProblemError};
use crate::ma2008::{Ma2008, Ma2008Error};
use crate::setting::{SettingText, Settings};
use crate::study::Study;
use crate::xu2017::{Xu2017, Xu2017Error};
use poinsot_identify::{Estimate, Problem};

/// A published method.
pub trait Method: Sync {
    /// Name, variants, paper and error codes.
    fn about(&self) -> About;

    /// Identifies; the first variant of [`About::variants`] where none is named. The settings are checked already:
    /// see [`identify_by`].
    ///
    /// # Errors
    /// The variant is unknown, a setting has no sense, or the problem does not suit the method. What the data do not
    /// determine is part of the estimate.
    fn identify(
        &self,
        problem: &Problem,
        variant: Option<&str>,
        settings: &Settings,
    ) -> Result<Estimate, MethodError>;

    /// The studies of its paper, see [`crate::study`].
    fn studies(&self) -> &'static [Study];
}

/// Every published method, by name.
pub static METHODS: [&dyn Method; 3] = [&Kim2010, &Ma2008, &Xu2017];

/// The published method of this name.
pub fn method(name: &str) -> Option<&'static dyn Method> {
    METHODS.into_iter().find(|m| m.about().name == name)
}

/// Identifies by a published method with settings `key=value`.
///
/// # Errors
/// As [`Method::identify`], or the method has no such setting.
pub fn identify_by(
    method: &dyn Method,
    problem: &Problem,
    variant: Option<&str>,
    settings: &[String],
) -> Result<Estimate, MethodError> {
    let about = method.about();
    let settings = Settings::parse(settings)?;
    settings.check(about.name, about.settings)?;
    method.identify(problem, variant, &settings)
}

/// Code, meaning, usual cause, remedy.
pub type Explained = (&'static str, &'static str, &'static str, &'static str);

/// A method in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct About {
    /// Name on the command line: author and year.
    pub name: &'static str,
    /// What it estimates from what, in one line.
    pub summary: &'static str,
    /// Where it was published.
    pub citation: &'static str,
    /// Variants; the first is the default.
    pub variants: Vec<VariantText>,
    /// Settings that `--set` takes.
    pub settings: &'static [SettingText],
    /// Whether it uses measured accelerations, which no other method reads.
    pub reads_accelerations: bool,
    /// The error codes that it alone gives.
    pub codes: &'static [Explained],
}

/// A variant in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VariantText {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
}

/// Variants of a method with their names, which are unique, and summaries; the first is the default.
pub trait Named: Copy + 'static {
    /// Every variant and its summary.
    const ALL: &'static [(Self, &'static str)];

    /// Name on the command line.
    fn name(self) -> &'static str;

    /// All variants in words.
    fn texts() -> Vec<VariantText> {
        let text = |&(variant, summary): &(Self, &'static str)| VariantText {
            name: variant.name(),
            summary,
        };
        Self::ALL.iter().map(text).collect()
    }

    /// The variant of this name, the default where none is given.
    fn named(method: &'static str, name: Option<&str>) -> Result<Self, MethodError> {
        let mut all = Self::ALL.iter().map(|(variant, _)| *variant);
        let found = match name {
            None => all.next(),
            Some(name) => all.find(|v| v.name() == name),
        };
        found.ok_or_else(|| MethodError::Variant {
            method,
            variant: name.unwrap_or_default().to_owned(),
            known: Self::texts().iter().map(|t| t.name).collect(),
        })
    }
}

/// Why a method gives no estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// No such variant.
    #[error("E0001 --variant '{variant}': {method} has no such variant; use one of {}", known.join(", "))]
    Variant {
        /// Method.
        method: &'static str,
        /// Variant as given.
        variant: String,
        /// Its variants.
        known: Vec<&'static str>,
    },
    /// A setting that the method does not have, or a value that it does not take.
    #[error("E0001 --set '{text}': {why}")]
    Setting {
        /// As given.
        text: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// The method of Kim, Choi and Oh.
    #[error(transparent)]
    Kim2010(#[from] Kim2010ProblemError),
    /// The method of Ma, Dang and Pham.
    #[error(transparent)]
    Ma2008(#[from] Ma2008Error),
    /// The method of Xu, Hu, Zhang and Liang.
    #[error(transparent)]
    Xu2017(#[from] Xu2017Error),
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    fn exact<V: Named + PartialEq + std::fmt::Debug>() {
        for (variant, summary) in V::ALL {
            assert_eq!(V::named("", Some(variant.name())), Ok(*variant));
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
        for about in METHODS.map(|m| m.about()) {
            assert!(names.insert(about.name) && method(about.name).is_some());
            assert!(about.citation.contains(&about.name[about.name.len() - 4..]));
            assert!(!about.variants.is_empty() && !about.summary.is_empty());
            assert!(about.codes.iter().all(|c| codes.insert(c.0)));
        }
    }
}
