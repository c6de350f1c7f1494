//! The studies of Ma, Dang and Pham 2008: figures, bounds, comparison, claims, speed.
//!
//! `cargo run --release -p poinsot --example ma2008_studies -- STUDY [OUT_DIR]`
#![allow(non_snake_case, missing_docs, clippy::expect_used)]

mod advantages;
mod claims;
mod figure;
#[allow(dead_code)]
mod monte;
mod names;
mod reach;
#[allow(dead_code)]
mod setup;
mod speed;
mod studies;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["speed"] => speed::run(None),
        ["speed", python, script] => speed::run(Some((python, script))),
        [study] => return one(study, Path::new(".")),
        [study, out] => return one(study, Path::new(out)),
        _ => return usage(),
    }
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    eprintln!("usage: ma2008_studies STUDY [OUT_DIR], or speed [PYTHON SCRIPT] with a NumPy peer");
    for (name, what, _) in names::STUDIES {
        eprintln!("  {name:11} {what}");
    }
    ExitCode::from(2)
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
        "readings" => claims::readings_of_noise(),
        "advantages" => advantages::run(),
        "reach" => reach::run(),
        "all" => {
            studies::exact();
            studies::histories(out);
            studies::mass_ratio(out);
            studies::noise_study(out);
            studies::compare(out);
            studies::bounds(out);
            claims::run();
            claims::readings_of_noise();
            advantages::run();
            reach::run();
        }
        _ => return usage(),
    }
    ExitCode::SUCCESS
}
