//! `poinsot check`

use super::{Outcome, print, print_json};
use crate::arguments::Check;
use poinsot::check::check;

pub fn run(arguments: &Check) -> Outcome {
    let found = check(&arguments.file)?;
    if arguments.print.json {
        print_json(&found);
    } else if !arguments.print.quiet {
        print(&format!("{}\n", found.content));
    }
    Ok(0)
}
