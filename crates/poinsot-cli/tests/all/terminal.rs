//! The command in a terminal and in a pipe: colours, quiet, JSON, completions, manual pages, figures.

use assert_cmd::Command;
use clap::CommandFactory;
use poinsot_cli::arguments::Arguments;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("poinsot").unwrap();
    for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(variable);
    }
    command.args(arguments);
    command
}

fn poinsot(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn example(path: &str) -> String {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    shipped.join(path).display().to_string()
}

/// Every command that gives a result, with valid arguments.
fn questions(folder: &Path) -> Vec<Vec<String>> {
    let out = folder.join("answer").display().to_string();
    let simulated = folder.join("simulated").display().to_string();
    let pages = folder.join("man").display().to_string();
    let (model, case) = (
        example("stsat3/model.toml"),
        example("cases/stsat3_spin.toml"),
    );
    let telemetry = example("stsat3/multiaxis/telemetry.parquet");
    let words = |list: &[&str]| list.iter().map(|w| (*w).to_owned()).collect();
    vec![
        words(&[
            "identify",
            "--method",
            "linear",
            "--model",
            &model,
            "--telemetry",
            &telemetry,
            "--out",
            &out,
        ]),
        words(&["report", &out]),
        words(&["simulate", &case, "--out", &simulated]),
        words(&["predict", &case]),
        words(&["inspect", &telemetry]),
        words(&["check", &model]),
        words(&["man", &pages]),
    ]
}

#[test]
fn cli_quiet_prints_nothing_and_json_prints_json() {
    let folder = tempfile::tempdir().unwrap();
    for question in questions(folder.path()) {
        let mut words: Vec<&str> = question.iter().map(String::as_str).collect();
        words.push("--quiet");
        let quiet = poinsot(&words);
        assert!(quiet.status.code().unwrap() < 2, "{}", text(&quiet.stderr));
        assert_eq!(
            text(&quiet.stdout) + &text(&quiet.stderr),
            "",
            "{question:?}"
        );

        *words.last_mut().unwrap() = "--json";
        let json = poinsot(&words);
        assert_eq!(json.status.code(), quiet.status.code());
        let answer: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        let schema = answer["schema"].as_str().unwrap_or_default();
        assert!(schema.starts_with("poinsot."), "{question:?}: {schema}");
    }
}

/// A command whose only output is a document for another program, or lines of JSON, needs neither.
#[test]
fn cli_every_verb_knows_json_and_quiet() {
    let documents = ["schema", "completions", "help", "follow"];
    for verb in Arguments::command().get_subcommands() {
        if verb.is_hide_set() || documents.contains(&verb.get_name()) {
            continue;
        }
        for wanted in ["json", "quiet"] {
            let knows = verb.get_arguments().any(|a| a.get_long() == Some(wanted));
            assert!(knows, "poinsot {} has no --{wanted}", verb.get_name());
        }
    }
}

/// The help of every command ends with examples, and each is a valid command line.
#[test]
fn cli_the_help_of_every_verb_has_examples_that_parse() {
    let all = Arguments::command();
    for command in std::iter::once(&all).chain(all.get_subcommands()) {
        let name = command.get_name();
        let help = command.get_after_help().map(ToString::to_string);
        let help = help.unwrap_or_default();
        let lines = help.lines().filter_map(|line| {
            let begin = line.find("poinsot ")?;
            line[begin..].split(" > ").next()?.split(" >> ").next()
        });
        let mut count = 0;
        for line in lines {
            let parsed = Arguments::command().try_get_matches_from(line.split_whitespace());
            let is_help = |e: &clap::Error| e.kind() == clap::error::ErrorKind::DisplayHelp;
            assert!(parsed.as_ref().err().is_none_or(is_help), "{line}");
            let of = parsed
                .ok()
                .and_then(|m| m.subcommand_name().map(str::to_owned));
            assert!(name == "poinsot" || of.as_deref() == Some(name), "{line}");
            count += 1;
        }
        assert!(count > 0, "poinsot {name} has no example: {help}");
    }
}

#[test]
fn cli_model_and_telemetry_have_the_same_short_names_everywhere() {
    for verb in Arguments::command().get_subcommands() {
        for (long, short) in [("model", 'm'), ("telemetry", 't')] {
            let own = verb.get_arguments().find(|a| a.get_long() == Some(long));
            let is_short = own.is_none_or(|a| a.get_short() == Some(short));
            assert!(is_short, "poinsot {} --{long}", verb.get_name());
        }
    }
}

#[test]
fn cli_colours_only_where_they_are_seen_or_asked_for() {
    let words = ["predict", &example("cases/stsat3_kim2010.toml")];
    let piped = command(&words).output().unwrap();
    assert!(!text(&piped.stdout).contains('\u{1b}'));
    let forced = command(&words).env("CLICOLOR_FORCE", "1").output().unwrap();
    assert!(text(&forced.stdout).contains("\u{1b}["));
    let refused = command(&words)
        .env("CLICOLOR_FORCE", "1")
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    assert_eq!(text(&refused.stdout), text(&piped.stdout));
}

#[test]
fn cli_errors_are_marked_only_where_colours_are() {
    let words = ["check", "nowhere.toml"];
    let plain = text(&command(&words).output().unwrap().stderr);
    assert!(plain.starts_with('E'), "{plain}");
    let forced = command(&words).env("CLICOLOR_FORCE", "1").output().unwrap();
    assert_eq!(
        forced.status.code(),
        command(&words).output().unwrap().status.code()
    );
    assert!(text(&forced.stderr).starts_with('\u{1b}'));
}

#[test]
fn cli_completions_of_every_shell_know_every_verb() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let done = poinsot(&["completions", shell]);
        assert_eq!(done.status.code(), Some(0), "{shell}");
        let script = text(&done.stdout);
        for verb in Arguments::command().get_subcommands() {
            if !verb.is_hide_set() {
                assert!(
                    script.contains(verb.get_name()),
                    "{shell}: {}",
                    verb.get_name()
                );
            }
        }
        assert!(script.contains("telemetry"), "{shell}");
    }
    assert_eq!(poinsot(&["completions", "cmd"]).status.code(), Some(2));
}

#[test]
fn cli_a_manual_page_for_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("man1");
    let done = poinsot(&["man", &out.display().to_string()]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let page = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    assert!(page("poinsot.1").contains(".TH poinsot 1"));
    for verb in Arguments::command().get_subcommands() {
        let name = verb.get_name();
        assert!(page(&format!("poinsot-{name}.1")).contains(".SH SYNOPSIS"));
    }
    let identify = page("poinsot-identify.1");
    assert!(identify.contains("telemetry") && identify.contains("relative"));
}

fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            (
                PathBuf::from(path.file_name().unwrap()),
                std::fs::read(&path).unwrap(),
            )
        })
        .collect()
}

#[test]
fn cli_figures_are_those_of_the_page_and_equal_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let asked = poinsot(&[
        "identify",
        "--model",
        &example("stsat3/model.toml"),
        "--telemetry",
        &example("stsat3/multiaxis/telemetry_noisy.csv"),
        "--out",
        &out,
        "--report",
        "--figures",
        "svg,svg",
        "--quiet",
    ]);
    assert_eq!(asked.status.code(), Some(0), "{}", text(&asked.stderr));
    let figures = folder.path().join("figures");
    let first = files(&figures);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(first.len(), page.matches("<figure").count());
    for (name, bytes) in &first {
        assert!(bytes.starts_with(b"<svg xmlns"), "{}", name.display());
    }
    std::fs::remove_dir_all(&figures).unwrap();
    let again = poinsot(&["report", &out, "--figures", "svg"]);
    assert_eq!(again.status.code(), Some(0));
    assert!(text(&again.stderr).contains("fit_segment1_gyro.svg"));
    assert!(files(&figures) == first);
    let png = poinsot(&["report", &out, "--figures", "png"]);
    if cfg!(feature = "png") {
        let written = files(&figures);
        let pictures = written.values().filter(|f| f.starts_with(b"\x89PNG"));
        assert_eq!(pictures.count(), first.len());
    } else {
        assert_eq!(png.status.code(), Some(2));
        assert!(text(&png.stderr).contains("feature `png`"));
    }
    assert_eq!(
        poinsot(&["report", &out, "--figures", "bmp"]).status.code(),
        Some(2)
    );
}
