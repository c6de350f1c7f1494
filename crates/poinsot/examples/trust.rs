//! How often an honest record is doubted: trials of the campaign's set-ups, nothing wrong in them.
//!
//!     cargo run --release -p poinsot --example trust -- [--trials 200] [--stride 1] [--only NAME]
//!
//! Readings are drawn from the declared noise; what comes out with a doubt is a false alarm.
#![allow(non_snake_case)]

#[path = "campaign/setups.rs"]
#[allow(dead_code)]
mod setups;

use poinsot::bind::bind;
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{Estimate, Problem, maximum_likelihood};
use rayon::prelude::*;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut trials, mut stride, mut only) = (200, 1, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word}: a value is missing"))?;
        match word.as_str() {
            "--trials" => trials = value.parse()?,
            "--stride" => stride = value.parse()?,
            "--only" => only = Some(value),
            _ => {
                return Err(
                    format!("{word}: known are --trials N, --stride N, --only NAME").into(),
                );
            }
        }
    }
    println!("| set-up | trials | doubted |");
    println!("|---|---|---|");
    let wanted = |name: &&str| only.as_ref().is_none_or(|o| o == name);
    for name in setups::NAMES.into_iter().filter(wanted) {
        let setup = setups::setup(name, stride).ok_or(format!("{name}: no such set-up"))??;
        let study = setup.study;
        let all: Vec<_> = (0..trials)
            .into_par_iter()
            .map(|trial| answer(&study, trial))
            .collect();
        let mut doubted = 0;
        for (trial, estimate) in all.iter().enumerate() {
            let said = match estimate {
                Ok(e) if e.doubts.is_empty() => continue,
                Ok(e) => e.doubts.join("; "),
                Err(why) => why.clone(),
            };
            doubted += 1;
            println!("  {name} {trial}: {said}");
        }
        println!("| {name} | {trials} | {doubted} |");
    }
    Ok(())
}

fn answer(study: &Study, trial: u64) -> Result<Estimate, String> {
    let (tables, _) = study.draw(trial);
    let tree = Tree::new(&study.model);
    let bound = bind(&study.model, &tree, &tables).map_err(|e| e.to_string())?;
    maximum_likelihood(&Problem {
        model: &study.model,
        tree: &tree,
        segments: &bound.segments,
        noise: &bound.noise,
        relative_accuracy: 1.0,
    })
    .map_err(|e| e.to_string())
}
