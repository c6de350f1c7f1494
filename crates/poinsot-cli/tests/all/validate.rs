//! `poinsot validate` and driven joints on the command line: exit codes, streams, files.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn example(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    root.join(path).display().to_string()
}

fn poinsot<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Output {
    let mut command = Command::cargo_bin("poinsot").unwrap();
    command.args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn cli_validate_compares_two_models() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let (model, truth) = (
        example("xu2017/model.toml"),
        example("cases/xu2017_truth.toml"),
    );
    let case = example("cases/xu2017_table13.toml");
    let base = ["validate", "--model", &model, "--against", &truth, &case];
    let plain = poinsot(&base);
    assert_eq!(plain.status.code(), Some(0));
    let words = text(&plain.stdout);
    assert!(words.contains("compared, no limit given") && words.contains("joint joint6"));
    assert!(plain.stderr.is_empty());

    let limited = [
        &base[..],
        &["--within-rad", "1e-6", "--json", "--out", &out],
    ]
    .concat();
    let limited = poinsot(&limited);
    assert_eq!(limited.status.code(), Some(1));
    let printed: Value = serde_json::from_slice(&limited.stdout).unwrap();
    let file = std::fs::read_to_string(format!("{out}/validation.json")).unwrap();
    let file: Value = serde_json::from_str(&file).unwrap();
    assert_eq!(printed, file);
    assert_eq!(file["schema"], "poinsot.validation/3");
    assert_eq!(
        (&file["verdict"], &file["kind"]),
        (&"differs".into(), &"model".into())
    );
    assert_eq!(file["limits"]["within_rad"], 1e-6);
    assert_eq!(file["compared"].as_array().unwrap().len(), 8);
    let csv = std::fs::read_to_string(format!("{out}/histories.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 16 * 201);
    assert_eq!(text(&limited.stderr).matches("written: ").count(), 2);

    let generous = [
        &base[..],
        &["--within-rad", "1", "--within-m", "1", "--quiet"],
    ]
    .concat();
    let generous = poinsot(&generous);
    assert_eq!(generous.status.code(), Some(0));
    assert!(generous.stdout.is_empty() && generous.stderr.is_empty());
}

#[test]
fn cli_validate_refuses_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let truth = example("cases/xu2017_truth.toml");
    let case = example("cases/xu2017_table13.toml");
    let missing = poinsot(&[
        "validate",
        "--estimate",
        "nowhere",
        "--against",
        &truth,
        &case,
        "--out",
        &out,
    ]);
    assert_eq!(missing.status.code(), Some(2));
    let words = text(&missing.stderr);
    assert!(words.starts_with("E0701 nowhere: "), "{words}");
    assert_eq!(words.lines().count(), 1);
    assert!(!Path::new(&out).exists() && missing.stdout.is_empty());
    let without = poinsot(&["validate", "--against", &truth]);
    assert_eq!(without.status.code(), Some(2));
    assert!(text(&without.stderr).starts_with("E0001 --model"));
}

#[test]
fn cli_a_driven_case_is_simulated_and_a_singular_one_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let run = poinsot(&[
        "simulate",
        &example("cases/xu2017_table13.toml"),
        "--out",
        &out,
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let csv = std::fs::read_to_string(format!("{out}/telemetry.csv")).unwrap();
    let head = csv.lines().next().unwrap();
    assert!(
        head.contains("joint6_rad") && head.contains("joint6_Nm"),
        "{head}"
    );
    assert_eq!(csv.lines().count(), 202);

    // All mass of the hand in its joint, without inertia: the mass matrix is singular.
    let model = std::fs::read_to_string(example("cases/xu2017_truth.toml")).unwrap();
    let (before, hand) = model.split_once("name = \"B6\"").unwrap();
    let (_, rest) = hand.split_once("[[").unwrap();
    let singular = format!(
        "{before}name = \"B6\"\nmass_kg = 1.0\ncom_m = [0.0, 0.0, 0.0]\ninertia_kg_m2 = {{ xx = 0.0, yy = 0.0, zz = 0.0 }}\n[[{rest}"
    );
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("xu2017_truth.toml"), singular).unwrap();
    std::fs::copy(example("cases/xu2017_table13.toml"), at("case.toml")).unwrap();
    let bad = folder.path().join("bad").display().to_string();
    let case = at("case.toml").display().to_string();
    let refused = poinsot(&["simulate", &case, "--out", &bad]);
    let words = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{words}");
    assert!(
        words.starts_with("E0509 ") && words.contains("joint \"joint6\""),
        "{words}"
    );
    assert!(words.contains("singular mass matrix"), "{words}");
    assert!(!Path::new(&bad).exists());
}

#[test]
fn cli_check_says_what_a_spring_is() {
    let checked = poinsot(&["check", &example("cases/slosh_truth.toml")]);
    assert_eq!(checked.status.code(), Some(0));
    let words = text(&checked.stdout);
    let own = "spring damper (stiffness 1 N m/rad, damping 0.002 N m s/rad, rest 0 rad)";
    assert!(words.contains(own), "{words}");
}
