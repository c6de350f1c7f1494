//! Checks that every link of the built book has a target, and that nothing is loaded from a network.

use crate::error::BookError;
use crate::repository::normal;
use scraper::{Html, Selector};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Elements that load a resource, and their attribute.
const LOADING: [(&str, &str); 6] = [
    ("img", "src"),
    ("script", "src"),
    ("link", "href"),
    ("iframe", "src"),
    ("source", "src"),
    ("object", "data"),
];

/// Links and anchors of a page.
struct Page {
    /// Link targets as written; true for loaded resources.
    links: BTreeSet<(String, bool)>,
    /// Anchors.
    anchors: BTreeSet<String>,
    /// Images without alternative text.
    wordless: Vec<String>,
}

/// Number of pages and links.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checked {
    /// HTML files.
    pub pages: usize,
    /// Links between pages and to figures.
    pub inside: usize,
    /// External links, which are not followed.
    pub outside: usize,
}

/// Checks the links of a folder of HTML.
///
/// # Errors
/// Broken links, or resources loaded from a network.
pub fn check(folder: &Path) -> Result<Checked, BookError> {
    let mut pages = BTreeMap::new();
    read(folder, Path::new(""), &mut pages)?;
    let mut broken = Vec::new();
    let mut checked = Checked {
        pages: pages.len(),
        inside: 0,
        outside: 0,
    };
    for (name, page) in &pages {
        let place = name.display();
        for picture in &page.wordless {
            broken.push(format!("{place}: picture {picture} has no words beside it"));
        }
        for (target, loaded) in &page.links {
            if target.contains("://") || target.starts_with("//") {
                checked.outside += 1;
                if *loaded {
                    broken.push(format!("{place}: loads {target}"));
                }
            } else if !target.starts_with("mailto:") && !target.starts_with("data:") {
                checked.inside += 1;
                if let Err(why) = follow(folder, &pages, name, target) {
                    broken.push(format!("{place}: {target}: {why}"));
                }
            }
        }
    }
    if broken.is_empty() {
        Ok(checked)
    } else {
        Err(BookError::Links(broken))
    }
}

fn follow(
    folder: &Path,
    pages: &BTreeMap<PathBuf, Page>,
    from: &Path,
    target: &str,
) -> Result<(), &'static str> {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let file = if path.is_empty() {
        from.to_owned()
    } else {
        let near = from.parent().unwrap_or(Path::new("")).join(path);
        normal(&near).ok_or("leaves the book")?
    };
    if !folder.join(&file).is_file() {
        return Err("no such file");
    }
    match pages.get(&file) {
        Some(page) if !anchor.is_empty() && !page.anchors.contains(anchor) => Err("no such anchor"),
        _ => Ok(()),
    }
}

fn read(
    folder: &Path,
    inside: &Path,
    pages: &mut BTreeMap<PathBuf, Page>,
) -> Result<(), BookError> {
    let place = folder.join(inside);
    for entry in std::fs::read_dir(&place).map_err(BookError::io(&place))? {
        let entry = entry.map_err(BookError::io(&place))?;
        let name = inside.join(entry.file_name());
        let path = entry.path();
        if path.is_dir() {
            read(folder, &name, pages)?;
        } else if path.extension().is_some_and(|e| e == "html") {
            let text = std::fs::read_to_string(&path).map_err(BookError::io(&path))?;
            pages.insert(name, page(&text));
        }
    }
    Ok(())
}

fn page(text: &str) -> Page {
    let html = Html::parse_document(text);
    let select = |what: &str| -> Vec<_> {
        Selector::parse(what)
            .map(|s| html.select(&s).collect())
            .unwrap_or_default()
    };
    let mut links = BTreeSet::new();
    for (element, attribute) in LOADING {
        for found in select(element) {
            // rel="canonical" and similar load nothing, but mdBook does not write them.
            links.extend(found.attr(attribute).map(|a| (a.to_owned(), true)));
        }
    }
    for found in select("a") {
        links.extend(found.attr("href").map(|a| (a.to_owned(), false)));
    }
    let anchors = select("[id]")
        .iter()
        .filter_map(|e| e.attr("id"))
        .map(str::to_owned)
        .collect();
    let wordless = select("img")
        .iter()
        .filter(|e| e.attr("alt").is_none_or(|a| a.trim().is_empty()))
        .map(|e| e.attr("src").unwrap_or_default().to_owned())
        .collect();
    Page {
        links,
        anchors,
        wordless,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn book(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    #[test]
    fn unit_good_links_are_counted() {
        let folder = book(&[
            (
                "a.html",
                "<a href='b.html#x'>b</a><a href='https://example.org'>o</a>",
            ),
            ("b.html", "<h1 id='x'>x</h1><a href='#x'>here</a>"),
        ]);
        let checked = check(folder.path()).unwrap();
        assert_eq!((checked.pages, checked.inside, checked.outside), (2, 2, 1));
    }

    #[test]
    fn unit_every_fault_is_named() {
        let folder = book(&[(
            "a.html",
            "<a href='b.html'>b</a><a href='#y'>y</a><img src='https://example.org/p.png' alt='p'>\
             <a href='../../etc'>out</a><img src='a.html'>",
        )]);
        let why = check(folder.path()).unwrap_err().to_string();
        for word in [
            "b.html: no such file",
            "#y: no such anchor",
            "loads https",
            "leaves the book",
            "no words",
        ] {
            assert!(why.contains(word), "{word} in {why}");
        }
    }
}
