//! Escapes text from outside, so that no terminal or browser interprets it, and shortens long lines.

use std::borrow::Cow;

/// Longest line of an error, characters.
pub const LONGEST_LINE: usize = 600;

/// Length to which quoted values and words are shortened at most, characters.
const SHORTEST_RUN: usize = 24;

/// Largest number of runs that are shortened before the middle of the line is cut.
const MOST_RUNS: usize = 8;

/// Mark for omitted text.
const CUT: &str = "...";

/// Whether a terminal or a browser interprets the character: control characters, marks of text direction (Unicode UAX
/// 9), line separators.
pub fn is_unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Text with every unprintable character written as its escape (`\u{1b}`); line ends too.
pub fn escaped(text: &str) -> Cow<'_, str> {
    escaped_except(text, |_| false)
}

/// Escapes text of several lines; line ends and tabs are kept.
pub fn escaped_lines(text: &str) -> Cow<'_, str> {
    escaped_except(text, |c| matches!(c, '\n' | '\t'))
}

fn escaped_except(text: &str, kept: impl Fn(char) -> bool) -> Cow<'_, str> {
    rewritten(text, kept, |c| c.escape_default().to_string())
}

/// Text in which `escape` replaces every unprintable character that is not kept.
fn rewritten(
    text: &str,
    kept: impl Fn(char) -> bool,
    escape: impl Fn(char) -> String,
) -> Cow<'_, str> {
    let bad = |c: char| is_unprintable(c) && !kept(c);
    if !text.contains(bad) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match bad(c) {
            true => out.push_str(&escape(c)),
            false => out.push(c),
        }
    }
    out.into()
}

/// Start of a text, escaped: at most `limit` characters.
pub fn excerpt(text: &str, limit: usize) -> String {
    match text.char_indices().nth(limit) {
        None => escaped(text).into_owned(),
        Some((at, _)) => format!("{}{CUT}", escaped(text.get(..at).unwrap_or_default())),
    }
}

/// JSON text with unprintable characters in strings as `\u....`; the document is unchanged. Line ends and tabs between
/// tokens are kept.
pub fn json_escaped(text: &str) -> Cow<'_, str> {
    let kept = |c| matches!(c, '\n' | '\t' | '\r');
    // All unprintable characters lie below U+10000: one UTF-16 unit.
    rewritten(text, kept, |c| format!("\\u{:04x}", u32::from(c)))
}

/// One line of an error: escaped, at most [`LONGEST_LINE`] characters. The longest values and words are shortened
/// first, then the middle, so that code, place and advice remain.
pub fn error_line(text: &str) -> String {
    // Tabs are harmless in one line.
    let mut line = escaped_except(text, |c| c == '\t').into_owned();
    for _ in 0..MOST_RUNS {
        if line.chars().count() <= LONGEST_LINE {
            return line;
        }
        match shortened(&line) {
            Some(shorter) => line = shorter,
            None => break,
        }
    }
    if line.chars().count() <= LONGEST_LINE {
        return line;
    }
    // The advice, after the last semicolon, is kept whole if code and place still fit.
    let most = LONGEST_LINE * 2 / 3;
    let advice = line.rfind("; ").and_then(|at| line.get(at..));
    let tail = advice
        .map(|a| a.chars().count())
        .filter(|n| *n <= most)
        .unwrap_or(LONGEST_LINE / 3);
    cut_middle(&line, LONGEST_LINE - tail - CUT.len(), tail)
}

/// Shortens the longest run by the excess length of the line, at most to [`SHORTEST_RUN`].
fn shortened(line: &str) -> Option<String> {
    let excess = line.chars().count().saturating_sub(LONGEST_LINE);
    let (start, end, length) = runs(line)
        .map(|(start, end)| {
            let run = line.get(start..end).unwrap_or_default();
            (start, end, run.chars().count())
        })
        .max_by_key(|run| run.2)?;
    let target = length.saturating_sub(excess).max(SHORTEST_RUN);
    if target + CUT.len() >= length {
        return None;
    }
    let kept = target - CUT.len();
    let run = cut_middle(line.get(start..end)?, kept.div_ceil(2), kept / 2);
    Some(format!("{}{run}{}", line.get(..start)?, line.get(end..)?))
}

/// Byte ranges of quoted or bracketed text on one line, and of words outside them.
fn runs(line: &str) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = line.get(at..)?;
        let start = at + rest.find(|c: char| !c.is_whitespace())?;
        let word = line.get(start..)?;
        let quote = word.chars().next().and_then(|c| match c {
            '\'' | '"' => Some(c),
            '{' => Some('}'),
            '[' => Some(']'),
            _ => None,
        });
        let length = match quote.and_then(|q| word.get(1..)?.find(q)) {
            Some(inside) => inside + 2,
            None => word.find(char::is_whitespace).unwrap_or(word.len()),
        };
        at = start + length;
        Some((start, at))
    })
}

/// The first `head` and last `tail` characters with the mark between them.
fn cut_middle(text: &str, head: usize, tail: usize) -> String {
    let count = text.chars().count();
    let start: String = text.chars().take(head).collect();
    let end: String = text.chars().skip(count.saturating_sub(tail)).collect();
    format!("{start}{CUT}{end}")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn exact_escapes_and_direction_marks_become_visible() {
        assert_eq!(escaped("a\u{1b}[31mb"), "a\\u{1b}[31mb");
        assert_eq!(escaped("\u{9b}2J"), "\\u{9b}2J");
        assert_eq!(escaped("x\u{202e}y\nz"), "x\\u{202e}y\\nz");
        assert_eq!(escaped("Größe °"), "Größe °");
        assert_eq!(excerpt("abc\u{1b}def", 4), "abc\\u{1b}...");
    }

    #[test]
    fn exact_json_is_the_same_document() {
        let text = "{\"a\": \"x\u{202e}y\u{9b}\"}\n";
        assert_eq!(json_escaped(text), "{\"a\": \"x\\u202ey\\u009b\"}\n");
    }

    #[test]
    fn exact_an_error_keeps_code_place_and_advice() {
        let value = "9".repeat(5000);
        let line = error_line(&format!(
            "E0203 t.csv:5 column 'x': '{value}' is not a number; write a number"
        ));
        assert_eq!(line.chars().count(), LONGEST_LINE);
        assert!(line.starts_with("E0203 t.csv:5 column 'x': '999"), "{line}");
        assert!(
            line.ends_with("99' is not a number; write a number"),
            "{line}"
        );
    }

    #[test]
    fn exact_a_value_of_many_words_is_one_run() {
        let value = "ab ".repeat(2000);
        let line = error_line(&format!(
            "E0001 --x '{value}': no such thing; name one of them"
        ));
        assert!(line.chars().count() <= LONGEST_LINE);
        assert!(
            line.ends_with("': no such thing; name one of them"),
            "{line}"
        );
    }

    #[test]
    fn exact_a_long_problem_is_cut_before_the_advice() {
        let problem = "this is wrong and that too ".repeat(40);
        let advice =
            "; add a segment with thrust, take estimate out of the base, or use another method";
        let line = error_line(&format!("E0533 {problem}{advice}"));
        assert_eq!(line.chars().count(), LONGEST_LINE);
        assert!(
            line.starts_with("E0533 this") && line.ends_with(advice),
            "{line}"
        );
        let table = format!(
            "E0115 m.toml:8: inertia = {{ {} }}: no body; correct it",
            "xx = 1.0, ".repeat(60)
        );
        let line = error_line(&table);
        assert!(line.ends_with(" }: no body; correct it"), "{line}");
    }

    /// A refusal of the checks of telemetry lost the end of its parenthesis.
    #[test]
    fn regress_a_refusal_with_its_parentheses_is_whole() {
        let text = format!(
            "E0215 {}(increments = true); write it",
            "attitude and gyro ".repeat(17)
        );
        assert_eq!(error_line(&text), text);
    }

    #[test]
    fn prop_no_text_gives_a_line_that_is_too_long() {
        for piece in ["\u{1b}", "ä", "'", "\"x ", "word ", "日本", "\u{202e}\n"] {
            for count in [1, 99, 100, 301, 5000] {
                let line = error_line(&piece.repeat(count));
                assert!(line.chars().count() <= LONGEST_LINE, "{piece:?} {count}");
                assert!(!line.contains(is_unprintable), "{piece:?} {count}");
            }
        }
    }
}
