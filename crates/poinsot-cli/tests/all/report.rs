//! `poinsot report` and `identify --report`, run as commands.

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
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    shipped.join(path).display().to_string()
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

/// Results of other commands, from their files only: the same page layout, verdict first.
#[test]
fn cli_results_of_other_verbs_have_the_same_page() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let (model, six, one) = (
        example("stsat3/model.toml"),
        example("stsat3/multiaxis/telemetry_noisy.csv"),
        example("stsat3/paper/telemetry_noisy.csv"),
    );
    let out = at("six");
    let asked = ["identify", "--model", &model, "--out", &out];
    let done = poinsot(&[&asked[..], &["--telemetry", &six]].concat());
    assert_eq!(done.status.code(), Some(0));
    let validate = ["validate", "--model", &model, "--estimate", &out];
    let validation = at("validation");
    poinsot(&[&validate[..], &["--against", &one, "--out", &validation]].concat());
    let keep = |name: &str, arguments: &[&str]| {
        let path = at(name);
        std::fs::write(&path, poinsot(arguments).stdout).unwrap();
        path
    };
    let case = example("cases/stsat3_kim2010.toml");
    let prediction = keep("prediction.json", &["predict", &case, "--json"]);
    let comparison = keep("comparison.json", &["compare", &out, &out, "--json"]);
    for (result, word, section) in [
        (&validation, "Agrees", "Differences"),
        (
            &prediction,
            "Partly determined",
            "Not identifiable from the data",
        ),
        (&comparison, "Agree, not reliable", "Notes"),
    ] {
        assert_eq!(poinsot(&["report", result]).status.code(), Some(0));
        let path = Path::new(result);
        let folder = match path.is_dir() {
            true => path,
            false => path.parent().unwrap(),
        };
        let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
        assert!(
            page.contains(&format!("<p class=\"status\">{word}</p>")),
            "{result}"
        );
        assert!(page.contains(&format!("<h2>{section}</h2>")), "{result}");
    }
    let other = at("other.json");
    std::fs::write(&other, "{\"schema\": \"poinsot.truth/2\"}").unwrap();
    let refused = poinsot(&["report", &other]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("has no page"));
}
