//! Names shown in help and completions. The command checks the value itself, so that its error lists the
//! valid names.

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use poinsot::export::Target;

/// Value parser that offers names and accepts any word.
#[derive(Clone)]
pub struct Words(Vec<PossibleValue>);

impl Words {
    fn plain(names: impl Iterator<Item = &'static str>) -> Self {
        Self(names.map(PossibleValue::new).collect())
    }

    /// Formats of `export`.
    pub fn targets() -> Self {
        let value = |t: Target| PossibleValue::new(t.name()).help(t.about());
        Self(Target::ALL.map(value).to_vec())
    }

    /// Methods of `identify`.
    pub fn methods() -> Self {
        Self::plain(poinsot::methods::methods().iter().map(|m| m.name))
    }

    /// Papers that have studies.
    pub fn papers() -> Self {
        let mut papers: Vec<&'static str> = poinsot::study::studies().map(|s| s.0).collect();
        papers.dedup();
        Self::plain(papers.into_iter())
    }

    /// Studies of all papers.
    pub fn studies() -> Self {
        let all = poinsot::study::studies().map(|s| s.1.name);
        Self::plain(all.chain([poinsot::study::ALL]))
    }

    /// Variants of all methods.
    pub fn variants() -> Self {
        let methods = poinsot::methods::methods();
        let all = methods.iter().flat_map(|m| &m.variants).map(|v| v.name);
        let mut all: Vec<_> = all.collect();
        all.sort_unstable();
        all.dedup();
        Self::plain(all.into_iter())
    }
}

impl TypedValueParser for Words {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().cloned()))
    }
}
