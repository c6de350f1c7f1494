//! The studies of Ma, Dang and Pham 2008: figures, bounds, comparison, claims, speed.
//!
//! `cargo run --release -p poinsot --example ma2008_studies -- STUDY [OUT_DIR]`
#![allow(non_snake_case, missing_docs, clippy::expect_used)]

mod claims;
mod figure;
#[allow(dead_code)]
mod monte;
#[allow(dead_code)]
mod setup;
mod speed;
mod studies;

use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "ma2008_studies STUDY [OUT_DIR]\n  STUDY: mass-ratio | histories | noise | compare | bounds | exact | claims | all\n  or: speed [PYTHON SCRIPT]   trials per second, beside a NumPy peer";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["speed"] => speed::run(None),
        ["speed", python, script] => speed::run(Some((python, script))),
        [study] => return one(study, Path::new(".")),
        [study, out] => return one(study, Path::new(out)),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

fn one(study: &str, out: &Path) -> ExitCode {
    if let Err(e) = std::fs::create_dir_all(out) {
        eprintln!("{}: {e}", out.display());
        return ExitCode::from(3);
    }
    match study {
        "mass-ratio" => studies::mass_ratio(out),
        "histories" => studies::histories(out),
        "noise" => studies::noise_study(out),
        "compare" => studies::compare(out),
        "bounds" => studies::bounds(out),
        "exact" => studies::exact(),
        "claims" => claims::run(),
        "all" => {
            studies::exact();
            studies::histories(out);
            studies::mass_ratio(out);
            studies::noise_study(out);
            studies::compare(out);
            studies::bounds(out);
            claims::run();
        }
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}
