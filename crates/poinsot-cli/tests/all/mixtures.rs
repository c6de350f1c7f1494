//! Each file of one run beside the files of another: every reader refuses them, or gives the answer as before.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn crates(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn shipped(path: &str) -> String {
    crates("../data").join(path).display().to_string()
}

/// Runs the program in a folder; whether it gives an answer.
#[track_caller]
fn answers(folder: &Path, words: &[&str]) -> bool {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poinsot"));
    let output = command.current_dir(folder).args(words).output().unwrap();
    match output.status.code() {
        Some(0 | 1) => true,
        Some(2) => false,
        other => panic!(
            "{words:?}: {other:?} {}",
            String::from_utf8_lossy(&output.stderr)
        ),
    }
}

/// Files below a folder, by name without the digest of a plan.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(files(&path)),
            false => found.push(path),
        }
    }
    found.sort_by_key(|path| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        name.rsplit('_').next().unwrap().to_owned()
    });
    found
}

/// Swaps each file of the folders `a` and `b`, and reads `a`. `read` gives what a reader says, and nothing where it refuses.
/// Returns how many files were refused.
fn refused(folder: &Path, read: impl Fn() -> Option<Vec<u8>>) -> usize {
    let [a, b] = ["a", "b"].map(|run| files(&folder.join(run)));
    assert_eq!(a.len(), b.len());
    let original = read().unwrap();
    let mut refused = 0;
    for (own, other) in a.iter().zip(&b) {
        let kept = fs::read(own).unwrap();
        fs::copy(other, own).unwrap();
        match read() {
            None => refused += 1,
            Some(said) => assert!(said == original, "{} of another run is read", own.display()),
        }
        fs::write(own, kept).unwrap();
    }
    assert!(read().unwrap() == original);
    println!("{refused} of {} files refused", a.len());
    refused
}

/// What `report` makes of the folder `a`.
fn page(folder: &Path) -> Option<Vec<u8>> {
    answers(folder, &["report", "a"]).then(|| fs::read(folder.join("a/report.html")).unwrap())
}

/// Two parts of a record.
fn records(folder: &Path) {
    let whole = fs::read_to_string(shipped("stsat3/multiaxis/telemetry_noisy.csv")).unwrap();
    let rows: Vec<&str> = whole.lines().collect();
    for (name, part) in [("a.csv", 1..300), ("b.csv", 301..600)] {
        let text = [&rows[..1], &rows[part]].concat().join("\n");
        fs::write(folder.join(name), text + "\n").unwrap();
    }
}

#[test]
fn exact_files_of_two_runs_of_identify_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path());
    let model = shipped("stsat3/model.toml");
    for (out, rows) in [("a", "a.csv"), ("b", "b.csv")] {
        let words = [
            "identify", "-m", &model, rows, "--method", "linear", "--out", out, "--report",
        ];
        assert!(answers(folder.path(), &words));
    }
    assert_eq!(refused(folder.path(), || page(folder.path())), 2);
}

#[test]
fn exact_files_of_two_runs_of_validate_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = shipped("cases/stsat3_spin.toml");
    for (out, model) in [("a", "stsat3/model.toml"), ("b", "cases/stsat3_truth.toml")] {
        let (model, against) = (shipped(model), shipped("cases/stsat3_truth.toml"));
        let words = [
            "validate",
            &case,
            "--model",
            &model,
            "--against",
            &against,
            "--out",
            out,
        ];
        assert!(answers(folder.path(), &words));
    }
    assert_eq!(refused(folder.path(), || page(folder.path())), 2);
}

#[test]
fn exact_files_of_two_runs_of_design_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| fs::read_to_string(crates("poinsot-design/doc").join(name)).unwrap();
    for (out, mass) in [("a", "mass_kg = 10.0"), ("b", "mass_kg = 11.0")] {
        let model = read("model.toml").replacen("mass_kg = 10.0", mass, 1);
        fs::write(folder.path().join("model.toml"), model).unwrap();
        let duration = if out == "a" { "10.0" } else { "20.0" };
        let case =
            read("case.toml").replacen("duration_s = 10.0", &format!("duration_s = {duration}"), 1);
        fs::write(folder.path().join("case.toml"), case).unwrap();
        assert!(answers(
            folder.path(),
            &["design", "case.toml", "--out", out]
        ));
    }
    assert_eq!(refused(folder.path(), || page(folder.path())), 4);
}

/// A truth beside other telemetry is not used, and the page says so.
#[test]
fn exact_files_of_two_runs_of_simulate_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = fs::read_to_string(shipped("cases/stsat3_spin.toml")).unwrap();
    let truth = "stsat3_truth.toml";
    fs::copy(
        shipped(&format!("cases/{truth}")),
        folder.path().join(truth),
    )
    .unwrap();
    for (out, seed) in [("a", "seed = 3"), ("b", "seed = 4")] {
        fs::write(
            folder.path().join("case.toml"),
            case.replacen("seed = 3", seed, 1),
        )
        .unwrap();
        assert!(answers(
            folder.path(),
            &["simulate", "case.toml", "--out", out]
        ));
    }
    let model = shipped("stsat3/model.toml");
    let read = || {
        let words = [
            "identify",
            "-m",
            &model,
            "a/telemetry.csv",
            "--method",
            "linear",
            "--out",
            "o",
            "--report",
        ];
        assert!(answers(folder.path(), &words));
        let page = fs::read_to_string(folder.path().join("o/report.html")).unwrap();
        (!page.contains("truth.json beside the telemetry is not used")).then(|| page.into_bytes())
    };
    assert_eq!(refused(folder.path(), read), 2);
}

/// Sums and rows of shards; the result is made again of them.
#[test]
fn exact_files_of_two_campaigns_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["plan.toml", "case.toml", "model.toml"] {
        fs::copy(crates("poinsot/doc").join(name), folder.path().join(name)).unwrap();
    }
    let plan = fs::read_to_string(folder.path().join("plan.toml")).unwrap();
    let other = plan.replacen("seed = 1", "seed = 77", 1);
    assert_ne!(plan, other);
    fs::write(folder.path().join("other.toml"), other).unwrap();
    for (out, plan) in [("a", "plan.toml"), ("b", "other.toml")] {
        assert!(answers(
            folder.path(),
            &["campaign", plan, "--out", out, "--trials", "2"]
        ));
    }
    let words = [
        "campaign",
        "plan.toml",
        "--out",
        "a",
        "--trials",
        "2",
        "--merge",
    ];
    let read = || {
        let text = || fs::read(folder.path().join("a/campaign.json")).unwrap();
        answers(folder.path(), &words).then(text)
    };
    assert_eq!(refused(folder.path(), read), 2);
}
