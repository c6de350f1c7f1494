//! The on-board filter from the command line: on a stream, and as a table.

use poinsot_onboard::{Configuration, TABLE};
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases")
}

fn model() -> PathBuf {
    shipped().join("pyramid_truth.toml")
}

fn poinsot(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poinsot"));
    command.current_dir(folder);
    command
}

fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{error}");
    output
}

/// A satellite turned by four wheels for 120 s, and its answer in `answer` by way of `follow`.
fn followed(folder: &Path) -> Vec<Value> {
    let case = shipped().join("pyramid.toml");
    done(
        poinsot(folder)
            .arg("simulate")
            .arg(&case)
            .args(["--out", "sim"]),
    );
    let arguments = ["sim/telemetry.csv", "--out", "answer"];
    let output = done(poinsot(folder).arg("follow").arg(model()).args(arguments));
    lines(&output)
}

fn lines(output: &Output) -> Vec<Value> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn of_body(estimate: &Value, element: &str) -> (f64, f64) {
    let body = estimate["bodies"]
        .as_object()
        .unwrap()
        .values()
        .next()
        .unwrap();
    let number = &body["inertia_kg_m2"][element];
    (
        number["value"].as_f64().unwrap(),
        number["sigma"].as_f64().unwrap(),
    )
}

#[test]
fn xval_follow_ends_where_identify_does() {
    let folder = tempfile::tempdir().unwrap();
    let lines = followed(folder.path());
    assert_eq!(lines[0]["health"], "converging");
    let undetermined = lines[0]["numbers"]
        .as_object()
        .unwrap()
        .values()
        .next()
        .unwrap();
    assert!(undetermined["value"].is_null());
    let last = &lines[lines.len() - 1];
    assert_eq!(
        (&last["health"], &last["gyro"]["gated"]),
        (&"determined".into(), &0.into())
    );
    let estimate = read(&folder.path().join("answer/estimate.json"));
    agree(last, &estimate);
}

/// The last line of the filter and the answer of a fit, which smooths the speeds of wheels by samples that come later.
fn agree(last: &Value, estimate: &Value) {
    for element in ["xx", "yy", "zz", "xy", "xz", "yz"] {
        let (value, sigma) = of_body(estimate, element);
        let mut numbers = last["numbers"].as_object().unwrap().iter();
        let (_, own) = numbers.find(|(name, _)| name.ends_with(element)).unwrap();
        let ratio = own["sigma"].as_f64().unwrap() / sigma;
        let off = (own["value"].as_f64().unwrap() - value) / sigma;
        println!("{element}: {off:.2} sigma from identify, sigma {ratio:.3} of its sigma");
        assert!(off.abs() < 1.0 && (0.8..1.3).contains(&ratio));
    }
}

/// The satellite with a panel on a bracket that is turned against it.
fn with_panel() -> String {
    let panel = r#"
[[body]]
name = "panel"
mass_kg = 6.0
com_m = [0.8, 0.0, 0.0]
inertia_kg_m2 = { xx = 0.1, yy = 1.1, zz = 1.2 }

[[joint]]
name = "bracket"
type = "fixed"
parent = "bus"
child = "panel"
origin_m = [0.5, 0.1, -0.3]
rotation_xyzw = [0.2, -0.4, 0.4, 0.8]

[[mode]]
name = "bending"
body = "panel"
frequency_Hz = 0.06
damping_ratio = 0.01
translation_kg05 = [0.0, 0.2, 1.5]
rotation_kg05_m = [0.1, -1.4, 0.2]
"#;
    std::fs::read_to_string(model()).unwrap() + panel
}

/// A mode of a body that is fixed to the base, turned and away from it.
#[test]
fn xval_follow_takes_a_mode_as_identify_does() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("model.toml"), with_panel()).unwrap();
    let case = std::fs::read_to_string(shipped().join("pyramid.toml")).unwrap();
    let case = case.replace("pyramid_truth.toml", "model.toml");
    std::fs::write(at("case.toml"), case).unwrap();
    done(poinsot(folder.path()).args(["simulate", "case.toml", "--out", "sim"]));
    let files = ["follow", "model.toml", "sim/telemetry.csv"];
    let found = lines(&done(poinsot(folder.path()).args(files)));
    let answer = ["--telemetry", "sim/telemetry.csv", "--out", "answer"];
    done(
        poinsot(folder.path())
            .args(["identify", "--model", "model.toml"])
            .args(answer),
    );
    agree(found.last().unwrap(), &read(&at("answer/estimate.json")));
    // Without the mode the stream is that of another vehicle.
    let text = with_panel();
    std::fs::write(at("model.toml"), text.split_once("[[mode]]").unwrap().0).unwrap();
    let rigid = poinsot(folder.path()).args(files).output().unwrap();
    assert_eq!(rigid.status.code(), Some(1));
    assert_ne!(lines(&rigid).last().unwrap()["health"], "determined");
}

/// A bus that its wheels turn from rest: what the whole model says, these moments of inertia, and axis and spin inertia of each wheel.
fn turned_from_rest(whole: &str, inertia: &str, wheels: [([f64; 3], f64); 3]) -> String {
    let mut text = format!(
        r#"schema = "poinsot.model/1"
name = "scout"
{whole}
[[body]]
name = "bus"
mass_kg = 61.0
com_m = [0.02, -0.01, 0.04]
inertia_kg_m2 = {{ {inertia} }}
estimate = ["inertia"]
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 3e-4
bias = "estimate"
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 8e-5
[[sensor]]
name = "tach"
type = "wheel_speed"
noise_rad_s = 0.05
"#
    );
    for (k, (axis, spin)) in wheels.iter().enumerate() {
        let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axis = axis.map(|x| x / norm);
        text += &format!(
            "[[wheel]]\nname = \"w{}\"\nbody = \"bus\"\naxis = {axis:?}\nspin_inertia_kg_m2 = {spin:?}\n",
            k + 1
        );
    }
    text
}

/// Inertia of the bus, and its wheels as a model has them.
const TRUE_INERTIA: [(&str, f64); 6] = [
    ("xx", 4.1),
    ("yy", 5.3),
    ("zz", 3.2),
    ("xy", 0.21),
    ("xz", -0.13),
    ("yz", 0.08),
];
const WHEELS: [([f64; 3], f64); 3] = [
    ([1.0, 0.0, 0.0], 0.0021),
    ([0.0, 1.0, 0.0], 0.0021),
    ([0.0, 0.0, 1.0], 0.0021),
];

/// Simulates `truth.toml` with so many of its wheels running, and follows with `model.toml`: exit code and last line.
fn run(folder: &Path, wheels: usize, (rate_hz, seed): (u32, u32)) -> (Option<i32>, Value) {
    let motions = [
        r#"{ wheel = "w1", time_s = [0, 30, 70, 100, 140], speed_rad_s = [0, 220, -90, 130, 0] }"#,
        r#"{ wheel = "w2", time_s = [0, 40, 80, 140], speed_rad_s = [0, -180, 140, 10] }"#,
        r#"{ wheel = "w3", time_s = [0, 50, 90, 140], speed_rad_s = [0, 160, -120, 30] }"#,
    ];
    let motions = motions
        .iter()
        .enumerate()
        .map(|(k, motion)| match k < wheels {
            true => motion.replace(" }", ", interpolation = \"cubic_clamped\" },\n"),
            false => format!(
                "{{ wheel = \"w{}\", time_s = [0.0], speed_rad_s = [0.0] }},\n",
                k + 1
            ),
        });
    let case = format!(
        "schema = \"poinsot.case/1\"\nmodel = \"truth.toml\"\nduration_s = 140.0\ninitial.momentum_zero = true\n\
         wheel_motion = [\n{}]\noutput = {{ rate_hz = {rate_hz}, seed = {seed} }}\n",
        motions.collect::<String>()
    );
    std::fs::write(folder.join("case.toml"), case).unwrap();
    done(poinsot(folder).args(["simulate", "case.toml", "--out", "sim"]));
    let files = ["follow", "model.toml", "sim/telemetry.csv"];
    let found = poinsot(folder).args(files).output().unwrap();
    let last = lines(&found).last().unwrap().clone();
    (found.status.code(), last)
}

/// Simulates `truth.toml`, follows and identifies with `model.toml`: the last line, and the answer.
fn turned(folder: &Path, truth: &str, model: &str, at: (u32, u32)) -> (Value, Value) {
    std::fs::write(folder.join("truth.toml"), truth).unwrap();
    std::fs::write(folder.join("model.toml"), model).unwrap();
    let (code, last) = run(folder, WHEELS.len(), at);
    assert_eq!(code, Some(0));
    let answer = ["identify", "--model", "model.toml", "--out", "answer"];
    let records = ["--telemetry", "sim/telemetry.csv"];
    done(poinsot(folder).args(answer).args(records));
    let estimate = read(&folder.join("answer/estimate.json"));
    (last, estimate)
}

/// A turn about one axis alone: the three elements of its row are known and given, the others are not, and the word stays *converging*.
#[test]
fn stat_a_turn_about_one_axis_gives_the_elements_of_its_row() {
    let inertia = TRUE_INERTIA.map(|(element, x)| format!("{element} = {x}"));
    let truth = turned_from_rest("exact = true", &inertia.join(", "), WHEELS);
    let model = turned_from_rest("exact = true", "xx = 4.6, yy = 4.7, zz = 3.6", WHEELS);
    for (rate_hz, seed) in [(5, 1), (13, 2), (20, 3)] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("truth.toml"), &truth).unwrap();
        std::fs::write(folder.path().join("model.toml"), &model).unwrap();
        let (code, last) = run(folder.path(), 1, (rate_hz, seed));
        assert_eq!((code, &last["health"]), (Some(1), &"converging".into()));
        for (element, truth) in TRUE_INERTIA {
            let number = &last["numbers"][format!("bus.inertia_kg_m2.{element}")];
            let sigma = number["sigma"].as_f64().unwrap();
            match number["value"].as_f64() {
                Some(value) => {
                    assert!(element.contains('x') && (value - truth).abs() < 4.5 * sigma)
                }
                None => assert!(!element.contains('x') && sigma > 0.5),
            }
        }
    }
}

/// Errors of the last line in its sigmas, and these over those of `identify`.
fn errors(last: &Value, estimate: &Value) -> Vec<(f64, f64)> {
    let each = TRUE_INERTIA.iter().map(|(element, truth)| {
        let number = &last["numbers"][format!("bus.inertia_kg_m2.{element}")];
        let of = |key: &str| number[key].as_f64().unwrap();
        let off = (of("value") - truth) / of("sigma");
        let ratio = of("sigma") / of_body(estimate, element).1;
        println!("{element}: {off:.2} sigma off, sigma {ratio:.3} of that of identify");
        (off, ratio)
    });
    each.collect()
}

/// Nominal moments of inertia a third to a half off, on a bus that starts from rest: what the first samples tell is little, and the bias of
/// the gyro is larger than its rate. At 20 Hz numbers were 13 sigma off.
#[test]
fn regress_a_far_nominal_costs_time_alone() {
    let inertia = TRUE_INERTIA.map(|(element, x)| format!("{element} = {x}"));
    let truth = turned_from_rest("exact = true", &inertia.join(", "), WHEELS);
    let far = "xx = 5.6, yy = 3.6, zz = 4.3";
    let model = turned_from_rest("exact = true", far, WHEELS);
    for (rate_hz, seed) in [(7, 11), (7, 12), (14, 13), (20, 14), (28, 14)] {
        let folder = tempfile::tempdir().unwrap();
        let (last, estimate) = turned(folder.path(), &truth, &model, (rate_hz, seed));
        assert_eq!(last["health"], "determined");
        let errors = errors(&last, &estimate);
        assert!(
            errors
                .iter()
                .all(|(off, ratio)| off.abs() < 4.5 && (0.9..1.2).contains(ratio))
        );
    }
}

/// Wheels that fly with other spin inertias and axes than their drawings say: what is known with a sigma counts as `identify` has it, and an
/// answer as prior holds what its numbers have in common with it.
#[test]
fn xval_follow_takes_known_numbers_as_identify_does() {
    let inertia = TRUE_INERTIA.map(|(element, x)| format!("{element} = {x}"));
    let flown = [
        ([1.0, 2.0e-3, -3.0e-3], 0.00213),
        ([1.0e-3, 1.0, 2.0e-3], 0.00207),
        ([-2.0e-3, 1.0e-3, 1.0], 0.00211),
    ];
    let truth = turned_from_rest("exact = true", &inertia.join(", "), flown);
    let nominal = "xx = 4.5, yy = 4.9, zz = 3.5";
    let model = turned_from_rest("source = \"cad\"", nominal, WHEELS);
    let folder = tempfile::tempdir().unwrap();
    let (last, estimate) = turned(folder.path(), &truth, &model, (7, 3));
    assert_eq!(last["health"], "determined");
    for (off, ratio) in errors(&last, &estimate) {
        assert!(off.abs() < 3.5 && (0.9..1.1).contains(&ratio));
    }
    let table = ["answer", "--to", "onboard", "--onto", "model.toml"];
    let export = ["export", "-o", "filter.bin"];
    done(poinsot(folder.path()).args(export).args(table));
    let bytes = std::fs::read(folder.path().join("filter.bin")).unwrap();
    let prior = Configuration::from_table(&bytes).unwrap();
    let uncertain: Vec<usize> = (0..prior.uncertain.len())
        .filter(|k| prior.uncertain[*k])
        .collect();
    assert_eq!(uncertain.len(), 6 + 9 + 3 + 1);
    // zz is the last of the six: its variance where the known numbers are given, and with them.
    let mut row = vec![0.0; uncertain.len()];
    let mut variance = 0.0;
    for j in 5..uncertain.len() {
        let unit = f64::from(u8::from(j == 5));
        let sum: f64 = (5..j).map(|k| row[k] * prior.prior[(k, j)]).sum();
        row[j] = (unit - sum) / prior.prior[(j, j)];
        variance += row[j] * row[j];
    }
    let (_, sigma) = of_body(&estimate, "zz");
    let given = row[5];
    println!(
        "zz: sigma {given:.2e} with known numbers given, {:.4} with them, {sigma:.4} in the answer",
        variance.sqrt()
    );
    assert!((variance.sqrt() / sigma - 1.0).abs() < 0.02 && given < 0.02 * sigma);
}

/// The model of the branched arm without its sensor of velocity; one body is unknown, its nominal mass a tenth off.
fn branched_arm(unknown: &str) -> String {
    let text = std::fs::read_to_string(shipped().join("branched_arm_truth.toml")).unwrap();
    let text = text.replace("estimate = true\n", "");
    let mut tables: Vec<String> = text.split("\n[[").map(str::to_owned).collect();
    tables.retain(|table| !table.contains("type = \"velocity\""));
    let own = format!("body]]\nname = \"{unknown}\"\nmass_kg = ");
    let body = tables
        .iter_mut()
        .find(|table| table.starts_with(&own))
        .unwrap();
    let (mass, rest) = body[own.len()..].split_once('\n').unwrap();
    let mass = 1.1 * mass.parse::<f64>().unwrap();
    *body = format!("{own}{mass}\n{rest}estimate = true\n");
    tables.join("\n[[")
}

/// Each body of a tree with joints that turn and slide, unknown in turn: base, links in between and at an end.
#[test]
fn xval_follow_knows_any_body_of_an_arm_as_identify_does() {
    let folder = tempfile::tempdir().unwrap();
    let case = shipped().join("branched_arm.toml");
    done(
        poinsot(folder.path())
            .arg("simulate")
            .arg(&case)
            .args(["--out", "sim"]),
    );
    for body in ["base", "upper", "boom", "mast"] {
        std::fs::write(folder.path().join("model.toml"), branched_arm(body)).unwrap();
        let files = ["model.toml", "sim/telemetry.csv", "--out", body];
        let found = done(poinsot(folder.path()).arg("follow").args(files));
        let found = lines(&found);
        let last = &found[found.len() - 1];
        let estimate = read(&folder.path().join(body).join("estimate.json"));
        assert_eq!(last["health"], "determined");
        for element in ["xx", "yy", "zz", "xy", "xz", "yz"] {
            let number = &estimate["bodies"][body]["inertia_kg_m2"][element];
            let own = &last["numbers"][format!("{body}.inertia_kg_m2.{element}")];
            let of = |number: &Value, key: &str| number[key].as_f64().unwrap();
            let ratio = of(own, "sigma") / of(number, "sigma");
            let off = (of(own, "value") - of(number, "value")) / of(number, "sigma");
            println!(
                "{body} {element}: {off:.3} sigma from identify, sigma {ratio:.4} of its sigma"
            );
            assert!(off.abs() < 0.1 && (0.98..1.02).contains(&ratio));
        }
    }
}

/// Rows that arrive in pieces of any size give the lines of the file.
#[test]
fn exact_pieces_of_a_stream_give_the_last_line_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let whole = followed(folder.path());
    let rows = std::fs::read(folder.path().join("sim/telemetry.csv")).unwrap();
    let mut command = poinsot(folder.path());
    command
        .arg("follow")
        .arg(model())
        .args(["-", "--out", "stream"]);
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    for piece in rows.chunks(1777) {
        input.write_all(piece).unwrap();
    }
    drop(input);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(lines(&output).last(), whole.last());
    assert_eq!(
        std::fs::read(folder.path().join("stream/rows.csv")).unwrap(),
        rows
    );
    assert!(folder.path().join("stream/estimate.json").is_file());
}

#[test]
fn exact_a_table_has_the_model_or_an_answer() {
    let folder = tempfile::tempdir().unwrap();
    followed(folder.path());
    let table = |arguments: &[&str]| {
        done(poinsot(folder.path()).arg("export").args(arguments));
        let bytes = std::fs::read(folder.path().join("filter.bin")).unwrap();
        assert_eq!(bytes.len(), TABLE);
        Configuration::from_table(&bytes).unwrap()
    };
    let path = model();
    let path = path.to_str().unwrap();
    let of_model = table(&[path, "--to", "onboard", "-o", "filter.bin"]);
    assert_eq!((of_model.wheel_count, of_model.uncertain[9]), (4, true));
    let of_answer = table(&[
        "answer",
        "--to",
        "onboard",
        "--onto",
        path,
        "-o",
        "filter.bin",
    ]);
    let (value, sigma) = of_body(&read(&folder.path().join("answer/estimate.json")), "zz");
    // The last of the triangle is the inverse sigma of the last parameter alone.
    let prior = 1.0 / of_answer.prior[(5, 5)];
    assert!((prior / sigma - 1.0).abs() < 1.0e-6, "{prior} {sigma}");
    assert!(of_model.prior[(5, 5)] < 1.0e-2 * of_answer.prior[(5, 5)]);
    println!("{value} {:?}", of_answer.nominal);
    let refused = poinsot(folder.path())
        .args(["export", path, "--to", "onboard"])
        .output();
    assert_eq!(refused.unwrap().status.code(), Some(2));
}

/// What a stream lacks, and where a row is broken, is said as `identify` says it; it does not run on without a word.
#[test]
fn cli_follow_says_what_is_missing_and_where_a_row_is_broken() {
    let folder = tempfile::tempdir().unwrap();
    let case = shipped().join("pyramid.toml");
    let mut simulate = poinsot(folder.path());
    done(simulate.arg("simulate").arg(&case).args(["--out", "sim"]));
    let rows = std::fs::read_to_string(folder.path().join("sim/telemetry.csv")).unwrap();
    let refused = |rows: &str, options: &[&str]| {
        std::fs::write(folder.path().join("rows.csv"), rows).unwrap();
        let mut command = poinsot(folder.path());
        command.arg("follow").arg(model()).arg("rows.csv");
        let output = command.args(options).arg("--quiet").output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    for (own, other, named) in [
        ("omega_", "rate_", "omega_x omega_y omega_z"),
        ("q_", "att_", "q_x q_y q_z q_w"),
        ("wheel3_rad_s", "rw3", "wheel3_rad_s"),
    ] {
        let text = refused(&rows.replace(own, other), &[]);
        assert!(text.starts_with("E0301 rows.csv: "), "{text}");
        assert!(text.contains(named) && text.contains(other), "{text}");
        // The lines that it prints are a map.
        let (_, lines) = text.split_once("[telemetry.columns] ").unwrap();
        let (lines, _) = lines.split_once(", with its own unit").unwrap();
        let mut lines = lines.replace("}, ", "}\n");
        for name in named.split(' ') {
            lines = lines.replacen("...", &name.replace(own, other), 1);
        }
        let lines = format!("[telemetry.columns]\n{lines}\n");
        std::fs::write(folder.path().join("map.toml"), lines).unwrap();
        let mut command = poinsot(folder.path());
        command.arg("follow").arg(model()).arg("rows.csv");
        done(command.args(["--map", "map.toml"]));
    }
    // A wheel is named by both commands in the same words, whatever the names of the columns that are not used; what they advise works.
    let model_text = std::fs::read_to_string(model()).unwrap();
    for (wheel, columns) in [("wheel3", ["a", "b"]), ("wheel1", ["z1", "temp"])] {
        let channel = format!("{wheel}_rad_s");
        let (head, rest) = rows.split_once('\n').unwrap();
        let others = rest.lines().map(|row| format!("{row},0\n"));
        let head = format!("{},{}\n", head.replace(&channel, columns[0]), columns[1]);
        let other = head + &others.collect::<String>();
        let said = refused(&other, &[]);
        let advice = format!(
            "map it by [telemetry.columns] {channel} = {{ column = \"...\", unit = \"rad/s\" }}, with its own unit (unused: {}); or write at_rest = true",
            columns.join(", ")
        );
        assert!(said.contains(&advice), "{said}");
        let mut identify = poinsot(folder.path());
        identify.arg("identify").arg("--model").arg(model());
        let output = identify.args(["--telemetry", "rows.csv"]).output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stderr), said);
        // The wheel turns: the numbers are wrong, but the rows are read.
        let name = format!("name = \"{wheel}\"\n");
        let rests = model_text.replace(&name, &format!("{name}at_rest = true\n"));
        std::fs::write(folder.path().join("rests.toml"), rests).unwrap();
        let mut command = poinsot(folder.path());
        let output = command
            .args(["follow", "rests.toml", "rows.csv"])
            .output()
            .unwrap();
        let assumed = format!("assumed: {wheel} at rest (at_rest), unless a record has {channel}");
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(
            error.contains(&assumed) && output.status.code() != Some(2),
            "{error}"
        );
        assert!(!output.stdout.is_empty());
    }
    // In a later batch than the first.
    let mut broken: Vec<&str> = rows.lines().collect();
    broken[499] = "100,abc";
    let text = refused(&broken.join("\n"), &[]);
    assert!(text.starts_with("E0204 rows.csv:500: "), "{text}");
    let text = refused(&rows, &["--relative-accuracy", "0"]);
    assert!(text.starts_with("E0001 --relative-accuracy"), "{text}");
}
