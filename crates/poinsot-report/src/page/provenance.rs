//! Warnings, repairs, and the origin of the result.

use super::{Answer, repairs};
use minijinja::{Value, context};
use poinsot_figures::{PageError, Part, render};
use poinsot_files::significant;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let inputs: Vec<Value> = e
        .inputs
        .iter()
        .map(|i| {
            let [a, b] = i.time_s;
            let span = format!("{} to {}", significant(a, 6), significant(b, 6));
            context! { path => i.path, sha256 => i.sha256, segment => i.segment, span, rows => i.rows }
        })
        .collect();
    let body = render(
        "provenance.html",
        include_str!("templates/provenance.html"),
        context! {
            warnings => e.warnings,
            repairs => e.repairs.len(),
            rows => repairs::rows(answer),
            several => e.fit.len() > 1,
            ignored => e.ignored_columns,
            inputs,
            model => e.model_file.as_ref().map(|m| context! { path => m.path, sha256 => m.sha256 }),
            command => command(&answer.data.command),
            written_by => e.poinsot,
            method => e.method_in_words(),
            iterations => e.iterations,
            truth => answer.truth.is_known(),
            epoch => e.epoch.as_ref().and_then(|x| x.at.clone()),
        },
    )?;
    Ok(Part {
        id: "provenance",
        title: "Provenance",
        body,
        figures: Vec::new(),
    })
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
