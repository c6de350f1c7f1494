//! `poinsot check`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Check;
use poinsot::check::check;

pub fn run(arguments: &Check) -> Outcome {
    let found = check(&arguments.file)?;
    let text = || print(&format!("{}\n", found.content));
    shown(&arguments.print, || print_json(&found), text);
    Ok(0)
}
