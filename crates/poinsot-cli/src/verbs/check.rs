//! `poinsot check`

use super::{Failure, Outcome, print, print_json};
use crate::arguments::Check;
use poinsot_formats::{DESCRIPTION, StatedFile};
use poinsot_model::{describe, read_model};

pub fn run(arguments: &Check) -> Outcome {
    let model = read_model(&arguments.model).map_err(Failure::from)?;
    let description = describe(&model);
    if arguments.json {
        print_json(&StatedFile {
            schema: DESCRIPTION,
            content: description,
        });
    } else if !arguments.quiet {
        print(&format!("{description}\n"));
    }
    Ok(0)
}
