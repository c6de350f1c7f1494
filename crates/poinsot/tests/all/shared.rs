//! Common helpers of the tests of this crate.

use poinsot::trials::{OUTSIDE, Row, Study, Sums};
use poinsot::{Identified, IdentifyRequest, identify};
use poinsot_formats::MethodResultFile;
use poinsot_identify::{Estimate, Problem, Settings, maximum_likelihood_with};
use rayon::prelude::*;
use std::ops::Range;
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

/// The rows of these trials in parallel, in order of their numbers, each with the bound.
pub fn rows(study: &Study, trials: Range<u64>) -> Vec<Row> {
    let bound = study.bound_sigmas();
    let trials = trials.into_par_iter();
    trials.map(|n| study.trial(n, &bound)).collect()
}

/// Statistics of rows of one method.
pub fn statistics(rows: &[Row]) -> MethodResultFile {
    let mut sums = Sums::default();
    rows.iter().for_each(|row| sums.add(row));
    sums.result(OUTSIDE)
}

/// Factor by which the sigmas of an answer were multiplied.
pub fn sigma_factor(estimate: &Estimate) -> f64 {
    let factors = estimate.remarks.iter().map(|remark| remark.sigma_factor);
    factors.fold(1.0, f64::max)
}

/// The first failed trials, and statistics outside their 99.9 % bands. Empty if the stated uncertainty is correct.
pub fn faults(result: &MethodResultFile) -> Vec<String> {
    let failed = |(trial, why): &(u64, String)| format!("trial {trial} failed: {why}");
    let failed = result.failures.iter().map(failed);
    failed.chain(result.outside(false)).collect()
}
