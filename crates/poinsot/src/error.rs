//! Faults that several commands report. Each carries code, place, value and advice as data ([`Fault`]).

pub use poinsot_files::{Fault, FaultKind as ErrorKind, Faults as Error};

use poinsot_files::Place;
use poinsot_model::SensorKind;
use std::fmt::Display;
use std::path::Path;

/// E0301: a missing channel of a segment, with its purpose.
pub(crate) fn missing(segment: &str, channel: &str, purpose: &str, advice: &str) -> Error {
    let problem = format!("no channel '{channel}': {purpose}");
    Error::one("E0301", Place::label(segment), problem, advice)
}

/// E0302: a sensor without declared noise.
pub(crate) fn no_noise(kind: SensorKind) -> Error {
    let (word, unit) = (kind.declared_as().word(), kind.unit(false));
    let problem =
        format!("no sensor of type '{word}' declares its noise, which every uncertainty needs");
    let advice = format!("add [[sensor]] type = \"{word}\" with noise_{unit}");
    Error::one("E0302", Place::label("model"), problem, advice)
}

/// E0305: something that no estimator supports.
pub(crate) fn unsupported(problem: impl Into<String>, advice: impl Into<String>) -> Error {
    Error::one("E0305", Place::label("model"), problem, advice)
}

/// E0509: the motion of a case cannot be computed.
pub(crate) fn no_motion(case: &Path, error: impl Display) -> Error {
    Error::one("E0509", Place::file(case), error.to_string(), "")
}

/// E0701: an estimate that gives no vehicle to simulate.
pub(crate) fn cannot_simulate(path: &Path, problem: impl Display, advice: &str) -> Error {
    let problem = format!("this estimate cannot be simulated: {problem}");
    Error::one("E0701", Place::file(path), problem, advice)
}

/// E0001: a name that is none of the known ones.
pub(crate) fn unknown(
    option: &'static str,
    name: impl Display,
    what: &str,
    known: impl IntoIterator<Item = &'static str>,
) -> Error {
    let known: Vec<&str> = known.into_iter().collect();
    let (problem, advice) = (format!("there is no such {what}"), known.join(", "));
    Error::usage(option, name, problem, format!("use one of {advice}"))
}

/// E0001: an accuracy that is no positive number.
pub(crate) fn check_accuracy(relative_accuracy: f64) -> Result<(), Error> {
    if relative_accuracy > 0.0 && relative_accuracy.is_finite() {
        return Ok(());
    }
    let (option, problem) = ("--relative-accuracy", "must be a positive number");
    let advice = "give for example 1.0";
    Err(Error::usage(option, relative_accuracy, problem, advice))
}
