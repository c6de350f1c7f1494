//! Common helpers of the tests of this crate.

use poinsot::{Identified, IdentifyRequest, identify};
use poinsot_identify::{Estimate, Problem, Settings, maximum_likelihood_with};
use std::path::{Path, PathBuf};

/// The folder of the shipped data.
pub fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// The files of one satellite.
pub fn stsat3() -> PathBuf {
    shipped().join("stsat3")
}

/// The answer to shipped telemetry.
pub fn identified(model: &str, telemetry: &[&str], method: &str) -> Identified {
    let files = telemetry.iter().map(|t| shipped().join(t));
    identify(&IdentifyRequest::new(shipped().join(model), files).by(method)).unwrap()
}

/// The estimate without a search for causes of a misfit, which takes longer than the fit.
pub fn undiagnosed(problem: &Problem) -> Estimate {
    let options = Settings {
        undiagnosed: true,
        ..Settings::default()
    };
    maximum_likelihood_with(problem, options).unwrap()
}
