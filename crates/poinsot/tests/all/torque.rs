//! Joints driven by torques and springs: from the case file to telemetry and identification.

use crate::shared::shipped;
use poinsot::case::{Case, parse_case, read_case};
use poinsot::predict::predict_case;
use poinsot::simulate::simulate_case;
use poinsot::{Identified, Modes, Question, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{Model, parse_model, read_model};
use poinsot_telemetry::{Channel, Table};
use poinsot_testkit::vehicles::ModelText;
use poinsot_testkit::{Matrix3, Vector3};
use std::path::Path;

fn load(name: &str) -> (Case, Model) {
    let case = read_case(&shipped().join("cases").join(name)).unwrap();
    let model = read_model(&case.model).unwrap();
    (case, model)
}

/// A bus with a hinged arm, a sliding mass on a spring, a rod that spins about its axis, and a plate.
fn text() -> String {
    let z = "axis = [0.0, 0.0, 1.0]";
    let spring =
        "axis = [0.0, 1.0, 0.0]\nspring_damper = { stiffness_N_per_m = 20.0, rest_m = 0.125 }";
    let moments = |xx, yy, zz| [xx, yy, zz, 0.0, 0.0, 0.0];
    let bus = [10.0, 12.0, 9.0, 0.3, 0.0, 0.0];
    ModelText::new("m")
        .body("bus", 100.0, [0.0, 0.0, 0.1], bus, "")
        .body("arm", 8.0, [0.5, 0.0, 0.0], moments(0.1, 0.7, 0.7), "")
        .body("tank", 5.0, [0.0; 3], moments(0.2, 0.2, 0.2), "")
        .body("plate", 1.0, [0.0; 3], moments(0.1, 0.1, 0.1), "")
        .body("rod", 1.0, [0.0, 0.0, 0.5], moments(0.1, 0.1, 0.0), "")
        .joint(
            ("elbow", "revolute"),
            ["bus", "arm"],
            [0.5, 0.0, 0.0],
            &format!("{z}\nlocked_at_rad = 0.25"),
        )
        .joint(
            ("slide", "prismatic"),
            ["bus", "tank"],
            [0.0, 0.4, 0.0],
            spring,
        )
        .joint(("bolt", "fixed"), ["bus", "plate"], [0.0, 0.0, 0.5], "")
        .joint(("twist", "revolute"), ["bus", "rod"], [0.0, 0.0, -0.5], z)
        .text()
}

const HEAD: &str = "schema = \"poinsot.case/1\"\nmodel = \"m.toml\"\nduration_s = 2.0\n";
const TAIL: &str = "\n[output]\nrate_hz = 100\n";

fn model() -> Model {
    parse_model(&text(), "m.toml").unwrap()
}

fn case(body: &str) -> Case {
    parse_case(Path::new("case.toml"), format!("{HEAD}{body}{TAIL}")).unwrap()
}

fn column<'t>(table: &'t Table, name: &str) -> &'t [f64] {
    let found = table.channel(name);
    &found.unwrap_or_else(|| panic!("no {name}")).values
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// A tank on a spring in a free bus: one oscillator of the reduced mass, without rotation. Its line of motion passes
/// through no mass centre, so the relative motion of a vehicle that cannot rotate is tested.
#[test]
fn exact_a_sliding_mass_oscillates_with_the_reduced_mass() {
    let mut model = model();
    // All mass centres are on the line of the slide: no rotation.
    for body in &mut model.bodies {
        body.nominal.p_BoBcm_B = Default::default();
    }
    model.joints[0].p_PoCo_P = Default::default();
    model.joints[1].p_PoCo_P = Default::default();
    model.joints[2].p_PoCo_P = Default::default();
    model.joints[3].p_PoCo_P = Default::default();
    let case = case("[[initial.joint]]\njoint = \"slide\"\nposition_m = 0.225\nrate_m_s = 0.0\n");
    let simulation = simulate_case(&case, &model).unwrap();
    let table = simulation.table;
    let omega = (20.0_f64 * (1.0 / 5.0 + 1.0 / 110.0)).sqrt();
    let q = column(&table, "slide_m");
    let time = &table.channel("slide_m").unwrap().time_s;
    for (t, q) in time.iter().zip(q) {
        let expected = 0.125 + 0.1 * (omega * t).cos();
        assert!((q - expected).abs() < 1e-12, "{t}: {:e}", q - expected);
    }
    // The bus moves by its share, and a passive joint has no motor channel.
    let bus = column(&table, "r_y");
    for (r, q) in bus.iter().zip(q) {
        assert!((r + 5.0 / 115.0 * (q - 0.225)).abs() < 1e-12);
    }
    assert!(table.channel("slide_N").is_none());
    let start = serde_json::to_value(&simulation.truth.initial).unwrap();
    assert_eq!(start["joints"]["slide"]["position_m"], 0.225);
    assert_eq!(start["joints"]["elbow"]["position_rad"], 0.25);
}

#[test]
fn exact_a_spring_that_nothing_disturbs_rests() {
    let table = simulate_case(&case(""), &model()).unwrap().table;
    assert_eq!(apart(column(&table, "slide_m"), &vec![0.125; 201]), 0.0);
    assert_eq!(apart(column(&table, "elbow_rad"), &vec![0.25; 201]), 0.0);
}

/// The torque of a prescribed Fourier motion of the elbow, applied as a constant, a table or a file.
#[test]
fn exact_the_torque_that_a_motion_takes_gives_the_motion_back() {
    let led = "[[joint_motion]]\njoint = \"elbow\"\ninterpolation = \"fourier\"\nbase_frequency_hz = 0.5\n\
               sine_rad = [0.2, 0.05]\n";
    let model = model();
    let fast = |body: &str, path: &Path| {
        let text = format!("{HEAD}{body}\n[output]\nrate_hz = 2000\n");
        simulate_case(&parse_case(path, text).unwrap(), &model)
            .unwrap()
            .table
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    let first = fast(led, &path);
    let torque = first.channel("elbow_Nm").unwrap().clone();
    let largest = torque.values.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    assert!(largest > 1.0, "{largest}");
    let start = (
        column(&first, "elbow_rad")[0],
        column(&first, "elbow_rad_s")[0],
    );
    let initial = format!(
        "[[initial.joint]]\njoint = \"elbow\"\nposition_rad = {:?}\nrate_rad_s = {:?}\n",
        start.0, start.1
    );
    // The base starts with its rotation opposite to the elbow.
    let first_of = |name: &str| column(&first, name)[0];
    let base = format!(
        "[initial]\nomega_rad_s = {:?}\nv_m_s = {:?}\n",
        ["omega_x", "omega_y", "omega_z"].map(first_of),
        ["v_x", "v_y", "v_z"].map(first_of)
    );
    let own = Channel {
        name: "elbow_Nm".into(),
        ..torque.clone()
    };
    poinsot_telemetry::write(&folder.path().join("torque.csv"), &[own]).unwrap();
    let as_file =
        "[[joint_torque]]\njoint = \"elbow\"\nfile = \"torque.csv\"\ninterpolation = \"linear\"\n";
    let as_table = format!(
        "[[joint_torque]]\njoint = \"elbow\"\ntime_s = {:?}\ntorque_N_m = {:?}\ninterpolation = \"linear\"\n",
        torque.time_s, torque.values
    );
    for torques in [as_file, &as_table] {
        let again = fast(&format!("{base}{initial}{torques}"), &path);
        for name in ["elbow_rad", "omega_z", "slide_m", "q_z", "r_x"] {
            let off = apart(column(&again, name), column(&first, name));
            println!("{name} {off:.1e}");
            // Linear interpolation between samples of 0.5 ms; measured: 7.4e-7.
            assert!(off < 3e-6, "{name}: {off:e}");
        }
    }
    // Zero-order hold is first order.
    let held = fast(
        &format!(
            "{base}{initial}{}",
            as_file.replace("\"linear\"", "\"constant\"")
        ),
        &path,
    );
    let off = apart(column(&held, "elbow_rad"), column(&first, "elbow_rad"));
    println!("held {off:.1e}");
    assert!((1e-5..1e-2).contains(&off), "{off:e}");
}

/// Each motor form against the same torque as a sinusoid or table.
#[test]
fn exact_forms_of_a_motor_agree() {
    let model = model();
    let run = |motor: &str| {
        let body = format!("[[joint_torque]]\njoint = \"elbow\"\n{motor}\n");
        simulate_case(&case(&body), &model).unwrap().table
    };
    let constant = run("constant_N_m = 0.5");
    let forms = [
        "amplitude_N_m = 0.5\nfrequency_rad_s = 0.0\nphase_rad = 1.5707963267948966",
        "time_s = [0.0, 1.0]\ntorque_N_m = [0.5, 0.5]",
        "time_s = [0.0]\ntorque_N_m = [0.5]\ninterpolation = \"constant\"",
    ];
    for form in forms {
        let other = run(form);
        for name in ["elbow_rad", "omega_z", "elbow_Nm"] {
            assert!(
                apart(column(&constant, name), column(&other, name)) < 1e-12,
                "{form} {name}"
            );
        }
    }
    // Before its first node a table is zero.
    let late = run("time_s = [1.0]\ntorque_N_m = [0.5]");
    assert_eq!(column(&late, "elbow_rad")[100], 0.25);
    assert!(column(&late, "elbow_rad")[200] > 0.26);
    assert_eq!(column(&late, "elbow_Nm")[..100], [0.0; 100]);
}

/// Frequency of a hinge with spring in a free vehicle: kinetic energy with both momenta zero.
fn free_frequency_hz(model: &Model, joint: &str) -> f64 {
    let joint = &model.joints[model.joint(joint).unwrap()];
    let to_kit = |m: &[f64]| Vector3::new(m[0], m[1], m[2]);
    let (bus, own) = (&model.bodies[0].nominal, &model.bodies[joint.child].nominal);
    let u = to_kit(joint.axis_C.as_slice());
    let d = to_kit(own.p_BoBcm_B.as_slice());
    let r_p = to_kit(joint.p_PoCo_P.as_slice()) + d;
    let r_b = to_kit(bus.p_BoBcm_B.as_slice());
    let tensor = |m: &[f64]| Matrix3::from_column_slice(m);
    let (I_b, I_p) = (
        tensor(bus.I_BBcm_B.as_slice()),
        tensor(own.I_BBcm_B.as_slice()),
    );
    let M = bus.mass + own.mass;
    let c = (r_b * bus.mass + r_p * own.mass) / M;
    let about = |I: Matrix3, m: f64, r: Vector3| {
        I + (Matrix3::identity() * r.dot(&r) - r * r.transpose()) * m
    };
    let I_S = about(I_b, bus.mass, r_b - c) + about(I_p, own.mass, r_p - c);
    let p = u.cross(&d) * own.mass;
    let h = I_p * u + (r_p - c).cross(&p);
    let J = u.dot(&(I_p * u)) + own.mass * u.cross(&d).norm_squared() - p.norm_squared() / M;
    let J = J - h.dot(&(I_S.try_inverse().unwrap() * h));
    (joint.spring_damper.unwrap().stiffness / J).sqrt() / std::f64::consts::TAU
}

/// The answer of a vehicle that stays rigid.
fn identify(table: Table) -> Identified {
    let model = read_model(shipped().join("cases/rigid_bus.toml")).unwrap();
    let request = Question {
        modes: Modes::None,
        ..Question::default()
    };
    identify_tables(model, vec![table], &request).unwrap()
}

/// Without modes, slosh or flexibility that is not modelled rejects the rigid model, by a spectral line at the closed-form frequency.
#[test]
fn exact_a_hidden_oscillator_is_rejected_by_its_line() {
    for (name, joint) in [("slosh.toml", "slosh"), ("hinged_panel.toml", "hinge")] {
        let (case, model) = load(name);
        let expected = free_frequency_hz(&model, joint);
        let answer = identify(simulate_case(&case, &model).unwrap().table);
        let e = &answer.estimate;
        assert_eq!(e.status, Status::Rejected, "{name}: {:?}", e.warnings());
        assert!(!e.covariance_trustworthy(), "{name}");
        assert!(
            e.bodies[0].inertia.iter().all(|n| n.value.is_none()),
            "{name}"
        );
        assert!(!answer.passes());
        let rejected = e
            .warnings()
            .iter()
            .any(|w| w.starts_with("rigid model rejected"));
        assert!(rejected, "{name}: {:?}", e.warnings());
        let line = e
            .warnings()
            .iter()
            .find_map(|w| w.split("a spectral line at ").nth(1));
        let found: f64 = line.unwrap().split(' ').next().unwrap().parse().unwrap();
        println!("{name}: {found} Hz, closed form {expected:.4} Hz");
        // 200 s resolve 0.005 Hz.
        assert!(
            (found - expected).abs() < 0.006,
            "{name}: {found} {expected}"
        );
    }
}

/// With a locked hinge the vehicle is rigid, and the model is not rejected.
#[test]
fn exact_a_locked_hinge_is_not_rejected() {
    let (case, mut model) = load("slosh.toml");
    model.joints[0].spring_damper = None;
    let answer = identify(simulate_case(&case, &model).unwrap().table);
    let e = &answer.estimate;
    assert_eq!(e.status, Status::Converged, "{:?}", e.warnings());
    assert!(e.covariance_trustworthy());
}

/// The oscillation itself: the angle in the exact motion crosses its mean at the closed-form frequency.
#[test]
fn exact_a_free_pendulum_swings_at_the_closed_form() {
    for (name, joint) in [("slosh.toml", "slosh"), ("hinged_panel.toml", "hinge")] {
        let (case, mut model) = load(name);
        let expected = free_frequency_hz(&model, joint);
        model.sensors.clear();
        let text = std::fs::read_to_string(case.path()).unwrap();
        let text = text.replace("sensors_only = true", "");
        let case = parse_case(case.path(), text).unwrap();
        let table = simulate_case(&case, &model).unwrap().table;
        let angle = table.channel(&format!("{joint}_rad")).unwrap();
        let passages: Vec<f64> = angle
            .time_s
            .windows(2)
            .zip(angle.values.windows(2))
            .filter(|(t, q)| t[0] > 176.0 && q[0] < 0.0 && q[1] >= 0.0)
            .map(|(t, q)| t[0] - (t[1] - t[0]) * q[0] / (q[1] - q[0]))
            .collect();
        let turns = (passages.len() - 1) as f64;
        let found = turns / (passages[passages.len() - 1] - passages[0]);
        println!("{name}: {found:.5} Hz, closed form {expected:.5} Hz");
        assert!(
            (found / expected - 1.0).abs() < 2e-3,
            "{name}: {found} {expected}"
        );
    }
}

#[test]
fn unit_predict_refuses_a_joint_that_nothing_reads() {
    let (case, model) = load("slosh.toml");
    let text = std::fs::read_to_string(case.path()).unwrap();
    let motor = "\n[[joint_torque]]\njoint = \"slosh\"\nconstant_N_m = 0.001\n";
    let case = poinsot::case::parse_case(case.path(), text + motor).unwrap();
    let error = predict_case(&case, model, 1.0).err().unwrap();
    assert_eq!(error.kind(), poinsot::ErrorKind::Input);
    assert_eq!(
        error.to_string(),
        "E0305 model: joint 'slosh' moves by torque or spring, but no sensor measures it; add [[sensor]] type = \"joint_position\" for it, or prescribe it with [[joint_motion]]"
    );
}

#[test]
fn unit_a_joint_that_nothing_resists_is_refused_by_name() {
    let case = case("[[joint_torque]]\njoint = \"twist\"\nconstant_N_m = 0.1\n");
    let error = simulate_case(&case, &model()).unwrap_err();
    assert_eq!(error.kind(), poinsot::ErrorKind::Input);
    assert_eq!(
        error.to_string(),
        "E0509 case.toml: joint \"twist\" moves by torque or spring, but its outboard bodies have no inertia about its axis (singular mass matrix); give them mass off the axis or inertia about it, or prescribe its motion with [[joint_motion]]"
    );
}

/// Text in a case, and the complete message.
const REFUSALS: &[(&str, &str)] = &[
    (
        "[[joint_torque]]\njoint = \"elbw\"\nconstant_N_m = 1.0",
        "E0504 case.toml:5: joint_torque[0].joint = \"elbw\": the model has no joint of this name; did you mean \"elbow\"?",
    ),
    (
        "[[joint_torque]]\njoint = \"bolt\"\nconstant_N_m = 1.0",
        "E0507 case.toml:5: joint_torque[0].joint = \"bolt\": a fixed joint does not move; leave it out",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"",
        "E0507 case.toml:4: joint_torque[0]: a joint's motor needs exactly one of constant, sinusoid, table and file; give constant_N_m; or amplitude_N_m with frequency_rad_s; or time_s with torque_N_m; or file",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nconstant_N_m = 1.0\namplitude_N_m = 1.0",
        "E0507 case.toml:4: joint_torque[0]: a joint's motor needs exactly one of constant, sinusoid, table and file; give constant_N_m; or amplitude_N_m with frequency_rad_s; or time_s with torque_N_m; or file",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nconstant_N = 1.0",
        "E0507 case.toml:6: joint_torque[0].constant_N = 1.0: a revolute joint moves in radians and newton metres; use constant_N_m",
    ),
    (
        "[[joint_torque]]\njoint = \"slide\"\ntime_s = [0.0]\ntorque_N_m = [1.0]",
        "E0507 case.toml:7: joint_torque[0].torque_N_m = [1.0]: a prismatic joint moves in metres and newtons; use force_N",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nconstant_N_m = inf",
        "E0505 case.toml:6: joint_torque[0].constant_N_m = inf: the number is not finite; write a finite number",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\namplitude_N_m = 1.0",
        "E0502 case.toml:4: joint_torque[0]: a sinusoid needs frequency_rad_s; add it: torque = amplitude sin(frequency t + phase)",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nconstant_N_m = 1.0\nphase_rad = 1.0",
        "E0507 case.toml:7: joint_torque[0].phase_rad = 1.0: this key does not belong to a motor given as constant; leave it out",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\ntorque_N_m = [1.0]",
        "E0502 case.toml:4: joint_torque[0]: torque_N_m needs time_s; add time_s = [...]",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\ntime_s = [0.0, 1.0]\ntorque_N_m = [1.0]",
        "E0506 case.toml:7: joint_torque[0].torque_N_m = [1.0]: 2 times but 1 values; give one value per time",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\ntime_s = [0.0]\ntorque_N_m = [1.0]\ninterpolation = \"cubic\"",
        "E0507 case.toml:8: joint_torque[0].interpolation = \"cubic\": no such interpolation here; use \"constant\" or \"linear\"",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nconstant_N_m = 1.0\n[[joint_torque]]\njoint = \"elbow\"\nconstant_N_m = 1.0",
        "E0504 case.toml:8: joint_torque[1].joint = \"elbow\": a second motion for the same joint or wheel; keep one of the two",
    ),
    (
        "[[joint_motion]]\njoint = \"elbow\"\ninterpolation = \"quintic_rest\"\ntime_s = [0.0]\nposition_rad = [0.0]\n[[joint_torque]]\njoint = \"elbow\"\nconstant_N_m = 1.0",
        "E0504 case.toml:10: joint_torque[0].joint = \"elbow\": a second motion for the same joint or wheel; keep one of the two",
    ),
    (
        "[[initial.joint]]\njoint = \"elbow\"\nposition_rad = 1.0",
        "E0507 case.toml:5: initial.joint[0].joint = \"elbow\": this joint has no drive: it stays locked at the model's position; leave it out; a start belongs to a joint with [[joint_torque]] or with spring_damper in the model",
    ),
    (
        "[[joint_motion]]\njoint = \"slide\"\ninterpolation = \"quintic_rest\"\ntime_s = [0.0]\nposition_m = [0.0]\n[[initial.joint]]\njoint = \"slide\"\nposition_m = 1.0",
        "E0507 case.toml:10: initial.joint[0].joint = \"slide\": the joint's motion is prescribed, and so is its initial state; leave it out; a start belongs to a joint with [[joint_torque]] or with spring_damper in the model",
    ),
    (
        "[[initial.joint]]\njoint = \"slide\"\nposition_rad = 1.0",
        "E0507 case.toml:6: initial.joint[0].position_rad = 1.0: a prismatic joint moves in metres and newtons; use position_m",
    ),
    (
        "[[initial.joint]]\njoint = \"slide\"\nrate_m_s = nan",
        "E0505 case.toml:6: initial.joint[0].rate_m_s = nan: the number is not finite; write a finite number",
    ),
    (
        "[[initial.joint]]\njoint = \"slide\"\nrate_m_s = 1.0\n[[initial.joint]]\njoint = \"slide\"\nrate_m_s = 1.0",
        "E0504 case.toml:8: initial.joint[1].joint = \"slide\": a second motion for the same joint or wheel; keep one of the two",
    ),
    (
        "[[initial.joint]]\njoint = \"slide\"\nrate_m = 1.0",
        "E0502 case.toml:6: initial.joint[0].rate_m = 1.0: wrong unit; write rate_rad_s or rate_m_s and convert the number",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nfile = \"elbow.csv\"",
        "E0511 case.toml:6: joint_torque[0].file = \"elbow.csv\": the file has no column \"elbow_Nm\"; did you mean \"elbow2_Nm\"?",
    ),
    (
        "[[joint_torque]]\njoint = \"elbow\"\nfile = \"elbow.csv\"\ncolumn = \"elbow_rad\"",
        "E0511 case.toml:6: joint_torque[0].file = \"elbow.csv\": column \"elbow_rad\" is of another quantity; name a column that ends in _Nm",
    ),
];

#[test]
fn unit_every_refusal_says_where_what_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let csv = "time_s,elbow2_Nm,elbow_rad\n0,1,2\n1,1,2\n";
    std::fs::write(folder.path().join("elbow.csv"), csv).unwrap();
    let path = folder.path().join("case.toml");
    let model = model();
    let mut wrong = String::new();
    for (body, expected) in REFUSALS {
        let parsed = parse_case(&path, format!("{HEAD}{body}\n{TAIL}"));
        let message = match parsed.and_then(|case| case.bind(&model)) {
            Ok(_) => "accepted".to_owned(),
            Err(e) => e
                .to_string()
                .replace(&path.display().to_string(), "case.toml"),
        };
        if message != *expected {
            wrong += &format!("{body}\n  expected {expected}\n  found    {message}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn unit_a_missing_torque_file_is_named() {
    let case = case("[[joint_torque]]\njoint = \"elbow\"\nfile = \"none.csv\"\n");
    let text = case.bind(&model()).unwrap_err().to_string();
    assert_eq!(
        text,
        "E0511 case.toml:6: joint_torque[0].file = \"none.csv\": cannot be read: No such file or directory (os error 2); give the path of a telemetry file, from the folder of the case"
    );
}

/// With [control] all joints are locked: a joint that would move freely is refused, not silently locked.
#[test]
fn unit_control_refuses_what_would_move_by_itself() {
    let (case, mut truth) = load("stsat3_three_slews.toml");
    let (_, slosh) = load("slosh.toml");
    truth.bodies.push(slosh.bodies[1].clone());
    truth.joints.push(slosh.joints[0].clone());
    let text = case.bind(&truth).unwrap_err().to_string();
    let own = "joint \"slosh\" has a spring and damper, and the simulation does not support this with [control]: joints are locked; lock the joint by locked_at_rad or locked_at_m, or prescribe wheel speeds with [[wheel_motion]]";
    assert!(text.starts_with("E0508 ") && text.ends_with(own), "{text}");
}
