//! `poinsot methods`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Methods;
use poinsot::methods::{MethodText, methods, methods_file};

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
    let json = || print_json(&methods_file(listed.clone()));
    shown(&arguments.print, json, || {
        let texts: Vec<String> = listed.iter().map(text).collect();
        print(&texts.join("\n"));
    });
    Ok(0)
}

/// Text of a method: paper and variants, default variant first.
fn text(method: &MethodText) -> String {
    let mut out = format!("{}: {}\n", method.name, method.summary);
    if let Some(paper) = method.paper {
        out += &format!("  paper: {paper}\n");
    }
    let names = method.variants.iter().map(|v| v.name.len());
    let width = names.max().unwrap_or(0);
    for (k, variant) in method.variants.iter().enumerate() {
        let default = if k == 0 { " (default)" } else { "" };
        let (name, about) = (variant.name, variant.summary);
        out += &format!("  --variant {name:width$}  {about}{default}\n");
    }
    let settings = method.settings.iter();
    let pairs = settings.map(|s| (format!("{}={}", s.key, s.default), s.summary));
    let pairs: Vec<_> = pairs.collect();
    let width = pairs.iter().map(|p| p.0.len()).max().unwrap_or(0);
    for (pair, about) in pairs {
        out += &format!("  --set {pair:width$}  {about}\n");
    }
    out
}
