//! Runs small arbitrary problems through `identify`.

use crate::small_problem::SmallProblem;
use arbitrary::Unstructured;
use poinsot::{Identified, Question, estimate_file, identify_tables};
use poinsot_model::parse_model;
use poinsot_report::{Detail, estimate_document};

/// A small vehicle with a short record, both arbitrary. Every resulting number must be finite and have a finite sigma.
pub fn identify(bytes: &[u8]) {
    let Ok(problem) = SmallProblem::new(&mut Unstructured::new(bytes)) else {
        return;
    };
    let Ok(model) = parse_model(&problem.model, "fuzzed.toml") else {
        return;
    };
    let request = Question {
        variant: problem.variant.map(str::to_owned),
        ..Question::by(problem.method)
    };
    match identify_tables(model, vec![problem.table], &request) {
        Ok(identified) => check(&identified),
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with('E'), "no code: {text}");
            assert!(error.kind() != poinsot::ErrorKind::Internal, "{text}");
        }
    }
}

fn check(identified: &Identified) {
    let estimate = &identified.estimate;
    for body in estimate
        .bodies
        .iter()
        .chain(estimate.system.iter().map(|s| &s.0))
    {
        for number in body.numbers() {
            assert_eq!(number.value.is_some(), number.sigma.is_some(), "{number:?}");
            let finite = |x: Option<f64>| x.is_none_or(f64::is_finite);
            assert!(finite(number.value) && finite(number.sigma), "{number:?}");
            assert!(number.sigma.is_none_or(|s| s >= 0.0), "{number:?}");
        }
    }
    let mut all = estimate.covariance.iter().flatten();
    assert!(all.all(|c| c.is_finite()), "a covariance is not finite");
    let _ = estimate_file(identified);
    let _ = estimate_document(&estimate_file(identified), Detail::Everything).to_string();
}
