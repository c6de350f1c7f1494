//! Exports of an answer: output, refusals, and reading by other programs.
//!
//! MuJoCo, Drake and Basilisk read their files in `python/tests/test_export.py`.

use ccsds_ndm::messages::{acm::Acm, apm::Apm};
use ccsds_ndm::traits::Ndm;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn shipped() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

fn poinsot(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_poinsot"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Simulated telemetry and its answer in `out`; with a date if `epoch` gives one.
fn answer(folder: &Path, epoch: &str) -> Value {
    let case = shipped().join("cases/stsat3_spin.toml");
    let model = std::fs::read_to_string(shipped().join("stsat3/model.toml")).unwrap();
    assert!(!model.contains("[telemetry]"));
    std::fs::write(folder.join("m.toml"), model + epoch).unwrap();
    for arguments in [
        vec!["simulate", case.to_str().unwrap(), "--out", "sim"],
        vec![
            "identify",
            "--model",
            "m.toml",
            "--telemetry",
            "sim/telemetry.csv",
            "--out",
            "out",
        ],
    ] {
        let done = poinsot(folder, &arguments);
        assert_eq!(done.status.code(), Some(0), "{}", error(&done));
    }
    let text = std::fs::read_to_string(folder.join("out/estimate.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

const DATE: &str =
    "\n[telemetry]\ntime = { column = \"time_s\", epoch = \"2026-03-14T18:19:00Z\" }\n";

fn exported(folder: &Path, to: &str) -> String {
    let done = poinsot(folder, &["export", "out", "--to", to]);
    assert_eq!(done.status.code(), Some(0), "{}", error(&done));
    // Numbers without a field in the format are listed; the file is complete without them.
    let no_field = error(&done).contains("mass centre: an A");
    assert_eq!(no_field, ["apm", "acm"].contains(&to), "{}", error(&done));
    String::from_utf8(done.stdout).unwrap()
}

/// Another library reads inertia, mass and date from the messages.
#[test]
fn xval_ccsds_ndm_reads_both_messages() {
    let folder = tempfile::tempdir().unwrap();
    let estimate = answer(folder.path(), DATE);
    let tensor = &estimate["bodies"]["spacecraft"]["inertia_kg_m2"];
    let expected =
        ["xx", "yy", "zz", "xy", "xz", "yz"].map(|e| tensor[e]["value"].as_f64().unwrap());

    let apm = Apm::from_kvn(&exported(folder.path(), "apm")).unwrap();
    let data = &apm.body.segment.data;
    assert!(data.epoch.to_string().starts_with("2026-03-14T18:19:00"));
    let i = &data.inertia[0];
    let found = [&i.ixx, &i.iyy, &i.izz, &i.ixy, &i.ixz, &i.iyz].map(|m| m.value);
    assert_eq!(found, expected);

    let acm = Acm::from_kvn(&exported(folder.path(), "acm")).unwrap();
    assert_eq!(acm.body.segment.metadata.object_name, "stsat3");
    let body = acm.body.segment.data.phys.unwrap();
    assert_eq!(body.wet_mass.unwrap().value, 150.0);
    let found = [body.ixx, body.iyy, body.izz, body.ixy, body.ixz, body.iyz];
    assert_eq!(found.map(|m| m.unwrap().value), expected);
}

/// Only numbers change in a model file, comments remain, and the file has the answer.
#[test]
fn cli_model_changes_its_numbers_and_no_other_byte() {
    let folder = tempfile::tempdir().unwrap();
    let estimate = answer(folder.path(), "");
    let old = std::fs::read_to_string(folder.path().join("m.toml")).unwrap();
    let old = old.replacen("mass_kg = 150.0", "mass_kg   =  150.0  # weighed", 1);
    std::fs::write(folder.path().join("m.toml"), &old).unwrap();
    let done = poinsot(
        folder.path(),
        &[
            "export", "out", "--to", "model", "--onto", "m.toml", "-o", "new.toml",
        ],
    );
    assert_eq!(done.status.code(), Some(0), "{}", error(&done));
    let new = std::fs::read_to_string(folder.path().join("new.toml")).unwrap();
    assert_eq!(new.lines().count(), old.lines().count());
    let changed = old.lines().zip(new.lines()).filter(|(a, b)| a != b);
    let changed: Vec<&str> = changed.map(|(_, b)| b).collect();
    assert_eq!(changed.len(), 1, "{changed:?}");
    let xx = &estimate["bodies"]["spacecraft"]["inertia_kg_m2"]["xx"]["value"];
    assert!(
        changed[0].starts_with(&format!("inertia_kg_m2 = {{ xx = {xx}")),
        "{changed:?}"
    );
    let done = poinsot(folder.path(), &["check", "new.toml"]);
    assert_eq!(done.status.code(), Some(0), "{}", error(&done));
}

/// Formats that patch a file need it, others reject it, and a CCSDS message needs a date.
#[test]
fn cli_what_is_missing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), "");
    for (arguments, told) in [
        (
            vec!["--to", "sdf"],
            "E0001 --to 'sdf': this format changes a file; name it by --onto",
        ),
        (
            vec!["--to", "csv", "--onto", "m.toml"],
            "E0001 --onto 'm.toml': csv is written as a new file; leave --onto out",
        ),
        (vec!["--to", "apm"], "a CCSDS message needs a date"),
        (vec!["--to", "mjcf", "--onto", "m.toml"], "this is not XML"),
        (
            vec!["--to", "model", "--onto", "sim/truth.json"],
            "this is not TOML",
        ),
    ] {
        let all = [vec!["export", "out"], arguments].concat();
        let done = poinsot(folder.path(), &all);
        assert_eq!(done.status.code(), Some(2), "{all:?}: {}", error(&done));
        assert!(error(&done).contains(told), "{all:?}: {}", error(&done));
    }
}

/// An undetermined number is never written: the file's numbers remain, or the export is refused.
#[test]
fn cli_what_is_not_determined_is_not_exported() {
    let folder = tempfile::tempdir().unwrap();
    let telemetry = shipped().join("stsat3/paper/telemetry_noisy.csv");
    let model = shipped().join("stsat3/model.toml");
    let done = poinsot(
        folder.path(),
        &[
            "identify",
            "--model",
            model.to_str().unwrap(),
            "--telemetry",
            telemetry.to_str().unwrap(),
            "--out",
            "out",
        ],
    );
    assert_eq!(done.status.code(), Some(1), "{}", error(&done));
    for to in ["basilisk", "onboard"] {
        let done = poinsot(folder.path(), &["export", "out", "--to", to]);
        assert_eq!(done.status.code(), Some(2));
        assert!(done.stdout.is_empty());
        assert!(
            error(&done).contains("not exported: spacecraft"),
            "{}",
            error(&done)
        );
    }
    let table = exported(folder.path(), "csv");
    let row = table
        .lines()
        .find(|l| l.contains("inertia_kg_m2.xy"))
        .unwrap();
    assert_eq!(
        row,
        "spacecraft,inertia_kg_m2.xy,kg m2,,,0.0,not determined"
    );
}

#[test]
fn cli_export_names_the_formats_of_ccsds() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["ccsds", "CCSDS"] {
        let said = error(&poinsot(folder.path(), &["export", "out", "--to", name]));
        assert!(said.contains("use apm or acm"), "{said}");
    }
}
