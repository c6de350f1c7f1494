//! Every template of the terminal and the pages.

use poinsot_figures::Templates;
use std::sync::LazyLock;

pub(crate) static TEMPLATES: LazyLock<Templates> = LazyLock::new(|| {
    Templates::new(&[
        ("answer.html", include_str!("../templates/answer.html")),
        ("bodies.html", include_str!("../templates/bodies.html")),
        ("campaign.txt", include_str!("../templates/campaign.txt")),
        ("case.txt", include_str!("../templates/case.txt")),
        (
            "comparison.txt",
            include_str!("../templates/comparison.txt"),
        ),
        ("choose.html", include_str!("../templates/choose.html")),
        ("cost.txt", include_str!("../templates/cost.txt")),
        ("design.txt", include_str!("../templates/design.txt")),
        ("durations.txt", include_str!("../templates/durations.txt")),
        ("limits.txt", include_str!("../templates/limits.txt")),
        ("estimate.txt", include_str!("../templates/estimate.txt")),
        ("flown.html", include_str!("../templates/flown.html")),
        ("known.html", include_str!("../templates/known.html")),
        ("numbers.html", include_str!("../templates/numbers.html")),
        ("open.html", include_str!("../templates/open.html")),
        ("picture.html", include_str!("../templates/picture.html")),
        ("plan.txt", include_str!("../templates/plan.txt")),
        (
            "prediction.txt",
            include_str!("../templates/prediction.txt"),
        ),
        (
            "provenance.html",
            include_str!("../templates/provenance.html"),
        ),
        ("several.txt", include_str!("../templates/several.txt")),
        (
            "statistics.txt",
            include_str!("../templates/statistics.txt"),
        ),
        ("study.txt", include_str!("../templates/study.txt")),
        ("trust.html", include_str!("../templates/trust.html")),
        (
            "validation.txt",
            include_str!("../templates/validation.txt"),
        ),
    ])
});
