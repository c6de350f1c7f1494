//! The list of bad input, from the case files of `validation/bad_input/`.

use crate::commands::cell;
use crate::{Fault, read, repository};
use serde::Deserialize;
use std::fmt::Write;
use std::fs;

/// Sections of the page: folder, heading.
const SECTIONS: [(&str, &str); 6] = [
    ("telemetry", "Telemetry (2a)"),
    ("results", "Results (2b)"),
    ("files", "Files (2c)"),
    ("models", "Models (2d)"),
    ("security", "Security (2e)"),
    ("codes", "Codes that the list does not reach"),
];

/// What the page shows of a case.
#[derive(Deserialize)]
struct Case {
    id: String,
    fault: String,
    exit: i32,
    #[serde(default)]
    run: Vec<String>,
    #[serde(default)]
    more: Vec<String>,
    #[serde(default)]
    printed: Vec<String>,
}

/// The page.
pub fn page() -> Result<String, Fault> {
    let (mut tables, mut count) = (String::new(), 0);
    for (folder, title) in SECTIONS {
        let _ = writeln!(
            tables,
            "## {title}\n\n| | fault | exit | printed |\n|---|---|---|---|"
        );
        let folder = format!("validation/bad_input/{folder}");
        let mut names = Vec::new();
        for entry in fs::read_dir(repository(&folder))? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
        names.sort();
        count += names.len();
        for name in names {
            tables.push_str(&row(&toml::from_str(&read(&format!("{folder}/{name}"))?)?));
        }
        tables.push('\n');
    }
    let header = read("validation/bad_input/header.md")?.replace("{cases}", &count.to_string());
    Ok(header + &tables + &read("validation/bad_input/differences.md")?)
}

fn row(case: &Case) -> String {
    let code = |text: &str| {
        format!(
            "`{}`",
            cell(text).replace('`', "'").replace('\u{1b}', "ESC")
        )
    };
    let command = [case.run.as_slice(), &case.more].concat().join(" ");
    let command = match command.as_str() {
        "" => String::new(),
        command => format!(" ({})", code(command)),
    };
    let printed: Vec<String> = case.printed.iter().map(|line| code(line)).collect();
    format!(
        "| {} | {}{command} | {} | {} |\n",
        case.id,
        cell(&case.fault),
        case.exit,
        printed.join("<br>")
    )
}
