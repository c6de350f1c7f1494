//! A document for the terminal.

use crate::document::{Content, Document, Table};
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement};
use std::fmt;

/// Width where the terminal does not say one.
const WIDTH: u16 = 110;

impl fmt::Display for Document {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", printable(&self.verdict))?;
        for section in &self.sections {
            writeln!(f, "\n{}", printable(&section.title))?;
            match &section.content {
                Content::Table(table) => writeln!(f, "{}", layout(table))?,
                Content::List(lines) => {
                    for line in lines {
                        writeln!(f, "  {}", printable(line))?;
                    }
                }
            }
            if let Some(note) = &section.note {
                writeln!(f, "  ({})", printable(note))?;
            }
        }
        Ok(())
    }
}

fn layout(table: &Table) -> String {
    let mut out = comfy_table::Table::new();
    out.load_style(NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDTH);
    out.set_header(table.head.iter().map(|h| printable(h)));
    for row in &table.rows {
        out.add_row(row.iter().map(|c| printable(c)));
    }
    for column in out.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    out.lines()
        .map(|line| format!(" {}", line.trim_end()))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Text from files without control characters: a name must not move the cursor.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect()
}
