//! From URDF to a model, and from an answer back to the same file.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A satellite as URDF, with parts that must not change: comments, blanks, line ends, other tags.
const ROBOT: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\r\n<!-- made by hand -->\n<robot  name='stsat3' >\n\t<link name=\"spacecraft\">\n    <visual><geometry><box size=\"1 1 1\"/></geometry></visual>\n    <inertial>\n      <!-- from CAD -->\n      <mass value = \"150.0\" />\n      <inertia  ixx=\"15.0\" ixy=\"0.0\"  ixz='0.0'\n        iyy=\"16.0\" iyz=\"0.0\" izz=\"21.0\"/>\n    </inertial></link>\n  <gazebo reference=\"spacecraft\"/>\n</robot>\n<!-- end -->";

fn poinsot(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_poinsot"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn good(output: &Output) -> String {
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{error}");
    error
}

/// Simulated telemetry of STSAT-3, and the answer of `identify` in `out`.
fn answer(folder: &Path, robot: &str) -> Value {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let case = cases.join("stsat3_spin.toml").display().to_string();
    good(&poinsot(folder, &["simulate", &case, "--out", "sim"]));
    std::fs::write(folder.join("r.urdf"), robot).unwrap();
    good(&poinsot(folder, &["import", "r.urdf", "-o", "m.toml"]));
    // The URDF has the bodies; wheels and sensors are added.
    let truth = std::fs::read_to_string(cases.join("stsat3_truth.toml")).unwrap();
    let equipment = truth.find("[[wheel]]").unwrap();
    let imported = std::fs::read_to_string(folder.join("m.toml")).unwrap();
    let bodies = imported.split("[momentum]").next().unwrap();
    let model = bodies.replacen("[[body]]", "[[body]]\nestimate = [\"inertia\"]", 1)
        + "\n"
        + &truth[equipment..];
    std::fs::write(folder.join("m.toml"), model).unwrap();
    good(&poinsot(
        folder,
        &[
            "identify",
            "--model",
            "m.toml",
            "--telemetry",
            "sim/telemetry.csv",
            "--method",
            "linear",
            "--out",
            "out",
        ],
    ));
    let text = std::fs::read_to_string(folder.join("out/estimate.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn inertia(estimate: &Value, name: &str) -> f64 {
    estimate["bodies"]["spacecraft"]["inertia_kg_m2"][name]["value"]
        .as_f64()
        .unwrap()
}

#[test]
fn cli_export_changes_the_numbers_and_no_other_byte() {
    let folder = tempfile::tempdir().unwrap();
    let estimate = answer(folder.path(), ROBOT);
    let told = good(&poinsot(
        folder.path(),
        &[
            "export", "out", "--to", "urdf", "--onto", "r.urdf", "-o", "new.urdf",
        ],
    ));
    assert_eq!(told, "written: new.urdf\n");
    let mut expected = ROBOT.to_owned();
    for (old, key) in [
        ("ixx=\"15.0\"", "xx"),
        ("ixy=\"0.0\"", "xy"),
        ("ixz='0.0'", "xz"),
        ("iyy=\"16.0\"", "yy"),
        ("iyz=\"0.0\"", "yz"),
        ("izz=\"21.0\"", "zz"),
    ] {
        let quote = if old.contains('\'') { '\'' } else { '"' };
        let new = format!("i{key}={quote}{:?}{quote}", inertia(&estimate, key));
        expected = expected.replacen(old, &new, 1);
    }
    // The file has no origin, so the mass centre is added.
    expected = expected.replacen("<inertial>", "<inertial><origin xyz=\"0.0 0.0 0.0\"/>", 1);
    let new = std::fs::read_to_string(folder.path().join("new.urdf")).unwrap();
    assert_eq!(new, expected);
}

#[test]
fn cli_export_turns_the_tensor_into_the_axes_of_the_file() {
    let robot = ROBOT.replacen(
        "<mass",
        "<origin xyz='0 0 0' rpy=\"0.4 -0.7 1.9\"/><mass",
        1,
    );
    let folder = tempfile::tempdir().unwrap();
    let estimate = answer(folder.path(), &robot);
    good(&poinsot(
        folder.path(),
        &[
            "export", "out", "--to", "urdf", "--onto", "r.urdf", "-o", "new.urdf",
        ],
    ));
    let new = std::fs::read_to_string(folder.path().join("new.urdf")).unwrap();
    assert!(new.contains("rpy=\"0.4 -0.7 1.9\""));
    let read = poinsot_model::read_urdf(folder.path().join("new.urdf"))
        .model
        .unwrap();
    let tensor = read.bodies[0].nominal.I_BBcm_B;
    for (key, at) in [
        ("xx", (0, 0)),
        ("xy", (0, 1)),
        ("yy", (1, 1)),
        ("xz", (0, 2)),
        ("yz", (1, 2)),
        ("zz", (2, 2)),
    ] {
        let wanted = inertia(&estimate, key);
        assert!(
            (tensor[at] - wanted).abs() < 1e-12,
            "{key}: {} {wanted}",
            tensor[at]
        );
    }
}

#[test]
fn cli_export_of_what_is_not_determined_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), ROBOT);
    let path = folder.path().join("out/estimate.json");
    let (_, mut estimate) = poinsot_formats::read_estimate(&path).unwrap();
    let xy = &mut estimate.bodies["spacecraft"].inertia_kg_m2.xy;
    (xy.value, xy.source) = (None, None);
    let text = poinsot_formats::result_text(&estimate, true).unwrap();
    std::fs::write(&path, text).unwrap();
    let done = poinsot(
        folder.path(),
        &[
            "export", "out", "--to", "urdf", "--onto", "r.urdf", "-o", "new.urdf",
        ],
    );
    assert_eq!(done.status.code(), Some(2));
    assert_eq!(
        String::from_utf8_lossy(&done.stderr),
        "E0601 out/estimate.json: no report or export can be made of this: no body can be exported (not exported: spacecraft: not all of its mass, mass centre and inertia are determined; the file's numbers stay); identify with more data, or give the urdf file of the model\n"
    );
    assert!(!folder.path().join("new.urdf").exists());
}

/// Dummy links that move no mass are fixed on demand.
#[test]
fn cli_links_that_move_no_mass_are_fixed_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let robot = r#"<robot name="r"><link name="base"><inertial><mass value="20"/><inertia ixx="0.4" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.6"/></inertial></link>
        <link name="tip"/><joint name="wrist" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint></robot>"#;
    std::fs::write(folder.path().join("r.urdf"), robot).unwrap();
    let refused = poinsot(folder.path(), &["import", "r.urdf"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        said.starts_with("E0116 r.urdf:2:") && said.contains("--allow-massless"),
        "{said}"
    );
    let told = good(&poinsot(
        folder.path(),
        &["import", "r.urdf", "--allow-massless", "-o", "m.toml"],
    ));
    assert!(
        told.contains("neither it nor its outboard bodies have mass"),
        "{told}"
    );
    let model = std::fs::read_to_string(folder.path().join("m.toml")).unwrap();
    assert!(model.contains("type = \"fixed\""), "{model}");
    good(&poinsot(folder.path(), &["check", "m.toml"]));
}

/// The link of the gyro is the base, and the sensor names no body.
#[test]
fn cli_the_link_of_a_sensor_becomes_the_base() {
    let folder = tempfile::tempdir().unwrap();
    let robot = r#"<robot name="r"><link name="bus"><inertial><mass value="20"/><inertia ixx="0.4" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.6"/></inertial></link>
        <link name="arm"><inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link><link name="imu"/>
        <joint name="elbow" type="revolute"><parent link="bus"/><child link="arm"/><axis xyz="0 0 1"/></joint>
        <joint name="mount" type="fixed"><parent link="arm"/><child link="imu"/><origin xyz="0.1 0 0" rpy="0 0 1.5"/></joint></robot>"#;
    std::fs::write(folder.path().join("r.urdf"), robot).unwrap();
    let told = good(&poinsot(
        folder.path(),
        &["import", "r.urdf", "--base", "imu", "-o", "m.toml"],
    ));
    assert!(
        told.contains("link \"elbow_frame\": no <inertial>: assumed massless"),
        "{told}"
    );
    let model = std::fs::read_to_string(folder.path().join("m.toml")).unwrap();
    let sensor = "\n[[sensor]]\nname = \"gyro\"\ntype = \"gyro\"\nnoise_rad_s = 1e-4\n";
    std::fs::write(folder.path().join("m.toml"), model + sensor).unwrap();
    let checked = poinsot(folder.path(), &["check", "m.toml"]);
    good(&checked);
    let said = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(said.contains("elbow"), "{said}");
    let refused = poinsot(folder.path(), &["import", "r.urdf", "--base", "imo"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        said.contains("--base: there is no link \"imo\"; did you mean \"imu\"?"),
        "{said}"
    );
}
