//! A document as terminal text.

use crate::document::{Document, Section, Tone};
use anstyle::{AnsiColor, Effects, Style};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement};
use poinsot_files::escaped;
use std::fmt;

/// Width of tables if the terminal width is unknown.
const WIDTH: u16 = 110;
/// Least width of a table.
const NARROWEST: u16 = 40;
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
            out.push_str(&content(section, style));
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

fn content(section: &Section, style: &TextStyle) -> String {
    let mut out = String::new();
    for (k, line) in layout(section, style).iter().enumerate() {
        let line = if k == 0 {
            painted(line, Style::new().dimmed(), style)
        } else {
            line.replace(OPEN, &painted(OPEN, Tone::Fair.style(), style))
        };
        out.push_str(&format!("{line}\n"));
    }
    for line in &section.lines {
        out.push_str(&wrapped(&escaped(line), "  ", style));
        out.push('\n');
    }
    out
}

/// Lines of the table, the head first; none without rows.
fn layout(section: &Section, style: &TextStyle) -> Vec<String> {
    if section.rows.is_empty() {
        return Vec::new();
    }
    let mut table = comfy_table::Table::new();
    // One column less for the leading blank of each line.
    let width = style.width.map_or(WIDTH, |w| w.clamp(NARROWEST, WIDTH) - 1);
    table
        .load_style(NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(width);
    table.set_header(section.head.iter().map(|h| escaped(h).into_owned()));
    for row in &section.rows {
        table.add_row(row.iter().map(|c| escaped(c).into_owned()));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let lines = table.lines();
    lines.map(|line| format!(" {}", line.trim_end())).collect()
}

/// Wraps a sentence at the terminal width; later lines are indented to the first word.
fn wrapped(text: &str, indent: &str, style: &TextStyle) -> String {
    let Some(width) = style.width else {
        return format!("{indent}{text}");
    };
    let width = usize::from(width.max(NARROWEST));
    let own = text.len() - text.trim_start().len();
    let hang = format!("{indent}{}  ", &text[..own]);
    let mut lines = vec![format!("{indent}{}", &text[..own])];
    let mut fresh = true;
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        let used = lines[last].chars().count();
        if !fresh && used + 1 + word.chars().count() > width {
            lines.push(format!("{hang}{word}"));
        } else {
            if !fresh {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        }
        fresh = false;
    }
    lines.join("\n")
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
