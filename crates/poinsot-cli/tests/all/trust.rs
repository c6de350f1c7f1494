//! Messages and exit codes for unreliable answers, and refusals.

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

fn example(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data/stsat3")
        .join(path)
}

fn identify(model: &Path, more: &[&str]) -> Output {
    let telemetry = example("multiaxis/telemetry_noisy.csv");
    let mut command = Command::cargo_bin("poinsot").unwrap();
    command.arg("identify").arg("--model").arg(model);
    command.arg("--telemetry").arg(telemetry);
    command.args(more).output().unwrap()
}

/// Terminal, file and page agree, and scripts get it from the exit code.
#[test]
fn cli_exit_1_and_one_verdict_everywhere_where_a_prior_contradicts_the_data() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(example("model.toml")).unwrap();
    let asked = "estimate = [\"inertia\"]";
    let model = folder.path().join("model.toml");
    let prior = format!("{asked}\nprior = {{ inertia_kg_m2 = 0.005 }}");
    std::fs::write(&model, text.replace(asked, &prior)).unwrap();
    let out = folder.path().join("out");
    let done = identify(&model, &["--out", out.to_str().unwrap(), "--report"]);
    assert_eq!(done.status.code(), Some(1));
    let printed = String::from_utf8(done.stdout).unwrap();
    let first = printed.lines().next().unwrap();
    assert!(
        first.starts_with("stsat3: Determined, not reliable. "),
        "{first}"
    );
    assert!(
        printed.contains("Explain the failed test first: a prior is inconsistent with the data.")
    );
    let file = std::fs::read_to_string(out.join("estimate.json")).unwrap();
    let file: Value = serde_json::from_str(&file).unwrap();
    assert_eq!(file["status"], "converged");
    assert_eq!(file["covariance_trustworthy"], false);
    assert_eq!(file["doubts"][0], "a prior is inconsistent with the data");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Determined, not reliable"));
    assert!(page.contains("a prior is inconsistent with the data"));
    // Exported on request only, and marked.
    let export = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("poinsot").unwrap();
        command.arg("export").arg(&out).args(arguments);
        command.output().unwrap()
    };
    let onto = model.to_str().unwrap();
    for (arguments, mark) in [
        (vec!["--to", "csv"], "data (not reliable)"),
        (
            vec!["--to", "model", "--onto", onto],
            "# poinsot: not reliable: a prior is inconsistent with the data\n",
        ),
    ] {
        let refused = export(&arguments);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains("--accept-unreliable"), "{said}");
        let done = export(&[arguments, vec!["--accept-unreliable"]].concat());
        assert_eq!(done.status.code(), Some(0));
        assert!(String::from_utf8(done.stdout).unwrap().contains(mark));
    }
}

#[test]
fn cli_every_0_is_refused() {
    let done = identify(&example("model.toml"), &["--every", "0"]);
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(
        said.contains("E0001 --every '0': the number of rows must be at least 1"),
        "{said}"
    );
    let mut inspect = Command::cargo_bin("poinsot").unwrap();
    inspect
        .arg("inspect")
        .arg(example("multiaxis/telemetry_noisy.csv"));
    let done = inspect.args(["--every", "0"]).output().unwrap();
    assert_eq!(done.status.code(), Some(2));
}

/// Duplicate samples would make every sigma smaller by the root of two.
#[test]
fn cli_the_same_telemetry_twice_is_refused_under_any_name() {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.csv");
    std::fs::copy(example("multiaxis/telemetry_noisy.csv"), &copy).unwrap();
    let done = identify(
        &example("model.toml"),
        &["--telemetry", copy.to_str().unwrap()],
    );
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(
        said.contains("E0001 --telemetry") && said.contains("copy.csv"),
        "{said}"
    );
    assert!(said.contains("would count twice"), "{said}");
}

#[test]
fn cli_help_says_what_is_not_possible_together() {
    let help = Command::cargo_bin("poinsot").unwrap();
    let done = { help }.args(["identify", "--help"]).output().unwrap();
    let text = String::from_utf8(done.stdout).unwrap();
    assert!(text.contains("Excludes --json"), "{text}");
    let done = identify(&example("model.toml"), &["--json", "--quiet"]);
    assert_eq!(done.status.code(), Some(2));
}
