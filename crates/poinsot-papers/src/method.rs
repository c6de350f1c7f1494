//! What a published method is.

use crate::setting::{SettingText, Settings};
use crate::study::Study;
use poinsot_files::Faults;
pub use poinsot_formats::VariantFile as VariantText;
use poinsot_identify::{Estimate, Problem};

/// A published method.
pub struct Method {
    /// Name on the command line: author and year.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Citation.
    pub citation: &'static str,
    /// Variants; the first is the default.
    pub variants: fn() -> Vec<VariantText>,
    /// Settings for `--set`.
    pub settings: &'static [SettingText],
    /// Whether it uses measured accelerations, which no other method does.
    pub reads_accelerations: bool,
    /// Texts of the error codes that it alone has ([`explanations!`](crate::explanations)).
    pub codes: &'static [&'static str],
    /// Identifies by the named variant, or by the first, with settings that are already checked, see [`crate::identify_by`].
    /// Undetermined numbers are part of the estimate, not an error.
    pub identify: fn(&Problem, Option<&str>, &Settings) -> Result<Estimate, Faults>,
    /// Studies of its paper, see [`crate::study`].
    pub studies: &'static [Study],
}

/// Texts of error codes: the files `explanations/CODE.md` of the crate that calls it.
#[macro_export]
macro_rules! explanations {
    ($($code:literal),* $(,)?) => {
        [$(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/explanations/", $code, ".md"))),*]
    };
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
            let problem = format!("{method} has no such variant");
            let advice = format!("use one of {}", known.join(", "));
            Faults::usage("--variant", name.unwrap_or_default(), problem, advice)
        })
    }
}
