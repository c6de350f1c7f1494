//! A self-contained page: no network access but for a live one, and a content security policy with the hashes of its style and scripts.

use crate::document::{Section, Tone};
use crate::drawing::TEMPLATES;
use crate::error::PageError;
use crate::figure::Figure;
use crate::template::Html;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::{Value, context};
use serde::Serialize;
use sha2::{Digest, Sha256};

/// The style of every page, which begins with the licence of uPlot.
const STYLE: &str = concat!(
    "/*! uPlot\n",
    include_str!("../assets/uplot/LICENSE"),
    "*/\n",
    include_str!("../assets/uplot/uPlot.min.css"),
    "\n",
    include_str!("../assets/style.css")
);
/// Scripts, each with the texts in the page of which one requires it; the first is always included.
const SCRIPTS: [(&[&str], &str); 5] = [
    (&[""], include_str!("../assets/page.js")),
    (
        &[CURVES, LIVE],
        include_str!("../assets/uplot/uPlot.iife.min.js"),
    ),
    (&[CURVES], include_str!("../assets/curves.js")),
    (
        &["class=\"scene-data\""],
        include_str!("../assets/space.js"),
    ),
    (&[LIVE], include_str!("../assets/live.js")),
];
const CURVES: &str = "class=\"curves-data\"";
/// A page with it asks the server that it comes from for more.
const LIVE: &str = "class=\"live\"";

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

/// The first screen of a page: verdict, action and evidence.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Opening {
    /// Colour of the word.
    pub tone: Tone,
    /// Verdict in one word.
    pub word: String,
    /// Verdict in one sentence with its numbers.
    pub sentence: String,
    /// Recommended action, if any.
    pub action: Option<String>,
    /// Questions about the evidence.
    pub lights: Vec<Light>,
    /// Main figure, beside the text; below it on a phone.
    #[serde(skip)]
    pub beside: Html,
}

/// A question about the evidence with its answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Light {
    /// The question.
    pub question: &'static str,
    /// Anchor of the evidence.
    pub place: &'static str,
    /// Colour.
    pub tone: Tone,
    /// Answer in a word.
    pub word: String,
    /// Finding.
    pub found: String,
}

impl Opening {
    /// The first part of a page.
    ///
    /// # Errors
    /// The template is faulty.
    pub fn part(&self) -> Result<Part, PageError> {
        let context = context! { beside => self.beside.value(), ..Value::from_serialize(self) };
        let body = TEMPLATES.html("opening.html", context)?;
        Ok(Part::new("answer", "Answer", body))
    }
}

impl Part {
    /// A part without figures.
    pub fn new(id: &'static str, title: &'static str, body: Html) -> Self {
        Self {
            id,
            title,
            body,
            figures: Vec::new(),
        }
    }

    /// The same part with figures.
    pub fn with_figures(self, figures: Vec<Figure>) -> Self {
        Self { figures, ..self }
    }

    /// Sections of a document: tables with captions, lists with titles.
    ///
    /// # Errors
    /// The template is faulty.
    pub fn of_sections(
        id: &'static str,
        title: &'static str,
        about: &str,
        sections: &[Section],
    ) -> Result<Self, PageError> {
        let section =
            |s: &Section| context! { text => s.text_columns(), ..Value::from_serialize(s) };
        let sections: Vec<Value> = sections.iter().map(section).collect();
        let body = TEMPLATES.html("tables.html", context! { sections, about })?;
        Ok(Self::new(id, title, body))
    }
}

impl Page {
    /// The HTML file.
    ///
    /// # Errors
    /// The page's template is faulty.
    pub fn html(&self) -> Result<String, PageError> {
        let part = |p: &Part| context! { id => p.id, title => p.title, body => p.body.value() };
        let own = |text: &str| Html(text.to_owned()).value();
        let wanted = |mark: &str| self.parts.iter().any(|p| p.body.as_str().contains(mark));
        let any = |marks: &[&str]| marks.iter().any(|mark| wanted(mark));
        let needed = || SCRIPTS.iter().filter(|s| any(s.0)).map(|s| s.1);
        let script_hashes: Vec<String> = needed().map(hash).collect();
        let policy = format!(
            "default-src 'none'; style-src {}; script-src {};{} base-uri 'none'; form-action 'none'",
            hash(STYLE),
            script_hashes.join(" "),
            if wanted(LIVE) {
                " connect-src 'self';"
            } else {
                ""
            }
        );
        let page = TEMPLATES.html(
            "page.html",
            context! {
                policy => own(&policy),
                title => self.title,
                subtitle => self.subtitle,
                footer => self.footer,
                style => own(STYLE),
                scripts => needed().map(own).collect::<Vec<_>>(),
                parts => self.parts.iter().map(part).collect::<Vec<_>>(),
            },
        )?;
        Ok(format!("{}\n", page.as_str()))
    }
}

fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
