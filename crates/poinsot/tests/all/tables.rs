//! Tables of `docs/validation`, printed by the tests that judge them. `POINSOT_TRIALS` sets the trials of a row, `POINSOT_FIRST`
//! the number of the first, `POINSOT_ROW` selects the rows that contain this text.

use std::fmt::Display;
use std::str::FromStr;

fn variable<T: FromStr>(name: &str) -> Option<T> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name}: {text:?}")))
}

pub fn trials(otherwise: u64) -> u64 {
    variable("POINSOT_TRIALS").unwrap_or(otherwise)
}

pub fn first() -> u64 {
    variable("POINSOT_FIRST").unwrap_or(0)
}

pub fn wanted(row: &str) -> bool {
    variable::<String>("POINSOT_ROW").is_none_or(|text| row.contains(&text))
}

pub fn heading(columns: &[&str]) {
    row(columns);
    println!("|{}", "---|".repeat(columns.len()));
}

pub fn row(cells: &[impl Display]) {
    let cells: Vec<String> = cells.iter().map(ToString::to_string).collect();
    println!("| {} |", cells.join(" | "));
}

/// Processor time of this thread, s; zero if unknown. Exact with one thread.
pub fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.unwrap_or(0.0) * 1.0e-9
}
