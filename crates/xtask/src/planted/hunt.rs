//! Builds the tests of the copy and runs them with one bug on.

use super::{Bug, LISTED, chosen_targets, copy};
use crate::fault::Fault;
use crate::repository::{cannot_start, captured, cargo};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// A bug may let a test run for ever; all tests of a crate are one binary, the longest of which takes four minutes without one.
const PATIENCE: Duration = Duration::from_secs(1200);
/// Which targets are built, the same for all calls, so that cargo never builds twice.
const TARGETS: &str = "--lib --bins --tests";

/// A test binary of the copy.
pub struct Binary {
    package: String,
    name: String,
    executable: String,
}

/// Builds the tests of the copy.
pub fn build() -> Result<Vec<Binary>, Fault> {
    let targets = chosen_targets().unwrap_or_else(|| TARGETS.to_owned());
    let mut command = cargo(&[
        "test",
        "--no-run",
        "--message-format",
        "json",
        "--release",
        "--workspace",
    ]);
    command
        .args(["--exclude", "planted"])
        .args(targets.split_whitespace())
        .current_dir(copy::tree());
    command
        .env("CARGO_TARGET_DIR", copy::scratch().join("build"))
        .env("CARGO_INCREMENTAL", "1");
    let built = captured(&mut command)?;
    if !built.status.success() {
        return Err(Fault::Failed(
            "planted: the copy with the switches does not build".to_owned(),
        ));
    }
    let messages = String::from_utf8_lossy(&built.stdout);
    Ok(messages.lines().filter_map(binary).collect())
}

/// The test binary of one message of cargo.
fn binary(message: &str) -> Option<Binary> {
    let message: Value = serde_json::from_str(message).ok()?;
    let is_test = message["reason"] == "compiler-artifact" && message["profile"]["test"] == true;
    let manifest = Path::new(message["manifest_path"].as_str().filter(|_| is_test)?);
    Some(Binary {
        package: manifest
            .parent()?
            .file_name()?
            .to_string_lossy()
            .into_owned(),
        name: message["target"]["name"].as_str()?.to_owned(),
        executable: message["executable"].as_str()?.to_owned(),
    })
}

/// The tests that catch this bug, from the first package that has one.
pub fn hunt(bug: &Bug, binaries: &[Binary]) -> Result<Vec<String>, Fault> {
    for package in &bug.tests {
        let mut caught = Vec::new();
        for binary in binaries.iter().filter(|binary| binary.package == *package) {
            if caught.len() < LISTED {
                caught.extend(caught_by(binary, bug)?);
            }
        }
        if !caught.is_empty() {
            caught.truncate(LISTED);
            return Ok(caught);
        }
    }
    Ok(Vec::new())
}

/// Tests of one binary that fail with the bug on and pass with it off.
fn caught_by(binary: &Binary, bug: &Bug) -> Result<Vec<String>, Fault> {
    let found = failures(binary, &bug.name, &[])?;
    let anyway = if found.is_empty() {
        Vec::new()
    } else {
        failures(binary, "", &found)?
    };
    let (package, name) = (&binary.package, &binary.name);
    let label = match name.replace('-', "_") == package.replace('-', "_") {
        true => package.clone(),
        false => format!("{package}::{name}"),
    };
    let caught = found.iter().filter(|test| !anyway.contains(test));
    Ok(caught.map(|test| format!("{label} {test}")).collect())
}

/// Which tests of one binary fail while this bug is on; stops when it has enough.
fn failures(binary: &Binary, bug: &str, only: &[String]) -> Result<Vec<String>, Fault> {
    let mut command = Command::new(&binary.executable);
    if !only.is_empty() {
        command.arg("--exact").args(only);
    }
    command
        .current_dir(copy::tree().join("crates").join(&binary.package))
        .env("POINSOT_PLANTED", bug);
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut running = command
        .spawn()
        .map_err(|why| cannot_start(&command, &why))?;
    let (send, lines) = mpsc::channel();
    if let Some(output) = running.stdout.take() {
        thread::spawn(move || {
            let lines = BufReader::new(output).split(b'\n').map_while(Result::ok);
            // Sending fails where nobody waits any more.
            lines
                .map(|line| send.send(String::from_utf8_lossy(&line).into_owned()))
                .find(Result::is_err)
        });
    }
    let (failed, in_time) = first_failures(&lines);
    // It may have ended.
    let _ = running.kill();
    let _ = running.wait();
    if !in_time && failed.is_empty() {
        let file = Path::new(&binary.executable)
            .file_name()
            .unwrap_or_default();
        println!(
            "  {} did not end in {} s",
            file.to_string_lossy(),
            PATIENCE.as_secs()
        );
    }
    Ok(failed)
}

/// The first failures among lines of a test binary, and whether it ended in time.
fn first_failures(lines: &Receiver<String>) -> (Vec<String>, bool) {
    let end = Instant::now() + PATIENCE;
    let mut failed = Vec::new();
    while failed.len() < LISTED {
        match lines.recv_timeout(end.saturating_duration_since(Instant::now())) {
            Ok(line) => failed.extend(failed_test(&line).map(str::to_owned)),
            Err(RecvTimeoutError::Timeout) => return (failed, false),
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    (failed, true)
}

/// Name of the test that this line reports as failed.
fn failed_test(line: &str) -> Option<&str> {
    let (name, result) = line.strip_prefix("test ")?.split_once(' ')?;
    let result = result.strip_prefix("- should panic ").unwrap_or(result);
    result.starts_with("... FAILED").then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_failed_tests_are_read() {
        assert_eq!(failed_test("test a::unit_b ... FAILED"), Some("a::unit_b"));
        assert_eq!(failed_test("test a - should panic ... FAILED"), Some("a"));
        assert_eq!(failed_test("test a ... ok"), None);
        assert_eq!(failed_test("test result: FAILED. 1 passed"), None);
    }

    #[test]
    fn unit_test_binaries_are_read_from_messages() {
        let message = r#"{"reason":"compiler-artifact","profile":{"test":true},"executable":"/t/all-1",
            "manifest_path":"/t/crates/poinsot/Cargo.toml","target":{"name":"all"}}"#;
        let found = binary(message).unwrap();
        assert_eq!(
            (found.package.as_str(), found.name.as_str()),
            ("poinsot", "all")
        );
        assert!(binary(&message.replace("\"test\":true", "\"test\":false")).is_none());
    }
}
