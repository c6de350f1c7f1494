//! The command `poinsot`: parses arguments, runs one command, returns the exit code. Used by the program, the
//! manual pages, the book and the Python package.
//!
//! # Files
//! - `arguments.rs`: arguments and help, the source of completions, manual pages and the book.
//! - `verbs/`: one file per command.
//! - `live.rs`: the page of `follow --serve`.
//! - `terminal.rs`: width and colours. `progress.rs`: a line after two seconds, from `tracing` events.
//! - `signals.rs`: removes drafts on INT, TERM, HUP; SIGXFSZ becomes an error.

pub mod arguments;
mod live;
mod progress;
mod signals;
mod terminal;
mod verbs;
mod words;

pub use verbs::exit_of;

use arguments::{Arguments, Verb};
use clap::{CommandFactory, FromArgMatches};
use poinsot::{Error, guarded};
use poinsot_files::{limit_hours, limit_memory};
use poinsot_formats::ErrorFile;
use std::ffi::OsString;
use std::io::IsTerminal;

/// Stack of the thread that runs a verb, bytes; that of the main thread is the user's limit.
const STACK: usize = 8 << 20;

/// Runs the command line `words` (program name first) and returns the exit code. Call it once at program
/// start: it installs handlers for signals and panics and configures the thread pool.
pub fn run(words: Vec<OsString>) -> u8 {
    signals::install();
    let json = words.iter().any(|word| word == "--json");
    let thread = std::thread::Builder::new().stack_size(STACK);
    let ran = guarded(|| {
        let answer = thread
            .spawn(move || answer(words))
            .map_err(Error::threads)?;
        answer
            .join()
            .unwrap_or_else(|cause| std::panic::resume_unwind(cause))
    });
    ended(ran, json)
}

/// Runs the command line.
fn answer(words: Vec<OsString>) -> verbs::Outcome {
    verbs::remember(&words);
    let parsed = Arguments::command()
        .try_get_matches_from(words)
        .and_then(|matches| Ok((Arguments::from_arg_matches(&matches)?, matches)));
    let (arguments, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(usage) => return verbs::usage(&usage),
    };
    arguments.limit_memory.into_iter().for_each(limit_memory);
    limit_hours(arguments.limit_hours);
    let verb = matches.subcommand();
    let quiet = verb.and_then(|(_, m)| m.try_get_one::<bool>("quiet").ok().flatten());
    // `follow` shows its own lines; a person who types rows is not to be written over.
    let typed = std::io::stdin().is_terminal() && verbs::command_line().iter().any(|w| w == "-");
    let own = matches!(arguments.verb, Verb::Follow(_)) || typed;
    progress::start(quiet == Some(&true) || own);
    let result = guarded(|| match &arguments.verb {
        Verb::Identify(a) => verbs::identify::run(a),
        Verb::Follow(a) => verbs::follow::run(a),
        Verb::Simulate(a) => verbs::simulate::run(a),
        Verb::Predict(a) => verbs::predict::run(a),
        Verb::Design(a) => verbs::design::run(a),
        Verb::Validate(a) => verbs::validate::run(a),
        Verb::Compare(a) => verbs::compare::run(a),
        Verb::Campaign(a) => verbs::campaign::run(a),
        Verb::Sweep(a) => verbs::sweep::run(a),
        Verb::Report(a) => verbs::report::run(a),
        Verb::Inspect(a) => verbs::inspect::run(a),
        Verb::Init(a) => verbs::init::run(a),
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
    progress::clear();
    result
}

/// Prints why there is no answer, and returns the exit code.
fn ended(result: verbs::Outcome, json: bool) -> u8 {
    match result.and_then(verbs::printed) {
        Ok(code) => code,
        Err(failure) => {
            let file = ErrorFile::of(&failure);
            let message = terminal::error_text(&failure.to_string());
            // A closed standard error is ignored.
            let _ = std::io::Write::write_all(
                &mut std::io::stderr(),
                format!("{message}\n").as_bytes(),
            );
            if json {
                verbs::print_json(&file);
            }
            file.exit_code
        }
    }
}
