//! A self-contained page: no network access, and a content security policy with the hashes of its style and scripts.

use crate::document::{Content, Document, Section, Table};
use crate::error::PageError;
use crate::figure::Figure;
use crate::markup::{Html, render};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::context;
use sha2::{Digest, Sha256};

const TEMPLATE: &str = include_str!("../templates/page.html");
const TABLES: &str = include_str!("../templates/tables.html");
const STYLE: &str = concat!(
    include_str!("../assets/uplot/uPlot.min.css"),
    "\n",
    include_str!("../assets/style.css")
);
/// Scripts, each with the text in the page that requires it; the first is always included.
const SCRIPTS: [(&str, &str); 4] = [
    ("", include_str!("../assets/page.js")),
    (CURVES, include_str!("../assets/uplot/uPlot.iife.min.js")),
    (CURVES, include_str!("../assets/curves.js")),
    ("class=\"scene-data\"", include_str!("../assets/space.js")),
];
const CURVES: &str = "class=\"curves-data\"";

/// A titled part of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Anchor: letters only.
    pub id: &'static str,
    /// Title.
    pub title: &'static str,
    /// Content.
    pub body: Html,
    /// Its figures, for separate files.
    pub figures: Vec<Figure>,
}

impl Part {
    /// The sections of a document: tables with captions, lists with titles.
    ///
    /// # Errors
    /// The template is faulty.
    pub fn of_document(
        id: &'static str,
        title: &'static str,
        about: &str,
        document: &Document,
    ) -> Result<Self, PageError> {
        let section = |s: &Section| match &s.content {
            Content::Table(t) => {
                let text: Vec<bool> = (0..t.head.len()).map(|k| is_text(t, k)).collect();
                context! { title => s.title, head => t.head, rows => t.rows, note => s.note, text }
            }
            Content::List(lines) => context! { title => s.title, lines, note => s.note },
        };
        let sections: Vec<_> = document.sections.iter().map(section).collect();
        Ok(Self {
            id,
            title,
            body: render("tables", TABLES, context! { sections, about })?,
            figures: Vec::new(),
        })
    }
}

/// A page.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Title.
    pub title: String,
    /// Line above the footer text.
    pub subtitle: String,
    /// Line at the end.
    pub footer: String,
    /// Parts in reading order.
    pub parts: Vec<Part>,
}

impl Page {
    /// The HTML file.
    ///
    /// # Errors
    /// The page's template is faulty.
    pub fn html(&self) -> Result<String, PageError> {
        let parts: Vec<_> = self
            .parts
            .iter()
            .map(|p| context! { id => p.id, title => p.title, body => p.body.value() })
            .collect();
        let own = |text: &str| Html(text.to_owned()).value();
        let wanted = |mark: &str| self.parts.iter().any(|p| p.body.as_str().contains(mark));
        let needed = || SCRIPTS.iter().filter(|s| wanted(s.0)).map(|s| s.1);
        let scripts: Vec<_> = needed().map(own).collect();
        let script_hashes: Vec<String> = needed().map(hash).collect();
        let policy = format!(
            "default-src 'none'; style-src {}; script-src {}; base-uri 'none'; form-action 'none'",
            hash(STYLE),
            script_hashes.join(" ")
        );
        let page = render(
            "page",
            TEMPLATE,
            context! {
                policy => own(&policy),
                title => self.title,
                subtitle => self.subtitle,
                footer => self.footer,
                style => own(STYLE),
                scripts,
                parts,
            },
        )?;
        Ok(format!("{}\n", page.as_str()))
    }
}

/// Whether no cell of a column starts like a number.
fn is_text(table: &Table, column: usize) -> bool {
    let numeric =
        |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "+-±".contains(c));
    let mut cells = table.rows.iter().filter_map(|row| row.get(column));
    !cells.any(numeric)
}

fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
