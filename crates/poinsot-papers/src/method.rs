//! What every published method is to the rest of the program.

use crate::error::MethodError;
use crate::setting::{SettingText, Settings};
use crate::study::Study;
use poinsot_identify::{Estimate, Problem};

/// A published method.
pub trait Method: Sync {
    /// Name, variants, paper and error codes.
    fn about(&self) -> About;

    /// Identifies; the first variant of [`About::variants`] where none is named. The settings are checked already:
    /// see [`crate::identify_by`].
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
    /// How many equations, tables and figures the paper numbers: its page has a row for each.
    pub numbered: [usize; 3],
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
