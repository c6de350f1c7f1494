//! The page of commands, from the definition of the command line.

use clap::{Arg, Command, CommandFactory};
use minijinja::{Value, context};
use poinsot_cli::arguments::{Arguments, EXIT_CODES};

/// The context of `reference/commands.md`.
pub fn commands() -> Value {
    let mut command = Arguments::command().color(clap::ColorChoice::Never);
    command.build();
    let shown = |c: &&Command| !c.is_hide_set() && c.get_name() != "help";
    let verbs: Vec<Value> = command.get_subcommands().filter(shown).map(verb).collect();
    context! { exit_codes => EXIT_CODES, verbs }
}

fn verb(verb: &Command) -> Value {
    let usage = verb.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").trim();
    let usage = usage.split_whitespace().collect::<Vec<_>>().join(" ");
    let usage = match usage.strip_prefix("poinsot ") {
        Some(_) => usage,
        None => format!("poinsot {usage}"),
    };
    let shown = |a: &&Arg| !a.is_hide_set() && a.get_id() != "help" && a.get_id() != "version";
    let arguments: Vec<Value> = verb.get_arguments().filter(shown).map(argument).collect();
    let text = |text: Option<&clap::builder::StyledStr>| text.map(ToString::to_string);
    context! {
        name => verb.get_name(),
        about => cell(&text(verb.get_about()).unwrap_or_default()),
        long_about => text(verb.get_long_about().or(verb.get_about())),
        usage,
        arguments,
    }
}

fn argument(a: &Arg) -> Value {
    let help = a.get_long_help().or(a.get_help());
    let takes = takes(a);
    let defaults = a.get_default_values().iter().filter(|_| takes);
    let choices = a.get_possible_values().into_iter().filter(|_| takes);
    context! {
        words => words(a),
        help => cell(&help.map(ToString::to_string).unwrap_or_default()),
        defaults => defaults.map(|d| format!("`{}`", d.to_string_lossy())).collect::<Vec<_>>(),
        choices => choices.map(|v| format!("`{}`", v.get_name())).collect::<Vec<_>>(),
    }
}

fn takes(a: &Arg) -> bool {
    a.get_num_args().is_some_and(|n| n.takes_values())
}

/// An argument as written on the command line.
fn words(a: &Arg) -> String {
    let value = a
        .get_value_names()
        .and_then(|n| n.first())
        .map(|n| format!("<{n}>"))
        .unwrap_or_default();
    match a.get_long() {
        Some(long) if takes(a) => format!("--{long} {value}"),
        Some(long) => format!("--{long}"),
        None => value,
    }
}

/// Escapes text for a table cell.
pub fn cell(text: &str) -> String {
    let one = text.split_whitespace().collect::<Vec<_>>().join(" ");
    one.replace('|', "\\|").replace('<', "&lt;")
}
