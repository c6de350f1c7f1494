//! The command `poinsot`: arguments in, one verb, exit code out.

use poinsot_cli::arguments;
mod guard;
mod progress;
mod signals;
mod terminal;
mod verbs;

use arguments::{Arguments, Verb};
use clap::{CommandFactory, FromArgMatches};
use progress::Progress;
use std::process::ExitCode;

fn main() -> ExitCode {
    signals::install();
    let parsed = Arguments::command()
        .try_get_matches()
        .and_then(|matches| Ok((Arguments::from_arg_matches(&matches)?, matches)));
    let (arguments, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(usage) => return terminal::usage_exit(&usage),
    };
    let quiet = matches
        .subcommand()
        .and_then(|(_, m)| m.try_get_one::<bool>("quiet").ok().flatten())
        .is_some_and(|q| *q);
    let progress = Progress::start(quiet);
    let result = guard::guarded(|| match &arguments.verb {
        Verb::Identify(a) => verbs::identify::run(a),
        Verb::Simulate(a) => verbs::simulate::run(a),
        Verb::Predict(a) => verbs::predict::run(a),
        Verb::Validate(a) => verbs::validate::run(a),
        Verb::Compare(a) => verbs::compare::run(a),
        Verb::Report(a) => verbs::report::run(a),
        Verb::Inspect(a) => verbs::inspect::run(a),
        Verb::Check(a) => verbs::check::run(a),
        Verb::Import(a) => verbs::import::run(a),
        Verb::Export(a) => verbs::export::run(a),
        Verb::Explain(a) => verbs::explain::run(a),
        Verb::Units(a) => verbs::units::run(a),
        Verb::Methods(a) => verbs::methods::run(a),
        Verb::Study(a) => verbs::study::run(a),
        Verb::Schema(a) => verbs::schema::run(a),
        Verb::Completions(a) => verbs::completions::run(a),
        Verb::Man(a) => verbs::man::run(a),
    });
    progress.clear();
    match result.and_then(verbs::printed) {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            let message = terminal::error_text(&failure.message);
            // A closed standard error leaves nobody to tell.
            let _ = std::io::Write::write_all(
                &mut std::io::stderr(),
                format!("{message}\n").as_bytes(),
            );
            ExitCode::from(failure.exit_code)
        }
    }
}
