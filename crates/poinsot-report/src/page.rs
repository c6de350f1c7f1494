//! One self-contained page: no network, and a content security policy that names its own style and
//! scripts by hash.

use crate::error::PageError;
use crate::figure::Figure;
use crate::markup::{Html, render};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::context;
use sha2::{Digest, Sha256};

const TEMPLATE: &str = include_str!("../templates/page.html");
const STYLE: &str = include_str!("../assets/style.css");
const SCRIPTS: [&str; 2] = [
    include_str!("../assets/plot.js"),
    include_str!("../assets/scene.js"),
];

/// A titled part of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Anchor: letters only.
    pub id: &'static str,
    /// Title.
    pub title: &'static str,
    /// Content.
    pub body: Html,
    /// The pictures in it, for files of their own.
    pub figures: Vec<Figure>,
}

/// A page.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Title.
    pub title: String,
    /// Line under the title.
    pub subtitle: String,
    /// Line at the end.
    pub footer: String,
    /// Parts in reading order.
    pub parts: Vec<Part>,
}

impl Page {
    /// The whole file.
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
        let scripts: Vec<_> = SCRIPTS.iter().map(|s| own(s)).collect();
        let script_hashes: Vec<String> = SCRIPTS.iter().map(|s| hash(s)).collect();
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

fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
