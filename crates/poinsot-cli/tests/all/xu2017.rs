//! Xu, Hu, Zhang and Liang 2017 as a user calls it.

use assert_cmd::Command;
use std::path::{Path, PathBuf};

fn example(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples")
        .join(path)
}

/// Exit code, standard output, standard error.
fn identify(variant: &str, runs: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("poinsot").unwrap();
    command.args(["identify", "--method", "xu2017", "--variant", variant]);
    command.arg("--model").arg(example("xu2017/model.toml"));
    for run in runs {
        let file = example(&format!("xu2017/{run}/telemetry.parquet"));
        command.arg("--telemetry").arg(file);
    }
    let out = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        out.status.code().unwrap(),
        text(&out.stdout),
        text(&out.stderr),
    )
}

#[test]
fn cli_xu2017_says_what_is_seen_and_what_is_open() {
    let (code, out, _) = identify("linear", &["C1", "C2"]);
    assert_eq!(code, 1);
    assert!(
        out.starts_with(
            "xu2017: Partly determined. 17 of 70 independent combinations are determined; "
        ),
        "{out}"
    );
    assert!(out.contains("The method claims every number of every body; the data determine 17 of 70 combinations, and only those are given."));
}

#[test]
fn cli_xu2017_refuses_an_unknown_variant_and_a_missing_scale() {
    let (code, _, error) = identify("genetic", &["C1"]);
    assert_eq!(code, 2);
    assert!(error.contains("E0001 --variant 'genetic': xu2017 has no such variant; use one of swarm, linear, swarm-inward, linear-inward"), "{error}");
    let (code, _, error) = identify("linear", &["C2"]);
    assert_eq!(code, 2);
    assert!(error.contains("E0533 no thruster fires"), "{error}");
}
