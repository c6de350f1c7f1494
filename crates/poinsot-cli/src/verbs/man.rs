//! `poinsot man`

use super::{Failure, Outcome, written};
use crate::arguments::{Arguments, Man};
use clap::{Command, CommandFactory};
use poinsot::write_file;
use std::path::PathBuf;

pub fn run(arguments: &Man) -> Outcome {
    let mut command = Arguments::command();
    command.build();
    let mut paths = vec![page(arguments, &command, "poinsot")?];
    for verb in command.get_subcommands().filter(|c| c.get_name() != "help") {
        let name = format!("poinsot-{}", verb.get_name());
        paths.push(page(arguments, verb, &name)?);
    }
    written(&paths, arguments.json, arguments.quiet);
    Ok(0)
}

fn page(arguments: &Man, command: &Command, name: &str) -> Result<PathBuf, Failure> {
    let path = arguments.folder.join(format!("{name}.1"));
    let mut text = Vec::new();
    // Writing into memory does not fail.
    let _ = clap_mangen::Man::new(command.clone().name(name.to_owned())).render(&mut text);
    write_file(&path, &text)?;
    Ok(path)
}
