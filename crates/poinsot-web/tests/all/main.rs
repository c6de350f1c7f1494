//! Inputs in memory against the same files by the function of the command.
#![allow(clippy::unwrap_used)]

use poinsot::{IdentifyRequest, identify as identify_files, write_result};
use poinsot_web::{Named, check, identify};
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(name)
}

fn text(path: &Path) -> Named<String> {
    Named {
        name: path.display().to_string(),
        content: std::fs::read_to_string(path).unwrap(),
    }
}

fn bytes(path: &Path) -> Named<Vec<u8>> {
    Named {
        name: path.display().to_string(),
        content: std::fs::read(path).unwrap(),
    }
}

/// A text, and a Parquet file, whose footer is read first.
#[test]
fn exact_memory_gives_the_files_of_the_command() {
    for (model, telemetry) in [
        ("stsat3/model.toml", "stsat3/paper/telemetry_noisy.csv"),
        (
            "xu2017/model_noisy.toml",
            "xu2017/C1/telemetry_noisy.parquet",
        ),
    ] {
        let (model, telemetry) = (data(model), data(telemetry));
        let answer = identify(&text(&model), vec![bytes(&telemetry)], false).unwrap();
        let by_files = identify_files(&IdentifyRequest::new(&model, [&telemetry])).unwrap();
        assert_eq!(answer.exit_code == 0, by_files.passes());
        let folder = tempfile::tempdir().unwrap();
        let path = |p: &Path| p.display().to_string();
        let command = [
            "poinsot",
            "identify",
            "--model",
            &path(&model),
            "--telemetry",
            &path(&telemetry),
        ];
        write_result(
            folder.path(),
            &by_files,
            &command.map(str::to_owned),
            true,
            &[],
        )
        .unwrap();
        assert_eq!(answer.files.len(), 3);
        for file in &answer.files {
            let written = std::fs::read_to_string(folder.path().join(&file.name)).unwrap();
            assert!(file.text == written, "{} differs", file.name);
        }
    }
}

#[test]
fn unit_errors_have_code_and_line() {
    let mut model = text(&data("stsat3/model.toml"));
    assert!(check(&model).errors.is_empty() && check(&model).vehicle.contains("spacecraft"));
    let line = model
        .content
        .lines()
        .position(|l| l.starts_with("mass_kg"))
        .unwrap() as u64
        + 1;
    model.content = model.content.replace("mass_kg", "mass_lb");
    let errors = check(&model).errors;
    assert!(
        errors
            .iter()
            .any(|e| e.line == line && e.text.starts_with(e.code)),
        "{errors:?}"
    );

    let whole = text(&data("stsat3/model.toml"));
    let broken = Named {
        name: "broken.csv".to_owned(),
        content: b"time_s,omega_x\n0,zero\n".to_vec(),
    };
    let error = identify(&whole, vec![broken], false)
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("E02") && error.contains("broken.csv:2"),
        "{error}"
    );
    // Without telemetry there is nothing to identify, and no panic.
    assert!(identify(&whole, Vec::new(), true).is_err());
    assert!(identify(&whole, Vec::new(), false).is_err());
}

/// Two files of one record, each with some of the channels.
#[test]
fn unit_files_of_one_record_are_joined() {
    let whole = std::fs::read_to_string(data("stsat3/paper/telemetry_noisy.csv")).unwrap();
    let half = |name: &str, keep: &dyn Fn(usize) -> bool| {
        let line = |line: &str| {
            let cells = line
                .split(',')
                .enumerate()
                .filter(|(k, _)| *k == 0 || keep(*k));
            cells.map(|c| c.1).collect::<Vec<_>>().join(",")
        };
        Named {
            name: name.to_owned(),
            content: whole
                .lines()
                .map(line)
                .collect::<Vec<_>>()
                .join("\n")
                .into_bytes(),
        }
    };
    let model = text(&data("stsat3/model.toml"));
    let files = || vec![half("a.csv", &|k| k < 5), half("b.csv", &|k| k >= 5)];
    let joined = identify(&model, files(), true).unwrap();
    let one = identify(&model, vec![half("one.csv", &|_| true)], false).unwrap();
    assert_eq!(joined.verdict, one.verdict);
    assert!(identify(&model, files(), false).is_err());
}
