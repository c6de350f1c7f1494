//! `poinsot schema`

use super::{Outcome, print_json};

pub fn run() -> Outcome {
    print_json(&poinsot_model::model_schema());
    Ok(0)
}
