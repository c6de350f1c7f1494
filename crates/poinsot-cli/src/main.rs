//! The command `poinsot`: arguments in, one verb, exit code out.

mod arguments;
mod verbs;

use arguments::{Arguments, Verb};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match &arguments.verb {
        Verb::Identify(a) => verbs::identify::run(a),
        Verb::Simulate(a) => verbs::simulate::run(a),
        Verb::Predict(a) => verbs::predict::run(a),
        Verb::Validate(a) => verbs::validate::run(a),
        Verb::Report(a) => verbs::report::run(a),
        Verb::Inspect(a) => verbs::inspect::run(a),
        Verb::Check(a) => verbs::check::run(a),
        Verb::Schema => verbs::schema::run(),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            eprintln!("{}", failure.message);
            ExitCode::from(failure.exit_code)
        }
    }
}
