//! A document as terminal text.

use crate::document::{Document, Section, Tone};
use anstyle::{AnsiColor, Effects, Style};
use poinsot_files::escaped;
use std::fmt;
use unicode_width::UnicodeWidthStr;

/// Width of a table where its words and numbers fit into it.
const WIDTH: usize = 110;
/// Least width of a table.
const NARROWEST: u16 = 40;
/// Longest cell of a column of numbers that is never wrapped.
const NUMBER: usize = 24;
/// Cell text that is highlighted.
const OPEN: &str = "not identifiable";

/// Print style of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TextStyle {
    /// Terminal width at which sentences are wrapped. `None`: one line per sentence.
    pub width: Option<u16>,
    /// Whether colours may be used.
    pub colour: bool,
}

impl fmt::Display for Document {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(&TextStyle::default()))
    }
}

impl Document {
    /// The document as text.
    pub fn text(&self, style: &TextStyle) -> String {
        let verdict = wrapped(&escaped(&self.verdict), "", style);
        let mut out = painted(&verdict, self.tone.style().bold(), style);
        out.push('\n');
        for section in &self.sections {
            let title = wrapped(&escaped(&section.title), "", style);
            let heading = section.tone.style().bold();
            out.push_str(&format!("\n{}\n", painted(&title, heading, style)));
            out.push_str(&section.text(style));
            if let Some(note) = &section.note {
                let note = wrapped(&format!("({})", escaped(note)), "  ", style);
                out.push_str(&painted(&note, Style::new().dimmed(), style));
                out.push('\n');
            }
        }
        out
    }
}

impl Tone {
    fn style(self) -> Style {
        let colour = match self {
            Self::Plain => return Style::new(),
            Self::Good => AnsiColor::Green,
            Self::Fair => AnsiColor::Yellow,
            Self::Bad => AnsiColor::Red,
        };
        Style::new().fg_color(Some(colour.into()))
    }
}

impl Section {
    /// The content as text: the table and the sentences.
    ///
    /// ```
    /// use poinsot_figures::{Section, TextStyle};
    ///
    /// let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
    /// let section = Section { head: row(["", "kg"]), rows: vec![row(["bus", "41.5"])], ..Section::default() };
    /// assert_eq!(section.text(&TextStyle::default()), "         kg\n  bus  41.5\n");
    /// ```
    pub fn text(&self, style: &TextStyle) -> String {
        let (heads, table) = layout(self, style);
        let open = painted(OPEN, Tone::Fair.style(), style);
        let table = table.iter().enumerate().map(|(k, line)| match k < heads {
            true => painted(line, Style::new().dimmed(), style),
            false => line.replace(OPEN, &open),
        });
        let lines = self.lines.iter();
        let lines = lines.map(|line| wrapped(&escaped(line), "  ", style));
        table.chain(lines).map(|line| line + "\n").collect()
    }
}

impl TextStyle {
    /// Lines of text, each wrapped at the width; what follows is indented to its first word and two blanks.
    ///
    /// ```
    /// use poinsot_figures::TextStyle;
    ///
    /// let style = TextStyle { width: Some(40), colour: false };
    /// let text = "  a line of more than the forty columns of the terminal\n";
    /// assert_eq!(style.wrapped(text), "  a line of more than the forty columns\n    of the terminal\n");
    /// ```
    pub fn wrapped(&self, text: &str) -> String {
        let lines = text.lines().map(|line| wrapped(line, "", self) + "\n");
        lines.collect()
    }
}

/// Number of lines of the head, and all lines. A table that does not fit becomes a block of lines `name: value` for each row.
fn layout(section: &Section, style: &TextStyle) -> (usize, Vec<String>) {
    if section.rows.is_empty() {
        return Default::default();
    }
    let rows = std::iter::once(&section.head).chain(&section.rows);
    let plain = |row: &Vec<String>| row.iter().map(|c| escaped(c).into_owned()).collect();
    let rows: Vec<Vec<String>> = rows.map(plain).collect();
    let room = usize::from(style.width.map_or(u16::MAX, |w| w.max(NARROWEST)));
    // Whole words if they fit, then words that are broken.
    let fitted = |limit| widths(section, &rows, limit);
    let tries = [(true, room.min(WIDTH)), (true, room), (false, room)];
    if let Some(widths) = tries.into_iter().find_map(fitted) {
        let lines = rows.iter().flat_map(|row| aligned(row, &widths));
        return (aligned(&rows[0], &widths).len(), lines.collect());
    }
    let mut lines = Vec::new();
    for row in &rows[1..] {
        for (k, (name, cell)) in rows[0].iter().zip(row).enumerate() {
            let colon = if name.is_empty() { "" } else { ": " };
            let indent = if k == 0 { "  " } else { "    " };
            if !cell.is_empty() {
                lines.push(wrapped(&format!("{name}{colon}{cell}"), indent, style));
            }
        }
    }
    (0, lines)
}

/// Widths of the columns, so that a line has at most `width` columns of the terminal: numbers keep theirs, text is wrapped.
/// `None` where some word or number is too long.
fn widths(of: &Section, rows: &[Vec<String>], (whole, width): (bool, usize)) -> Option<Vec<usize>> {
    let parts = |word| if whole { vec![word] } else { pieces(word) };
    // The least and the natural width of each column.
    let range = |(k, is_text): (usize, bool)| {
        let cells = rows.iter().enumerate();
        let cells = cells.filter_map(|(n, row)| Some((n > 0 && !is_text, row.get(k)?)));
        cells.fold((0, 0), |(least, natural), (is_number, cell)| {
            let parts = cell.split_whitespace().flat_map(parts);
            let own = match is_number && cell.width() <= NUMBER {
                true => cell.width(),
                false => parts.map(UnicodeWidthStr::width).max().unwrap_or(0),
            };
            (least.max(own), natural.max(cell.width()))
        })
    };
    let columns = of.text_columns().into_iter().enumerate();
    let ranges: Vec<_> = columns.map(range).collect();
    let within = |most: usize| ranges.iter().map(move |&(a, b)| most.clamp(a, b));
    let fits = |most: &usize| within(*most).sum::<usize>() + 2 * ranges.len() <= width;
    let most = (0..=width).rev().find(fits)?;
    Some(within(most).collect())
}

/// A row as lines; the first column is aligned left, all others right.
fn aligned(row: &[String], widths: &[usize]) -> Vec<String> {
    let cells = row.iter().zip(widths);
    let cells: Vec<Vec<String>> = cells.map(|(c, w)| folded(c, *w, *w)).collect();
    let height = cells.iter().map(Vec::len).max().unwrap_or(0);
    let line = |n: usize| {
        let mut line = String::new();
        for (k, (cell, width)) in cells.iter().zip(widths).enumerate() {
            let cell = cell.get(n).map_or("", String::as_str);
            let blank = " ".repeat(width.saturating_sub(cell.width()));
            let (before, after) = blank.split_at(if k == 0 { 0 } else { blank.len() });
            line += &format!("  {before}{cell}{after}");
        }
        line.trim_end().to_owned()
    };
    (0..height).map(line).collect()
}

/// Wraps a sentence at the terminal width; later lines are indented to the first word.
fn wrapped(text: &str, indent: &str, style: &TextStyle) -> String {
    let Some(width) = style.width else {
        return format!("{indent}{text}");
    };
    let own = text.len() - text.trim_start().len();
    let indent = format!("{indent}{}", &text[..own]);
    let room = usize::from(width.max(NARROWEST)).saturating_sub(indent.width());
    let lines = folded(text, room, room.saturating_sub(2));
    format!("{indent}{}", lines.join(&format!("\n{indent}  ")))
}

/// Lines of at most `width`, the first of at most `first`: broken between words, and within a word that is longer.
fn folded(text: &str, first: usize, width: usize) -> Vec<String> {
    if text.width() <= first {
        return vec![text.trim_start().to_owned()];
    }
    let (mut lines, mut line) = (Vec::new(), String::new());
    for word in text.split_whitespace() {
        let is_long = word.width() > width;
        let parts = if is_long { pieces(word) } else { vec![word] };
        for (k, part) in parts.into_iter().enumerate() {
            let room = if lines.is_empty() { first } else { width };
            let gap = if k == 0 && !line.is_empty() { " " } else { "" };
            if !line.is_empty() && line.width() + gap.len() + part.width() > room {
                lines.push(std::mem::replace(&mut line, part.to_owned()));
            } else {
                line += gap;
                line += part;
            }
        }
    }
    lines.push(line);
    lines
}

/// The parts of a word between which a line may end: after `.`, `_` and `/`, unless it has a decimal number.
fn pieces(word: &str) -> Vec<&str> {
    let mut ends = word.split('.').skip(1);
    match ends.any(|end| end.starts_with(|c: char| c.is_ascii_digit())) {
        true => vec![word],
        false => word.split_inclusive(['.', '_', '/']).collect(),
    }
}

fn painted(text: &str, paint: Style, style: &TextStyle) -> String {
    if style.colour && paint != Style::new() {
        format!("{paint}{text}{paint:#}")
    } else {
        text.to_owned()
    }
}

/// Error line with its code, such as `E0104`, in bold red.
///
/// ```
/// use poinsot_figures::marked_code;
///
/// assert!(marked_code("E0103 mass_kg is negative").contains("E0103"));
/// assert_eq!(marked_code("no code"), "no code");
/// ```
pub fn marked_code(line: &str) -> String {
    let is_code = |w: &str| {
        w.strip_prefix('E')
            .is_some_and(|n| n.len() == 4 && n.bytes().all(|b| b.is_ascii_digit()))
    };
    let paint = Tone::Bad.style().effects(Effects::BOLD);
    match line.split_once(' ') {
        Some((code, rest)) if is_code(code) => format!("{paint}{code}{paint:#} {rest}"),
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document() -> Document {
        Document::parse(
            "a verdict of quite a number of words, more than fit into a narrow terminal\n\
             # numbers\n| | value | unit |\n| mass | not identifiable | kg |\n\
             #fair warnings\n- \u{1b}[2Ja sentence that is certainly longer than the forty columns of the \
             narrowest terminal\n",
        )
        .toned(Tone::Fair)
    }

    /// Text without colour codes.
    fn bare(text: &str) -> String {
        let mut out = String::new();
        let mut inside = false;
        for c in text.chars() {
            match c {
                '\u{1b}' => inside = true,
                'm' if inside => inside = false,
                _ if inside => {}
                c => out.push(c),
            }
        }
        out
    }

    #[test]
    fn unit_lines_end_before_the_edge() {
        for width in [40, 60, 80] {
            let text = document().text(&TextStyle {
                width: Some(width),
                colour: false,
            });
            for line in text.lines() {
                assert!(
                    line.chars().count() <= usize::from(width),
                    "{width}: {line}"
                );
            }
        }
    }

    #[test]
    fn unit_lines_end_between_words_and_never_within_numbers() {
        assert_eq!(
            pieces("aft.inertia_kg_m2"),
            ["aft.", "inertia_", "kg_", "m2"]
        );
        assert_eq!(pieces("-13.916097e-2").len(), 1);
        assert_eq!(
            folded("one two/three 4.5", 7, 7),
            ["one", "two/", "three", "4.5"]
        );
        assert_eq!(folded("no_break here", 8, 8), ["no_break", "here"]);
    }

    #[test]
    fn unit_a_table_wraps_text_and_becomes_blocks_where_that_is_not_enough() {
        let parsed = |cell: &str| {
            Document::parse(&format!(
                "verdict\n# title\n| | value | meaning |\n| mass | {cell} | quite a number of words that say it |\n"
            ))
        };
        let at = |document: Document| {
            document.text(&TextStyle {
                width: Some(40),
                colour: false,
            })
        };
        assert_eq!(
            at(parsed("13.916097")),
            "verdict\n\ntitle\n            value                meaning\n  mass  13.916097      quite a number of\n                       words that say it\n"
        );
        let long = "1234567890123456789012345678901234567890";
        assert_eq!(
            at(parsed(&long[..34])),
            format!(
                "verdict\n\ntitle\n  mass\n    value:\n      {}\n    meaning: quite a number of words\n      that say it\n",
                &long[..34]
            )
        );
    }

    #[test]
    fn unit_colours_add_nothing_but_colours() {
        let style = |colour| TextStyle {
            width: Some(70),
            colour,
        };
        let (plain, coloured) = (
            document().text(&style(false)),
            document().text(&style(true)),
        );
        assert!(!plain.contains('\u{1b}'));
        assert!(coloured.contains("\u{1b}["));
        assert_eq!(bare(&coloured), plain);
    }

    #[test]
    fn unit_a_code_is_marked_and_nothing_else() {
        assert!(marked_code("E0104 model.toml:3").contains("\u{1b}["));
        assert_eq!(marked_code("Every thing"), "Every thing");
    }
}
