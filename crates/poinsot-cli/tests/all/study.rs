//! The command `study`.

use assert_cmd::Command;
use std::path::Path;

/// Exit code, standard output, standard error of a run in the project's folder.
fn study(arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("poinsot").unwrap();
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    command.current_dir(project).arg("study").args(arguments);
    let out = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        out.status.code().unwrap(),
        text(&out.stdout),
        text(&out.stderr),
    )
}

#[test]
fn cli_study_lists_every_study_of_every_paper() {
    let (code, out, _) = study(&[]);
    assert_eq!(code, 0);
    for (paper, study) in poinsot::study::studies() {
        assert!(out.contains(&format!("poinsot study {paper} {}", study.name)));
        assert!(out.contains(study.summary));
    }
    let (_, one, _) = study(&["kim2010"]);
    assert!(one.contains("kim2010 table2") && !one.contains("ma2008"));
    let (_, json, _) = study(&["--json"]);
    let list: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        list["papers"].as_array().unwrap().len(),
        poinsot::study::studies_file(None).papers.len()
    );
}

#[test]
fn cli_study_warns_of_the_old_name_of_its_data() {
    let (code, out, said) = study(&["kim2010", "table2", "--examples", "data"]);
    let (_, now, quiet) = study(&["kim2010", "table2", "--data", "data"]);
    assert_eq!((code, &out), (0, &now));
    assert!(said.contains("Use --data"), "{said}");
    assert!(!quiet.contains("--examples"), "{quiet}");
}

#[test]
fn cli_study_prints_writes_and_gives_all_digits() {
    let (code, out, _) = study(&["kim2010", "table2"]);
    assert_eq!(code, 0);
    assert!(
        out.contains("14.150") && out.contains("1.7, 3.3, 4.2 %"),
        "{out}"
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    let (code, out, _) = study(&["ma2008", "histories", "--json", "--out", path]);
    assert_eq!(code, 0);
    let found: serde_json::Value = serde_json::from_str(&out).unwrap();
    let found = &found["findings"][0];
    assert_eq!(found["study"], "histories");
    assert_eq!(found["tables"][0]["rows"][0][1], 135.0);
    let csv = std::fs::read_to_string(folder.path().join("histories_histories.csv")).unwrap();
    assert!(csv.starts_with("figure,\"duration, s\""), "{csv}");
    let svg = std::fs::read_to_string(folder.path().join("fig10_v.svg")).unwrap();
    assert!(svg.starts_with("<svg"));
}

#[test]
fn cli_study_says_what_there_is_instead() {
    let (code, _, error) = study(&["kim2011"]);
    assert_eq!(code, 2);
    assert!(
        error.starts_with("E0001 study 'kim2011': there is no such paper; use one of kim2010"),
        "{error}"
    );
    let (code, _, error) = study(&["kim2010", "table9"]);
    assert_eq!(code, 2);
    assert!(
        error.contains("'table9'") && error.contains("axis, table2"),
        "{error}"
    );
    let (code, _, error) = study(&["kim2010", "axis", "--data", "docs"]);
    assert_eq!(code, 2);
    assert!(error.starts_with("E0001 --data 'docs'"), "{error}");
}
