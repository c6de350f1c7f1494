//! Checks the prose of all pages: words, sentence length, size, links, and, with a network, spelling and style.

mod links;
mod prose;
mod style;

use crate::fault::Fault;
use crate::repository::{listed, read, root};
use crate::words::Words;
use prose::Prose;
use std::collections::BTreeMap;

/// Most words of a page, code and tables included.
const MOST_WORDS: [(&str, usize); 2] = [("README.md", 900), ("DESIGN.md", 3000)];
/// Pages for a first reader have short sentences: the average, in words, is below this.
const AVERAGE_SENTENCE: usize = 18;
const FIRST_PAGES: [&str; 2] = ["README.md", "docs/tutorial"];
/// Made by the program, whose messages have a test of their own.
const GENERATED: [&str; 7] = [
    "docs/validation.md",
    "docs/reference/case.md",
    "docs/reference/commands.md",
    "docs/reference/formats.md",
    "docs/reference/python_api.md",
    "docs/reference/results.md",
    "docs/reference/verdicts.md",
];
/// Notes on data of tests.
const OF_TESTS: [&str; 2] = ["validation/", "fixtures/"];
/// Folders of the book that a page lists by itself.
const LISTED_BY_PAGE: [&str; 2] = ["methods/", "validation/"];
const CONTENTS: &str = "docs/SUMMARY.md";

/// Text of each page with words of a person, by its path from the root.
pub type Pages = BTreeMap<String, String>;

/// Checks all pages and prints how many there are.
pub fn run(offline: bool, figures: bool) -> Result<(), Fault> {
    let (pages, prose) = (pages()?, Prose::new()?);
    if figures {
        for (name, text) in &pages {
            println!(
                "{name}: {} words, {:.1} words a sentence",
                words_of(text),
                prose.average(text)
            );
        }
    }
    let mut faults = check_words(&pages, &prose)?;
    faults.extend(check_length(&pages, &prose));
    faults.extend(check_size(&pages)?);
    faults.extend(links::check(&pages, &prose)?);
    faults.extend(check_contents(&pages)?);
    if !offline {
        faults.extend(style::check(&pages, &prose)?);
    }
    if faults.is_empty() {
        println!("{} pages: no fault", pages.len());
        return Ok(());
    }
    let count = faults.len();
    Err(Fault::Failed(format!(
        "{}\n{count} faults in {} pages",
        faults.join("\n"),
        pages.len()
    )))
}

fn pages() -> Result<Pages, Fault> {
    let mut found = Pages::new();
    for name in listed(&["*.md"])? {
        let path = root().join(&name);
        let of_tests = OF_TESTS.iter().any(|folder| name.starts_with(folder));
        if path.exists() && !GENERATED.contains(&name.as_str()) && !of_tests {
            let text = read(&path)?;
            found.insert(name, text);
        }
    }
    Ok(found)
}

fn words_of(text: &str) -> usize {
    text.split_whitespace().count()
}

fn page<'a>(pages: &'a Pages, name: &str) -> Result<&'a str, Fault> {
    let text = pages.get(name).map(String::as_str);
    text.ok_or_else(|| Fault::Failed(format!("{name}: no such page")))
}

/// Words of docs/words.txt in prose.
fn check_words(pages: &Pages, prose: &Prose) -> Result<Vec<String>, Fault> {
    let words = Words::of_pages()?;
    let mut faults = Vec::new();
    for (name, text) in pages {
        let found = prose.of(text, true);
        let found = words.found_in(&found).into_iter();
        faults.extend(found.map(|(used, write)| format!("{name}: '{used}'; write: {write}")));
    }
    Ok(faults)
}

fn check_length(pages: &Pages, prose: &Prose) -> Vec<String> {
    let is_first = |name: &str| {
        FIRST_PAGES.iter().any(|first| {
            name.strip_prefix(first)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        })
    };
    let mut faults = Vec::new();
    for (name, text) in pages.iter().filter(|(name, _)| is_first(name)) {
        let mean = prose.average(text);
        println!("{name}: {mean:.1} words a sentence (limit {AVERAGE_SENTENCE})");
        if mean >= AVERAGE_SENTENCE as f64 {
            faults.push(format!(
                "{name}: {mean:.1} words a sentence; shorten to below {AVERAGE_SENTENCE}"
            ));
        }
    }
    faults
}

fn check_size(pages: &Pages) -> Result<Vec<String>, Fault> {
    let mut faults = Vec::new();
    for (name, most) in MOST_WORDS {
        let count = words_of(page(pages, name)?);
        println!("{name}: {count} words (limit {most})");
        if count > most {
            faults.push(format!("{name}: {count} words; at most {most}"));
        }
    }
    Ok(faults)
}

/// Every page of the book is in its contents.
fn check_contents(pages: &Pages) -> Result<Vec<String>, Fault> {
    let contents = page(pages, CONTENTS)?;
    let missing = pages.keys().filter(|name| {
        let Some(inside) = name.strip_prefix("docs/") else {
            return false;
        };
        let listed = *name == CONTENTS
            || LISTED_BY_PAGE
                .iter()
                .any(|folder| inside.starts_with(folder));
        !listed && !contents.contains(&format!("({inside})"))
    });
    Ok(missing
        .map(|name| format!("{name}: not in {CONTENTS}"))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_page_outside_the_contents_is_found() {
        let texts = [
            (CONTENTS, "[a](a.md)"),
            ("docs/a.md", ""),
            ("docs/b.md", ""),
            ("docs/methods/c.md", ""),
            ("d.md", ""),
        ];
        let pages: Pages = texts
            .map(|(name, text)| (name.to_owned(), text.to_owned()))
            .into();
        assert_eq!(
            check_contents(&pages).unwrap(),
            ["docs/b.md: not in docs/SUMMARY.md"]
        );
    }
}
