//! The tables of the documentation, generated from the printed messages.

use crate::bad_input::bench::Problem;
use crate::bad_input::case::{Case, File};
use poinsot::explain::ErrorCode;
use std::collections::BTreeMap;
use std::fmt::Write;

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
        .replace('<', "&lt;")
        .replace('\n', " ")
}

/// `docs/validation/bad_input.md`.
pub fn bad_input(sections: &[(&str, Vec<File>)]) -> Result<String, Problem> {
    let cases: usize = sections.iter().map(|s| s.1.len()).sum();
    let mut out = HEADER.replace("{cases}", &cases.to_string());
    for (name, files) in sections {
        let _ = writeln!(
            out,
            "## {name}\n\n| | fault | exit | printed |\n|---|---|---|---|"
        );
        for file in files {
            out.push_str(&row(&file.case)?);
        }
        out.push('\n');
    }
    out.push_str(DIFFERENCES);
    Ok(out)
}

/// A case in its table.
fn row(case: &Case) -> Result<String, Problem> {
    let printed = case.printed.iter().flat_map(|p| p.get_ref());
    let lines: Vec<String> = printed
        .map(|l| format!("`{}`", cell(l).replace('`', "'")))
        .collect();
    let more = match case.shown()? {
        none if none.is_empty() => none,
        more => format!(" (`{}`)", cell(&more).replace('\u{1b}', "ESC")),
    };
    let (id, fault, exit) = (&case.id, cell(&case.fault), case.exit.unwrap_or(-1));
    let lines = lines.join("<br>");
    Ok(format!("| {id} | {fault}{more} | {exit} | {lines} |\n"))
}

const HEADER: &str = "# Bad input: what is printed

Made from the {cases} case files of `validation/bad_input/`. Each spoils one thing of a good model and good telemetry of a
satellite with three wheels. No case panics, exceeds one minute of CPU time or, when it fails, leaves files behind.
Exit codes: 0 answered, 1 answered but not acceptable, 2 bad input, 3 environment. Of an answer the verdict and the
lines that concern the fault are shown. Where the behaviour differs from what was planned, the last section says why.

Run one case, or all whose file names begin so:

    POINSOT_CASE=T1_NaN_in_3_cells cargo nextest run --release -p poinsot-cli bad_input::

The test fails when the program prints something else. Add `POINSOT_BLESS=1` to write what it prints into the case file
and into this page. Without `POINSOT_CASE` all cases are run or written.

";

const DIFFERENCES: &str = "## Where it differs from the list

- Exit codes are those of the contract: the list's 1 and 2 are 2, its 3 is 1, its 4 is 3, its 5 is 4.
- T4: a wrapped counter is refused, not repaired: a jump of the clock and a wrap look alike. Several runs in one file are
  refused too where the gaps together exceed 30 times what is covered.
- T5: a median step of 200 s is plausible for a slow record, so ms read as s is found by the turn between samples.
- T6: a lag below what noise hides is found by the fit, not by the check of the telemetry; neither is applied. A drift of
  the clock is not estimated.
- T7: no torque of a wheel or joint is used by `identify`, so its unit can do no harm. Without attitude, body rates in
  rad/s mapped as deg/s contradict nothing: so slow a motion shows too little, and the answer says that.
- T9: a zero quaternion is no sample; a norm off by up to 5 % is normalised and listed, as the list asks.
- T12: a joint, wheel or thruster at rest is not a stuck sensor; only vector sensors of the base are checked.
- T13: more outliers than a robust loss can bear end in a rejected answer (1) without numbers, not in a refusal.
- T17, T18: what is not identifiable ends with 1 and null numbers.
- T21: no estimator of mass properties that vary is offered.
- R2: [answers at the edge of the physical bodies](physical_edge.md) have a page of their own.
- R3: no pseudo-inverse is taken: directions beyond the wanted accuracy are open, and said in words.
- R4: `xu2017` widens its sigma by the difference between swarm and linear answer; the ladder starts from one answer and
  says `iteration_limit` where it does not settle.
- R6, R7: there is no recursive filter yet.
- F2: a column that nobody asked for is ignored and listed; only a missing one is an error.
- F5: neither reading nor writing of numbers knows the process's locale.
- F6, S6: gzip and Zstandard are unpacked as they are read, and a line of more than 16 MiB ends it. No regular expression is
  applied to input.
- F7: no file is mapped into memory. A network file system was not tried.
- F8: nested, encrypted and other damaged files: `crates/poinsot-telemetry/tests`, `parquet_files.rs` and `corpora.rs`.
- F9: MCAP is not read.
- F10: what TOML 1.1 allows beyond 1.0 is read.
- M1: massless links on fixed joints are accepted, and a massless base whose subtree has mass.
- M2: there is no --allow-unphysical.
- M5: a mimic joint is read as a joint of its own and named; telemetry needs a column for it.
- S1: a case may name a model or a torque table outside of its folder, as the shipped ones do: such files are only
  read. No name that stands in a file becomes the name of an output.
- S3: no CSV with text cells is written.
";

/// `docs/reference/errors.md`.
pub fn errors(
    codes: &[ErrorCode],
    messages: &BTreeMap<String, (String, Option<&'static str>)>,
) -> String {
    let mut out = String::from(
        "# Error codes\n\n`poinsot explain CODE` prints these. Every error is one line: code, place, what was read, what is wrong, what to do.\n\
         The first two digits say where: 00 command, 01 model, 02 telemetry, 03 model and telemetry together, 04 and 05 methods\n\
         and simulation, 06 results. Exit code 2, but 3 for E0002 to E0006 and for what the operating system refuses, 4 for E0009.\n\
         The examples are what the program prints; a test compares them.\n\n",
    );
    for c in codes {
        let _ = writeln!(
            out,
            "## {}\n\n{}\n\n- Usual cause: {}\n- What to do: {}",
            c.code, c.meaning, c.cause, c.remedy
        );
        if let Some((message, why)) = messages.get(c.code) {
            let note = why.map_or(String::new(), |w| format!(" ({w})"));
            if message.is_empty() {
                let _ = writeln!(out, "- No example{note}");
            } else {
                let _ = writeln!(out, "- Example{note}:\n\n      {message}");
            }
        }
        out.push('\n');
    }
    out
}
