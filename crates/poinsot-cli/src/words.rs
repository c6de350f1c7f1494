//! Names offered by help and completions that the verb itself checks, so that its error says what to use instead.

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};

/// Offers names, takes any.
#[derive(Clone)]
pub struct Words(Vec<&'static str>);

impl Words {
    /// Methods of `identify`.
    pub fn methods() -> Self {
        Self(poinsot::methods::methods().iter().map(|m| m.name).collect())
    }

    /// Papers with studies.
    pub fn papers() -> Self {
        let mut papers: Vec<&'static str> = poinsot::study::studies().map(|s| s.0).collect();
        papers.dedup();
        Self(papers)
    }

    /// Studies of any paper.
    pub fn studies() -> Self {
        let all = poinsot::study::studies().map(|s| s.1.name);
        Self(all.chain([poinsot::study::ALL]).collect())
    }

    /// Variants of any method.
    pub fn variants() -> Self {
        let methods = poinsot::methods::methods();
        let all = methods.iter().flat_map(|m| &m.variants).map(|v| v.name);
        let mut all: Vec<_> = all.collect();
        all.sort_unstable();
        all.dedup();
        Self(all)
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
        Some(Box::new(self.0.iter().map(PossibleValue::new)))
    }
}
