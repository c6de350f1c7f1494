//! Generates the page of commands from the definition of the command line.

use crate::GENERATED;
use clap::{Arg, Command, CommandFactory};
use poinsot_cli::arguments::Arguments;
use std::fmt::Write;

/// The page `reference/commands.md`.
pub fn page() -> String {
    let mut command = Arguments::command().color(clap::ColorChoice::Never);
    command.build();
    let mut out = "# Commands\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(
        "Every command returns an exit code and writes its answer to standard output, everything else to standard error. \
         A command that fails leaves nothing under the final name.\n\n\
         | exit code | meaning |\n|---|---|\n",
    );
    for (code, meaning) in poinsot_cli::arguments::EXIT_CODES {
        let _ = writeln!(out, "| {code} | {meaning} |");
    }
    let verbs: Vec<&Command> = command
        .get_subcommands()
        .filter(|c| !c.is_hide_set() && c.get_name() != "help")
        .collect();
    out.push_str("\n| command | |\n|---|---|\n");
    for verb in &verbs {
        let name = verb.get_name();
        let about = verb
            .get_about()
            .map(ToString::to_string)
            .unwrap_or_default();
        let _ = writeln!(out, "| [`{name}`](#poinsot-{name}) | {} |", cell(&about));
    }
    for verb in verbs {
        section(verb, &mut out);
    }
    out
}

fn section(verb: &Command, out: &mut String) {
    let name = verb.get_name();
    let about = verb.get_long_about().or(verb.get_about());
    let about = about.map(ToString::to_string).unwrap_or_default();
    let usage = verb.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").trim();
    let usage = usage.split_whitespace().collect::<Vec<_>>().join(" ");
    let usage = match usage.strip_prefix("poinsot ") {
        Some(_) => usage,
        None => format!("poinsot {usage}"),
    };
    let _ = write!(
        out,
        "\n## poinsot {name}\n\n{about}\n\n```text\n{usage}\n```\n"
    );
    let arguments: Vec<&Arg> = verb
        .get_arguments()
        .filter(|a| !a.is_hide_set() && a.get_id() != "help" && a.get_id() != "version")
        .collect();
    if arguments.is_empty() {
        return;
    }
    out.push_str("\n| argument | meaning | default |\n|---|---|---|\n");
    for a in arguments {
        let help = a.get_long_help().or(a.get_help());
        let help = help.map(ToString::to_string).unwrap_or_default();
        let takes = a.get_num_args().is_some_and(|n| n.takes_values());
        let defaults: Vec<_> = a
            .get_default_values()
            .iter()
            .map(|d| format!("`{}`", d.to_string_lossy()))
            .filter(|_| takes)
            .collect();
        let choices: Vec<_> = a
            .get_possible_values()
            .iter()
            .filter(|_| takes)
            .map(|v| format!("`{}`", v.get_name()))
            .collect();
        let mut help = cell(&help);
        if !choices.is_empty() {
            let _ = write!(help, " One of {}.", choices.join(", "));
        }
        let _ = writeln!(out, "| `{}` | {help} | {} |", words(a), defaults.join(" "));
    }
}

/// An argument as written on the command line.
fn words(a: &Arg) -> String {
    let takes = a.get_num_args().is_some_and(|n| n.takes_values());
    let value = a
        .get_value_names()
        .and_then(|n| n.first())
        .map(|n| format!("<{n}>"))
        .unwrap_or_default();
    match a.get_long() {
        Some(long) if takes => format!("--{long} {value}"),
        Some(long) => format!("--{long}"),
        None => value,
    }
}

/// Escapes text for a table cell.
pub fn cell(text: &str) -> String {
    let one = text.split_whitespace().collect::<Vec<_>>().join(" ");
    one.replace('|', "\\|").replace('<', "&lt;")
}
