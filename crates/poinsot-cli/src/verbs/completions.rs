//! `poinsot completions`

use super::{Outcome, print};
use crate::arguments::{Arguments, Completions};
use clap::CommandFactory;

pub fn run(arguments: &Completions) -> Outcome {
    let mut text = Vec::new();
    let mut command = Arguments::command();
    clap_complete::generate(arguments.shell, &mut command, "poinsot", &mut text);
    print(&String::from_utf8_lossy(&text));
    Ok(0)
}
