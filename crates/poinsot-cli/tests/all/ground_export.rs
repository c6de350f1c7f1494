//! Telemetry in the formats of ground stations: four files of a satellite of 312 kg, one model file, one map.

use assert_cmd::Command;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use poinsot_testkit::vehicles::ModelText;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// The first sample: 2026 March 14, 18:19:00 UTC, as Unix time, s.
const START_UNIX: i64 = 1_773_512_340;
/// The same as GPS week and seconds of the week.
const START_GPS: (i64, i64) = (2409, 584_358);
const GM: f64 = 3.986_004_418e14;
const RADIUS_M: f64 = 6.921e6;
const INCLINATION_RAD: f64 = 1.7;
const ANOMALY_RAD: f64 = 0.6;

/// Bodies, wheels and thrusters; mass centre and inertia of the bus are parameters.
fn vehicle((com, inertia): ([f64; 3], [f64; 6]), tracker: &str) -> String {
    let unknown = "estimate = [\"com\", \"inertia\"]";
    let mut text = ModelText::new("sat312").body("bus", 312.0, com, inertia, unknown);
    let axes = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    for (k, [x, y]) in axes.into_iter().enumerate() {
        text = text.wheel(&format!("wheel{}", k + 1), "bus", [x, y, 1.0], 0.031);
    }
    let thrusters = [
        ([0.7, 0.6, -0.9], [0.0, 0.0, 1.0]),
        ([-0.7, 0.6, -0.9], [0.0, 0.0, 1.0]),
        ([0.7, -0.6, -0.9], [0.0, 1.0, 0.0]),
        ([-0.7, -0.6, 0.9], [1.0, 0.0, 0.0]),
    ];
    for (k, (at, along)) in thrusters.into_iter().enumerate() {
        text = text.thruster(&format!("thr{}", k + 1), "bus", at, along);
    }
    let gyro = "noise_rad_s = 5.0e-5\nbias = \"estimate\"";
    text.sensor("gyro", "gyro", gyro)
        .sensor("tracker", "attitude", tracker)
        .sensor("tachometers", "wheel_speed", "noise_rad_s = 0.02")
        .text()
}

const TRUTH: ([f64; 3], [f64; 6]) = ([0.021, -0.034, 0.052], [81.3, 66.9, 94.2, -2.1, 1.4, 3.3]);

fn truth() -> String {
    format!(
        "{}\n[environment]\ngravity = \"point_mass\"\ngm_m3_s2 = {GM:e}\ngravity_gradient = true\norbit = {{ semi_major_axis_m = {RADIUS_M:e}, inclination_rad = {INCLINATION_RAD}, true_anomaly_rad = {ANOMALY_RAD} }}\n",
        vehicle(TRUTH, "noise_rad = 3.0e-5")
    )
}

const CASE: &str = r#"schema = "poinsot.case/1"
model = "truth.toml"
duration_s = 120.0

[initial]
q_xyzw = [0.1, -0.2, 0.05, 0.9733961166965892]
omega_rad_s = [0.004, -0.006, 0.003]

[[wheel_motion]]
wheel = "wheel1"
time_s = [0.0, 20.0, 50.0, 90.0, 120.0]
speed_rad_s = [50.0, 220.0, -80.0, 160.0, 60.0]
interpolation = "cubic_clamped"

[[wheel_motion]]
wheel = "wheel2"
time_s = [0.0, 30.0, 60.0, 120.0]
speed_rad_s = [20.0, -180.0, 230.0, -50.0]
interpolation = "cubic_clamped"

[[wheel_motion]]
wheel = "wheel3"
time_s = [0.0, 25.0, 70.0, 120.0]
speed_rad_s = [-30.0, 190.0, -210.0, 40.0]
interpolation = "cubic_clamped"

[[wheel_motion]]
wheel = "wheel4"
time_s = [0.0, 40.0, 80.0, 120.0]
speed_rad_s = [10.0, 150.0, -170.0, 90.0]
interpolation = "cubic_clamped"

[[firing]]
thruster = "thr1"
on_s = 10.0
off_s = 14.0
force_N = 0.9

[[firing]]
thruster = "thr2"
on_s = 31.0
off_s = 35.0
force_N = 0.9

[[firing]]
thruster = "thr3"
on_s = 55.0
off_s = 60.0
force_N = 0.9

[[firing]]
thruster = "thr4"
on_s = 80.0
off_s = 84.0
force_N = 0.9

[output]
rate_hz = 4
seed = 11

[[output.sensor]]
name = "gyro"
bias_rad_s = [2.0e-4, -1.5e-4, 1.0e-4]
"#;

/// The engineer's model: nominal numbers, mounted sensors, and the map.
fn model() -> String {
    let tracker = "noise_rad = 3.0e-5\nrotation_matrix = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]";
    let guess = ([0.0; 3], [75.0, 72.0, 100.0, 0.0, 0.0, 0.0]);
    let nominal = vehicle(guess, tracker);
    format!(
        r#"{nominal}
[environment]
gravity = "point_mass"
gm_m3_s2 = {GM:e}
gravity_gradient = true

[telemetry]
comment = "\#"
units_row = true

[[telemetry.file]]
name = "aocs*.csv"
delimiter = ";"
time = {{ column = "UTC", format = "iso8601" }}

[telemetry.file.columns]
omega_x = {{ column = "GYR_X" }}
omega_y = {{ column = "GYR_Y" }}
omega_z = {{ column = "GYR_Z", sign = -1 }}
wheel1_rad_s = {{ column = "RW1" }}
wheel2_rad_s = {{ column = "RW2" }}
wheel3_rad_s = {{ column = "RW3" }}
wheel4_rad_s = {{ column = "RW4" }}

[[telemetry.file]]
name = "startracker*.csv"
time = {{ column = "TIME", format = "iso8601", scale = "TAI" }}
units_row = false
attitude = [{{ quaternion = ["Q0", "Q1", "Q2", "Q3"], order = "wxyz", sense = "inertial_to_body" }}]

[[telemetry.file]]
name = "thrusters*.csv"
time = {{ column = "TOW", format = "gps_week", week = "WEEK" }}
units_row = false

[telemetry.file.columns]
thr1_N = {{ column = "THR_A", nominal_N = 0.9 }}
thr2_N = {{ column = "THR_B", nominal_N = 0.9 }}
thr3_N = {{ column = "THR_C", nominal_N = 0.9 }}
thr4_N = {{ column = "THR_D", nominal_N = 0.9 }}

[[telemetry.file]]
name = "ephemeris*.csv"
time = {{ column = "t", epoch = "unix" }}
orbit = {{ position = ["rx", "ry", "rz"], velocity = ["vx", "vy", "vz"], frame = "earth_fixed" }}
"#
    )
    .replace("\\#", "#")
}

/// Simulated telemetry by column.
struct Sheet {
    header: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Sheet {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let header = lines
            .next()
            .unwrap()
            .split(',')
            .map(str::to_owned)
            .collect();
        let row = |line: &str| {
            line.split(',')
                .map(|c| c.parse().unwrap_or(f64::NAN))
                .collect()
        };
        Self {
            header,
            rows: lines.map(row).collect(),
        }
    }

    fn get(&self, row: usize, name: &str) -> f64 {
        let column = self.header.iter().position(|h| h == name).unwrap();
        self.rows[row][column]
    }
}

/// Date and time of day, to the millisecond, `after_s` seconds after the first sample in a scale `ahead_s` seconds
/// ahead of UTC.
fn date(after_s: f64, ahead_s: i64) -> String {
    let ms = (after_s * 1000.0).round() as i64 + 1000 * (ahead_s + 18 * 3600 + 19 * 60);
    let (s, ms) = (ms.div_euclid(1000), ms.rem_euclid(1000));
    format!(
        "2026-03-14T{:02}:{:02}:{:02}.{ms:03}",
        s / 3600,
        s / 60 % 60,
        s % 60
    )
}

/// Position on the orbit in Earth-fixed axes, km. Earth rotation angle by IERS Conventions 2010, eq. 5.15.
fn earth_fixed_km(after_s: f64) -> Vector3<f64> {
    let angle = ANOMALY_RAD + (GM / RADIUS_M.powi(3)).sqrt() * after_s;
    let (s, c) = INCLINATION_RAD.sin_cos();
    let r = Vector3::new(angle.cos(), c * angle.sin(), s * angle.sin()) * (RADIUS_M / 1e3);
    let days = (START_UNIX as f64 + after_s) / 86_400.0 + 2_440_587.5 - 2_451_545.0;
    let turn = TAU * (0.779_057_273_264_0 + 1.002_737_811_911_354_5 * days).fract();
    let (sin, cos) = turn.sin_cos();
    Vector3::new(cos * r.x + sin * r.y, -sin * r.x + cos * r.y, r.z)
}

fn write_exports(folder: &Path, sheet: &Sheet) {
    let mut aocs = "# MCS export v4.2\n# spacecraft: SAT312\nUTC;GYR_X;GYR_Y;GYR_Z;RW1;RW2;RW3;RW4;MODE\n-;deg/s;deg/s;[deg/s];rpm;rpm;rpm;rpm;-\n".to_owned();
    let mut tracker = "TIME,Q0,Q1,Q2,Q3,VALID\n".to_owned();
    let mut thrusters = "WEEK,TOW,THR_A,THR_B,THR_C,THR_D\n".to_owned();
    // The star tracker's x axis is the body's y axis.
    let q_BS = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), TAU / 4.0);
    for k in 0..sheet.rows.len() {
        let t = sheet.get(k, "time_s");
        let _ = write!(aocs, "{}Z", date(t, 0));
        for (name, sign) in [("omega_x", 1.0), ("omega_y", 1.0), ("omega_z", -1.0)] {
            let _ = write!(aocs, ";{}", sign * sheet.get(k, name).to_degrees());
        }
        for wheel in 1..=4 {
            let _ = write!(
                aocs,
                ";{}",
                sheet.get(k, &format!("wheel{wheel}_rad_s")) * 60.0 / TAU
            );
        }
        aocs.push_str(";FINE\n");
        if k % 2 == 0 {
            let part = |name| sheet.get(k, name);
            let q_NB = UnitQuaternion::from_quaternion(Quaternion::new(
                part("q_w"),
                part("q_x"),
                part("q_y"),
                part("q_z"),
            ));
            let q = (q_NB * q_BS).inverse();
            let _ = writeln!(tracker, "{},{},{},{},{},1", date(t, 37), q.w, q.i, q.j, q.k);
        }
        let _ = write!(thrusters, "{},{}", START_GPS.0, START_GPS.1 as f64 + t);
        for thruster in 1..=4 {
            let on = sheet.get(k, &format!("thr{thruster}_N")) > 0.0;
            let _ = write!(thrusters, ",{}", if on { "ON" } else { "OFF" });
        }
        thrusters.push('\n');
    }
    let mut orbit = "# ITRF\nt,rx,ry,rz,vx,vy,vz\ns,km,km,km,km/s,km/s,km/s\n".to_owned();
    for k in -4..18 {
        let after = f64::from(k) * 10.0;
        let r = earth_fixed_km(after);
        // Relative to Earth-fixed axes.
        let v = (earth_fixed_km(after + 1.0) - earth_fixed_km(after - 1.0)) / 2.0;
        let _ = writeln!(
            orbit,
            "{},{},{},{},{},{},{}",
            START_UNIX as f64 + after,
            r.x,
            r.y,
            r.z,
            v.x,
            v.y,
            v.z
        );
    }
    for (name, text) in [
        ("aocs_073.csv", aocs),
        ("startracker.csv", tracker),
        ("thrusters.csv", thrusters),
        ("ephemeris.csv", orbit),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
}

fn run(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("poinsot").unwrap();
    let output = command
        .current_dir(folder)
        .env("RAYON_NUM_THREADS", "1")
        .args(arguments)
        .output()
        .unwrap();
    let code = output.status.code().unwrap();
    assert!(code < 2, "{}", String::from_utf8_lossy(&output.stderr));
    output
}

fn simulated(folder: &Path) -> Sheet {
    std::fs::write(folder.join("truth.toml"), truth()).unwrap();
    std::fs::write(folder.join("case.toml"), CASE).unwrap();
    run(
        folder,
        &["simulate", "case.toml", "--out", "sim", "--quiet"],
    );
    Sheet::read(&folder.join("sim/telemetry.csv"))
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Values and sigmas of mass centre and inertia.
fn numbers(estimate: &Value) -> Vec<(f64, f64)> {
    let bus = &estimate["bodies"]["bus"];
    let number = |part: &Value, key: &str| {
        let at = |kind: &str| part[key][kind].as_f64().unwrap();
        (at("value"), at("sigma"))
    };
    let com = ["x", "y", "z"].map(|k| number(&bus["com_m"], k));
    let inertia = ["xx", "yy", "zz", "xy", "xz", "yz"].map(|k| number(&bus["inertia_kg_m2"], k));
    com.into_iter().chain(inertia).collect()
}

#[test]
fn cli_four_exported_files_and_one_map_give_the_right_answer() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_exports(folder, &simulated(folder));
    std::fs::write(folder.join("model.toml"), model()).unwrap();
    let files = "aocs_073.csv,startracker.csv,thrusters.csv,ephemeris.csv";
    let output = run(
        folder,
        &[
            "identify",
            "--model",
            "model.toml",
            "--telemetry",
            files,
            "--out",
            "out",
            "--report",
        ],
    );
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    let estimate = json(&folder.join("out/estimate.json"));
    let wanted = [0.021, -0.034, 0.052, 81.3, 66.9, 94.2, -2.1, 1.4, 3.3];
    for ((value, sigma), wanted) in numbers(&estimate).into_iter().zip(wanted) {
        assert!(
            (value - wanted).abs() < 3.0 * sigma,
            "{value} +- {sigma}, not {wanted}\n{said}"
        );
        assert!(sigma < 0.02 * 66.9, "{value} +- {sigma} says nothing");
    }
    assert_eq!(estimate["epoch"]["at"], "2026-03-14T18:19:00");
    assert_eq!(estimate["epoch"]["scale"], "UTC");
    let first = &estimate["inputs"][0]["time_s"];
    assert_eq!(
        (first[0].as_f64(), first[1].as_f64()),
        (Some(0.0), Some(120.0))
    );
    let data = json(&folder.join("out/report_data.json"));
    let times = data["segments"][0]["time_s"].as_array().unwrap();
    let distinct: std::collections::BTreeSet<String> = times.iter().map(Value::to_string).collect();
    assert_eq!(
        distinct.len(),
        times.len(),
        "times of the curves run into each other"
    );
}

#[test]
fn cli_the_same_answer_from_unix_gps_iso_and_relative_times() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let sheet = simulated(folder);
    std::fs::write(folder.join("model.toml"), model()).unwrap();
    let plain = std::fs::read_to_string(folder.join("sim/telemetry.csv")).unwrap();
    let orbit = "orbit = { position = [\"orbit_x\", \"orbit_y\", \"orbit_z\"], unit = \"m\" }";
    // The simulated star tracker is in body axes.
    let straight = model().replace(
        "[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]",
        "[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]",
    );
    std::fs::write(folder.join("model.toml"), straight).unwrap();
    let gps = START_GPS.0 * 604_800 + START_GPS.1;
    let decimal = |whole: i64, t: f64| {
        let ms = (t * 1000.0).round() as i64;
        format!("{}.{:03}", whole + ms / 1000, ms % 1000)
    };
    type Clock<'a> = Box<dyn Fn(f64) -> String + 'a>;
    let clocks: [(&str, &str, Clock); 5] = [
        (
            "relative",
            "time = { column = \"time_s\" }",
            Box::new(|t| format!("{t}")),
        ),
        (
            "unix",
            "time = { column = \"time_s\", epoch = \"unix\" }",
            Box::new(move |t| decimal(START_UNIX, t)),
        ),
        (
            "gps",
            "time = { column = \"time_s\", epoch = \"gps\" }",
            Box::new(move |t| decimal(gps, t)),
        ),
        (
            "iso",
            "time = { column = \"time_s\", format = \"iso8601\" }",
            Box::new(|t| date(t, 0) + "Z"),
        ),
        ("count", "", Box::new(move |t| decimal(START_UNIX, t))),
    ];
    let mut answers: Vec<(&str, Vec<(f64, f64)>)> = Vec::new();
    for (name, time, clock) in clocks {
        let mut lines = plain.lines();
        let mut text = lines.next().unwrap().to_owned() + "\n";
        for (k, line) in lines.enumerate() {
            let rest = line.split_once(',').unwrap().1;
            let _ = writeln!(text, "{},{rest}", clock(sheet.get(k, "time_s")));
        }
        std::fs::write(folder.join(format!("{name}.csv")), text).unwrap();
        std::fs::write(
            folder.join("map.toml"),
            format!("[telemetry]\n{time}\n{orbit}\n"),
        )
        .unwrap();
        let csv = format!("{name}.csv");
        run(
            folder,
            &[
                "identify",
                "--model",
                "model.toml",
                "--map",
                "map.toml",
                "--telemetry",
                &csv,
                "--out",
                name,
                "--quiet",
            ],
        );
        answers.push((
            name,
            numbers(&json(&folder.join(name).join("estimate.json"))),
        ));
    }
    let (_, relative) = answers[0].clone();
    for (name, answer) in &answers {
        for ((value, _), (wanted, sigma)) in answer.iter().zip(&relative) {
            assert!(
                (value - wanted).abs() <= 1e-9 * sigma,
                "{name}: {value}, not {wanted} +- {sigma}"
            );
        }
    }
}

#[test]
fn cli_check_says_the_map_and_the_surroundings_in_words() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("model.toml"), model()).unwrap();
    let said = run(folder.path(), &["check", "model.toml"]);
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    for line in [
        "gravity point_mass, gm 3.986e14 m3/s2",
        "gravity gradient",
        "aocs*.csv: time: column UTC, format iso8601",
        "aocs*.csv: omega_z: column GYR_Z, sign -1",
        "startracker*.csv: attitude: quaternion Q0 Q1 Q2 Q3, order wxyz, sense inertial_to_body",
        "thrusters*.csv: thr1_N: column THR_A, nominal 0.9 N",
        "ephemeris*.csv: time: column t, format number",
    ] {
        assert!(said.contains(line), "{line}\n{said}");
    }
    let units = run(folder.path(), &["units"]);
    let units = String::from_utf8_lossy(&units.stdout).into_owned();
    assert!(
        units.contains("angular velocity      rad/s    rad/s, mrad/s, deg/s"),
        "{units}"
    );
    let units: Value =
        serde_json::from_slice(&run(folder.path(), &["units", "--json"]).stdout).unwrap();
    let rpm = units["units"]
        .as_array()
        .unwrap()
        .iter()
        .find(|u| u["symbol"] == "rpm")
        .unwrap();
    assert_eq!(
        (&rpm["dimension"], &rpm["si"]),
        (&"angular_velocity".into(), &"rad/s".into())
    );
}

#[test]
fn cli_inspect_without_a_map_proposes_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_exports(folder, &simulated(folder));
    let said = run(folder, &["inspect", "aocs_073.csv"]);
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    for line in [
        "Proposed map",
        "name = \"aocs_073.csv\"",
        "delimiter = \";\"",
        "units_row = true",
        "time = { column = \"UTC\", format = \"iso8601\" }",
        "wheel1_rad_s = { column = \"RW1\" }",
        // Read with the proposed map.
        "omega_x",
    ] {
        assert!(said.contains(line), "{line}\n{said}");
    }
    let said = run(folder, &["inspect", "thrusters.csv"]);
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    assert!(
        said.contains("format = \"gps_week\", week = \"WEEK\""),
        "{said}"
    );
}

#[test]
fn cli_standard_input_is_a_file_too() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    simulated(folder);
    let telemetry = folder.join("sim/telemetry.csv");
    let from_file = run(folder, &["inspect", "sim/telemetry.csv", "--json"]);
    let mut command = Command::cargo_bin("poinsot").unwrap();
    let piped = command
        .args(["inspect", "-", "--json"])
        .write_stdin(std::fs::read(telemetry).unwrap())
        .output()
        .unwrap();
    let [a, b]: [Value; 2] =
        [from_file.stdout, piped.stdout].map(|out| serde_json::from_slice(&out).unwrap());
    assert_eq!(a["channels"], b["channels"]);
    assert_eq!(a["sources"][0]["sha256"], b["sources"][0]["sha256"]);
}
