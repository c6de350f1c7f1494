//! `poinsot init`

use super::{Outcome, asked, exit_of, note, print, print_json, reading};
use crate::arguments::Init;
use poinsot::{Draft, Error, check_outputs, init, segment_files};
use poinsot_files::{counted, error_line};
use poinsot_formats::{QuestionFile, WrittenFile};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

pub fn run(arguments: &Init) -> Outcome {
    let files: Vec<PathBuf> = arguments.files.iter().flat_map(segment_files).collect();
    let out = &arguments.out;
    let inputs = files.iter().chain(&arguments.urdf).map(PathBuf::as_path);
    check_outputs("-o", std::slice::from_ref(out), &inputs.collect::<Vec<_>>())?;
    if out.exists() {
        let advice = "remove it, or name another one with -o";
        return Err(Error::usage("-o", out.display(), "the file exists", advice));
    }
    let options = reading(&arguments.rows)?;
    let mut draft = init(&files, arguments.urdf.as_deref(), &options)?;
    let plain = !arguments.print.json && !arguments.print.quiet;
    if plain && std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        ask(&mut draft);
    }
    poinsot::write_file(out, draft.text.as_bytes())?;
    let questions = draft.questions();
    let code = exit_of(questions.is_empty());
    if arguments.print.json {
        print_json(&WrittenFile {
            questions: Some(questions),
            ..WrittenFile::of(std::slice::from_ref(out))
        });
    } else if plain {
        note(&format!("written: {}", out.display()));
        print(&remaining(out, &questions, &files));
    }
    Ok(code)
}

/// Asks every question; an empty answer leaves it open.
fn ask(draft: &mut Draft) {
    print("An empty answer leaves a question open.\n");
    for question in draft.questions() {
        loop {
            let Some(answer) = asked(&format!("{}: ", question.text)) else {
                return;
            };
            if answer.trim().is_empty() {
                break;
            }
            match draft.answer(&question, &answer) {
                Ok(()) => break,
                Err(error) => note(&error_line(&error.to_string())),
            }
        }
    }
}

/// The open questions, and the next command.
fn remaining(out: &Path, questions: &[QuestionFile], files: &[PathBuf]) -> String {
    let path = out.display();
    let mut text = String::new();
    for question in questions {
        let lines: Vec<String> = question.lines.iter().map(usize::to_string).collect();
        text += &format!("{path}:{}: {}\n", lines.join(","), question.text);
    }
    let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    let first = match questions.len() {
        0 => String::new(),
        open => format!("Answer {} in the file, then: ", counted(open, "question")),
    };
    let names = names.join(",");
    format!("{text}{first}poinsot identify -m {path} {names}\n")
}
