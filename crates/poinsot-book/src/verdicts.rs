//! The page of verdicts: each verdict with its colour and condition, and every cause that the diagnosis can name.

use minijinja::{Value, context};
use poinsot_identify::FaultKind;
use poinsot_report::{VERDICTS, Verdict};

/// The context of `reference/verdicts.md`.
pub fn verdicts() -> Value {
    let verdict = |v: &Verdict| {
        context! {
            status => v.status,
            condition => v.condition,
            colour => format!("{:?}", v.tone).to_lowercase(),
            word => v.word,
            exit_code => u8::from(!v.passes),
        }
    };
    let fault = |fault: &FaultKind| {
        let advice = fault.advice().trim_start_matches("; ");
        context! { name => fault.name(), what => fault.what(), advice }
    };
    let verdicts: Vec<Value> = VERDICTS.iter().map(verdict).collect();
    let faults: Vec<Value> = FaultKind::ALL.iter().map(fault).collect();
    context! { verdicts, faults }
}
