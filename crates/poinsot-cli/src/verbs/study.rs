//! `poinsot study`

use super::{
    Outcome, command_line, formats, note, print, print_document, print_json, shown, written,
};
use crate::arguments::Study;
use poinsot::study::{
    files, find, findings_file, printed_findings, run as run_study, studies_file,
};
use poinsot::write_files;
use poinsot_formats::{FINDINGS, FindingsFile, StudiesFile};
use poinsot_report::study_document;

pub fn run(arguments: &Study) -> Outcome {
    let chosen = find(arguments.paper.as_deref(), arguments.name.as_deref())?;
    if arguments.name.is_none() {
        list(arguments);
        return Ok(0);
    }
    let is_old = |word: &String| word.split('=').next() == Some("--examples");
    if command_line().iter().any(is_old) {
        note(
            "warning: --examples is the old name of --data. Use --data: version 0.3 refuses --examples.",
        );
    }
    let figures = match arguments.figures.as_slice() {
        [] => formats(&["svg".to_owned()])?,
        some => formats(some)?,
    };
    let mut answers = Vec::new();
    for (paper, study) in chosen {
        let findings = run_study(study, &arguments.data)?;
        if arguments.print.json {
            answers.push(findings_file(paper, study, &findings));
        } else if !arguments.print.quiet {
            let found = printed_findings(paper, study, &findings);
            print_document(&study_document(&found));
        }
        if let Some(folder) = &arguments.out {
            let paths = write_files(folder, &files(study, &findings, &figures)?)?;
            // With --json, the written files are not listed.
            written(&paths, false, arguments.print.quiet || arguments.print.json);
        }
    }
    if arguments.print.json {
        print_json(&FindingsFile {
            schema: FINDINGS.to_owned(),
            findings: answers,
        });
    }
    Ok(0)
}

fn list(arguments: &Study) {
    let all = studies_file(arguments.paper.as_deref());
    let text = || print(&listed(&all));
    shown(&arguments.print, || print_json(&all), text);
}

fn listed(all: &StudiesFile) -> String {
    let mut out = String::new();
    for of in &all.papers {
        let paper = &of.paper;
        out += &format!("{paper}: {}\n", of.citation);
        let width = of.studies.iter().map(|s| s.name.len()).max().unwrap_or(0);
        for s in &of.studies {
            let slow = if s.quick { "" } else { " (minutes)" };
            let (name, about) = (&s.name, &s.summary);
            out += &format!("  poinsot study {paper} {name:width$}  {about}{slow}\n");
        }
    }
    out
}
