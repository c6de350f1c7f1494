//! `poinsot schema`

use super::{Outcome, print_json};
use crate::arguments::Schema;

pub fn run(arguments: &Schema) -> Outcome {
    print_json(&poinsot::schema(&arguments.name)?);
    Ok(0)
}
