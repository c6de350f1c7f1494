//! `poinsot explain`

use super::{Outcome, print, print_json};
use crate::arguments::Explain;
use poinsot::explain::{codes_file, error_codes, explain};

pub fn run(arguments: &Explain) -> Outcome {
    let codes = match &arguments.code {
        None => error_codes(),
        Some(code) => vec![explain(code).ok_or_else(|| {
            poinsot::Error::usage(
                "explain",
                code,
                "there is no such code",
                "run `poinsot explain` for all",
            )
        })?],
    };
    if arguments.print.json {
        print_json(&codes_file(&codes));
    } else if arguments.print.quiet {
        return Ok(0);
    } else if arguments.code.is_some() {
        codes.iter().for_each(|c| print(&c.to_string()));
    } else {
        let lines: Vec<String> = codes
            .iter()
            .map(|c| format!("{}  {}\n", c.code, c.meaning))
            .collect();
        print(&lines.concat());
    }
    Ok(0)
}
