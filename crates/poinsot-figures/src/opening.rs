//! The first screen of a page: verdict, action and evidence.

use crate::document::Tone;
use crate::error::PageError;
use crate::markup::{Html, render};
use crate::page::Part;
use minijinja::{Value, context};

const TEMPLATE: &str = include_str!("../templates/opening.html");

/// The first screen.
#[derive(Debug, Clone, PartialEq, Default)]
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
    pub beside: Html,
}

/// A question about the evidence with its answer.
#[derive(Debug, Clone, PartialEq)]
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
        let light = |l: &Light| {
            context! { question => l.question, place => l.place, tone => l.tone.name(), word => l.word, found => l.found }
        };
        let lights: Vec<Value> = self.lights.iter().map(light).collect();
        let body = render(
            "opening",
            TEMPLATE,
            context! {
                tone => self.tone.name(), word => self.word, sentence => self.sentence, action => self.action,
                lights, beside => self.beside.value(),
            },
        )?;
        Ok(Part {
            id: "answer",
            title: "Answer",
            body,
            figures: Vec::new(),
        })
    }
}
