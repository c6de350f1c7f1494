//! The command `poinsot`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(poinsot_cli::run(std::env::args_os().collect()))
}
