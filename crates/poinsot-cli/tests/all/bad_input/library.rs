//! Codes that only callers of the library reach.

/// Messages that no input of the command can cause, with the reason: bugs, and checks of the library for callers whose
/// numbers the command would have rejected.
pub fn messages() -> Vec<(&'static str, String, &'static str)> {
    use poinsot_identify::{EvaluationError, ProblemError};
    use poinsot_papers::{kim2010, ma2008::Ma2008Error, xu2017::Xu2017Error};
    let fault = poinsot::Error::Internal {
        what: "index out of range (src/x.rs:1)".to_owned(),
    };
    let short = ProblemError::TooFewSamples {
        label: "t.csv".to_owned(),
        samples: 1,
    };
    let overflow = ProblemError::NotFinite(poinsot_identify::NotFinite);
    let threshold = poinsot_identify::Settings {
        false_alarm: 2.0,
        ..Default::default()
    };
    let threads = poinsot::Error::Threads {
        why: "Resource temporarily unavailable (os error 11)".to_owned(),
    };
    let kept = poinsot::Error::Kept {
        path: "out/report_data.json".into(),
        source: std::io::ErrorKind::StorageFull.into(),
        kept: "out/.poinsot-a1B2c3".into(),
    };
    let length = EvaluationError::Length {
        what: "values of the unknowns".to_owned(),
        found: 11,
        expected: 12,
    };
    vec![
        (
            "E0004",
            kept.to_string(),
            "only where a disk fails between two renames: tests/all/environment",
        ),
        (
            "E0005",
            threads.to_string(),
            "only where the system refuses: tests/all/environment",
        ),
        (
            "E0006",
            poinsot::Error::Memory.to_string(),
            "only where the system refuses: tests/all/environment",
        ),
        (
            "E0009",
            fault.to_string(),
            "only where the program has a fault",
        ),
        (
            "E0404",
            short.to_string(),
            "only by the library: the program says E0303 before",
        ),
        (
            "E0407",
            threshold.validate().unwrap_err().to_string(),
            "only by the library: the program uses the defaults",
        ),
        (
            "E0410",
            overflow.to_string(),
            "only by the library: the program says E0306 or E0108 before",
        ),
        (
            "E0411",
            length.to_string(),
            "only by the library: the program makes all arrays from one table",
        ),
        (
            "E0529",
            Ma2008Error::NotFinite.to_string(),
            "only by the library: the program says E0108 before",
        ),
        (
            "E0420",
            kim2010::Kim2010Error::Lengths.to_string(),
            "only by the library: the program gives every channel the same times",
        ),
        (
            "E0540",
            Xu2017Error::NotFinite.to_string(),
            "only by the library: the program says E0306 before",
        ),
    ]
}
