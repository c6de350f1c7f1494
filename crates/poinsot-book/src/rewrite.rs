//! Rewrites the Markdown of a page for mdBook: formulas to MathML, and links to files outside the book to the file's
//! path.

use crate::error::BookError;
use crate::math::mathml;
use crate::repository::{base_of, normal, root, shown_at};
use pulldown_cmark::{CodeBlockKind, Event, LinkType, Options, Parser, Tag};
use std::ops::Range;
use std::path::Path;

/// The text of a page, `page` relative to the book's folder.
///
/// # Errors
/// A formula is invalid, or a linked file is missing.
pub fn rewrite(page: &Path, text: &str) -> Result<String, BookError> {
    let name = page.display().to_string();
    let options = Options::ENABLE_TABLES
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_HEADING_ATTRIBUTES
        | Options::ENABLE_MATH;
    let mut changes: Vec<(Range<usize>, String)> = Vec::new();
    for (event, range) in Parser::new_ext(text, options).into_offset_iter() {
        match event {
            // Dollars around code, as in a shell's ${name}, are not a formula.
            Event::InlineMath(words) if words.contains('`') => {}
            Event::InlineMath(formula) => changes.push((range, mathml(&name, &formula, false)?)),
            Event::DisplayMath(formula) => changes.push((range, mathml(&name, &formula, true)?)),
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(_))) => {
                let block = &text[range.clone()];
                changes.push((range, flush_left(block)));
            }
            Event::Start(Tag::Link {
                link_type: LinkType::Inline,
                dest_url,
                ..
            }) => {
                if let Some(new) = link(page, &text[range.clone()], &dest_url)? {
                    changes.push((range, new));
                }
            }
            Event::Start(Tag::Image {
                link_type: LinkType::Inline,
                dest_url,
                ..
            }) => {
                // A picture within a link is part of the words of that link.
                let within = changes
                    .last()
                    .is_some_and(|(link, _)| range.start < link.end);
                if within {
                    continue;
                }
                if let Some(new) = picture(page, &text[range.clone()], &dest_url) {
                    changes.push((range, new));
                }
            }
            _ => {}
        }
    }
    let mut out = text.to_owned();
    for (range, new) in changes.into_iter().rev() {
        out.replace_range(range, &new);
    }
    Ok(out)
}

/// A fenced block without common indentation: snippets come from inside functions.
fn flush_left(block: &str) -> String {
    let last = block.trim_end().lines().count().saturating_sub(1);
    let code = |k: usize, line: &str| k > 0 && k < last && !line.trim().is_empty();
    let indent = |line: &str| line.len() - line.trim_start_matches(' ').len();
    let lines = || block.lines().enumerate();
    let shared = lines().filter(|(k, l)| code(*k, l)).map(|(_, l)| indent(l));
    let shared = shared.min().unwrap_or(0);
    let mut out: String = lines()
        .map(|(k, line)| {
            let cut = if code(k, line) { shared } else { 0 };
            format!("{}\n", &line[cut..])
        })
        .collect();
    if !block.ends_with('\n') {
        out.pop();
    }
    out
}

/// The link in the book; `None` if it is unchanged.
fn link(page: &Path, written: &str, target: &str) -> Result<Option<String>, BookError> {
    if target.starts_with('#') || target.contains("://") || target.starts_with("mailto:") {
        return Ok(None);
    }
    let missing = || BookError::Missing {
        page: page.display().to_string(),
        target: target.to_owned(),
    };
    let (path, fragment) = target.split_once('#').unwrap_or((target, ""));
    let file = normal(&base_of(page).join(path)).ok_or_else(missing)?;
    if !root().join(&file).exists() {
        return Err(missing());
    }
    let fragment = if fragment.is_empty() {
        String::new()
    } else {
        format!("#{fragment}")
    };
    let words = written
        .rfind("](")
        .and_then(|end| written.get(1..end))
        .unwrap_or(target);
    Ok(match place_in_book(&file) {
        Some(inside) => Some(format!("[{words}]({}{fragment})", from(page, &inside))),
        None if words.trim_matches('`') == file.display().to_string() => {
            Some(format!("`{}`", file.display()))
        }
        None => Some(format!("{words} (`{}`)", file.display())),
    })
}

/// The picture in the book; `None` if it is not in the folder of the book, whose check then finds it missing.
fn picture(page: &Path, written: &str, target: &str) -> Option<String> {
    let inside = place_in_book(&normal(&base_of(page).join(target))?)?;
    let new = format!("]({})", from(page, &inside));
    Some(written.replacen(&format!("]({target})"), &new, 1))
}

/// The page or figure of the book for a file of the repository.
fn place_in_book(file: &Path) -> Option<String> {
    let inside = || {
        let inside = file.strip_prefix("docs").ok()?;
        root()
            .join(file)
            .is_file()
            .then(|| inside.display().to_string())
    };
    shown_at(file).or_else(inside)
}

/// A path of the book relative to a page.
fn from(page: &Path, target: &str) -> String {
    let depth = page.components().count().saturating_sub(1);
    let mut out = "../".repeat(depth);
    out.push_str(target);
    out
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn on(page: &str, text: &str) -> String {
        rewrite(Path::new(page), text).unwrap()
    }

    #[test]
    fn unit_code_is_left_alone() {
        let text = "`$x$` and\n\n```text\n$y$ [a](b)\n```\n";
        assert_eq!(on("start.md", text), text);
    }

    #[test]
    fn unit_dollars_of_a_shell_are_no_formula() {
        let text = "${...} (`import`) and `\"${m}\"`\n";
        assert_eq!(on("start.md", text), text);
    }

    #[test]
    fn unit_snippets_begin_at_the_left_edge() {
        assert_eq!(
            on("start.md", "```rust\n    a\n\n      b\n```\n\ntext\n"),
            "```rust\na\n\n  b\n```\n\ntext\n"
        );
    }

    #[test]
    fn unit_links_lead_to_pages_or_name_files() {
        assert_eq!(
            on("methods/a.md", "[n](../../NOTATION.md#units)"),
            "[n](../reference/notation.md#units)"
        );
        assert_eq!(
            on("explanation/design.md", "[one](docs/methods/ma2008.md)"),
            "[one](../methods/ma2008.md)"
        );
        assert_eq!(
            on("start.md", "[model](../data/stsat3/model.toml)"),
            "model (`data/stsat3/model.toml`)"
        );
        assert_eq!(
            on(
                "howto/a.md",
                "[x](../../crates/poinsot/explanations/E0111.md)"
            ),
            "[x](../reference/errors.md#e0111)"
        );
        assert_eq!(
            on("start.md", "[x](../crates/poinsot/explanations)"),
            "[x](reference/errors.md)"
        );
        assert_eq!(
            on("architecture.md", "![x](docs/assets/architecture.svg)"),
            "![x](assets/architecture.svg)"
        );
        assert_eq!(on("start.md", "![x](gone.svg)"), "![x](gone.svg)");
        assert_eq!(on("start.md", "[x](#there)"), "[x](#there)");
        assert!(rewrite(Path::new("start.md"), "[x](nowhere.md)").is_err());
    }
}
