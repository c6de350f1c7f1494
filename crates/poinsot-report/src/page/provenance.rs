//! Warnings, repairs, and the origin of the result.

use super::Answer;
use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{PageError, Part};

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let context = context! {
        command => command(&answer.data.command),
        method => e.method_in_words(),
        truth => answer.data.truth.is_some(),
        truth_note => answer.data.truth_note,
        ..Value::from_serialize(e)
    };
    let body = TEMPLATES.html("provenance.html", context)?;
    Ok(Part::new("provenance", "Provenance", body))
}

/// The command line, quoted for a shell.
fn command(words: &[String]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+@%".contains(c);
    words
        .iter()
        .map(|w| {
            if !w.is_empty() && w.chars().all(plain) {
                w.clone()
            } else {
                format!("'{}'", w.replace('\'', "'\\''"))
            }
        })
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_command_can_be_pasted() {
        let words = ["poinsot", "a b", "it's"].map(str::to_owned);
        assert_eq!(command(&words), r"poinsot 'a b' 'it'\''s'");
    }
}
