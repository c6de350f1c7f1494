//! `poinsot study`

use super::{Outcome, formats, print, print_document, print_json, written};
use crate::arguments::{FigureFile, Study};
use poinsot::study::{document, files, find, json, papers, run as run_study};
use poinsot::write_files;
use std::fmt::Write;

pub fn run(arguments: &Study) -> Outcome {
    let chosen = find(arguments.paper.as_deref(), arguments.name.as_deref())?;
    if arguments.name.is_none() {
        list(arguments);
        return Ok(0);
    }
    let figures = match arguments.figures.as_slice() {
        [] => vec![FigureFile::Svg],
        some => some.to_vec(),
    };
    let mut answers = Vec::new();
    for (paper, study) in chosen {
        let findings = run_study(study, &arguments.examples)?;
        if arguments.json {
            answers.push(json(paper, study, &findings));
        } else if !arguments.quiet {
            print_document(&document(paper, study, &findings));
        }
        if let Some(folder) = &arguments.out {
            let paths = write_files(folder, &files(study, &findings, &formats(&figures))?)?;
            // With --json the standard output is the findings.
            written(&paths, false, arguments.quiet || arguments.json);
        }
    }
    match answers.as_slice() {
        [] => {}
        [one] => print_json(one),
        all => print_json(&all),
    }
    Ok(0)
}

/// The papers with their studies.
fn list(arguments: &Study) {
    let chosen = |name: &str| arguments.paper.as_ref().is_none_or(|p| p == name);
    let all: Vec<_> = papers().filter(|p| chosen(p.0)).collect();
    if arguments.json {
        let studies = |list: &[poinsot::study::Study]| -> Vec<_> {
            let one = |s: &poinsot::study::Study| serde_json::json!({ "name": s.name, "summary": s.summary, "quick": s.quick });
            list.iter().map(one).collect()
        };
        let papers = all.iter().map(|(name, citation, list)| {
            serde_json::json!({ "paper": name, "citation": citation, "studies": studies(list) })
        });
        print_json(&papers.collect::<Vec<_>>());
        return;
    }
    if arguments.quiet {
        return;
    }
    let mut out = String::new();
    for (name, citation, list) in all {
        let _ = writeln!(out, "{name}: {citation}");
        let width = list.iter().map(|s| s.name.len()).max().unwrap_or(0);
        for s in list {
            let slow = if s.quick { "" } else { " (minutes)" };
            let _ = writeln!(
                out,
                "  poinsot study {name} {:width$}  {}{slow}",
                s.name, s.summary
            );
        }
    }
    print(&out);
}
