//! `poinsot man`

use super::{Outcome, written};
use crate::arguments::{Arguments, Man};
use clap::{Command, CommandFactory};
use poinsot::write_files;
use std::path::PathBuf;

pub fn run(arguments: &Man) -> Outcome {
    let mut command = Arguments::command();
    command.build();
    let mut pages = vec![page(&command, "poinsot")];
    for verb in command.get_subcommands().filter(|c| c.get_name() != "help") {
        let name = format!("poinsot-{}", verb.get_name());
        pages.push(page(verb, &name));
    }
    let paths = write_files(&arguments.folder, &pages)?;
    written(&paths, arguments.print.json, arguments.print.quiet);
    Ok(0)
}

fn page(command: &Command, name: &str) -> (PathBuf, Vec<u8>) {
    let mut text = Vec::new();
    // Writing to memory cannot fail.
    let _ = clap_mangen::Man::new(command.clone().name(name.to_owned())).render(&mut text);
    (format!("{name}.1").into(), text)
}
