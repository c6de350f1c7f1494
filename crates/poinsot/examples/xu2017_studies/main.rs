//! The studies of Xu, Hu, Zhang and Liang 2017: tables, figures, uses, sensitivity.
//!
//! `cargo run --release -p poinsot --example xu2017_studies -- STUDY [OUT_DIR]`
#![allow(non_snake_case, missing_docs, clippy::expect_used)]

mod coefficients;
mod figures;
mod names;
#[allow(dead_code)]
mod null;
mod printed;
#[allow(dead_code)]
mod setup;
#[allow(dead_code)]
mod studies;
#[allow(dead_code)]
#[path = "../kim2010_studies/svg.rs"]
mod svg;
mod tables;
mod together;
mod validation;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (study, out) = match words.as_slice() {
        [study] => (*study, Path::new(".")),
        [study, out] => (*study, Path::new(*out)),
        _ => return usage(),
    };
    if let Err(e) = std::fs::create_dir_all(out) {
        eprintln!("{}: {e}", out.display());
        return ExitCode::from(3);
    }
    match study {
        "tables" => tables::run(tables::SEEDS),
        "figures" => figures::run(out),
        "uses" => studies::uses(),
        "target" => studies::target(),
        "together" => together::run(),
        "sensitivity" => studies::sensitivity(),
        "coefficients" => coefficients::run(),
        "validation" => validation::run(out, tables::SEEDS),
        "all" => {
            tables::run(tables::SEEDS);
            figures::run(out);
            studies::uses();
            studies::target();
            together::run();
            studies::sensitivity();
            coefficients::run();
            validation::run(out, tables::SEEDS);
        }
        _ => return usage(),
    }
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    eprintln!("usage: xu2017_studies STUDY [OUT_DIR]");
    for (name, what, _) in names::STUDIES {
        eprintln!("  {name:13} {what}");
    }
    ExitCode::from(2)
}
