//! `poinsot init`: six shipped records with the columns of other systems become an answer, with only the marked lines filled in.

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(path)
}

fn poinsot(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::cargo_bin("poinsot").unwrap();
    command.args(words).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A record by column names.
struct Record {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Record {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let names = lines
            .next()
            .unwrap()
            .split(',')
            .map(str::to_owned)
            .collect();
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
        Self {
            names,
            rows: lines.map(row).collect(),
        }
    }

    fn multiaxis() -> Self {
        Self::read(&data("stsat3/multiaxis/telemetry_noisy.csv"))
    }

    fn cell(&self, row: &[f64], name: &str) -> f64 {
        row[self.names.iter().position(|own| own == name).unwrap()]
    }

    fn quaternion(&self, row: &[f64]) -> [f64; 4] {
        ["q_w", "q_x", "q_y", "q_z"].map(|name| self.cell(row, name))
    }

    /// The record under other names, every row made by a function.
    fn written(&self, head: &str, comma: &str, row: impl Fn(&[f64]) -> Vec<String>) -> String {
        let rows: Vec<String> = self
            .rows
            .iter()
            .map(|r| row(r).join(comma) + "\n")
            .collect();
        format!("{head}\n{}", rows.concat())
    }
}

fn cells(values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values
        .into_iter()
        .map(|value| format!("{value:.10}"))
        .collect()
}

const RPM: f64 = 30.0 / std::f64::consts::PI;

fn wheels(record: &Record, row: &[f64], factor: f64, count: usize) -> Vec<String> {
    cells((1..=count).map(|k| factor * record.cell(row, &format!("wheel{k}_rad_s"))))
}

fn rates(record: &Record, row: &[f64], factor: f64) -> Vec<String> {
    cells(["x", "y", "z"].map(|axis| factor * record.cell(row, &format!("omega_{axis}"))))
}

/// Drafts a model, fills in the answers in place of the questions that begin so, and identifies.
fn answered(folder: &Path, init: &[&str], answers: &[(&str, &str)]) -> Value {
    let drafted = poinsot(folder, &[&["init", "--json"], init].concat());
    assert_eq!(drafted.status.code(), Some(1), "{}", text(&drafted.stderr));
    let listed: Value = serde_json::from_slice(&drafted.stdout).unwrap();
    let listed = listed["questions"].as_array().unwrap().clone();
    let path = folder.join("model.toml");
    let draft = std::fs::read_to_string(&path).unwrap();
    // Until the lines are answered they are refused, each by its number.
    let refused = poinsot(folder, &["check", "model.toml"]);
    assert_eq!(refused.status.code(), Some(2));
    for question in &listed {
        let line = format!("model.toml:{}:", question["lines"][0]);
        assert!(
            text(&refused.stderr).contains(&line),
            "{line} {}",
            text(&refused.stderr)
        );
    }
    let fill = |line: &str| {
        let Some((code, question)) = line.split_once("   # ? ") else {
            return line.to_owned();
        };
        let answer = answers
            .iter()
            .find(|(begin, _)| question.starts_with(begin));
        let (_, answer) = answer.unwrap_or_else(|| panic!("{line}"));
        let words: Vec<&str> = answer.split('|').collect();
        let words = words.iter().cycle().take(code.matches("\"?\"").count());
        words.fold(code.to_owned(), |code, word| {
            code.replacen("\"?\"", word, 1)
        })
    };
    let model: Vec<String> = draft.lines().map(fill).collect();
    std::fs::write(&path, model.join("\n")).unwrap();
    let files: Vec<&str> = init
        .iter()
        .copied()
        .filter(|w| w.ends_with(".csv"))
        .collect();
    let files = files.join(",");
    let identified = poinsot(folder, &["identify", "-m", "model.toml", &files, "--json"]);
    assert_eq!(
        identified.status.code(),
        Some(0),
        "{}{}\n{draft}",
        text(&identified.stdout),
        text(&identified.stderr)
    );
    serde_json::from_slice(&identified.stdout).unwrap()
}

/// Every number of the inertia is within four sigma of the truth, and the moments within 5 %.
fn assert_inertia(estimate: &Value, body: &str, truth: [f64; 6]) {
    let inertia = &estimate["bodies"][body]["inertia_kg_m2"];
    for (name, truth) in ["xx", "yy", "zz", "xy", "xz", "yz"].into_iter().zip(truth) {
        let number = |key: &str| inertia[name][key].as_f64().unwrap();
        let (value, sigma) = (number("value"), number("sigma"));
        assert!(
            (value - truth).abs() < 4.0 * sigma,
            "{name}: {value} +- {sigma}, true {truth}"
        );
        let is_moment = name[..1] == name[1..];
        assert!(
            !is_moment || (value / truth - 1.0).abs() < 0.05,
            "{name}: {value}, true {truth}"
        );
    }
}

/// The inertia of STSAT-3 in the simulation.
const STSAT3: [f64; 6] = [13.916, 16.954, 19.894, 0.085, 0.133, 0.5896];

/// What an engineer knows of STSAT-3, by the name of its three wheels.
fn satellite(wheels: [&str; 3]) -> Vec<(&str, &str)> {
    let axes = ["[1.0, 0.0, 0.0]", "[0.0, 1.0, 0.0]", "[0.0, 0.0, 1.0]"];
    let mut all = vec![("mass, kg", "150.0"), ("nominal moments", "15.0|16.0|21.0")];
    for (wheel, axis) in wheels.into_iter().zip(axes) {
        all.push((
            Box::leak(format!("{wheel}: spin axis").into_boxed_str()),
            axis,
        ));
        all.push((
            Box::leak(format!("{wheel}: spin inertia").into_boxed_str()),
            "4.113e-4",
        ));
    }
    all
}

/// Camel case, units in names, letters for wheels, Unix milliseconds, and a tracker that rotates inertial to body.
#[test]
fn xval_init_units_in_names_and_an_inverse_quaternion() {
    let folder = tempfile::tempdir().unwrap();
    let record = Record::multiaxis();
    let head = "time_unix_ms,BodyRateX_dps,BodyRateY_dps,BodyRateZ_dps,RW_A_rpm,RW_B_rpm,RW_C_rpm,ST_qw,ST_qx,ST_qy,ST_qz,Mode";
    let row = |row: &[f64]| {
        let [w, x, y, z] = record.quaternion(row);
        let time = format!("{}", (1.7e12 + 1e3 * record.cell(row, "time_s")) as u64);
        [
            vec![time],
            rates(&record, row, 180.0 / std::f64::consts::PI),
            wheels(&record, row, RPM, 3),
            cells([w, -x, -y, -z]),
            vec!["3".into()],
        ]
        .concat()
    };
    std::fs::write(
        folder.path().join("flight.csv"),
        record.written(head, ",", row),
    )
    .unwrap();
    // `inspect` recognises the same, and names the next step.
    let seen = text(&poinsot(folder.path(), &["inspect", "flight.csv"]).stdout);
    for part in [
        "omega_z ",
        "wheel_c_rad_s ",
        "q_w ",
        "sense = \"inertial_to_body\" }]   # sense by comparison with the gyro\n",
        "Next: `poinsot init flight.csv`",
    ] {
        assert!(seen.contains(part), "{part}: {seen}");
    }
    let estimate = answered(
        folder.path(),
        &["flight.csv"],
        &satellite(["wheel_a", "wheel_b", "wheel_c"]),
    );
    assert_inertia(&estimate, "spacecraft", STSAT3);
}

/// No units in names: those of the gyro and the times, and the order of the quaternion, follow from the data; that of the wheels
/// is asked.
#[test]
fn xval_init_units_that_the_data_show() {
    let folder = tempfile::tempdir().unwrap();
    let record = Record::multiaxis();
    let head = "time,gx,gy,gz,rw_speed_1,rw_speed_2,rw_speed_3,q0,q1,q2,q3";
    let row = |row: &[f64]| {
        [
            cells([record.cell(row, "time_s")]),
            rates(&record, row, 180.0 / std::f64::consts::PI),
            wheels(&record, row, RPM, 3),
            cells(record.quaternion(row)),
        ]
        .concat()
    };
    std::fs::write(
        folder.path().join("flight.csv"),
        record.written(head, ",", row),
    )
    .unwrap();
    let mut answers = satellite(["wheel1", "wheel2", "wheel3"]);
    answers.extend([
        ("unit of rw_speed_1, rw_speed_2, rw_speed_3", "\"rpm\""),
        ("noise of wheel_speed", "0.017"),
    ]);
    let estimate = answered(folder.path(), &["flight.csv"], &answers);
    assert_inertia(&estimate, "spacecraft", STSAT3);
}

/// A gyro and a tracker in files of their own, with dates, semicolons and a row of units.
#[test]
fn xval_init_two_files_of_a_ground_station() {
    let folder = tempfile::tempdir().unwrap();
    let record = Record::multiaxis();
    let date = |row: &[f64]| {
        let ms = (1e3 * record.cell(row, "time_s")).round() as u64;
        format!(
            "2026-03-14T18:{:02}:{:02}.{:03}",
            19 + ms / 60_000,
            ms / 1000 % 60,
            ms % 1000
        )
    };
    let head = "UTC;GYR_X;GYR_Y;GYR_Z;RW1;RW2;RW3\n;deg/s;deg/s;deg/s;rpm;rpm;rpm";
    let aocs = |row: &[f64]| {
        [
            vec![date(row)],
            rates(&record, row, 180.0 / std::f64::consts::PI),
            wheels(&record, row, RPM, 3),
        ]
        .concat()
    };
    std::fs::write(
        folder.path().join("aocs.csv"),
        record.written(head, ";", aocs),
    )
    .unwrap();
    let tracker = |row: &[f64]| {
        let [w, x, y, z] = record.quaternion(row);
        [vec![date(row)], cells([x, y, z, w])].concat()
    };
    std::fs::write(
        folder.path().join("tracker.csv"),
        record.written("UTC;Q1;Q2;Q3;Q4", ";", tracker),
    )
    .unwrap();
    let estimate = answered(
        folder.path(),
        &["aocs.csv", "tracker.csv"],
        &satellite(["wheel1", "wheel2", "wheel3"]),
    );
    assert_inertia(&estimate, "spacecraft", STSAT3);
}

/// Names of Basilisk: Rodrigues parameters, and four wheels in a pyramid.
#[test]
fn xval_init_rodrigues_parameters_of_basilisk() {
    let folder = tempfile::tempdir().unwrap();
    let case = data("cases/pyramid.toml").display().to_string();
    assert!(
        poinsot(folder.path(), &["simulate", &case, "--out", "sim"])
            .status
            .success()
    );
    let record = Record::read(&folder.path().join("sim/telemetry.csv"));
    let head = "time_ns,sigma_BN[0],sigma_BN[1],sigma_BN[2],omega_BN_B[0],omega_BN_B[1],omega_BN_B[2],wheelSpeeds[0],wheelSpeeds[1],wheelSpeeds[2],wheelSpeeds[3]";
    let row = |row: &[f64]| {
        let [w, x, y, z] = record.quaternion(row);
        let mrp = [x, y, z].map(|v| v / (1.0 + w));
        let time = format!("{}", (1e9 * record.cell(row, "time_s")).round() as u64);
        [
            vec![time],
            cells(mrp),
            rates(&record, row, 1.0),
            wheels(&record, row, 1.0, 4),
        ]
        .concat()
    };
    std::fs::write(
        folder.path().join("run.csv"),
        record.written(head, ",", row),
    )
    .unwrap();
    let (c, s) = (0.819_152_044_288_991_8, 0.573_576_436_351_046);
    let axes = [[c, 0.0], [0.0, c], [-c, 0.0], [0.0, -c]].map(|[x, y]| format!("[{x}, {y}, {s}]"));
    let mut answers = vec![("mass, kg", "180.0"), ("nominal moments", "20.0|25.0|31.0")];
    answers.push(("unit of wheelSpeeds[0]", "\"rad/s\""));
    answers.push(("noise of wheel_speed", "0.01"));
    for (k, axis) in axes.iter().enumerate() {
        answers.push((
            [
                "wheel0: spin axis",
                "wheel1: spin axis",
                "wheel2: spin axis",
                "wheel3: spin axis",
            ][k],
            axis,
        ));
    }
    let inertias = [
        "wheel0: spin inertia",
        "wheel1: spin inertia",
        "wheel2: spin inertia",
        "wheel3: spin inertia",
    ];
    answers.extend(inertias.map(|question| (question, "0.01")));
    let estimate = answered(folder.path(), &["run.csv"], &answers);
    assert_inertia(&estimate, "spacecraft", [21.0, 26.0, 30.0, 0.9, -0.6, 1.1]);
}

/// Names of MAVLink: roll, pitch and yaw without a sequence or a unit, which the gyro shows.
#[test]
fn xval_init_angles_of_mavlink() {
    let folder = tempfile::tempdir().unwrap();
    let record = Record::multiaxis();
    let head = "time_boot_ms,roll,pitch,yaw,rollspeed,pitchspeed,yawspeed,wheel1_rpm,wheel2_rpm,wheel3_rpm";
    let row = |row: &[f64]| {
        let [w, x, y, z] = record.quaternion(row);
        let roll = (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y));
        let pitch = (2.0 * (w * y - z * x)).asin();
        let yaw = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
        let time = format!("{}", (1e3 * record.cell(row, "time_s")).round() as u64);
        [
            vec![time],
            cells([roll, pitch, yaw]),
            rates(&record, row, 1.0),
            wheels(&record, row, RPM, 3),
        ]
        .concat()
    };
    std::fs::write(
        folder.path().join("log.csv"),
        record.written(head, ",", row),
    )
    .unwrap();
    let estimate = answered(
        folder.path(),
        &["log.csv"],
        &satellite(["wheel1", "wheel2", "wheel3"]),
    );
    assert_inertia(&estimate, "spacecraft", STSAT3);
}

/// An arm with two hinges and a slide: joints come from the URDF, columns from a recorder of joint states.
#[test]
fn xval_init_a_robot_with_its_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let case = data("cases/branched_arm.toml").display().to_string();
    assert!(
        poinsot(folder.path(), &["simulate", &case, "--out", "sim"])
            .status
            .success()
    );
    let record = Record::read(&folder.path().join("sim/telemetry.csv"));
    let joints = [
        "shoulder_joint/position [deg]",
        "slide_joint/position [mm]",
        "pan_joint/position [deg]",
        "shoulder_joint/velocity [deg/s]",
        "slide_joint/velocity [mm/s]",
        "pan_joint/velocity [deg/s]",
    ];
    let sources = [
        "shoulder_rad",
        "slide_m",
        "pan_rad",
        "shoulder_rad_s",
        "slide_m_s",
        "pan_rad_s",
    ];
    let head = format!(
        "t [s],{},orientation.x,orientation.y,orientation.z,orientation.w,angular_velocity.x,angular_velocity.y,angular_velocity.z,vx_mps,vy_mps,vz_mps",
        joints.join(",")
    );
    let row = |row: &[f64]| {
        let joint = |name: &&str| {
            record.cell(row, name)
                * if name.contains("_m") {
                    1e3
                } else {
                    180.0 / std::f64::consts::PI
                }
        };
        let [w, x, y, z] = record.quaternion(row);
        let velocity = ["v_x", "v_y", "v_z"].map(|name| record.cell(row, name));
        [
            cells([record.cell(row, "time_s")]),
            cells(sources.iter().map(joint)),
            cells([x, y, z, w]),
            rates(&record, row, 1.0),
            cells(velocity),
        ]
        .concat()
    };
    std::fs::write(
        folder.path().join("arm.csv"),
        record.written(&head, ",", row),
    )
    .unwrap();
    std::fs::write(folder.path().join("arm.urdf"), URDF).unwrap();
    let without = poinsot(folder.path(), &["init", "arm.csv"]);
    assert_eq!(without.status.code(), Some(2));
    assert!(
        text(&without.stderr).contains("give the robot: --urdf ROBOT.urdf"),
        "{}",
        text(&without.stderr)
    );
    let answers = [("what is unknown of base", "true")];
    let estimate = answered(folder.path(), &["arm.csv", "--urdf", "arm.urdf"], &answers);
    assert_inertia(&estimate, "base", [62.0, 71.0, 80.0, 2.1, -1.4, 1.8]);
}

/// The branched arm; the numbers of the base are nominal.
const URDF: &str = r#"<robot name="branched">
<link name="base"><inertial><mass value="400"/><inertia ixx="60" ixy="0" ixz="0" iyy="70" iyz="0" izz="80"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.55 0.02 -0.03"/><mass value="14"/><inertia ixx="0.21" ixy="0.02" ixz="-0.01" iyy="1.35" iyz="0.015" izz="1.30"/></inertial></link>
<link name="boom"><inertial><origin xyz="0.40 0.05 0.02"/><mass value="22"/><inertia ixx="0.30" ixy="0.03" ixz="0.02" iyy="1.10" iyz="-0.01" izz="1.15"/></inertial></link>
<link name="mast"><inertial><origin xyz="0.03 0.35 0.10"/><mass value="9"/><inertia ixx="0.50" ixy="0.01" ixz="0.01" iyy="0.08" iyz="0.02" izz="0.46"/></inertial></link>
<joint name="shoulder_joint" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0.6 0.1 0.4"/><axis xyz="0 0.6 0.8"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="slide_joint" type="prismatic"><parent link="upper"/><child link="boom"/><origin xyz="0.9 0 0.1"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="pan_joint" type="revolute"><parent link="upper"/><child link="mast"/><origin xyz="0.3 0.1 0.1"/><axis xyz="0.8 0 0.6"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>"#;

/// What it asks is listed with lines; an existing file is kept; without a model `identify` says how to make one.
#[test]
fn cli_init_lists_its_questions_and_keeps_files() {
    let folder = tempfile::tempdir().unwrap();
    // The last column has an escape in its name, which no TOML may contain.
    let csv = "t,wx,wy,wz,RW1,THR1,Mode,a\u{1b}b\n0,1,2,3,900,0,2,1\n1,1,2,3,910,1,2,1\n2,1,2,4,920,0,2,1\n";
    std::fs::write(folder.path().join("a.csv"), csv).unwrap();
    let drafted = poinsot(folder.path(), &["init", "a.csv", "-o", "m.toml"]);
    assert_eq!(drafted.status.code(), Some(1), "{}", text(&drafted.stderr));
    let listed = text(&drafted.stdout);
    for part in [
        "m.toml:8: mass, kg\n",
        "unit of the times: \"s\", \"ms\", \"us\" or \"ns\"\n",
        "unit of wx, wy, wz: \"rad/s\", \"deg/s\" or \"rpm\"\n",
        "force of THR1 while it is on, N\n",
        "thr1: direction of the force on the body",
        "questions in the file, then: poinsot identify -m m.toml a.csv\n",
    ] {
        assert!(listed.contains(part), "{part}: {listed}");
    }
    let draft = std::fs::read_to_string(folder.path().join("m.toml")).unwrap();
    assert!(
        draft.ends_with(
            "# Not used, because the name does not say what it is or no sensor needs it: Mode, a\\u{1b}b\n"
        ),
        "{draft}"
    );
    let again = poinsot(folder.path(), &["init", "a.csv", "-o", "m.toml"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(
        text(&again.stderr)
            .contains("E0001 -o 'm.toml': the file exists; remove it, or name another one with -o")
    );
    let refused = poinsot(folder.path(), &["identify", "-m", "m.toml", "a.csv"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("E0106 m.toml:8:11: body[0].mass_kg (body \"spacecraft\") = \"?\": the question has no answer"));
    let without = poinsot(folder.path(), &["identify", "a.csv"]);
    assert_eq!(without.status.code(), Some(2));
    assert!(
        text(&without.stderr).contains("poinsot init a.csv -o model.toml"),
        "{}",
        text(&without.stderr)
    );
}

/// A wheel whose momentum is exported: the draft asks for its spin inertia, and has the unit.
#[test]
fn cli_init_drafts_a_wheel_of_its_momentum() {
    let folder = tempfile::tempdir().unwrap();
    let csv = "t_s,wx_dps,wy_dps,wz_dps,RW1_H_Nms,RW2_momentum_N_m_s\n0,1,2,3,0.1,0.2\n1,1,2,3,0.2,0.1\n2,1,2,4,0.3,0.1\n";
    std::fs::write(folder.path().join("a.csv"), csv).unwrap();
    let inspected = text(&poinsot(folder.path(), &["inspect", "a.csv"]).stdout);
    assert!(inspected.contains("wheel1_rad_s: not read: the spin inertia of a wheel, over which a momentum is its speed, is not known; give --model"), "{inspected}");
    poinsot(folder.path(), &["init", "a.csv", "-o", "m.toml"]);
    let draft = std::fs::read_to_string(folder.path().join("m.toml")).unwrap();
    for part in [
        "wheel1: spin inertia, kg m2 (momentum in N m s over speed in rad/s)",
        "wheel1_rad_s = { column = \"RW1_H_Nms\", unit = \"N m s\" }",
        "wheel2_rad_s = { column = \"RW2_momentum_N_m_s\", unit = \"N m s\" }",
    ] {
        assert!(draft.contains(part), "{part}: {draft}");
    }
}

#[test]
fn cli_without_a_model_a_missing_file_is_named_before_a_draft_is_advised() {
    let folder = tempfile::tempdir().unwrap();
    let said = |words: &[&str]| text(&poinsot(folder.path(), words).stderr);
    let missing = said(&["identify", "nofile.csv"]);
    assert!(missing.starts_with("E0201 nofile.csv: "), "{missing}");
    assert!(!missing.contains("poinsot init"), "{missing}");
    std::fs::write(folder.path().join("a.csv"), "time_s,omega_x\n").unwrap();
    let draft = said(&["identify", "a.csv"]);
    assert!(draft.contains("poinsot init a.csv"), "{draft}");
}
