//! The first screen of a page: the answer in a word and a sentence, what to do, and the evidence for it.

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
    /// The answer in a word.
    pub word: String,
    /// The answer in a sentence with its numbers.
    pub sentence: String,
    /// What to do next, where something is needed.
    pub action: Option<String>,
    /// Questions about the evidence.
    pub lights: Vec<Light>,
    /// What shows the answer best: beside the words, on a phone below them.
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
    /// What was found.
    pub found: String,
}

impl Opening {
    /// As the first part of a page.
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
