//! Disk full, errors of the disk, a kill at every call that changes a file, closed and full standard output.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg(target_os = "linux")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn example(path: &str) -> String {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    examples.join(path).display().to_string()
}

fn poinsot(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poinsot"));
    command.args(arguments).stdin(Stdio::null());
    command
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The library that makes the n-th call fail; `None` where there is no C compiler.
fn shim(folder: &Path) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/environment/faults.c");
    let library = folder.join("faults.so");
    let compiled = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .arg(&library)
        .arg(source)
        .arg("-ldl")
        .status();
    compiled.is_ok_and(|s| s.success()).then_some(library)
}

/// A verb that writes, and its files.
struct Question {
    arguments: Vec<String>,
    files: &'static [&'static str],
}

/// The first rows of a record: the calls that write are the same, and each run is short.
fn short_record() -> String {
    static FOLDER: std::sync::OnceLock<tempfile::TempDir> = std::sync::OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let whole =
            std::fs::read_to_string(example("stsat3/multiaxis/telemetry_noisy.csv")).unwrap();
        let rows: Vec<&str> = whole.lines().take(300).collect();
        std::fs::write(folder.path().join("t.csv"), rows.join("\n") + "\n").unwrap();
        folder
    });
    folder.path().join("t.csv").display().to_string()
}

fn identify() -> Question {
    let arguments = [
        "identify",
        "--model",
        &example("stsat3/model.toml"),
        "--telemetry",
        &short_record(),
        "--method",
        "linear",
        "--report",
        "--quiet",
    ];
    Question {
        arguments: arguments.map(str::to_owned).to_vec(),
        files: &["estimate.json", "report_data.json", "report.html"],
    }
}

fn simulate() -> Question {
    let arguments = ["simulate", &example("cases/stsat3_spin.toml"), "--quiet"];
    Question {
        arguments: arguments.map(str::to_owned).to_vec(),
        files: &["telemetry.csv", "truth.json"],
    }
}

/// The bytes that a good run writes, the name of its folder aside.
fn good(question: &Question, folder: &Path) -> Vec<Vec<u8>> {
    let done = run(question, folder, |_| {});
    assert!(
        done.status.code().is_some_and(|c| c <= 1),
        "{}",
        stderr(&done)
    );
    contents(question, folder)
        .into_iter()
        .map(Option::unwrap)
        .collect()
}

fn run(question: &Question, folder: &Path, change: impl FnOnce(&mut Command)) -> Output {
    let arguments: Vec<&str> = question.arguments.iter().map(String::as_str).collect();
    let mut command = poinsot(&arguments);
    // A relative name: the command line stands in the result.
    command.args(["--out", "out"]).current_dir(folder);
    command.env("RAYON_NUM_THREADS", "1");
    change(&mut command);
    command.output().unwrap()
}

fn contents(question: &Question, folder: &Path) -> Vec<Option<Vec<u8>>> {
    let read = |name: &&str| std::fs::read(folder.join("out").join(name)).ok();
    question.files.iter().map(read).collect()
}

/// Fails every call once; afterwards each file is whole or not there, and the exit code is honest.
fn at_every_call(question: &Question, how: &str, once: bool) {
    let workshop = tempfile::tempdir().unwrap();
    let Some(shim) = shim(workshop.path()) else {
        eprintln!("skipped: no C compiler");
        return;
    };
    let reference = tempfile::tempdir().unwrap();
    let whole = good(question, reference.path());
    let mut calls = 0;
    for n in 1..10_000 {
        let folder = tempfile::tempdir().unwrap();
        let fired = workshop.path().join("fired");
        let _ = std::fs::remove_file(&fired);
        let done = run(question, folder.path(), |command| {
            command.env("LD_PRELOAD", &shim);
            command.env("FAULT_AT", n.to_string());
            command.env("FAULT_HOW", how);
            command.env("FAULT_FIRED", &fired);
            if once {
                command.env("FAULT_ONCE", "1");
            }
        });
        let here = contents(question, folder.path());
        let place = format!("call {n}, {how}, once {once}: {}", stderr(&done));
        for (found, wanted) in here.iter().zip(&whole) {
            assert!(
                found.as_ref().is_none_or(|f| f == wanted),
                "a partial file: {place}"
            );
        }
        if !fired.exists() {
            assert!(here.iter().all(Option::is_some), "{place}");
            calls = n - 1;
            break;
        }
        let code = done.status.code();
        let complete = here.iter().all(Option::is_some);
        if how == "kill" {
            assert_eq!(code, None, "{place}");
            // The answer is put in place last: where it stands, the others do.
            let answer = here[0].is_some() && question.files[0] == "estimate.json";
            assert!(!answer || complete, "{place}");
        } else if code == Some(3) {
            assert!(
                here.iter().all(Option::is_none),
                "files of a failed run: {place}"
            );
            assert!(stderr(&done).starts_with("E0"), "{place}");
            assert_eq!(stderr(&done).lines().count(), 1, "{place}");
        } else {
            // The call did not matter: flushing a folder, which not every system can.
            assert!(code.is_some_and(|c| c <= 1), "{place}");
            assert!(complete, "{place}");
        }
        if how != "kill" {
            let left: Vec<_> = std::fs::read_dir(folder.path().join("out"))
                .into_iter()
                .flatten()
                .flatten()
                .filter(|e| e.file_name().to_string_lossy().starts_with(".poinsot-"))
                .collect();
            assert!(left.is_empty(), "a temporary file stays: {place}");
        }
    }
    println!(
        "{} {how} once={once}: {calls} calls, each failed in turn",
        question.arguments[0]
    );
    assert!(calls >= 8, "only {calls} calls were seen");
}

#[test]
fn cli_disk_full_at_every_call_of_identify() {
    at_every_call(&identify(), "enospc", true);
    at_every_call(&identify(), "enospc", false);
}

#[test]
fn cli_disk_error_at_every_call_of_simulate() {
    at_every_call(&simulate(), "eio", true);
}

#[test]
fn cli_killed_at_every_call_of_identify() {
    at_every_call(&identify(), "kill", true);
}

#[test]
fn cli_killed_at_every_call_of_simulate() {
    at_every_call(&simulate(), "kill", true);
}

#[test]
fn cli_a_file_size_limit_is_an_error_of_the_environment() {
    let folder = tempfile::tempdir().unwrap();
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$@\"";
    let done = Command::new("sh")
        .args(["-c", script, "sh", env!("CARGO_BIN_EXE_poinsot")])
        .args(identify().arguments)
        .args(["--out", "out"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(3), "{}", stderr(&done));
    assert!(stderr(&done).starts_with("E0002 out/"), "{}", stderr(&done));
    assert!(
        contents(&identify(), folder.path())
            .iter()
            .all(Option::is_none)
    );
}

#[test]
fn cli_full_standard_output_is_exit_3() {
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let done = poinsot(&["schema"]).stdout(full).output().unwrap();
    assert_eq!(done.status.code(), Some(3));
    assert_eq!(
        stderr(&done),
        "E0003 standard output: No space left on device (os error 28); free space, or write to another place\n"
    );
}

#[test]
fn cli_closed_standard_output_is_no_error() {
    let mut child = poinsot(&["schema"]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn cli_closed_standard_error_is_no_error_either() {
    let mut child = poinsot(&["explain", "E9999"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

/// Notes after an answer that is written: nobody reads them, and the answer stands.
#[test]
fn regress_notes_on_a_closed_standard_error_are_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    let case = example("cases/stsat3_spin.toml");
    let mut child = poinsot(&["simulate", &case, "--out", "out"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn cli_a_folder_without_permission_is_exit_3() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        eprintln!("skipped: this user may write everywhere");
        return;
    }
    let out = locked.join("out").display().to_string();
    let mut arguments = identify().arguments;
    arguments.extend(["--out".to_owned(), out]);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = poinsot(&arguments).output().unwrap();
    assert_eq!(done.status.code(), Some(3));
    assert!(
        stderr(&done).contains("Permission denied"),
        "{}",
        stderr(&done)
    );
}
