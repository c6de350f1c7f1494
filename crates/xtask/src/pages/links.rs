//! Links between files of the repository; the book checks its own once more, as HTML.

use super::Pages;
use super::prose::Prose;
use crate::fault::Fault;
use crate::repository::{is_ignored, normal, pattern, read, root};
use regex::Regex;
use std::collections::HashSet;

struct Patterns {
    code: Regex,
    target: Regex,
    heading: Regex,
    sign: Regex,
    white: Regex,
}

/// Links to files or headings that are not there.
pub fn check(pages: &Pages, prose: &Prose) -> Result<Vec<String>, Fault> {
    let patterns = Patterns {
        code: pattern(r"`[^`\n]+`")?,
        target: pattern(r"\]\(([^)\s]+)\)")?,
        heading: pattern(r"(?m)^#+ +(.*)$")?,
        sign: pattern(r"[^\w\s-]")?,
        white: pattern(r"\s")?,
    };
    let mut faults = Vec::new();
    for (name, text) in pages {
        let text = prose.without_code(text);
        let body = patterns.code.replace_all(&text, "");
        for target in patterns
            .target
            .captures_iter(&body)
            .filter_map(|found| found.get(1))
        {
            if let Some(why) = fault(&patterns, prose, name, target.as_str())? {
                faults.push(format!("{name}: link to '{}': {why}", target.as_str()));
            }
        }
    }
    Ok(faults)
}

/// What is wrong with a link of a page.
fn fault(
    patterns: &Patterns,
    prose: &Prose,
    page: &str,
    target: &str,
) -> Result<Option<&'static str>, Fault> {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    if path.contains("://") || path.starts_with("mailto:") {
        return Ok(None);
    }
    let page = root().join(page);
    let file = match path.is_empty() {
        true => page,
        false => normal(&page.with_file_name("").join(path)),
    };
    if !file.exists() {
        return Ok((!is_ignored(&file)?).then_some("no such file"));
    }
    if anchor.is_empty() || file.extension().is_none_or(|end| end != "md") {
        return Ok(None);
    }
    let text = read(&file)?;
    let known = text.contains("{{#include") || anchors(patterns, prose, &text).contains(anchor);
    Ok((!known).then_some("no such heading"))
}

/// Anchors of a page as the book and GitHub make them.
fn anchors(patterns: &Patterns, prose: &Prose, text: &str) -> HashSet<String> {
    let text = prose.without_code(text);
    let headings = patterns
        .heading
        .captures_iter(&text)
        .filter_map(|found| found.get(1));
    let anchor = |heading: &str| {
        let plain = prose.without_links(heading).replace(['`', '*'], "");
        let plain = plain.trim().to_lowercase();
        let plain = patterns.sign.replace_all(&plain, "");
        patterns.white.replace_all(&plain, "-").into_owned()
    };
    headings.map(|heading| anchor(heading.as_str())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_planted_broken_links_are_found() {
        let text = "# A `b` [c](README.md)\n\n[x](#a-b-c) [y](#none) [z](no_such.md) [w](https://a.b) `[v](no.md)`";
        let pages = Pages::from([("README.md".to_owned(), text.to_owned())]);
        let found = check(&pages, &Prose::new().unwrap()).unwrap();
        // Headings are those of the file, which has none of these.
        let expected = [
            "#a-b-c': no such heading",
            "#none': no such heading",
            "no_such.md': no such file",
        ];
        assert_eq!(
            found,
            expected.map(|end| format!("README.md: link to '{end}"))
        );
    }
}
