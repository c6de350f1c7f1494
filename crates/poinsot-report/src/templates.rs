//! Every template of the terminal and the pages.

use poinsot_figures::Templates;
use std::sync::LazyLock;

/// Names of templates with their texts.
macro_rules! templates {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../templates/", $name)))),*]
    };
}

pub(crate) static TEMPLATES: LazyLock<Templates> = LazyLock::new(|| {
    Templates::new(templates! {
        "answer.html"
        "answer.txt"
        "bodies.html"
        "campaign.txt"
        "case.txt"
        "comparison.txt"
        "choose.html"
        "cost.txt"
        "design.txt"
        "differences.txt"
        "durations.txt"
        "limits.txt"
        "estimate.txt"
        "flown.html"
        "follow.txt"
        "known.html"
        "live.html"
        "numbers.html"
        "open.html"
        "picture.html"
        "plan.txt"
        "prediction.txt"
        "prediction_sentence.txt"
        "sentence.txt"
        "headline.txt"
        "design_sentence.txt"
        "provenance.html"
        "several.txt"
        "statistics.txt"
        "study.txt"
        "trust.html"
        "validation.txt"
    })
});
