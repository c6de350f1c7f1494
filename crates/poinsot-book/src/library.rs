//! Messages of codes that no case file of bad input reaches.

/// Messages, each with the reason why no input of the command causes it: bugs, and checks of the library for callers whose
/// numbers the command would have rejected.
pub fn messages() -> Vec<(String, Option<&'static str>)> {
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
    let threshold = threshold.validate().err().map(|e| e.to_string());
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
        // Needs standard output on a full device: tests/all/environment of the command.
        ("E0003 standard output: No space left on device (os error 28); free space, or write to another place".to_owned(), None),
        (kept.to_string(), Some("only where a disk fails between two renames: tests/all/environment")),
        (threads.to_string(), Some("only where the system refuses: tests/all/environment")),
        (poinsot::Error::Memory.to_string(), Some("only where the system refuses: tests/all/environment")),
        (fault.to_string(), Some("only where the program has a fault")),
        (short.to_string(), Some("only by the library: the program says E0303 before")),
        (threshold.unwrap_or_default(), Some("only by the library: the program uses the defaults")),
        (overflow.to_string(), Some("only by the library: the program says E0306 or E0108 before")),
        (length.to_string(), Some("only by the library: the program makes all arrays from one table")),
        (Ma2008Error::NotFinite.to_string(), Some("only by the library: the program says E0108 before")),
        (kim2010::Kim2010Error::Lengths.to_string(), Some("only by the library: the program gives every channel the same times")),
        (Xu2017Error::NotFinite.to_string(), Some("only by the library: the program says E0306 before")),
    ]
}
