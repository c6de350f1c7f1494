//! An error as data: code, place, value, problem and advice of every fault.

use crate::case::{CaseError, CaseFault};
use crate::error::Error;
use crate::simulate::SimulateError;
use poinsot_formats::FaultFile;
use poinsot_model::{Finding, ModelError};

impl Error {
    /// All faults.
    pub fn faults(&self) -> Vec<FaultFile> {
        match self {
            Self::Model(error) | Self::Simulate(SimulateError::Model(error)) => of_model(error),
            Self::File(error) | Self::Simulate(SimulateError::Case(error)) => of_case(error),
            Self::Usage { option, value, why } => {
                let line = FaultFile::of_line(&format!("E0001 {option}: {why}"));
                vec![FaultFile {
                    value: (!value.is_empty()).then(|| value.clone()),
                    ..line
                }]
            }
            other => other.to_string().lines().map(FaultFile::of_line).collect(),
        }
    }
}

fn of_model(error: &ModelError) -> Vec<FaultFile> {
    let fault = |f: &Finding| {
        let column = (f.line > 0).then_some(f.column);
        fault(
            f.code,
            place(&f.file, f.line, column, &f.key),
            &f.value,
            (&f.problem, &f.remedy),
        )
    };
    error.findings.iter().map(fault).collect()
}

fn of_case(error: &CaseError) -> Vec<FaultFile> {
    let fault = |f: &CaseFault| {
        let place = place(&f.file, f.line, None, &f.key);
        fault(f.code, place, &f.value, (&f.problem, &f.remedy))
    };
    error.faults.iter().map(fault).collect()
}

fn fault(code: &str, place: String, value: &str, (problem, advice): (&str, &str)) -> FaultFile {
    FaultFile {
        code: code.to_owned(),
        place: Some(place),
        value: (!value.is_empty()).then(|| value.to_owned()),
        problem: problem.to_owned(),
        advice: Some(advice.to_owned()),
    }
}

/// File, line and column if any, and key.
fn place(file: &str, line: usize, column: Option<usize>, key: &str) -> String {
    let mut place = file.to_owned();
    for number in [(line > 0).then_some(line), column].into_iter().flatten() {
        place.push_str(&format!(":{number}"));
    }
    match key {
        "" => place,
        key => format!("{place}: {key}"),
    }
}
