//! The command `poinsot`: arguments in, one verb, exit code out.

mod arguments;
mod guard;
mod verbs;

use arguments::{Arguments, Verb};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = guard::guarded(|| match &arguments.verb {
        Verb::Identify(a) => verbs::identify::run(a),
        Verb::Simulate(a) => verbs::simulate::run(a),
        Verb::Predict(a) => verbs::predict::run(a),
        Verb::Validate(a) => verbs::validate::run(a),
        Verb::Report(a) => verbs::report::run(a),
        Verb::Inspect(a) => verbs::inspect::run(a),
        Verb::Check(a) => verbs::check::run(a),
        Verb::Import(a) => verbs::import::run(a),
        Verb::Export(a) => verbs::export::run(a),
        Verb::Explain(a) => verbs::explain::run(a),
        Verb::Schema => verbs::schema::run(),
    });
    match result.and_then(verbs::printed) {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            // A closed standard error leaves nobody to tell.
            let _ = std::io::Write::write_all(
                &mut std::io::stderr(),
                format!("{}\n", guard::plain(&failure.message)).as_bytes(),
            );
            ExitCode::from(failure.exit_code)
        }
    }
}
