//! `poinsot check`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Check;
use poinsot::check::check;

pub fn run(arguments: &Check) -> Outcome {
    let found = check(&arguments.file)?;
    shown(
        &arguments.print,
        || print_json(&found),
        || print(&format!("{}\n", found.content)),
    );
    Ok(0)
}
