//! Plants faults in one experiment and counts how often the diagnosis notices and names them.
//!
//!     cargo run --release -p poinsot --example faults -- --trials 100 [--clean 1000] [--only 3]
//!
//!     cargo run --release -p poinsot --example faults -- --drawn 200 [--clean 250] [--only 3]
//!
//! The second form plants faults of drawn size in three vehicles. `--clean` is the number of trials without a fault; they tell how often an alarm is false. `--only` runs one row,
//! counted from 0.
#![allow(non_snake_case)]

mod drawn;
mod planted;

use planted::{Planted, experiment, row};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut trials, mut clean, mut only, mut drawn) = (100, None, None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word}: a number is missing"))?;
        match word.as_str() {
            "--trials" => trials = value.parse()?,
            "--drawn" => drawn = Some(value.parse()?),
            "--clean" => clean = Some(value.parse()?),
            "--only" => only = Some(value.parse::<usize>()?),
            _ => {
                return Err(format!(
                    "{word}: known are --trials N, --drawn N, --clean N, --only ROW"
                )
                .into());
            }
        }
    }
    if let Some(trials) = drawn {
        return of_drawn_size(trials, clean.unwrap_or(0), only);
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

/// The table of faults of random size, and of vehicles without a fault.
fn of_drawn_size(trials: u64, clean: u64, only: Option<usize>) -> Result<(), Box<dyn Error>> {
    println!(
        "| planted | vehicle | noticeable at 5 sigma | trials | noticed | named rightly | alone | wrongly | rightly from twice the smallest | mean, longest s | first named |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let faulty = drawn::faults().into_iter().map(|f| (f, trials));
    let none = drawn::clean().into_iter().map(|f| (f, clean));
    for (at, (fault, count)) in faulty.chain(none).enumerate() {
        if only.is_some_and(|only| only != at) || count == 0 {
            continue;
        }
        let r = drawn::tally(&fault, count)?;
        let firsts: Vec<String> = r.firsts.iter().map(|(n, k)| format!("{n} {k}")).collect();
        let size = match r.noticeable.is_finite() {
            true => format!("{:.2e} {}", r.noticeable, fault.size.1),
            false => format!("planted: {} {}", fault.size.0, fault.size.1),
        };
        println!(
            "| {} | {} | {size} | {} | {} | {} | {} | {} | {} of {} | {:.2}, {:.2} | {} |",
            fault.words,
            fault.craft.words(),
            r.trials,
            r.noticed,
            r.named,
            r.alone,
            r.wrong,
            r.large.0,
            r.large.1,
            r.seconds.1,
            r.seconds.0,
            firsts.join(", ")
        );
    }
    if only.is_none() {
        for craft in drawn::Craft::ALL {
            let [fit, all] = drawn::times(craft)?;
            println!(
                "\n{}: fit {fit:.2} s, with diagnosis {all:.2} s",
                craft.words()
            );
        }
    }
    Ok(())
}
