//! Plants faults in one experiment and counts how often the diagnosis notices and names them.
//!
//!     cargo run --release -p poinsot --example faults -- --trials 100 [--clean 1000] [--only 3]
//!
//! `--clean` is the number of trials without a fault; they tell how often an alarm is false. `--only` runs one row,
//! counted from 0.
#![allow(non_snake_case)]

mod planted;

use planted::{Planted, experiment, row};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut trials, mut clean, mut only) = (100, None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word}: a number is missing"))?;
        match word.as_str() {
            "--trials" => trials = value.parse()?,
            "--clean" => clean = Some(value.parse()?),
            "--only" => only = Some(value.parse::<usize>()?),
            _ => return Err(format!("{word}: known are --trials N, --clean N, --only ROW").into()),
        }
    }
    println!("| planted | trials | noticed | named rightly | not trusted | first named |");
    println!("|---|---|---|---|---|---|");
    for (at, planted) in Planted::ALL.into_iter().enumerate() {
        if only.is_some_and(|only| only != at) {
            continue;
        }
        let count = match planted {
            Planted::Nothing => clean.unwrap_or(trials),
            _ => trials,
        };
        let r = row(&experiment(planted)?, planted, count);
        let firsts: Vec<String> = r.firsts.iter().map(|(n, k)| format!("{n} {k}")).collect();
        let named = match planted {
            Planted::Nothing => "-".to_owned(),
            _ => r.named.to_string(),
        };
        println!(
            "| {} | {} | {} | {named} | {} | {} |",
            r.planted.words(),
            r.trials,
            r.detected,
            r.doubted,
            firsts.join(", ")
        );
    }
    Ok(())
}
