//! Fragments of TOML text.

use std::fmt::Write;

pub(crate) fn section(out: &mut String, header: &str) {
    let _ = writeln!(out, "\n{header}");
}

pub(crate) fn line(out: &mut String, key: &str, value: String) {
    let _ = writeln!(out, "{key} = {value}");
}

/// A TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Shortest text that reads back to the same number.
pub(crate) fn number(x: f64) -> String {
    format!("{x:?}")
}
