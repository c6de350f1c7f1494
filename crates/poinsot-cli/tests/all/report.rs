//! `poinsot report` and `identify --report` from outside.

use assert_cmd::Command;
use std::path::Path;
use std::process::Output;

fn poinsot(arguments: &[&str]) -> Output {
    Command::cargo_bin("poinsot")
        .unwrap()
        .args(arguments)
        .output()
        .unwrap()
}

fn example(path: &str) -> String {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    examples.join(path).display().to_string()
}

#[test]
fn cli_the_page_of_identify_is_that_of_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let (model, telemetry) = (
        example("stsat3/model.toml"),
        example("stsat3/multiaxis/telemetry_noisy.csv"),
    );
    let asked = poinsot(&[
        "identify",
        "--model",
        &model,
        "--telemetry",
        &telemetry,
        "--out",
        &out,
        "--report",
    ]);
    assert_eq!(asked.status.code(), Some(0));
    let page = folder.path().join("report.html");
    let first = std::fs::read(&page).unwrap();
    std::fs::remove_file(&page).unwrap();
    let again = poinsot(&["report", &out]);
    assert_eq!(again.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&again.stderr).contains("report.html"));
    assert!(std::fs::read(&page).unwrap() == first);
}

#[test]
fn cli_a_folder_without_an_answer_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let refused = poinsot(&["report", &out]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("E0601"));
    std::fs::write(folder.path().join("estimate.json"), "[1, 2").unwrap();
    assert_eq!(poinsot(&["report", &out]).status.code(), Some(2));
    assert!(!folder.path().join("report.html").exists());
}
