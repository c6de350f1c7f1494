//! Texts in Rust sources: string literals and comments for documentation, with their lines.

use crate::fault::Fault;
use crate::repository::pattern;
use regex::{Captures, Regex};

/// Reads texts out of sources.
pub struct Reader {
    tests: Regex,
    joined_line: Regex,
    escape: Regex,
    documentation: Regex,
    slashes: Regex,
    between_tags: Regex,
}

/// Line, counted from 1, and text.
pub type Found = (usize, String);

enum Token<'a> {
    Other,
    Raw(&'a str),
    Escaped(&'a str),
}

impl Reader {
    /// Compiles its patterns.
    pub fn new() -> Result<Self, Fault> {
        Ok(Self {
            tests: pattern(r"#\[cfg\(test\)\]\s*(pub(\(crate\))? )?mod \w+ \{")?,
            joined_line: pattern(r"\\\n\s*")?,
            escape: pattern(r#"\\["nt\\]"#)?,
            documentation: pattern(r"(?m)(?:^\s*///[^\n]*\n)+")?,
            slashes: pattern(r"(?m)^\s*/// ?")?,
            between_tags: pattern(r">([^<>{}]+)<")?,
        })
    }

    /// Every string literal of a source, outside its tests.
    pub fn texts(&self, source: &str) -> Vec<Found> {
        let end = self
            .tests
            .find(source)
            .map_or(source.len(), |tests| tests.start());
        let mut found = Vec::new();
        let (mut rest, mut line) = (&source[..end], 1);
        while !rest.is_empty() {
            let (length, token) = next_token(rest);
            match token {
                Token::Other => {}
                Token::Raw(text) => found.push((line, text.to_owned())),
                Token::Escaped(text) => found.push((line, self.unescaped(text))),
            }
            line += newlines(&rest[..length]);
            rest = &rest[length..];
        }
        found
    }

    /// Every paragraph of comments for documentation; its line is that where the block begins.
    pub fn comments(&self, source: &str) -> Vec<Found> {
        let mut found = Vec::new();
        for block in self.documentation.find_iter(source) {
            let line = newlines(&source[..block.start()]) + 1;
            let plain = self
                .slashes
                .replace_all(block.as_str().trim_start_matches('\n'), "");
            found.extend(
                plain
                    .split("\n\n")
                    .map(|paragraph| (line, one_line(paragraph))),
            );
        }
        found
    }

    /// Every text between tags of a template.
    pub fn templates(&self, source: &str) -> Vec<Found> {
        let texts = self.between_tags.captures_iter(source);
        let texts = texts.filter_map(|text| Some((text.get(0)?.start(), text.get(1)?.as_str())));
        texts
            .map(|(at, text)| (newlines(&source[..at]) + 1, one_line(text)))
            .collect()
    }

    fn unescaped(&self, text: &str) -> String {
        let joined = self.joined_line.replace_all(text, "");
        let plain = self
            .escape
            .replace_all(&joined, |escape: &Captures<'_>| match &escape[0] {
                r"\n" => "\n",
                r"\t" => "\t",
                r"\\" => "\\",
                _ => "\"",
            });
        plain.into_owned()
    }
}

/// A text with single blanks for all white space.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn newlines(text: &str) -> usize {
    text.matches('\n').count()
}

/// Length and kind of the token at the start of a source.
fn next_token(rest: &str) -> (usize, Token<'_>) {
    comment(rest)
        .map(|length| (length, Token::Other))
        .or_else(|| raw(rest))
        .or_else(|| quoted(rest))
        .or_else(|| Some((character(rest)?, Token::Other)))
        .unwrap_or_else(|| (word(rest), Token::Other))
}

fn comment(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    let inside = rest.strip_prefix("/*")?;
    let end = inside.find("*/")?;
    Some("/*".len() + end + "*/".len())
}

fn raw(rest: &str) -> Option<(usize, Token<'_>)> {
    let after = rest.strip_prefix('b').unwrap_or(rest).strip_prefix('r')?;
    let inside = after.trim_start_matches('#');
    let hashes = &after[..after.len() - inside.len()];
    let inside = inside.strip_prefix('"')?;
    let closing = format!("\"{hashes}");
    let end = inside.find(&closing)?;
    let length = rest.len() - inside.len() + end + closing.len();
    Some((length, Token::Raw(&inside[..end])))
}

fn quoted(rest: &str) -> Option<(usize, Token<'_>)> {
    let inside = rest.strip_prefix('b').unwrap_or(rest).strip_prefix('"')?;
    let mut letters = inside.char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\\' => drop(letters.next()),
            '"' => {
                let length = rest.len() - inside.len() + at + 1;
                return Some((length, Token::Escaped(&inside[..at])));
            }
            _ => {}
        }
    }
    None
}

fn character(rest: &str) -> Option<usize> {
    let inside = rest.strip_prefix('b').unwrap_or(rest).strip_prefix('\'')?;
    let after = match inside.strip_prefix('\\') {
        None => inside.strip_prefix(|letter| !matches!(letter, '\'' | '\n'))?,
        Some(escape) => after_unicode(escape)
            .or_else(|| after_letters(escape.strip_prefix('x')?, 2))
            .filter(|after| after.starts_with('\''))
            .or_else(|| after_letters(escape, 1))?,
    };
    Some(rest.len() - after.strip_prefix('\'')?.len())
}

/// What follows `u{...}`.
fn after_unicode(escape: &str) -> Option<&str> {
    let digits = escape.strip_prefix("u{")?;
    let after = digits.trim_start_matches(is_of_word);
    (after.len() < digits.len())
        .then_some(after)?
        .strip_prefix('}')
}

fn after_letters(text: &str, count: usize) -> Option<&str> {
    let mut letters = text.chars();
    for _ in 0..count {
        letters.next()?;
    }
    Some(letters.as_str())
}

/// A lifetime, a word, or one letter.
fn word(rest: &str) -> usize {
    let inside = rest.strip_prefix('\'').unwrap_or(rest);
    let after = inside.trim_start_matches(is_of_word);
    if after.len() < inside.len() {
        return rest.len() - after.len();
    }
    rest.chars().next().map_or(1, char::len_utf8)
}

fn is_of_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(source: &str) -> Vec<Found> {
        Reader::new().unwrap().texts(source)
    }

    fn lines(found: &[(usize, &str)]) -> Vec<Found> {
        found
            .iter()
            .map(|(line, text)| (*line, (*text).to_owned()))
            .collect()
    }

    #[test]
    fn unit_texts_are_read_past_comments_characters_and_lifetimes() {
        let source = "// \"no\"\n/* \"no\n\" */ f::<'a>('\"', b'\\'', '\\u{22}', '\\x22');\nlet for_r = \"a \\\"b\\\" \\\n    c\\n\";\n";
        assert_eq!(texts(source), lines(&[(4, "a \"b\" c\n")]));
    }

    #[test]
    fn unit_raw_texts_keep_their_signs() {
        let source = "x(r\"a\\n\", br##\"q\"#\n\"##, r#type, b\"bytes\", \"end\")";
        let expected = [(1, "a\\n"), (1, "q\"#\n"), (2, "bytes"), (2, "end")];
        assert_eq!(texts(source), lines(&expected));
    }

    #[test]
    fn unit_texts_end_at_the_tests() {
        let source = "const A: &str = \"a\";\n#[cfg(test)]\nmod tests {\n \"b\"\n}";
        assert_eq!(texts(source), lines(&[(1, "a")]));
    }

    #[test]
    fn unit_comments_are_paragraphs() {
        let source = "use x;\n\n/// One\n/// line.\n///\n/// Two.\nfn f() {}\n";
        let found = Reader::new().unwrap().comments(source);
        assert_eq!(found, lines(&[(2, "One line."), (2, "Two.")]));
    }
}
