//! `poinsot methods`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Methods;
use poinsot::methods::{MethodText, methods, methods_file};
use std::fmt::Write;

pub fn run(arguments: &Methods) -> Outcome {
    let mut listed = methods();
    if let Some(name) = &arguments.name {
        let all: Vec<&str> = listed.iter().map(|m| m.name).collect();
        let advice = format!("use one of {}", all.join(", "));
        listed.retain(|m| m.name == name);
        if listed.is_empty() {
            let problem = "there is no such method";
            return Err(poinsot::Error::usage("methods", name, problem, advice));
        }
    }
    shown(
        &arguments.print,
        || print_json(&methods_file(listed.clone())),
        || {
            let texts: Vec<String> = listed.iter().map(text).collect();
            print(&texts.join("\n"));
        },
    );
    Ok(0)
}

/// Text of a method: paper and variants, default variant first.
fn text(method: &MethodText) -> String {
    let mut out = format!("{}: {}\n", method.name, method.summary);
    if let Some(paper) = method.paper {
        let _ = writeln!(out, "  paper: {paper}");
    }
    let width = method.variants.iter().map(|v| v.name.len()).max();
    for (k, variant) in method.variants.iter().enumerate() {
        let default = if k == 0 { " (default)" } else { "" };
        let _ = writeln!(
            out,
            "  --variant {:width$}  {}{default}",
            variant.name,
            variant.summary,
            width = width.unwrap_or(0)
        );
    }
    let settings = method.settings.iter();
    let width = settings.map(|s| s.key.len() + s.default.len());
    let width = width.max().unwrap_or(0) + 1;
    for setting in method.settings {
        let pair = format!("{}={}", setting.key, setting.default);
        let _ = writeln!(out, "  --set {pair:width$}  {}", setting.summary);
    }
    out
}
