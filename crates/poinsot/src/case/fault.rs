//! Faults of a case file with line numbers.

use crate::error::Fault;
use poinsot_files::Place;
use poinsot_formats::ShapeFault;
use std::ops::Range;
use std::path::PathBuf;

/// Name and text of a case file; converts byte ranges to lines.
#[derive(Debug, Clone)]
pub(crate) struct CaseText {
    pub path: PathBuf,
    pub text: String,
}

impl CaseText {
    /// A fault at the byte range of a value.
    pub fn fault(
        &self,
        code: &'static str,
        key: &str,
        span: Range<usize>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Fault {
        let before = self.text.get(..span.start).unwrap_or(&self.text);
        let place = Place {
            line: before.matches('\n').count() as u64 + 1,
            ..Place::file(&self.path).key(key)
        };
        let fault = Fault::new(code, place, problem, remedy);
        fault.with_value(excerpt(self.text.get(span).unwrap_or("")))
    }

    /// A fault of the file's structure; `remedy` is used if no similar name is known.
    pub fn shape(&self, code: &'static str, fault: &ShapeFault, remedy: &str) -> Fault {
        let remedy = match &fault.unknown {
            Some((name, known)) => did_you_mean(name, known.iter().map(String::as_str)),
            None => remedy.to_owned(),
        };
        let told = self.fault(code, "", fault.span.clone(), fault.problem.clone(), remedy);
        told.with_value("")
    }
}

/// A value on one line, shortened; empty for a whole section.
fn excerpt(text: &str) -> String {
    if text.contains("[[") || text.contains('=') {
        return String::new();
    }
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut short: String = line.chars().filter(|c| !c.is_control()).take(60).collect();
    if short.len() < line.len() {
        short.push_str("...");
    }
    short
}

/// Suggests the nearest known name as remedy.
pub(crate) fn did_you_mean<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> String {
    let known: Vec<&str> = known.collect();
    let nearest = known
        .iter()
        .min_by_key(|k| strsim::damerau_levenshtein(name, k));
    match nearest {
        None => "remove it: it does not exist here".to_owned(),
        Some(nearest)
            if nearest.starts_with(name)
                || strsim::damerau_levenshtein(name, nearest) <= name.len() / 2 =>
        {
            format!("did you mean \"{nearest}\"?")
        }
        Some(_) => {
            let some = known.iter().take(8).map(|k| format!("\"{k}\""));
            format!("write one of {}", some.collect::<Vec<_>>().join(", "))
        }
    }
}
