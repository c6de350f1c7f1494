//! Generates the page of verdicts: each verdict with its colour and condition, and every cause that the diagnosis can
//! name.

use crate::GENERATED;
use poinsot_identify::FaultKind;
use poinsot_report::VERDICTS;
use std::fmt::Write;

/// The page.
pub fn page() -> String {
    let mut out = format!("{GENERATED}# Verdicts\n\n");
    out.push_str(
        "This page lists what sets the word and colour of an answer, and what to do about a named cause.\n\n\
         For each status the first verdict whose condition holds applies. \
         Green is *good*, amber *fair*, red *bad*. The exit code is that of `poinsot identify`.\n\n\
         | status | condition | colour | word | exit code |\n|---|---|---|---|---|\n",
    );
    for v in &VERDICTS {
        let _ = writeln!(
            out,
            "| `{}` | {} | {} | {} | {} |",
            v.status,
            v.condition,
            format!("{:?}", v.tone).to_lowercase(),
            v.word,
            u8::from(!v.passes)
        );
    }
    out.push_str(
        "\n## Causes\n\n\
         The diagnosis tests each of these and names the one with the best [evidence](../validation/faults.md#how-diagnosis-works). \
         If the data cannot distinguish two causes, it names both.\n\n\
         | name in `estimate.json` | what it is | what to do |\n|---|---|---|\n",
    );
    for fault in FaultKind::ALL.iter().copied() {
        let advice = fault.advice().trim_start_matches("; ");
        let _ = writeln!(out, "| `{}` | {} | {advice} |", fault.name(), fault.what());
    }
    out
}
