//! A column name, split into its unit, its component and what its words say.

use super::words::{Word, vocabulary};
use crate::{Dimension, Unit, parse_unit};

/// Words of a turn about x, y, z.
const TURNS: [Word; 3] = [Word::Roll, Word::Pitch, Word::Yaw];
/// Most tokens of a unit.
const UNIT_TOKENS: usize = 4;
/// Longest token that is parted into words.
const LONGEST: usize = 40;
/// Shortest unit of one token that may be inside of a name and not only at its end.
const INSIDE: usize = 3;

fn meaning(token: &str) -> Option<Word> {
    vocabulary().words.get(token).copied()
}

/// The meaning of a letter.
fn head(token: &str) -> Option<Word> {
    vocabulary().letters.get(token).copied()
}

/// A name as it is understood.
#[derive(Debug, Clone, Default)]
pub(super) struct Name {
    /// Words with a meaning.
    pub words: Vec<Word>,
    /// The unit.
    pub unit: Option<Unit>,
    /// The last of x, y, z, w.
    pub axis: Option<usize>,
    /// The last number.
    pub number: Option<usize>,
    /// Which wheel, joint or thruster: the number or letter after that word, or the last one, or the words that are unknown.
    pub index: String,
    /// Everything but component and unit.
    pub owner: Vec<String>,
}

impl Name {
    /// Splits a name; `below` is the unit of the units row.
    pub fn of(column: &str, below: Option<Unit>) -> Self {
        let (stem, unit) = bracketed(column);
        let mut tokens = split(&stem);
        let written = unit.or(below);
        let spelled = spelled(&mut tokens);
        let mut name = Self {
            unit: written.or(spelled),
            ..Self::default()
        };
        name.read(&tokens);
        name
    }

    pub fn is_momentum(&self) -> bool {
        let unit = self.unit.as_ref();
        unit.is_some_and(|unit| unit.dimension == Dimension::AngularMomentum)
    }

    pub fn has(&self, word: Word) -> bool {
        self.words.contains(&word)
    }

    /// The component that the name says: x, y, z, w, or the axis of a turn.
    pub fn component(&self) -> Option<usize> {
        let turn = || TURNS.iter().position(|turn| self.has(*turn));
        self.axis.or_else(turn)
    }

    fn read(&mut self, tokens: &[String]) {
        let long: Vec<Option<Word>> = tokens.iter().map(|t| meaning(t)).collect();
        let others = [Word::Plain, Word::Estimate, Word::Command, Word::Attitude];
        let is_quantity = |word: &Word| !others.contains(word);
        let counted = long.iter().flatten().any(is_quantity);
        // A bias is written b_w or b_a.
        let second = tokens.get(1).and_then(|t| head(t));
        if tokens.first().is_some_and(|t| t == "b") && second.is_some() && !counted {
            self.words.push(Word::Other);
        }
        let mut unknown = Vec::new();
        let lone = tokens.iter().position(|t| head(t).is_some() && !counted);
        for (k, (token, word)) in tokens.iter().zip(long).enumerate() {
            let frame = tokens.get(k + 1).is_some_and(|t| t == "bn");
            let numbered = tokens.get(k + 1).is_some_and(|t| is_number(t));
            let word = match (word, lone == Some(k)) {
                (None, true) => head(token),
                // A joint is written J1, and its position q.
                (None, _) if token == "j" && numbered => Some(Word::Joint),
                (None, _) if token == "q" && self.has(Word::Joint) => Some(Word::Place),
                // Basilisk writes the Rodrigues parameters of the body as sigma_BN.
                _ if token == "sigma" && frame => Some(Word::Rodrigues),
                (word, _) => word,
            };
            // A letter such as b is filling, or the name of a part.
            if matches!(word, None | Some(Word::Plain)) && self.take(tokens, k) {
                continue;
            }
            self.words.extend(word);
            if word.is_none() {
                unknown.push(token.as_str());
            }
            if !word.is_some_and(|word| TURNS.contains(&word)) {
                self.owner.push(token.clone());
            }
        }
        for (word, is) in [
            (Word::Silent, self.words.is_empty() && unknown.is_empty()),
            (Word::Bare, unknown.is_empty()),
            (Word::Axis, self.axis.is_some()),
        ] {
            self.words.extend(is.then_some(word));
        }
        if self.index.is_empty() {
            self.index = match (self.number, self.axis) {
                (Some(number), _) => number.to_string(),
                (None, Some(axis)) => super::axis(axis).to_owned(),
                (None, None) => unknown.join("_"),
            };
        }
    }

    /// Takes a token that is an axis, a number, or the letter of a part.
    fn take(&mut self, tokens: &[String], k: usize) -> bool {
        let Some(token) = tokens.get(k) else {
            return false;
        };
        let before = k.checked_sub(1).and_then(|k| tokens.get(k));
        let is_part = |word: &Word| matches!(word, Word::Wheel | Word::Joint | Word::Thruster);
        let before = before.and_then(|t| meaning(t).or_else(|| head(t)));
        let follows = before.is_some_and(|word| is_part(&word));
        let ends = k + 1 == tokens.len() && self.words.iter().any(is_part);
        let is_number = is_number(token);
        // H is the sign of a momentum.
        let last = if self.is_momentum() { b'g' } else { b'h' };
        let is_letter = matches!(token.as_bytes(), [c] if (b'a'..=last).contains(c));
        let letter = is_letter && (follows || ends);
        if self.index.is_empty() && (letter || (is_number && follows)) {
            self.index.clone_from(token);
        }
        if is_number {
            // A number that is not the last belongs to the owner.
            if let Some(earlier) = self.number.take() {
                self.owner.push(earlier.to_string());
            }
            self.number = token.parse().ok();
            return true;
        }
        let of_quaternion = self.has(Word::Quaternion) || self.has(Word::Attitude);
        let axis = match token.as_str() {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            "i" if of_quaternion => 0,
            "j" if of_quaternion => 1,
            "k" if of_quaternion => 2,
            "w" | "s" | "scalar" if of_quaternion => 3,
            _ => return letter,
        };
        self.axis = Some(axis);
        true
    }
}

/// The name without a unit in brackets or after a comma, and that unit.
fn bracketed(column: &str) -> (String, Option<Unit>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let found = column.match_indices(open).find_map(|(at, _)| {
            let rest = column.get(at + 1..)?;
            let (inside, after) = rest.split_once(close)?;
            let unit = parse_unit(inside).ok().filter(|_| !is_number(inside))?;
            let stem = format!("{}_{after}", column.get(..at)?);
            Some((stem, Some(unit)))
        });
        if let Some(found) = found {
            return found;
        }
    }
    match column.rsplit_once(", ") {
        Some((stem, last)) if parse_unit(last).is_ok() => (stem.to_owned(), parse_unit(last).ok()),
        _ => (column.to_owned(), None),
    }
}

fn is_number(inside: &str) -> bool {
    inside.bytes().all(|b| b.is_ascii_digit())
}

/// Tokens in lower case: parted at other characters than letters and digits, before capitals, and between letters and
/// digits; a token of several words of the vocabulary is parted too.
fn split(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().collect();
    let mut tokens = vec![String::new()];
    for (k, &c) in letters.iter().enumerate() {
        let before = k.checked_sub(1).and_then(|k| letters.get(k)).copied();
        let after = letters.get(k + 1).is_some_and(|c| c.is_lowercase());
        let parts = before.is_some_and(|b| {
            (b.is_ascii_digit() != c.is_ascii_digit() && !(c == '2' && squared(&tokens)))
                || (b.is_lowercase() && c.is_uppercase())
                || (b.is_uppercase() && c.is_uppercase() && after)
        });
        if parts || !c.is_alphanumeric() {
            tokens.push(String::new());
        }
        if let Some(token) = tokens.last_mut().filter(|_| c.is_alphanumeric()) {
            token.extend(c.to_lowercase());
        }
    }
    let tokens = tokens.into_iter().filter(|token| !token.is_empty());
    tokens
        .flat_map(|token| segments(&token).unwrap_or(vec![token]))
        .collect()
}

/// Whether the last token is the `s` of a unit, as in `m_s2`.
fn squared(tokens: &[String]) -> bool {
    tokens
        .last()
        .is_some_and(|t| matches!(t.as_str(), "s" | "mps"))
}

/// The words of which a token consists, as `omegax` or `wheelspeed`; `None` if it does not.
fn segments(token: &str) -> Option<Vec<String>> {
    let is_word = |text: &str| meaning(text).is_some() || vocabulary().units.contains_key(text);
    if is_word(token) || !(2..=LONGEST).contains(&token.len()) || !token.is_ascii() {
        return None;
    }
    let is_axis = |text: &str| matches!(text, "x" | "y" | "z" | "w");
    let (first, rest) = token.split_at(1);
    let parted = |a: &str, b: &str| Some(vec![a.to_owned(), b.to_owned()]);
    if is_axis(rest) && head(first).is_some() && (rest != "w" || first == "q") {
        return parted(first, rest);
    }
    if is_axis(first) && rest.len() >= INSIDE && meaning(rest).is_some() {
        return parted(first, rest);
    }
    (2..token.len()).rev().find_map(|at| {
        let (word, rest) = (token.get(..at)?, token.get(at..)?);
        let known = meaning(word).is_some();
        let of_quaternion = meaning(word) == Some(Word::Quaternion);
        let ends = is_axis(rest) && (rest != "w" || of_quaternion);
        let ends = ends || (rest.len() > 1 && is_word(rest));
        let mut tail = match (known, ends) {
            (false, _) => return None,
            (true, true) => vec![rest.to_owned()],
            (true, false) => segments(rest).filter(|_| rest.len() > 2)?,
        };
        tail.insert(0, word.to_owned());
        Some(tail)
    })
}

/// Takes the unit that the tokens spell out of them.
fn spelled(tokens: &mut Vec<String>) -> Option<Unit> {
    let is_component = |t: &String| matches!(t.as_str(), "x" | "y" | "z" | "w") || is_number(t);
    for length in (1..=UNIT_TOKENS).rev() {
        for at in (0..(tokens.len() + 1).saturating_sub(length)).rev() {
            let Some(part) = tokens.get(at..at + length) else {
                continue;
            };
            let text = part.join("_");
            let Some(symbol) = vocabulary().units.get(text.as_str()) else {
                continue;
            };
            let after = tokens.get(at + length..).unwrap_or_default();
            let at_end = after.iter().all(is_component);
            let alone = at == 0 && (length == 1 && text.len() < INSIDE);
            if alone || !(at_end || length > 1 || text.len() >= INSIDE) {
                continue;
            }
            tokens.drain(at..at + length);
            return parse_unit(symbol).ok();
        }
    }
    None
}
