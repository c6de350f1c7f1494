//! The vocabulary of column names, parsed from `vocabulary.txt`.

use super::Kind;
use crate::{Dimension, parse_unit};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error, StrDeserializer};
use std::collections::HashMap;
use std::sync::OnceLock;

/// What a word of a column name says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[rustfmt::skip]
pub(super) enum Word {
    Time, Rate, Angular, Speed, Place, Torque, Force, Acceleration, Wheel, Joint, Thruster, Pulse, State, Quaternion, Attitude,
    Rodrigues, Field, Sun, Roll, Pitch, Yaw, Momentum, Command, Estimate,
    Plain, Other,
    // Not of one word: all words are known, there is none, there is an axis.
    Bare, Silent, Axis,
}

/// Words and unit that make up a kind.
#[derive(Debug)]
pub(super) struct Rule {
    pub kind: Kind,
    /// Stem and suffix of the standard name; the prefix of a vector and ".".
    pub stem: &'static str,
    pub suffix: &'static str,
    /// `None`: any.
    pub dimension: Option<Dimension>,
    /// One of each.
    needed: Vec<Vec<Word>>,
    without: Vec<Word>,
    /// `None`: any. An entry `None`: the name has no unit.
    units: Option<Vec<Option<Dimension>>>,
}

impl Rule {
    /// Whether the words of a name and the dimension of its unit fit.
    pub fn fits(&self, words: &[Word], unit: Option<Dimension>) -> bool {
        let has = |word: &Word| words.contains(word);
        let units = self.units.as_ref();
        self.needed.iter().all(|any| any.iter().any(has))
            && !self.without.iter().any(has)
            && units.is_none_or(|units| units.contains(&unit))
    }
}

/// All of the vocabulary.
#[derive(Debug, Default)]
pub(super) struct Vocabulary {
    pub words: HashMap<&'static str, Word>,
    pub letters: HashMap<&'static str, Word>,
    /// Symbols of units by spelling.
    pub units: HashMap<&'static str, &'static str>,
    pub rules: Vec<Rule>,
    sets: HashMap<&'static str, Vec<Word>>,
}

/// The vocabulary; a test parses every line.
pub(super) fn vocabulary() -> &'static Vocabulary {
    static PARSED: OnceLock<Vocabulary> = OnceLock::new();
    PARSED.get_or_init(|| {
        let mut all = Vocabulary::default();
        for line in include_str!("vocabulary.txt").lines() {
            all.take(line);
        }
        all
    })
}

fn named<'a, T: Deserialize<'a>>(name: &'a str) -> Option<T> {
    let name: StrDeserializer<'a, Error> = name.into_deserializer();
    T::deserialize(name).ok()
}

fn dimension(symbol: &str) -> Option<Dimension> {
    parse_unit(symbol).ok().map(|unit| unit.dimension)
}

impl Vocabulary {
    /// Takes a line; `None` if it is empty, a comment or not understood.
    fn take(&mut self, line: &'static str) -> Option<()> {
        let mut fields = line.split_whitespace();
        let (what, name) = (fields.next()?, fields.next()?);
        match what {
            "word" => self
                .words
                .extend(fields.zip(std::iter::repeat(named(name)?))),
            "letter" => self
                .letters
                .extend(fields.zip(std::iter::repeat(named(name)?))),
            "unit" => self.units.extend(fields.zip(std::iter::repeat(name))),
            "set" => {
                let words = self.set(fields);
                self.sets.insert(name, words);
            }
            "kind" => {
                let mut parts = line.split(" : ");
                let mut part = || parts.next().map(str::split_whitespace);
                let (mut own, needed, without, units) =
                    (part()?.skip(2), part()?, part()?, part()?);
                let any = |one: &'static str| one.split('|').filter_map(named).collect();
                let units: Vec<&str> = units.collect();
                self.rules.push(Rule {
                    kind: named(name)?,
                    stem: own.next()?,
                    suffix: own.next()?,
                    dimension: dimension(own.next()?),
                    needed: needed.map(any).collect(),
                    without: self.set(without),
                    units: (units != ["*"]).then(|| units.into_iter().map(dimension).collect()),
                });
            }
            _ => return None,
        }
        Some(())
    }

    /// Words and the words of sets.
    fn set(&self, names: impl Iterator<Item = &'static str>) -> Vec<Word> {
        let words = |name: &'static str| match self.sets.get(name) {
            Some(set) => set.clone(),
            None => named(name).into_iter().collect(),
        };
        names.flat_map(words).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_every_line_of_the_vocabulary_is_understood() {
        let mut all = Vocabulary::default();
        let lines = include_str!("vocabulary.txt").lines();
        let lines: Vec<&str> = lines
            .filter(|l| !l.starts_with('#') && !l.is_empty())
            .collect();
        for line in lines {
            assert!(all.take(line).is_some(), "{line}");
        }
        assert!(all.units.values().all(|symbol| parse_unit(symbol).is_ok()));
        assert!(
            all.rules
                .iter()
                .all(|rule| !rule.needed.is_empty() && !rule.needed.iter().any(Vec::is_empty))
        );
        let words = include_str!("vocabulary.txt")
            .lines()
            .filter(|l| l.starts_with("word"));
        let count: usize = words.map(|l| l.split_whitespace().count() - 2).sum();
        assert_eq!(count, all.words.len(), "a word is there twice");
    }
}
