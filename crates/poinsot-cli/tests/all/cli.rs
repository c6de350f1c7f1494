//! The command line: exit codes, files, streams, messages.

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

fn example(path: &str) -> String {
    shipped().join(path).display().to_string()
}

fn poinsot<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    Command::cargo_bin("poinsot")
        .unwrap()
        .args(arguments)
        .output()
        .unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Arguments of an identification by the linear method.
fn identify(model: &str, telemetry: &str, more: &[&str]) -> Vec<String> {
    let mut list = vec![
        "identify",
        "--model",
        model,
        "--telemetry",
        telemetry,
        "--method",
        "linear",
    ];
    list.extend(more);
    list.into_iter().map(str::to_owned).collect()
}

/// The spinning satellite of the shipped data, simulated: folder, model, telemetry.
struct Satellite {
    folder: tempfile::TempDir,
    model: String,
}

impl Satellite {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().display().to_string();
        let case = example("cases/stsat3_spin.toml");
        let done = poinsot(["simulate", &case, "--out", &out, "--quiet"]);
        assert_eq!(code(&done), 0, "{}", stderr(&done));
        Self {
            folder,
            model: example("stsat3/model.toml"),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn telemetry(&self) -> String {
        self.path("telemetry.csv").display().to_string()
    }

    /// The telemetry with every row changed by a function of its cells by name.
    fn changed(&self, name: &str, change: impl Fn(&mut Vec<String>, &mut Vec<String>)) -> String {
        let text = std::fs::read_to_string(self.telemetry()).unwrap();
        let cells = |row: &str| row.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let header = cells(lines.next().unwrap());
        let mut out = String::new();
        let mut first = true;
        for line in lines {
            let (mut names, mut row) = (header.clone(), cells(line));
            change(&mut names, &mut row);
            if std::mem::take(&mut first) {
                out.push_str(&(names.join(",") + "\n"));
            }
            out.push_str(&(row.join(",") + "\n"));
        }
        let path = self.path(name);
        std::fs::write(&path, out).unwrap();
        path.display().to_string()
    }

    fn refused(&self, telemetry: &str) -> String {
        let out = self.path("refused");
        let place = out.display().to_string();
        let done = poinsot(identify(&self.model, telemetry, &["--out", &place]));
        assert_eq!(code(&done), 2, "{}", stdout(&done));
        assert_eq!(stdout(&done), "");
        assert!(!out.exists(), "a refused question must leave nothing");
        stderr(&done)
    }
}

#[test]
fn cli_exit_0_and_the_file_where_all_is_determined() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/folder");
    let done = poinsot(identify(
        &example("ma2008/model.toml"),
        &example("ma2008/traj1/telemetry.parquet"),
        &["--out", &out.display().to_string()],
    ));
    assert_eq!(code(&done), 0, "{}", stderr(&done));
    assert!(stdout(&done).contains("base"));
    assert!(stderr(&done).contains("estimate.json"));
    // The result and the data of a report; no incomplete file.
    let names: Vec<_> = std::fs::read_dir(&out).unwrap().collect();
    assert_eq!(names.len(), 2);
    let text = std::fs::read_to_string(out.join("estimate.json")).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    check_layout(&file);
    assert_eq!(file["status"], "converged");
    let base = &file["bodies"]["base"];
    assert!((base["mass_kg"]["value"].as_f64().unwrap() - 1000.0).abs() < 1.0e-6);
    assert_eq!(base["mass_kg"]["source"], "data");
    assert_eq!(file["bodies"]["link1"]["mass_kg"]["source"], "known");
}

/// Every key of the result used by scripts (docs/reference/interface.md).
fn check_layout(file: &Value) {
    let keys = |at: &Value, wanted: &[&str]| {
        for key in wanted {
            assert!(at.get(*key).is_some(), "no '{key}' in {at:.0}");
        }
    };
    keys(
        file,
        &[
            "schema",
            "poinsot",
            "method",
            "reference",
            "epoch",
            "model_file",
            "status",
            "inputs",
            "bodies",
            "covariance",
            "system",
            "momentum",
            "nuisance",
            "identifiability",
            "fit",
            "covariance_trustworthy",
            "repairs",
            "warnings",
        ],
    );
    assert_eq!(file["schema"], "poinsot.estimate/3");
    assert!(file.get("variant").is_none_or(|v| !v.is_null()));
    assert_eq!(file["model_file"]["sha256"].as_str().unwrap().len(), 64);
    keys(&file["inputs"][0], &["path", "sha256", "segment", "time_s"]);
    assert_eq!(file["inputs"][0]["sha256"].as_str().unwrap().len(), 64);
    let number = ["value", "sigma", "nominal", "source"];
    for (_, body) in file["bodies"].as_object().unwrap() {
        keys(
            body,
            &[
                "mass_kg",
                "com_m",
                "inertia_kg_m2",
                "principal",
                "barycentric",
                "physically_consistent",
            ],
        );
        keys(&body["mass_kg"], &number);
        for (group, wanted) in [
            ("com_m", &["x", "y", "z"][..]),
            ("inertia_kg_m2", &["xx", "yy", "zz", "xy", "xz", "yz"]),
        ] {
            let parts = body[group].as_object().unwrap();
            assert!(parts.keys().eq(wanted), "{parts:?}");
            parts.values().for_each(|n| keys(n, &number));
        }
        keys(&body["barycentric"], &["m_kg", "mc_kg_m", "I_BBo_kg_m2"]);
    }
    let covariance = &file["covariance"];
    keys(covariance, &["names", "units", "matrix"]);
    let count = covariance["names"].as_array().unwrap().len();
    let rows = covariance["matrix"].as_array().unwrap();
    assert_eq!(rows.len(), count);
    assert!(rows.iter().all(|r| r.as_array().unwrap().len() == count));
    assert_eq!(covariance["units"].as_array().unwrap().len(), count);
    for momentum in file["momentum"].as_array().unwrap() {
        keys(momentum, &["linear_N_s", "angular_N_m_s"]);
        keys(&momentum["linear_N_s"]["x"], &number);
    }
    let found = &file["identifiability"];
    keys(
        found,
        &[
            "parameters",
            "rank",
            "structural_rank",
            "sigmas_natural",
            "identifiable",
            "not_identifiable",
        ],
    );
    for one in found["identifiable"].as_array().unwrap() {
        keys(
            one,
            &["combination", "coefficients", "unit", "value", "sigma"],
        );
    }
    for one in found["not_identifiable"].as_array().unwrap() {
        keys(one, &["combination", "coefficients", "reason", "remedy"]);
    }
    for fit in file["fit"].as_array().unwrap() {
        keys(fit, &["samples", "chi2_per_dof", "channels"]);
        for (_, channel) in fit["channels"].as_object().unwrap() {
            keys(channel, &["rms", "unit"]);
        }
    }
}

#[test]
fn cli_exit_1_where_part_is_open_with_null_and_a_reason() {
    let done = poinsot(identify(
        &example("stsat3/model.toml"),
        &example("stsat3/paper/telemetry.parquet"),
        &["--json"],
    ));
    assert_eq!(code(&done), 1, "{}", stderr(&done));
    let file: Value = serde_json::from_str(&stdout(&done)).unwrap();
    check_layout(&file);
    assert_eq!(file["status"], "partial");
    let inertia = &file["bodies"]["spacecraft"]["inertia_kg_m2"];
    for element in ["xx", "yy", "zz", "xy", "xz", "yz"] {
        for part in ["value", "sigma", "source"] {
            assert!(inertia[element][part].is_null(), "{part} {element}");
        }
        assert!(inertia[element]["nominal"].is_number());
    }
    let open = file["identifiability"]["not_identifiable"]
        .as_array()
        .unwrap();
    assert_eq!(open.len(), 3);
    assert!(
        open.iter()
            .all(|o| !o["remedy"].as_str().unwrap().is_empty())
    );
}

#[test]
fn cli_exit_2_names_the_word_that_is_wrong() {
    let model = example("stsat3/model.toml");
    let telemetry = example("stsat3/paper/telemetry.parquet");
    let ask = |method: &str, more: &[&str]| {
        let mut list = identify(&model, &telemetry, more);
        if let Some(word) = list.iter_mut().find(|w| *w == "linear") {
            *word = method.to_owned();
        }
        let done = poinsot(list);
        assert_eq!(code(&done), 2);
        assert_eq!(stdout(&done), "");
        stderr(&done)
    };
    let unknown = ask("kalman", &[]);
    assert!(
        unknown.contains("--method") && unknown.contains("'kalman'"),
        "{unknown}"
    );
    assert!(unknown.contains("linear") && unknown.contains("maximum_likelihood"));
    let variant = ask("linear", &["--variant", "swarm"]);
    assert!(
        variant.contains("--variant") && variant.contains("'swarm'"),
        "{variant}"
    );
    let accuracy = ask("linear", &["--relative-accuracy", "0"]);
    assert!(accuracy.contains("--relative-accuracy"), "{accuracy}");
    let flag = ask("linear", &["--no-such-flag"]);
    assert!(flag.contains("--no-such-flag"), "{flag}");
    assert_eq!(code(&poinsot(["identify", "--model", &model])), 2);
    assert_eq!(code(&poinsot(["conjure"])), 2);
}

#[test]
fn cli_exit_2_for_files_that_are_not_there() {
    let model = example("stsat3/model.toml");
    let telemetry = example("stsat3/paper/telemetry.parquet");
    for (model, telemetry, missing) in [
        (
            "no_such_model.toml",
            telemetry.as_str(),
            "no_such_model.toml",
        ),
        (model.as_str(), "no_such_file.csv", "no_such_file.csv"),
    ] {
        let done = poinsot(identify(model, telemetry, &[]));
        assert_eq!(code(&done), 2, "{}", stderr(&done));
        assert!(stderr(&done).contains(missing));
        assert_eq!(stderr(&done).lines().count(), 1, "{}", stderr(&done));
    }
}

#[test]
fn cli_exit_3_where_nothing_can_be_written_and_nothing_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a_file");
    std::fs::write(&file, "in the way").unwrap();
    let below = file.join("out").display().to_string();
    let model = example("ma2008/model.toml");
    let telemetry = example("ma2008/traj2/telemetry.parquet");
    let done = poinsot(identify(&model, &telemetry, &["--out", &below]));
    assert_eq!(code(&done), 3, "{}", stderr(&done));
    assert!(stderr(&done).contains("a_file"));
    // A folder in place of the result: no draft may remain.
    let taken = folder.path().join("taken");
    std::fs::create_dir_all(taken.join("estimate.json")).unwrap();
    let place = taken.display().to_string();
    let done = poinsot(identify(&model, &telemetry, &["--out", &place]));
    assert_eq!(code(&done), 3, "{}", stderr(&done));
    assert_eq!(std::fs::read_dir(&taken).unwrap().count(), 1);
    let case = example("cases/stsat3_spin.toml");
    let done = poinsot(["simulate", &case, "--out", &below]);
    assert_eq!(code(&done), 3, "{}", stderr(&done));
}

#[test]
fn cli_json_goes_to_stdout_alone_and_equals_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let model = example("ma2008/model.toml");
    let telemetry = example("ma2008/traj2/telemetry.parquet");
    let done = poinsot(identify(&model, &telemetry, &["--json", "--out", &out]));
    assert_eq!(code(&done), 0);
    let printed: Value = serde_json::from_str(&stdout(&done)).unwrap();
    let text = std::fs::read_to_string(folder.path().join("estimate.json")).unwrap();
    let written: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(printed, written);
}

#[test]
fn cli_quiet_prints_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let model = example("ma2008/model.toml");
    let telemetry = example("ma2008/traj2/telemetry.parquet");
    let done = poinsot(identify(&model, &telemetry, &["--quiet", "--out", &out]));
    assert_eq!(
        (code(&done), stdout(&done), stderr(&done)),
        (0, String::new(), String::new())
    );
    assert!(folder.path().join("estimate.json").exists());
}

#[test]
fn cli_any_number_of_threads_prints_the_same_bytes() {
    let list = identify(
        &example("ma2008/model_noisy.toml"),
        &example("ma2008/traj1/telemetry_noisy.csv"),
        &["--json"],
    );
    let printed = ["1", "3"].map(|threads| {
        let mut command = Command::cargo_bin("poinsot").unwrap();
        let done = command
            .args(&list)
            .env("RAYON_NUM_THREADS", threads)
            .output();
        done.unwrap().stdout
    });
    assert!(printed[0].len() > 1000);
    assert!(printed[0] == printed[1]);
}

#[test]
fn cli_a_missing_column_is_named_in_one_whole_line() {
    let satellite = Satellite::new();
    let file = satellite.changed("no_wheel.csv", |names, row| {
        let at = names.iter().position(|n| n == "wheel3_rad_s").unwrap();
        names.remove(at);
        row.remove(at);
    });
    let message = satellite.refused(&file);
    let expected = format!(
        "E0301 {file}: no channel 'wheel3_rad_s', and the model does not say what wheel3 does; "
    );
    assert!(message.starts_with(&expected), "{message}");
    assert!(message.contains("at_rest = true"), "{message}");
    assert_eq!(message.lines().count(), 1);
}

#[test]
fn cli_scalar_first_quaternions_are_refused_by_name() {
    let satellite = Satellite::new();
    let file = satellite.changed("wxyz.csv", |names, row| {
        let at = names.iter().position(|n| n == "q_x").unwrap();
        assert_eq!(names[at + 3], "q_w");
        row[at..at + 4].rotate_right(1);
    });
    let message = satellite.refused(&file);
    assert!(message.starts_with("E0215"), "{message}");
    assert!(
        message.contains("quaternion scalar first (wxyz)"),
        "{message}"
    );
    assert_eq!(message.lines().count(), 1);
}

#[test]
fn cli_degrees_are_refused_by_name() {
    let satellite = Satellite::new();
    let file = satellite.changed("degrees.csv", |names, row| {
        for (name, cell) in names.iter().zip(row) {
            if name.starts_with("omega_") && !cell.is_empty() {
                *cell = cell.parse::<f64>().unwrap().to_degrees().to_string();
            }
        }
    });
    let message = satellite.refused(&file);
    assert!(
        message.starts_with("E0215") && message.contains("gyro in deg/s"),
        "{message}"
    );
}

#[test]
fn cli_a_number_that_is_none_names_row_and_column() {
    let satellite = Satellite::new();
    let file = satellite.changed("word.csv", |names, row| {
        if row[0] == "1.5" {
            let at = names.iter().position(|n| n == "omega_y").unwrap();
            row[at] = "fast".to_owned();
        }
    });
    let message = satellite.refused(&file);
    assert!(
        message.starts_with("E0203") && message.contains("'fast'"),
        "{message}"
    );
    assert!(
        message.contains("omega_y") && message.contains("word.csv"),
        "{message}"
    );
}

#[test]
fn cli_a_massless_unknown_that_moves_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    std::fs::write(
        &model,
        r#"schema = "poinsot.model/1"
exact = true
[[body]]
name = "bus"
mass_kg = 10.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.0, zz = 1.0 }
[[body]]
name = "boom"
mass_kg = 0.0
estimate = true
[[joint]]
name = "hinge"
type = "revolute"
parent = "bus"
child = "boom"
origin_m = [1.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
"#,
    )
    .unwrap();
    let done = poinsot(["check", &model.display().to_string()]);
    assert_eq!(code(&done), 2, "{}", stdout(&done));
    let message = stderr(&done);
    assert!(
        message.starts_with("E0117") && message.contains("boom"),
        "{message}"
    );
}

fn files_below(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, ending, found);
        } else if path.display().to_string().ends_with(ending) {
            found.push(path);
        }
    }
}

#[test]
fn cli_check_schema_and_inspect_read_all_examples() {
    let mut models = Vec::new();
    files_below(&shipped(), ".toml", &mut models);
    models.retain(|p| {
        let text = std::fs::read_to_string(p).unwrap();
        text.contains("poinsot.model/1")
    });
    assert!(models.len() > 5);
    for model in models {
        let path = model.display().to_string();
        let done = poinsot(["check", &path]);
        assert_eq!(code(&done), 0, "{path}: {}", stderr(&done));
        assert!(!stdout(&done).is_empty());
        let done = poinsot(["check", &path, "--json"]);
        serde_json::from_str::<Value>(&stdout(&done)).unwrap();
    }
    let done = poinsot(["schema"]);
    assert_eq!(code(&done), 0);
    let schema: Value = serde_json::from_str(&stdout(&done)).unwrap();
    assert_eq!(schema["title"], "poinsot.model/1");
    for file in [
        "stsat3/paper/telemetry_noisy.csv",
        "ma2008/traj1/telemetry.parquet",
        "xu2017/C1/telemetry.parquet",
    ] {
        let done = poinsot(["inspect", &example(file)]);
        assert_eq!(code(&done), 0, "{file}: {}", stderr(&done));
        assert!(stdout(&done).contains("omega_x"), "{}", stdout(&done));
        let done = poinsot(["inspect", &example(file), "--json"]);
        serde_json::from_str::<Value>(&stdout(&done)).unwrap();
    }
}

/// Identifies the simulation of a shipped case with the given model, and compares with `truth.json`.
fn round_trip(case: &str, model: &str, body: &str) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let done = poinsot(["simulate", &example(case), "--out", &out, "--quiet"]);
    assert_eq!(code(&done), 0, "{case}: {}", stderr(&done));
    let telemetry = folder.path().join("telemetry.csv").display().to_string();
    let mut list = identify(&example(model), &telemetry, &["--out", &out]);
    list.retain(|w| w != "--method" && w != "linear");
    let done = poinsot(list);
    assert_eq!(code(&done), 0, "{case}: {}{}", stdout(&done), stderr(&done));
    let read = |name: &str| -> Value {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let (answer, truth) = (read("estimate.json"), read("truth.json"));
    assert_eq!(answer["method"], "maximum_likelihood");
    let found = &answer["bodies"][body]["inertia_kg_m2"];
    let expected = &truth["bodies"][body]["inertia_kg_m2"];
    for element in ["xx", "yy", "zz", "xy", "xz", "yz"] {
        let number = |at: &Value, part: &str| at[element][part].as_f64().unwrap();
        let error = number(found, "value") - number(expected, "value");
        let sigmas = error / number(found, "sigma");
        println!("{case} {element}: {sigmas:.2} sigma");
        assert!(sigmas.abs() < 4.5, "{case} {element}: {sigmas}");
    }
}

#[test]
fn cli_simulated_arm_is_identified() {
    round_trip("cases/ma2008_traj1.toml", "ma2008/model_noisy.toml", "base");
}

#[test]
fn cli_simulated_satellite_is_identified() {
    round_trip("cases/stsat3_spin.toml", "stsat3/model.toml", "spacecraft");
}

#[test]
fn cli_simulated_tug_is_identified() {
    round_trip("cases/tug_thrusters.toml", "cases/tug_truth.toml", "bus");
}

#[test]
fn cli_methods_lists_what_identify_takes() {
    let all = poinsot(["methods", "--json"]);
    let all: Value = serde_json::from_str(&stdout(&all)).unwrap();
    assert_eq!(all["schema"], "poinsot.methods/1");
    let names: Vec<&str> = all["methods"]
        .as_array()
        .unwrap()
        .iter()
        .map(|m| m["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "auto",
            "linear",
            "maximum_likelihood",
            "kim2010",
            "ma2008",
            "xu2017"
        ]
    );
    let one = stdout(&poinsot(["methods", "ma2008"]));
    assert!(
        one.starts_with("ma2008: ") && one.contains("doi 10.2514/1.35188"),
        "{one}"
    );
    assert!(
        one.contains("--variant unknown-momentum  ") && one.contains("(default)"),
        "{one}"
    );
    let none = poinsot(["methods", "best"]);
    assert_eq!(code(&none), 2);
    assert!(stderr(&none).starts_with("E0001 methods 'best': there is no such method"));
    let help = stdout(&poinsot(["identify", "--help"]));
    for name in names {
        assert!(help.contains(name), "{help}");
    }
}

#[test]
fn cli_unused_columns_are_printed() {
    let satellite = Satellite::new();
    let file = satellite.changed("spare.csv", |names, row| {
        names.push("spare_temperature".to_owned());
        row.push("20".to_owned());
    });
    let printed = stdout(&poinsot(identify(&satellite.model, &file, &[])));
    let unused = printed.split("unused columns\n").nth(1);
    let unused = unused.and_then(|text| text.split("\n\n").next());
    let is_there = unused.is_some_and(|list| list.contains("spare_temperature"));
    assert!(is_there, "{printed}");
}
