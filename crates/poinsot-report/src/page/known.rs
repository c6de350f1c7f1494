//! Sensitivity of the estimate to known numbers.

use super::Answer;
use crate::estimate::sensitivities;
use crate::templates::TEMPLATES;
use minijinja::context;
use poinsot_figures::{PageError, Part};

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let rows = sensitivities(&e.known_numbers, &e.covariance);
    let context = context! { rows, known => e.known_numbers };
    let body = TEMPLATES.html("known.html", context)?;
    Ok(Part::new("known", "Sensitivity to known numbers", body))
}
