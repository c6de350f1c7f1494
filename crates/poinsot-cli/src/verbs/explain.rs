//! `poinsot explain`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Explain;
use poinsot::explain::{codes_file, error_codes, explain};

pub fn run(arguments: &Explain) -> Outcome {
    let codes = match &arguments.code {
        None => error_codes(),
        Some(code) => vec![explain(code).ok_or_else(|| {
            let advice = "run `poinsot explain` for all";
            poinsot::Error::usage("explain", code, "there is no such code", advice)
        })?],
    };
    let text = || {
        for code in &codes {
            match arguments.code {
                Some(_) => print(&code.to_string()),
                None => print(&format!("{}  {}\n", code.code, code.meaning)),
            }
        }
    };
    let json = || print_json(&codes_file(codes.clone()));
    shown(&arguments.print, json, text);
    Ok(0)
}
