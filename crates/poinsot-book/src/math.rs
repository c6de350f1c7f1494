//! Formulas: LaTeX in `$...$` and `$$...$$` becomes MathML, which browsers render without scripts.

use crate::error::BookError;
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::mathml::push_mathml;
use pulldown_latex::{Parser, Storage};

/// One formula as a `<math>` element on one line.
///
/// # Errors
/// The formula is invalid or unsupported LaTeX.
pub fn mathml(page: &str, formula: &str, display: bool) -> Result<String, BookError> {
    let fault = |why: String| BookError::Formula {
        page: page.to_owned(),
        formula: formula.to_owned(),
        why,
    };
    let storage = Storage::new();
    // Parse once for errors, which the writer would put into the formula.
    for event in Parser::new(formula, &storage) {
        event.map_err(|e| fault(e.to_string()))?;
    }
    let config = RenderConfig {
        display_mode: if display {
            DisplayMode::Block
        } else {
            DisplayMode::Inline
        },
        annotation: None,
        ..RenderConfig::default()
    };
    let storage = Storage::new();
    let mut out = String::new();
    push_mathml(&mut out, Parser::new(formula, &storage), config)
        .map_err(|e| fault(e.to_string()))?;
    // A blank line would end the element in Markdown.
    Ok(out.lines().map(str::trim).collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_formula_is_mathml() {
        let made = mathml("page", r"\dot P = \sum F", true).unwrap();
        assert!(made.starts_with("<math"));
        assert!(made.contains("display=\"block\""));
        assert!(made.contains("∑"));
    }

    #[test]
    fn unit_a_faulty_formula_is_refused() {
        let why = mathml("page", r"\frac{1", false).unwrap_err().to_string();
        assert!(why.contains("page"), "{why}");
        assert!(mathml("page", r"\nosuchword x", false).is_err());
    }
}
