//! From case files to telemetry.

use crate::shared::shipped;
use poinsot::case::{Case, parse_case, read_case};
use poinsot::simulate::{simulate, simulate_case, simulate_trial};
use poinsot_model::{FlexibleMode, JointKind, Mode, ModeEstimate, Model, SensorKind, read_model};
use poinsot_telemetry::{ReadOptions, Table, read};
use poinsot_testkit::compare::attitude_apart;
use poinsot_testkit::joint_plans::fourier;
use poinsot_testkit::momentum_sum::*;
use poinsot_testkit::trees::rotation_from_xyzw;
use poinsot_testkit::{Matrix3, Vector3};
use std::path::Path;
use std::time::{Duration, Instant};

fn load(name: &str) -> (Case, Model) {
    let case = read_case(&shipped().join("cases").join(name)).unwrap();
    let model = read_model(&case.model).unwrap();
    (case, model)
}

/// The vehicle with ideal sensors for all channels.
fn exact(mut model: Model) -> Model {
    model.sensors.clear();
    model
}

fn read_back(path: &Path) -> Table {
    let path = path.to_path_buf();
    read(&[path], &ReadOptions::default()).unwrap()
}

fn rows<const N: usize>(table: &Table, names: [&str; N]) -> Vec<[f64; N]> {
    let channels = names.map(|n| table.channel(n).unwrap_or_else(|| panic!("no {n}")));
    (0..channels[0].values.len())
        .map(|k| channels.map(|c| c.values[k]))
        .collect()
}

/// Largest differences of attitude and of the other common channels.
fn compare(ours: &Table, theirs: &Table) -> [f64; 2] {
    let q = ["q_x", "q_y", "q_z", "q_w"];
    let pairs = rows(ours, q).into_iter().zip(rows(theirs, q));
    let attitude = pairs
        .map(|(a, b)| attitude_apart(&rotation_from_xyzw(a), &rotation_from_xyzw(b)))
        .fold(0.0, f64::max);
    let mut other = 0.0_f64;
    let mut compared = 0;
    for c in theirs.channels.iter().filter(|c| !c.name.starts_with("q_")) {
        let Some(mine) = ours.channel(&c.name) else {
            continue;
        };
        assert_eq!(mine.values.len(), c.values.len(), "{}", c.name);
        let mut times = mine.time_s.iter().zip(c.time_s.iter());
        assert!(times.all(|(a, b)| (a - b).abs() < 1e-12), "{}", c.name);
        let pairs = mine.values.iter().zip(&c.values);
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-11, "{}: {worst:e}", c.name);
        other = other.max(worst);
        compared += 1;
    }
    assert!(compared > 9);
    [attitude, other]
}

#[test]
fn xval_mujoco_example_cases() {
    for (name, run, point) in [
        ("ma2008_traj1.toml", "ma2008/traj1", [0.0; 3]),
        ("xu2017_c1.toml", "xu2017/C1", [-0.30, 0.10, 0.25]),
    ] {
        let (case, mut model) = load(name);
        // The accelerometer of the recorded thruster run is not at the origin.
        let mut accelerometer = model.sensors.swap_remove(0);
        accelerometer.kind = SensorKind::Accelerometer;
        accelerometer.noise_covariance = None;
        accelerometer.p_BoS_B = point.into();
        model.sensors = vec![accelerometer];
        let ours = simulate_case(&without_sensors(case), &model).unwrap().table;
        let theirs = read_back(&shipped().join(run).join("telemetry.parquet"));
        let found = compare(&ours, &theirs);
        println!("{name}: attitude {:e} rad, others {:e}", found[0], found[1]);
        assert!(found[0] < 1e-11, "{found:?}");
    }
}

/// The recorded closed loops, with the controller named in their truth file.
#[test]
fn xval_basilisk_control_in_a_case() {
    for run in ["paper", "bias", "multiaxis"] {
        let folder = shipped().join("stsat3").join(run);
        let text = std::fs::read_to_string(folder.join("truth.json")).unwrap();
        let source = serde_json::from_str::<serde_json::Value>(&text).unwrap()["source"].clone();
        let theirs = read_back(&folder.join("telemetry.parquet"));
        let first = |name: &str| theirs.channel(name).unwrap().values[0];
        let q = ["q_x", "q_y", "q_z", "q_w"].map(first);
        let omega = ["omega_x", "omega_y", "omega_z"].map(first);
        let control = &source["controller"];
        let mut body = format!(
            "schema = \"poinsot.case/1\"\nmodel = \"stsat3_truth.toml\"\nduration_s = {}\n\
             [initial]\nq_xyzw = {q:?}\nomega_rad_s = {omega:?}\n\
             [control]\nproportional_N_m = {}\nderivative_N_m_s = {}\nperiod_s = 0.1\n",
            theirs.channel("q_x").unwrap().time_s.last().unwrap(),
            control["Kp"],
            control["Kd"],
        );
        for target in control["targets"].as_array().into_iter().flatten() {
            let (t, q) = (&target["t_s"], &target["q_xyzw"]);
            body += &format!("[[control.target]]\ntime_s = {t}\nq_xyzw = {q}\n");
        }
        for k in 1..=3 {
            let speed = first(&format!("wheel{k}_rad_s"));
            body += &format!(
                "[[control.wheel]]\nwheel = \"wheel{k}\"\ninitial_speed_rad_s = {speed:?}\n"
            );
        }
        body += "[output]\nrate_hz = 10\n";
        let case = parse_case(&shipped().join("cases/x.toml"), body).unwrap();
        let model = exact(read_model(&case.model).unwrap());
        let ours = simulate_case(&case, &model).unwrap();
        let names = [
            "q_x",
            "q_y",
            "q_z",
            "q_w",
            "omega_x",
            "omega_y",
            "omega_z",
            "wheel1_rad_s",
            "wheel2_rad_s",
            "wheel3_rad_s",
            "wheel1_Nm",
            "wheel2_Nm",
            "wheel3_Nm",
        ];
        let (ours_rows, mut theirs_rows) = (rows(&ours.table, names), rows(&theirs, names));
        assert_eq!(ours_rows.len(), theirs_rows.len());
        // The last recorded torque belongs to a period that was not simulated.
        theirs_rows.pop();
        for (k, (a, b)) in ours_rows.iter().zip(&theirs_rows).enumerate() {
            let sign = (0..4).map(|i| a[i] * b[i]).sum::<f64>().signum();
            for i in 0..names.len() {
                let theirs = if i < 4 { sign * b[i] } else { b[i] };
                assert!(
                    (a[i] - theirs).abs() < 1e-8,
                    "{run} row {k} {}: {} {theirs}",
                    names[i],
                    a[i]
                );
            }
        }
        assert!(!ours.truth.wheel_use["wheel1"].saturated);
    }
}

#[test]
fn unit_faults_of_a_controller_are_named() {
    let head = "schema = \"poinsot.case/1\"\nmodel = \"stsat3_truth.toml\"\nduration_s = 1.0\n";
    let tail = "[output]\nrate_hz = 10\n";
    let good = "[control]\nnatural_frequency_rad_s = 0.04\ndamping_ratio = 0.7\n";
    let wheel = "[[wheel_motion]]\nwheel = \"wheel1\"\ntime_s = [0.0]\nspeed_rad_s = [0.0]\n";
    for (body, parts) in [
        (
            "[control]\ndamping_ratio = 0.7\n".to_owned(),
            vec!["E0507", "two gains"],
        ),
        (format!("{good}period_s = 0.0\n"), vec!["E0505", "period_s"]),
        (
            format!("{good}drive = \"voltage\"\n"),
            vec!["E0507", "drive", "voltage"],
        ),
        (
            format!("{good}[[control.target]]\ntime_s = 0.0\nq_xyzw = [1.0, 1.0, 0.0, 0.0]\n"),
            vec!["E0505", "q_xyzw", "norm"],
        ),
        (
            format!("{good}[[control.wheel]]\nwheel = \"weel1\"\n"),
            vec!["E0504", "did you mean \"wheel1\"?"],
        ),
        (
            format!("{good}[[control.wheel]]\nwheel = \"wheel1\"\nmax_speed_rad_s = -1.0\n"),
            vec!["E0505", "control.wheel[0]"],
        ),
        (
            format!("{good}{wheel}"),
            vec!["E0507", "wheel_motion", "already drives"],
        ),
    ] {
        let case = parse_case(
            &shipped().join("cases/x.toml"),
            format!("{head}{body}{tail}"),
        );
        let bound = case.and_then(|case| case.bind(&read_model(&case.model).unwrap()));
        let text = bound.unwrap_err().to_string();
        for part in parts {
            assert!(text.contains(part), "{body}\n-> {text}\nlacks {part}");
        }
    }
    // Two wheels cannot control three axes.
    let case = parse_case(
        &shipped().join("cases/x.toml"),
        format!("{head}{good}{tail}"),
    )
    .unwrap();
    let mut model = read_model(&case.model).unwrap();
    model.wheels.pop();
    model.sensors.retain(|s| s.kind != SensorKind::WheelSpeed);
    let text = simulate_case(&case, &model).unwrap_err().to_string();
    assert!(
        text.contains("E0509") && text.contains("span 2 of 3 directions"),
        "{text}"
    );
}

fn kit(model: &Model) -> (Vec<KitBody>, Vec<KitWheel>) {
    let bodies = model.bodies.iter().map(|body| {
        let joint = body.joint.map(|j| &model.joints[j]);
        KitBody {
            parent: joint.map_or(0, |j| j.parent),
            joint: joint.map_or(KitJoint::Base, |j| match j.kind {
                JointKind::Revolute => KitJoint::Revolute,
                JointKind::Prismatic => KitJoint::Prismatic,
                JointKind::Fixed => KitJoint::Fixed,
            }),
            p_PoCo_P: joint.map_or(Vector3::zeros(), |j| j.p_PoCo_P),
            R_PC_zero: joint.map_or(Matrix3::identity(), |j| j.R_PC_zero),
            axis_C: joint.map_or(Vector3::z(), |j| j.axis_C),
            mass: body.nominal.mass,
            p_CoCcm_C: body.nominal.p_BoBcm_B,
            I_CCcm_C: body.nominal.I_BBcm_B,
        }
    });
    let wheels = model.wheels.iter().map(|w| KitWheel {
        host: w.body,
        axis_C: w.axis_B,
        spin_inertia: w.spin_inertia,
    });
    (bodies.collect(), wheels.collect())
}

/// Momentum by definition from every row of a table.
fn momenta(model: &Model, table: &Table) -> Vec<SystemMomentum> {
    let (bodies, wheels) = kit(model);
    let q = rows(table, ["q_x", "q_y", "q_z", "q_w"]);
    let r = rows(table, ["r_x", "r_y", "r_z"]);
    let v = rows(table, ["v_x", "v_y", "v_z"]);
    let w = rows(table, ["omega_x", "omega_y", "omega_z"]);
    let column = |name: String| &table.channel(&name).unwrap().values;
    let joints: Vec<_> = model
        .joints
        .iter()
        .map(|j| column(format!("{}_rad", j.name)))
        .collect();
    let rates: Vec<_> = model
        .joints
        .iter()
        .map(|j| column(format!("{}_rad_s", j.name)))
        .collect();
    let speeds: Vec<_> = model
        .wheels
        .iter()
        .map(|w| column(format!("{}_rad_s", w.name)))
        .collect();
    (0..q.len())
        .map(|k| {
            let R_NB = rotation_from_xyzw(q[k]);
            let state = KitState {
                R_NB,
                p_NBo_N: r[k].into(),
                v_NBo_B: R_NB.transpose() * Vector3::from(v[k]),
                w_NB_B: w[k].into(),
                q: joints.iter().map(|j| j[k]).collect(),
                qd: rates.iter().map(|j| j[k]).collect(),
                wheel_speeds: speeds.iter().map(|s| s[k]).collect(),
            };
            system_momentum(&bodies, &wheels, &state).unwrap()
        })
        .collect()
}

/// Largest relative change of the momenta, and largest deviation of the mass centre from its line, m.
fn conservation(model: &Model, table: &Table) -> [f64; 3] {
    let sums = momenta(model, table);
    let times = &table.channel("q_x").unwrap().time_s;
    let first = sums[0];
    let mut worst = [0.0_f64; 3];
    for (s, t) in sums.iter().zip(times.iter()) {
        let line = first.p_NScm_N + first.l_S_N / first.mass * *t;
        let now = [
            (s.l_S_N - first.l_S_N).norm() / first.scale_l.max(s.scale_l),
            (s.h_SScm_N - first.h_SScm_N).norm() / first.scale_h.max(s.scale_h),
            (s.p_NScm_N - line).norm(),
        ];
        for (worst, x) in worst.iter_mut().zip(now) {
            *worst = if x.is_nan() { x } else { worst.max(x) };
        }
    }
    worst
}

/// An example case at another rate, for a model without sensors.
fn altered(name: &str, from: &str, to: &str) -> Case {
    let path = shipped().join("cases").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from));
    let text = text
        .split("[[output.sensor]]")
        .next()
        .unwrap()
        .replace(from, to);
    parse_case(&path, text).unwrap()
}

#[test]
fn prop_written_telemetry_conserves_momentum_over_1e5_rows() {
    let folder = tempfile::tempdir().unwrap();
    for (name, from, to) in [
        ("ma2008_traj1.toml", "rate_hz = 20\n", "rate_hz = 750\n"),
        ("stsat3_spin.toml", "rate_hz = 10\n", "rate_hz = 900\n"),
    ] {
        let case = altered(name, from, to);
        let model = exact(read_model(&case.model).unwrap());
        let path = folder.path().join("telemetry.csv");
        let table = simulate_case(&case, &model).unwrap().table;
        poinsot_telemetry::write(&path, &table.channels).unwrap();
        let back = read_back(&path);
        let rows = back.channel("q_x").unwrap().values.len();
        assert!(rows > 100_000);
        let found = conservation(&model, &back);
        println!("{name}: {rows} rows; l, h relative, line m: {found:?}");
        assert!(
            found[0] < 1e-12 && found[1] < 1e-12 && found[2] < 1e-9,
            "{found:?}"
        );
    }
}

/// The case without its tables of sensors, for a model that has none.
fn without_sensors(case: Case) -> Case {
    let text = std::fs::read_to_string(case.path()).unwrap();
    let text = text.split("[[output.sensor]]").next().unwrap().to_owned();
    parse_case(case.path(), text).unwrap()
}

/// Three pieces of rows: firings that switch between rows and at the edge of a piece, a slow sensor, an increment without a
/// beginning, a sensor that is late and one that is early.
#[test]
fn exact_rows_written_in_pieces_are_those_of_the_whole_table() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| std::fs::read_to_string(shipped().join("cases").join(name)).unwrap();
    let sensor = "\n[[sensor]]\nname = \"dv\"\ntype = \"velocity_increment\"\nnoise_m_s = 1e-4\n";
    let model = read("tug_truth.toml") + sensor;
    std::fs::write(folder.path().join("tug_truth.toml"), model).unwrap();
    let edge = poinsot_telemetry::GROUP as f64;
    for (format, name) in [("csv", "telemetry.csv"), ("parquet", "telemetry.parquet")] {
        let case = read("tug_thrusters.toml")
            .replacen(
                "rate_hz = 10\n",
                &format!("rate_hz = 1250\nformat = \"{format}\"\n"),
                1,
            )
            .replacen("on_s = 2.0\n", "on_s = 2.00013\n", 1)
            .replacen(
                "on_s = 54.0\n",
                &format!("on_s = {}\n", (edge - 0.4) / 1250.0),
                1,
            )
            .replacen("bias_rad_s", "lag_s = 0.03\nbias_rad_s", 1);
        let late = "\n[[output.sensor]]\nname = \"dv\"\nrate_hz = 1\n[[output.sensor]]\nname = \"position\"\nlag_s = -0.02\n";
        let path = folder.path().join("case.toml");
        std::fs::write(&path, case + late).unwrap();
        let out = folder.path().join("out");
        let written = simulate(&path, &out).unwrap();
        assert!(written.rows > 2 * poinsot_telemetry::GROUP);
        let case = read_case(&path).unwrap();
        let table = simulate_case(&case, &read_model(&case.model).unwrap())
            .unwrap()
            .table;
        let whole = folder.path().join(name);
        poinsot_telemetry::write(&whole, &table.channels).unwrap();
        let bytes = |path: &Path| std::fs::read(path).unwrap();
        assert!(bytes(&whole) == bytes(&written.telemetry), "{format}");
    }
}

/// Each of its rows would take 10^16 steps.
#[test]
fn regress_a_torque_beyond_reason_ends_at_once() {
    let torque =
        "[[wheel_motion]]\nwheel = \"wheel1\"\ntime_s = [0.0]\ntorque_N_m = [1e30]\n\n[output]";
    let case = altered("stsat3_spin.toml", "[output]", torque);
    let text = std::fs::read_to_string(case.path()).unwrap();
    let others = text.find("[[wheel_motion]]").unwrap()..text.find("[output]").unwrap();
    let text = case.text().replacen(&text[others], "", 1);
    let rest = ["wheel2", "wheel3"].map(|wheel| {
        format!("\n[[wheel_motion]]\nwheel = \"{wheel}\"\ntime_s = [0.0]\nspeed_rad_s = [0.0]\n")
    });
    let case = parse_case(case.path(), text + &rest.concat()).unwrap();
    let model = exact(read_model(&case.model).unwrap());
    let started = Instant::now();
    let error = simulate_case(&case, &model).unwrap_err().to_string();
    assert!(error.starts_with("E0509 "), "{error}");
    assert!(
        error.contains("more than the allowed number of steps"),
        "{error}"
    );
    assert!(started.elapsed() < Duration::from_secs(5));
}

#[test]
fn exact_files_hold_what_memory_holds_and_repeat_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("deep/er");
    for name in ["ma2008_traj1.toml", "stsat3_spin.toml", "xu2017_c1.toml"] {
        let path = shipped().join("cases").join(name);
        let written = simulate(&path, &out).unwrap();
        let (case, model) = load(name);
        let mut memory = simulate_case(&case, &model).unwrap();
        let back = read_back(&written.telemetry);
        assert_eq!(back.channels.len(), memory.table.channels.len());
        for channel in &memory.table.channels {
            let found = back.sensor_channel(&channel.sensor, &channel.name).unwrap();
            // Reading normalises quaternions.
            let slack = if channel.name.starts_with("q_") {
                1e-15
            } else {
                0.0
            };
            let pairs = found.values.iter().zip(&channel.values);
            assert!(
                pairs.clone().all(|(a, b)| (a - b).abs() <= slack),
                "{}",
                channel.name
            );
            assert_eq!(found.time_s, channel.time_s, "{}", channel.name);
        }
        let bytes = std::fs::read(&written.telemetry).unwrap();
        // The file alone names the telemetry.
        let name = written.telemetry.file_name().unwrap().to_str().unwrap();
        let sum = poinsot_formats::sha256(&bytes);
        memory.truth.files.insert(name.to_owned(), sum);
        let text = std::fs::read_to_string(&written.truth).unwrap();
        // The file ends with the checksum of what memory holds.
        let truth = serde_json::to_string_pretty(&memory.truth).unwrap();
        let (content, seal) = text.rsplit_once(",\n  \"sha256\": \"").unwrap();
        assert_eq!(content, truth.strip_suffix("\n}").unwrap());
        assert_eq!(seal.len(), 64 + "\"\n}\n".len());
        let read = poinsot_formats::read_truth(&written.truth).unwrap();
        assert_eq!(read, memory.truth);
        let base = &model.bodies[0];
        assert_eq!(
            memory.truth.bodies[&base.name].mass.mass_kg.value,
            base.nominal.mass
        );
        let again = simulate(&path, &out).unwrap();
        assert_eq!(bytes, std::fs::read(&again.telemetry).unwrap());
    }
    // No other file is in the folder.
    let mut left: Vec<_> = std::fs::read_dir(&out)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["telemetry.csv", "telemetry.parquet", "truth.json"]);
}

#[test]
fn exact_truth_states_momentum_and_errors() {
    let (case, model) = load("ma2008_traj1.toml");
    let simulation = simulate_case(&case, &model).unwrap();
    let truth = &simulation.truth;
    let clean = simulate_case(&without_sensors(case), &exact(model.clone()))
        .unwrap()
        .table;
    let sums = momenta(&model, &clean);
    for k in 0..3 {
        let l = truth.momentum[0].linear_N_s.map(|n| n.value)[k];
        let h = truth.momentum[0].angular_N_m_s.map(|n| n.value)[k];
        assert!((l - sums[0].l_S_N[k]).abs() < 1e-12);
        assert!((h - sums[0].h_SScm_N[k]).abs() < 1e-12);
    }
    let bias = ["x", "y", "z"].map(|axis| truth.nuisance[&format!("gyro.bias_rad_s.{axis}")].value);
    assert_eq!(bias, [2e-5, -1.5e-5, 1e-5]);
    // The noise in the file is that of the model, about the bias of the case.
    let names = ["omega_x", "omega_y", "omega_z"];
    let pairs = rows(&simulation.table, names)
        .into_iter()
        .zip(rows(&clean, names));
    let errors: Vec<f64> = pairs.map(|(a, b)| a[0] - b[0]).collect();
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let sigma = (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / n).sqrt();
    assert!((mean - 2e-5).abs() < 5.0 * 1e-5 / n.sqrt(), "{mean:e}");
    assert!(
        (sigma / 1e-5 - 1.0).abs() < 5.0 / (2.0 * n).sqrt(),
        "{sigma:e}"
    );
}

#[test]
fn exact_a_mode_is_felt_and_stated() {
    let (case, mut model) = load("stsat3_spin.toml");
    let case = without_sensors(case);
    let rigid = simulate_case(&case, &exact(model.clone())).unwrap();
    model.modes.push(FlexibleMode {
        name: "panel".into(),
        mode: Mode {
            body: 0,
            frequency_Hz: 0.3,
            damping_ratio: 0.01,
            translation: [0.5, 0.0, 0.0].into(),
            rotation: [0.2, 0.3, -0.4].into(),
            inertia_slope: Matrix3::zeros(),
        },
        estimate: ModeEstimate::default(),
    });
    let flexible = simulate_case(&case, &exact(model)).unwrap();
    let rates = |table: &Table| rows(table, ["omega_x", "omega_y", "omega_z"]);
    let (a, b) = (rates(&rigid.table), rates(&flexible.table));
    let apart = |k: usize| {
        (0..3)
            .map(|i| (a[k][i] - b[k][i]).abs())
            .fold(0.0, f64::max)
    };
    assert!(apart(0) < 1e-15, "{:e}", apart(0));
    assert!(apart(a.len() - 1) > 1e-9, "{:e}", apart(a.len() - 1));
    let stated = |address: &str| flexible.truth.nuisance[address].value;
    assert_eq!(stated("panel.frequency_Hz"), 0.3);
    assert_eq!(stated("panel.damping_ratio"), 0.01);
    assert_eq!(stated("panel.rotation_kg05_m.z"), -0.4);
}

#[test]
fn exact_trials_differ_in_noise_only() {
    let (case, model) = load("stsat3_spin.toml");
    let trial = |k| simulate_trial(&case, &model, k).unwrap();
    let (a, b, again) = (trial(1), trial(2), trial(1));
    assert_eq!(a.table, again.table);
    let gyro =
        |s: &poinsot::simulate::Simulation| s.table.channel("omega_x").unwrap().values.clone();
    assert_ne!(gyro(&a), gyro(&b));
    let exact = |s: &poinsot::simulate::Simulation| s.table.channel("r_x").unwrap().values.clone();
    assert_eq!(exact(&a), exact(&b));
    // The star tracker has its own rate; its columns are empty in other rows.
    let tracker = a.table.channel("q_w").unwrap();
    assert_eq!(tracker.values.len(), 241);
    assert_eq!(tracker.time_s[1], 0.5);
}

#[test]
fn exact_two_sensors_of_one_type_carry_their_names() {
    let (case, mut model) = load("stsat3_spin.toml");
    let mut second = model.sensors[0].clone();
    second.name = "gyro2".into();
    model.sensors.push(second);
    let mut increments = model.sensors[0].clone();
    increments.name = "dv".into();
    increments.kind = SensorKind::VelocityIncrement;
    increments.noise_covariance = None;
    increments.p_BoS_B = Vector3::new(0.5, 0.0, 0.0);
    model.sensors.push(increments);
    let table = simulate_case(&case, &model).unwrap().table;
    assert!(table.sensor_channel("", "omega_x").is_none());
    let a = table.sensor_channel("gyro", "omega_x").unwrap();
    let b = table.sensor_channel("gyro2", "omega_x").unwrap();
    assert_ne!(a.values, b.values);
    let dv = table.channel("dv_x").unwrap();
    assert_eq!(dv.values.len() + 1, a.values.len());
    assert_eq!(dv.time_s[0], a.time_s[1]);
    // The increments sum to the change of velocity: at most twice the point's speed.
    let sum: f64 = dv.values.iter().sum();
    assert!(sum.abs() < 2.0 * 0.5 * 0.1 && sum != 0.0, "{sum}");
}

#[test]
fn exact_harmonics_of_a_case_reach_the_channels() {
    let text = format!(
        "{HEAD}{}{TAIL}",
        "[[joint_motion]]\njoint = \"joint2\"\ninterpolation = \"fourier\"\n\
         base_frequency_hz = 0.25\noffset_rad = 0.3\nsine_rad = [0.1, -0.2]\ncosine_rad = [0.0, 0.05]\n"
    );
    let case = parse_case(&shipped().join("cases/test.toml"), text).unwrap();
    let model = exact(read_model(&case.model).unwrap());
    let table = simulate_case(&case, &model).unwrap().table;
    let names = ["joint2_rad", "joint2_rad_s", "joint2_rad_s2"];
    let times = &table.channel("joint2_rad").unwrap().time_s;
    assert_eq!(times.len(), 11);
    for (found, t) in rows(&table, names).into_iter().zip(times.iter()) {
        let terms = [[0.1, 0.0], [-0.2, 0.05]];
        let plan = fourier(0.3, 0.25 * std::f64::consts::TAU, &terms, *t);
        for (a, b) in found
            .into_iter()
            .zip([plan.position, plan.rate, plan.acceleration])
        {
            assert!((a - b).abs() < 1e-14, "{t}: {a} {b}");
        }
    }
}

const HEAD: &str = "schema = \"poinsot.case/1\"\nmodel = \"ma2008_truth.toml\"\nduration_s = 1.0\n";
const TAIL: &str = "\n[output]\nrate_hz = 10\n";

/// Faults of a case: one line per fault.
fn fault(head: &str, body: &str, tail: &str) -> String {
    let path = shipped().join("cases/test.toml");
    let parsed = parse_case(&path, format!("{head}{body}{tail}"));
    let model = read_model(shipped().join("cases/ma2008_truth.toml")).unwrap();
    match parsed.and_then(|case| case.bind(&model)) {
        Ok(_) => "accepted".into(),
        Err(e) => {
            let text = e.to_string();
            text.replace(&path.display().to_string(), "test.toml")
        }
    }
}

#[test]
fn unit_faults_name_line_key_and_remedy() {
    let joint = |rest: &str| format!("[[joint_motion]]\njoint = \"joint1\"\n{rest}");
    for (body, parts) in [
        (
            joint(
                "interpolation = \"quintic_rest\"\ntime_s = [0, 1, 1]\nposition_rad = [0.0, 1.0, 2.0]",
            ),
            vec!["E0506", ":7:", "joint_motion[0].time_s", "time of node 2"],
        ),
        (
            joint("interpolation = \"quintic_rest\"\ntime_s = [0, 1]\nposition_rad = [0.0]"),
            vec!["E0506", "2 times but 1 values"],
        ),
        (
            joint("interpolation = \"quintic_rest\"\ntime_s = [0, 1]\nposition_m = [0.0, 1.0]"),
            vec!["E0507", ":8:", "_rad"],
        ),
        (
            joint("interpolation = \"quintic\"\ntime_s = [0, 1]\nposition_rad = [0.0, 1.0]"),
            vec!["E0507", ":6:", "did you mean \"quintic_rest\"?"],
        ),
        (
            joint("interpolation = \"fourier\"\nsine_rad = [0.1]"),
            vec!["E0502", "base_frequency_hz"],
        ),
        (
            joint("interpolation = \"fourier\"\nbase_frequency_hz = -0.1\nsine_rad = [0.1]"),
            vec!["E0505", "base_frequency_hz"],
        ),
        (
            "[[joint_motion]]\njoint = \"jiont1\"\ninterpolation = \"fourier\"\nbase_frequency_hz = 0.1\n".to_owned(),
            vec!["E0504", ":5:", "did you mean \"joint1\"?"],
        ),
        (
            "[[wheel_motion]]\nwheel = \"w\"\ntime_s = [0]\nspeed_rad_s = [1.0]".to_owned(),
            vec!["E0504", ":5:", "remove it: it does not exist here"],
        ),
        (
            "[[firing]]\nthruster = \"thr1\"\non_s = 3.0\noff_s = 2.0\nforce_N = 1.0".to_owned(),
            vec!["E0505", "firing[0].off_s", ":7:"],
        ),
        (
            "[[firing]]\nthruster = \"thr1\"\non_s = 1.0\noff_s = 2.0\nforce_N = -1.0".to_owned(),
            vec!["E0505", "firing[0].force_N", ":8:"],
        ),
        (
            "[initial]\nomega_rad_s = [0, 0, 0.1]\nmomentum_zero = true".to_owned(),
            vec!["E0507", "initial", "twice"],
        ),
        (
            "[initial]\nq_xyzw = [0.0, 0.0, 0.0, 0.5]".to_owned(),
            vec!["E0505", "initial.q_xyzw", "norm 0.5"],
        ),
        (
            "[initial]\nomega_rad_s = [0.0, nan, 0.1]".to_owned(),
            vec!["E0505", "initial.omega_rad_s"],
        ),
        ("[control]\nkp = 1.0".to_owned(), vec!["E0502", ":5:", "kp"]),
        (
            "[[joint_torque]]\njoint = \"joint1\"\nconstant = 1.0".to_owned(),
            vec!["E0502", ":6:", "constant", "constant_N"],
        ),
        (
            "[initial]\nomega_rads = [0, 0, 0.1]".to_owned(),
            vec![
                "E0502",
                ":5:",
                "omega_rads",
                "did you mean omega_rad_s?",
            ],
        ),
    ] {
        let text = fault(HEAD, &body, TAIL);
        for part in parts {
            assert!(text.contains(part), "{body}\n-> {text}\nlacks {part}");
        }
    }
    for (tail, parts) in [
        ("\n[output]\nrate_hz = 0\n", vec!["E0505", "output.rate_hz"]),
        ("\n[output]\nrate_hz = 1e12\n", vec!["E0006", "rows"]),
        (
            "\n[output]\nrate_hz = 10\nformat = \"hdf5\"\n",
            vec!["E0502", "hdf5"],
        ),
        (
            "\n[output]\nrate_hz = 10\n[[output.sensor]]\nname = \"gyro\"\nrate_hz = 3\n",
            vec!["E0505", "output.sensor[0].rate_hz"],
        ),
        (
            "\n[output]\nrate_hz = 10\n[[output.sensor]]\nname = \"gyro\"\nbias_m = [1, 2, 3]\n",
            vec!["E0507", "bias_rad_s"],
        ),
        (
            "\n[output]\nrate_hz = 10\n[[output.sensor]]\nname = \"gyr\"\n",
            vec!["E0504", "did you mean \"gyro\"?"],
        ),
        ("", vec!["E0502", "output"]),
    ] {
        let text = fault(HEAD, "", tail);
        for part in parts {
            assert!(text.contains(part), "{tail}\n-> {text}\nlacks {part}");
        }
    }
    assert!(
        fault(
            "schema = \"poinsot.case/9\"\nmodel = \"m\"\nduration_s = 1\n",
            "",
            TAIL
        )
        .contains("E0503")
    );
    assert_eq!(fault(HEAD, "", TAIL), "accepted");
}

#[test]
fn unit_a_wheel_without_motion_is_refused() {
    let path = shipped().join("cases/test.toml");
    let case = parse_case(&path, format!("{HEAD}{TAIL}")).unwrap();
    let model = read_model(shipped().join("cases/stsat3_truth.toml")).unwrap();
    let text = case.bind(&model).unwrap_err().to_string();
    assert_eq!(text.lines().count(), 3);
    assert!(
        text.contains("the case does not prescribe wheel \"wheel1\""),
        "{text}"
    );
}

#[test]
fn unit_failure_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let case = folder.path().join("case.toml");
    std::fs::write(&case, format!("{HEAD}{TAIL}")).unwrap();
    let error = simulate(&case, &out).unwrap_err();
    assert_eq!(error.kind(), poinsot::ErrorKind::Input);
    assert!(!out.exists());
    let missing = simulate(&folder.path().join("none.toml"), &out).unwrap_err();
    assert!(missing.to_string().contains("E0501"), "{missing}");
    // A file in place of the folder.
    std::fs::write(&out, "").unwrap();
    let blocked = simulate(&shipped().join("cases/stsat3_spin.toml"), &out).unwrap_err();
    assert_eq!(blocked.kind(), poinsot::ErrorKind::System, "{blocked}");
}

/// `sensors_only` omits what an experiment does not measure: the motion. Commands are known.
#[test]
fn regress_commands_are_written_beside_sensors() {
    let text = std::fs::read_to_string(shipped().join("cases/tug_thrusters.toml")).unwrap();
    let text = text.replace("[output]\n", "[output]\nsensors_only = true\n");
    let case = parse_case(&shipped().join("cases/x.toml"), text).unwrap();
    let model = read_model(&case.model).unwrap();
    let table = simulate_case(&case, &model).unwrap().table;
    assert!(table.channel("thr12_N").is_some() && table.channel("acc_x").is_none());
    let whole = poinsot::predict::predict(&shipped().join("cases/tug_thrusters.toml"), 1.0);
    let only = poinsot::predict::predict_case(&case, model, 1.0).unwrap();
    let whole = whole.unwrap();
    assert_eq!(only.bound.identifiability.rank, 10);
    assert_eq!(only.bound.covariance, whole.bound.covariance);
    // Motor torques are commands; the motion they cause is not.
    for (name, there, absent) in [
        (
            "hinged_panel.toml",
            vec!["wheel1_Nm"],
            vec!["hinge_rad", "domega_x"],
        ),
        ("stsat3_kim2010.toml", vec![], vec!["wheel1_Nm", "acc_x"]),
    ] {
        let (case, model) = load(name);
        let table = simulate_case(&case, &model).unwrap().table;
        assert!(there.iter().all(|c| table.channel(c).is_some()), "{name}");
        assert!(absent.iter().all(|c| table.channel(c).is_none()), "{name}");
    }
}

/// A firing that starts and ends between two rows is written with its own times: the impulse of the record is exact.
#[test]
fn exact_a_firing_between_rows_keeps_its_times() {
    let (on, off) = (2.031, 7.987);
    let case = altered(
        "tug_thrusters.toml",
        "on_s = 2.0\noff_s = 8.0",
        &format!("on_s = {on}\noff_s = {off}"),
    );
    let model = read_model(&case.model).unwrap();
    let table = simulate_case(&case, &model).unwrap().table;
    let thrust = table.channel("thr1_N").unwrap();
    let held = thrust.time_s.windows(2).zip(&thrust.values);
    let impulse: f64 = held.map(|(t, force)| force * (t[1] - t[0])).sum();
    // The second firing of the thruster lasts 6 s.
    assert!(
        (impulse - 10.0 * (off - on + 6.0)).abs() < 1e-9,
        "{impulse}"
    );
    assert_eq!(thrust.time_s.len(), case.times().count() + 2);
    let others = table.channel("thr2_N").unwrap();
    assert_eq!(others.time_s.len(), case.times().count());
}

/// The impulse of the record is exact where a switch is at a row but for round-off: row 355 of 50 in 3 s is 4e-15 s before
/// 21.3 s.
#[test]
fn exact_a_switch_at_a_row_is_done_there() {
    for row in (45..400).step_by(31).chain([355]) {
        let off = f64::from(6 * row) / 100.0;
        let firing = format!("on_s = 2.1\noff_s = {off}");
        let mut case = altered("tug_thrusters.toml", "on_s = 2.0\noff_s = 8.0", &firing);
        case.rate_hz = 50.0 / 3.0;
        let model = read_model(&case.model).unwrap();
        let table = simulate_case(&case, &model).unwrap().table;
        let thrust = table.channel("thr1_N").unwrap();
        let held = thrust.time_s.windows(2).zip(&thrust.values);
        let impulse: f64 = held.map(|(t, force)| force * (t[1] - t[0])).sum();
        let expected = 10.0 * (off - 2.1 + 6.0);
        assert!(
            (impulse - expected).abs() < 1e-9,
            "{row}: {impulse} {expected}"
        );
    }
}

/// Wheel speeds and torques from a file give the same motion as the same table in the case.
#[test]
fn exact_wheel_profiles_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("wheels.csv"),
        "time_s,wheel1_rad_s,spin_Nm\n0,10,0.002\n4,40,-0.001\n9,-20,0.0\n",
    )
    .unwrap();
    let model = shipped()
        .join("cases/stsat3_truth.toml")
        .canonicalize()
        .unwrap();
    let case = |first: &str, second: &str| {
        let text = format!(
            "schema = \"poinsot.case/2\"\nmodel = {model:?}\nduration_s = 10.0\n\
             [initial]\nomega_rad_s = [0.01, 0.0, -0.02]\n\
             [[wheel_motion]]\nwheel = \"wheel1\"\n{first}\n\
             [[wheel_motion]]\nwheel = \"wheel2\"\n{second}\n\
             [[wheel_motion]]\nwheel = \"wheel3\"\ntime_s = [0.0]\nspeed_rad_s = [0.0]\n\
             [output]\nrate_hz = 10\n"
        );
        parse_case(&folder.path().join("case.toml"), text).unwrap()
    };
    let table = |case: &Case| {
        let model = exact(read_model(&case.model).unwrap());
        simulate_case(case, &model).unwrap().table
    };
    let from_file = case(
        "file = \"wheels.csv\"",
        "file = \"wheels.csv\"\ncolumn = \"spin_Nm\"\ninitial_speed_rad_s = 5.0",
    );
    let written = case(
        "time_s = [0.0, 4.0, 9.0]\nspeed_rad_s = [10.0, 40.0, -20.0]",
        "time_s = [0.0, 4.0, 9.0]\ntorque_N_m = [0.002, -0.001, 0.0]\ninitial_speed_rad_s = 5.0",
    );
    assert_eq!(table(&from_file).channels, table(&written).channels);
    assert_eq!(from_file.inputs_sha256().unwrap().len(), 2);
    let wrong = case(
        "file = \"wheels.csv\"\ncolumn = \"wheel9_rad_s\"",
        "file = \"none.csv\"",
    );
    let text = wrong
        .bind(&read_model(&model).unwrap())
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("E0511") && text.contains("did you mean \"wheel1_rad_s\"?"),
        "{text}"
    );
}

/// Feedback by wheels holds the attitude under thrust and in a gravity field.
#[test]
fn prop_control_holds_against_thrust_and_gravity() {
    let (case, _) = load("stsat3_kim2010.toml");
    let firing = "[[firing]]\nthruster = \"thr1\"\non_s = 100.0\noff_s = 110.0\nforce_N = 0.01\n";
    let text = case
        .text()
        .replace("[output]", &format!("{firing}\n[output]"));
    let text = text.replace("drive = \"acceleration\"", "drive = \"torque\"");
    let text = text.replace("sensors_only = true", "");
    let case = parse_case(case.path(), text).unwrap();
    let source = std::fs::read_to_string(&case.model).unwrap();
    let source = format!(
        "{source}\n[[thruster]]\nname = \"thr1\"\nbody = \"spacecraft\"\nposition_m = [0.5, 0.0, 0.0]\n\
         force_direction = [0.0, 1.0, 0.0]\n[environment]\ngravity = \"point_mass\"\ngm_m3_s2 = 3.986004418e14\n\
         gravity_gradient = true\norbit = {{ semi_major_axis_m = 7e6 }}\n"
    );
    let model = poinsot_model::parse_model(&source, "m.toml").unwrap();
    let table = simulate_case(&case, &model).unwrap().table;
    let thrust = table.channel("thr1_N").unwrap();
    assert_eq!(thrust.values.iter().filter(|f| **f > 0.0).count(), 100);
    let whole = simulate_case(&case, &exact(model)).unwrap().table;
    let last = *rows(&whole, ["q_x", "q_y", "q_z"]).last().unwrap();
    assert!(last.iter().all(|q| q.abs() < 0.02), "{last:?}");
    assert!(whole.channel("orbit_x").is_some());
}
