//! Limits, order, notes, round trips, the schema and the shipped examples.

#![allow(clippy::panic, clippy::unwrap_used, clippy::expect_used)]

use poinsot_model::{
    EstimateSet, JointKind, Model, MomentumKnowledge, Nuisance, RandomTorque, SpringDamper,
    describe, model_schema, parse_model, parse_telemetry_map, read_model, read_telemetry_map,
    write_model,
};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::PathBuf;

const HEAD: &str = "schema = \"poinsot.model/1\"\n";

fn body(name: &str, mass: f64) -> String {
    let inertia = if mass > 0.0 {
        "com_m = [0.0, 0.0, 0.1]\ninertia_kg_m2 = { xx = 0.3, yy = 0.4, zz = 0.5 }\n"
    } else {
        ""
    };
    format!("[[body]]\nname = \"{name}\"\nmass_kg = {mass:?}\n{inertia}")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\ntype = \"{kind}\"\nparent = \"{parent}\"\nchild = \"{child}\"\norigin_m = [0.0, 0.0, 1.0]\n{}",
        if kind == "fixed" {
            ""
        } else {
            "axis = [0.0, 1.0, 0.0]\n"
        }
    )
}

fn accepted(text: &str) -> Model {
    parse_model(text, "m.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    match parse_model(text, "m.toml") {
        Ok(_) => panic!("accepted"),
        Err(error) => error.to_string(),
    }
}

fn examples() -> Vec<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    [
        "stsat3/model.toml",
        "ma2008/model.toml",
        "ma2008/model_noisy.toml",
        "xu2017/model.toml",
    ]
    .iter()
    .map(|name| root.join(name))
    .collect()
}

fn full() -> String {
    let mut text = format!("{HEAD}name = \"everything \\\"quoted\\\"\"\n");
    text += &body("bus", 100.0);
    text += "estimate = [\"mass\", \"inertia\"]\nprior = { mass_kg = 5.0, inertia_kg_m2 = 0.25 }\n";
    text += &body("frame", 0.0);
    text += &body("arm", 10.0);
    text += "estimate = true\n";
    text += &body("slider", 2.0);
    text += &joint("hold", "fixed", "bus", "frame");
    text += &joint("turn", "revolute", "frame", "arm");
    text += "rotation_xyzw = [0.1, 0.2, 0.3, 0.9]\nlocked_at_rad = 0.25\n";
    text += "spring_damper = { stiffness_N_m_per_rad = 2.5, damping_N_m_s_per_rad = 0.0625, rest_rad = -0.5 }\n";
    text += &joint("slide", "prismatic", "arm", "slider");
    text += "locked_at_m = -0.125\nrotation_matrix = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]\n";
    text += "spring_damper = { stiffness_N_per_m = 0.0 }\n";
    text += r#"
[[wheel]]
name = "w1"
body = "bus"
axis = [1.0, 1.0, 1.0]
spin_inertia_kg_m2 = 1e-3
estimate = true
[[thruster]]
name = "t1"
body = "arm"
position_m = [0.1, 0.2, 0.3]
force_direction = [0.0, 0.0, 1.0]
scale = { sigma = 0.05 }
[[sensor]]
name = "imu"
type = "gyro"
noise_rad_s = [1e-4, 2e-4, 3e-4]
bias = { sigma_rad_s = 1e-3 }
scale = "estimate"
misalignment = { sigma_rad = 0.01 }
lag = { sigma_s = 0.1 }
rotation_xyzw = [0.0, 0.0, 0.6, 0.8]
[[sensor]]
name = "imu"
type = "accelerometer"
body = "arm"
noise_m_s2 = [[2e-3, 1e-3, 0.0], [1e-3, 2e-3, 0.0], [0.0, 0.0, 1e-3]]
position_m = [0.1, 0.0, 0.0]
[[sensor]]
name = "angles"
type = "joint_position"
noise_rad = 1e-5
quantisation_rad = 2e-5
[[sensor]]
name = "lengths"
type = "joint_position"
noise_m = 1e-5
[[sensor]]
name = "tachometer"
type = "wheel_speed"
of = "w1"
[[sensor]]
name = "thrust"
type = "thrust"
noise_N = 0.01
[momentum]
linear_N_s = "zero"
angular_N_m_s = [0.1, 0.2, 0.3]
[environment]
gravity = "point_mass"
gm_m3_s2 = 3.986004418e14
gravity_gradient = true
orbit = { semi_major_axis_m = 7e6, eccentricity = 0.01, inclination_rad = 1.7, raan_rad = 0.3, epoch_s = 12.5 }
disturbance_torque = { sigma_N_m = 1e-5 }
disturbance_torque_inertial = "estimate"
[telemetry]
where = { log = "LOG00119" }
[telemetry.columns]
omega_x = { column = "gyro1_wx", unit = "deg/s" }
"imu.acc_x" = { column = "a \"x\"", unit = "m/s2" }
turn_rad = { column = "turn", unit = "deg" }
"#;
    text
}

/// Equal but for noise matrices, which go through a square root, and notes.
fn assert_reads_back(model: &Model) {
    let written = write_model(model);
    let mut back = parse_model(&written, "back.toml").unwrap_or_else(|e| panic!("{e}\n{written}"));
    let mut model = model.clone();
    for (a, b) in model.sensors.iter_mut().zip(&mut back.sensors) {
        if let (Some(x), Some(y)) = (a.noise_covariance, b.noise_covariance) {
            assert!((x - y).amax() <= 1e-14 * x.amax(), "{x} {y}");
            b.noise_covariance = a.noise_covariance;
        }
    }
    model.notes.clear();
    back.notes.clear();
    assert_eq!(back, model);
}

#[test]
fn exact_every_key_is_read() {
    let model = accepted(&full());
    assert_eq!(model.name, "everything \"quoted\"");
    assert_eq!(
        model.bodies[0].estimate,
        EstimateSet {
            mass: true,
            com: false,
            inertia: true
        }
    );
    let prior = model.bodies[0].prior.unwrap();
    assert_eq!(
        (prior.mass, prior.com, prior.inertia),
        (Some(5.0), None, Some(0.25))
    );
    assert_eq!(model.joints[1].locked_at, 0.25);
    assert_eq!(model.joints[2].locked_at, -0.125);
    let spring = model.joints[1].spring_damper.unwrap();
    let numbers = (spring.stiffness, spring.damping, spring.rest);
    assert_eq!(numbers, (2.5, 0.0625, -0.5));
    assert_eq!(spring.effort(0.5, 2.0), -2.625);
    assert_eq!(model.joints[0].spring_damper, None);
    assert_eq!(model.joints[2].spring_damper, Some(SpringDamper::default()));
    assert_eq!(model.joints[2].kind, JointKind::Prismatic);
    // A quarter turn about z: the child's x is the parent's y.
    assert_eq!(model.joints[2].R_PC_zero.column(0).y, 1.0);
    assert!((model.wheels[0].axis_B.norm() - 1.0).abs() < 1e-15);
    assert_eq!(model.thrusters[0].scale, Nuisance::Prior(0.05));
    assert_eq!(model.thrusters[0].body, 2);
    let gyro = &model.sensors[0];
    assert_eq!(gyro.noise_covariance.unwrap()[(2, 2)], 3e-4 * 3e-4);
    assert_eq!(gyro.bias, Nuisance::Prior(1e-3));
    assert_eq!(gyro.scale, Nuisance::Estimate);
    assert_eq!(gyro.lag, Nuisance::Prior(0.1));
    // Turned by 2 atan(0.6 / 0.8) about z.
    assert!((gyro.R_BS[(1, 0)] - 0.96).abs() < 1e-15);
    let covariance = model.sensors[1].noise_covariance.unwrap();
    assert!((covariance[(0, 1)] - 4e-6).abs() < 1e-20, "S S, not S");
    assert_eq!(model.sensors[1].body, 2);
    assert_eq!(model.sensors[2].of, [1]);
    assert_eq!(model.sensors[3].of, [2]);
    assert_eq!(model.sensors[4].of, [0]);
    assert_eq!(
        model.momentum.linear,
        MomentumKnowledge::Known([0.0; 3].into())
    );
    assert_eq!(
        model.momentum.angular,
        MomentumKnowledge::Known([0.1, 0.2, 0.3].into())
    );
    assert_eq!(model.environment.point_mass_gm, Some(3.986004418e14));
    assert_eq!(
        model.telemetry.row_filter,
        [("log".to_owned(), "LOG00119".to_owned())]
    );
    assert_eq!(model.telemetry.columns.len(), 3);
    assert_eq!(
        model.notes,
        [
            "line 37: joint[1].rotation_xyzw (joint \"turn\"): the quaternion has length 0.974679; normalised",
            "line 54: wheel[0].axis (wheel \"w1\"): the axis has length 1.73205; normalised",
        ]
    );
}

#[test]
fn exact_a_written_model_reads_back() {
    assert_reads_back(&accepted(&full()));
    for path in examples() {
        assert_reads_back(&read_model(path).unwrap());
    }
}

/// Everything in a model that may be known, unknown or known roughly.
fn nuisances(model: &mut Model) -> Vec<&mut Nuisance> {
    let mut all = Vec::new();
    for sensor in &mut model.sensors {
        all.push(&mut sensor.bias);
        all.push(&mut sensor.scale);
        all.push(&mut sensor.lag);
        if !sensor.kind.is_scalar() {
            all.push(&mut sensor.misalignment);
        }
    }
    all.extend(model.wheels.iter_mut().map(|w| &mut w.misalignment));
    all.extend(model.thrusters.iter_mut().map(|t| &mut t.scale));
    let around = &mut model.environment;
    all.push(&mut around.disturbance_torque);
    all.push(&mut around.disturbance_torque_inertial);
    all.push(&mut around.drag_torque);
    all
}

#[test]
fn exact_every_nuisance_reads_back_from_what_was_written() {
    let model = accepted(&full());
    let places = nuisances(&mut model.clone()).len();
    assert_eq!(places, 6 * 3 + 2 + 1 + 1 + 3);
    for place in 0..places {
        for value in [
            Nuisance::Known,
            Nuisance::Estimate,
            Nuisance::Prior(0.1),
            Nuisance::Prior(3.0e-17),
        ] {
            let mut changed = model.clone();
            if let Some(nuisance) = nuisances(&mut changed).into_iter().nth(place) {
                *nuisance = value;
            }
            assert_reads_back(&changed);
        }
    }
    let mut gusty = model;
    gusty.environment.random_torque = Some(RandomTorque {
        sigma_N_m: 1.0e-5,
        correlation_s: 30.0,
    });
    gusty.sensors[0].correlation_s = 0.3;
    assert_reads_back(&gusty);
}

#[test]
fn exact_examples_load_without_notes() {
    for path in examples() {
        let model = read_model(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(model.notes, Vec::<String>::new(), "{}", path.display());
    }
    let xu = read_model(&examples()[3]).unwrap();
    assert_eq!(
        (xu.bodies.len(), xu.joints.len(), xu.thrusters.len()),
        (7, 6, 12)
    );
    assert!(xu.bodies.iter().all(|b| b.estimate == EstimateSet::ALL));
    let ma = read_model(&examples()[2]).unwrap();
    assert_eq!(ma.sensors[0].bias, Nuisance::Estimate);
    assert_eq!(ma.bodies[4].nominal.mass, 0.0);
}

#[test]
fn exact_schema_has_every_key_of_the_examples() {
    let schema = model_schema();
    assert!(schema["properties"]["body"]["description"].is_string());
    assert!(!schema.to_string().contains("null"), "TOML has no null");
    let mut texts: Vec<String> = examples()
        .iter()
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    texts.push(full());
    for text in texts {
        let table: toml::Table = toml::from_str(&text).unwrap();
        assert_keys(&schema, &schema, &toml::Value::Table(table));
    }
}

/// Walks a file beside the schema, independently of the reader.
fn assert_keys(root: &serde_json::Value, schema: &serde_json::Value, value: &toml::Value) {
    let mut alternatives = vec![schema];
    let mut k = 0;
    while k < alternatives.len() {
        if let Some(path) = alternatives[k].get("$ref").and_then(|r| r.as_str()) {
            alternatives.push(root.pointer(path.trim_start_matches('#')).unwrap());
        }
        for list in ["anyOf", "oneOf"] {
            alternatives.extend(
                alternatives[k]
                    .get(list)
                    .and_then(|l| l.as_array())
                    .into_iter()
                    .flatten(),
            );
        }
        k += 1;
    }
    match value {
        toml::Value::Table(table) => {
            let object = alternatives
                .iter()
                .find(|a| a["type"] == "object")
                .expect("an object");
            for (key, value) in table {
                let inner = object["properties"].get(key);
                let inner =
                    inner.or_else(|| object.get("additionalProperties").filter(|a| a.is_object()));
                assert_keys(
                    root,
                    inner.unwrap_or_else(|| panic!("{key} is not in the schema")),
                    value,
                );
            }
        }
        toml::Value::Array(items) => {
            let list = alternatives
                .iter()
                .find(|a| a["type"] == "array")
                .expect("a list");
            for item in items.iter().filter(|item| item.is_table()) {
                assert_keys(root, &list["items"], item);
            }
        }
        _ => {}
    }
}

#[test]
fn unit_every_quantity_in_the_schema_is_described_with_its_unit() {
    let schema = model_schema();
    let mut checked = 0;
    for (_, table) in schema["$defs"].as_object().unwrap() {
        for (key, property) in table["properties"].as_object().into_iter().flatten() {
            for (suffix, unit) in [
                ("_kg", "kg"),
                ("_kg_m2", "kg m2"),
                ("_m", " m"),
                ("_N_s", "N s"),
                ("_N_per_m", "N/m"),
                ("_N_m_s_per_rad", "N m s/rad"),
            ] {
                // A stiffness in N/m is no length.
                if key.ends_with(suffix) && (suffix.contains("per") || !key.contains("_per_")) {
                    let text = property["description"].as_str().unwrap();
                    assert!(text.contains(unit), "{key}: {text}");
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 15);
}

#[test]
fn unit_bodies_are_sorted_parents_first_and_else_kept() {
    let mut text = HEAD.to_owned();
    for name in ["base", "c", "b", "a", "d"] {
        text += &body(name, 1.0);
    }
    text += &joint("jc", "revolute", "b", "c");
    text += &joint("jb", "revolute", "a", "b");
    text += &joint("ja", "revolute", "base", "a");
    text += &joint("jd", "revolute", "base", "d");
    let model = accepted(&text);
    let names: Vec<&str> = model.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["base", "a", "b", "c", "d"]);
    assert_eq!(model.joints[0].name, "jc");
    assert_eq!((model.joints[0].parent, model.joints[0].child), (2, 3));
    for (k, b) in model.bodies.iter().enumerate() {
        if let Some(j) = b.joint {
            assert_eq!(model.joints[j].child, k);
            assert!(model.joints[j].parent < k);
        }
    }
}

#[test]
fn unit_a_chain_of_ten_thousand_links_is_read_described_and_written() {
    let mut text = HEAD.to_owned();
    text += &body("b0", 1.0);
    for k in 1..10_000 {
        text += &body(&format!("b{k}"), 1.0);
    }
    // From the tip to the base: the order of the file must not matter.
    for k in (1..10_000).rev() {
        text += &joint(
            &format!("j{k}"),
            "revolute",
            &format!("b{}", k - 1),
            &format!("b{k}"),
        );
    }
    let model = accepted(&text);
    assert_eq!(model.bodies[9_999].name, "b9999");
    let words = describe(&model).to_string();
    assert!(words.contains("[9999] b9999"));
    assert_eq!(accepted(&write_model(&model)), model);
    text += &body("one too many", 1.0);
    assert!(refused(&text).starts_with("E0119 m.toml:"));
}

#[test]
fn unit_massless_bodies_may_carry_mass_or_be_carried_rigidly() {
    let base = format!("{HEAD}{}", body("base", 1.0));
    let wrist = base.clone()
        + &body("w", 0.0)
        + &body("tool", 1.0)
        + &joint("jw", "revolute", "base", "w")
        + &joint("jt", "revolute", "w", "tool");
    assert_eq!(accepted(&wrist).bodies[1].nominal.mass, 0.0);
    let frame = base.clone() + &body("f", 0.0) + &joint("jf", "fixed", "base", "f");
    accepted(&frame);
    let flag = base
        + &body("f", 0.0)
        + &body("g", 0.0)
        + &joint("jf", "fixed", "base", "f")
        + &joint("jg", "revolute", "f", "g");
    assert!(refused(&flag).contains("E0116"));
    let ghost = format!("{HEAD}{}", body("base", 0.0));
    assert_eq!(
        refused(&ghost),
        "E0116 m.toml:4:11: body[0].mass_kg (body \"base\") = 0.0: no body of the vehicle has mass; give the base a mass"
    );
}

#[test]
fn unit_remarkable_models_are_noted() {
    let mut text = format!("{HEAD}{}estimate = true\n", body("base", 1e-3));
    text += &body("panel", 2.0);
    text += "prior = { mass_kg = 1.0 }\n";
    text += &body("payload", 2.0);
    text += "estimate = true\n";
    text += &joint("jp", "fixed", "base", "panel");
    text += "axis = [0.0, 0.0, 1.0]\n";
    text += &joint("jq", "fixed", "base", "payload");
    text += "[[wheel]]\nname = \"w\"\nbody = \"panel\"\naxis = [0.0, 0.0, 1.0]\nspin_inertia_kg_m2 = 0.6\n";
    text += "[[sensor]]\nname = \"s\"\ntype = \"thrust\"\nnoise_N = 1.0\n";
    assert_eq!(
        accepted(&text).notes,
        [
            "line 6: body[0].inertia_kg_m2 (body \"base\"): the radius of gyration is 24.4949 m; are mass in kg and inertia in kg m2?",
            "line 13: body[1].prior.mass_kg (body \"panel\"): the prior has no effect: the number is not estimated; remove it, or estimate the number",
            "line 19: body[2].estimate (body \"payload\"): the body is rigidly connected with \"base\", which is unknown too: only their sum can be identified; give one of them as known",
            "line 26: joint[0].axis (joint \"jp\"): the axis of a fixed joint has no effect",
            "line 37: wheel[0].spin_inertia_kg_m2 (wheel \"w\"): the rotor has more inertia than its body \"panel\" about this axis (0.5 kg m2), which should contain it; add it there",
            "line 40: sensor[0].type (sensor \"s\"): the sensor has no effect: there is nothing that it could read; remove it, or add what it reads",
        ]
    );
}

#[test]
fn unit_printed_rotations_are_made_orthonormal_and_exact_ones_kept() {
    let with = |rotation: &str| {
        accepted(&format!(
            "{HEAD}{}{}{}rotation_matrix = {rotation}\n",
            body("base", 1.0),
            body("link", 1.0),
            joint("j", "revolute", "base", "link"),
        ))
    };
    let printed =
        with("[[0.7071068, -0.7071068, 0.0], [0.7071068, 0.7071068, 0.0], [0.0, 0.0, 1.0]]");
    let r = printed.joints[0].R_PC_zero;
    assert!((r.transpose() * r - poinsot_spatial::Matrix3::identity()).amax() < 1e-14);
    assert_eq!(printed.notes.len(), 1);
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let exact = with(&format!(
        "[[{h:?}, -{h:?}, 0.0], [{h:?}, {h:?}, 0.0], [0.0, 0.0, 1.0]]"
    ));
    assert_eq!(exact.joints[0].R_PC_zero[(0, 0)], h);
    assert!(exact.notes.is_empty());
}

#[test]
fn exact_twenty_findings_are_shown_in_order_and_the_rest_counted() {
    let mut text = format!("{HEAD}{}", body("base", 1.0));
    for k in 0..30 {
        let _ = writeln!(
            text,
            "[[wheel]]\nname = \"w{k}\"\nbody = \"base\"\naxis = [0, 0, 0]\nspin_inertia_kg_m2 = 1"
        );
    }
    let error = parse_model(&text, "m.toml").unwrap_err();
    assert_eq!((error.findings.len(), error.omitted), (20, 10));
    assert!(
        error
            .findings
            .windows(2)
            .all(|pair| pair[0].line < pair[1].line)
    );
    assert!(error.to_string().ends_with("\nand 10 more"));
}

#[test]
fn exact_files_that_cannot_be_read() {
    let folder = std::env::temp_dir();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.join(format!("poinsot-model-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        let error = read_model(&path).unwrap_err();
        std::fs::remove_file(&path).unwrap();
        let text = error.to_string();
        text.replace(&path.display().to_string(), "F")
    };
    assert_eq!(
        read_model("no/such.toml").unwrap_err().to_string(),
        "E0101 no/such.toml: there is no such file; check the path"
    );
    assert_eq!(
        file("utf8", b"name = \"\xff\""),
        "E0101 F: byte 8 is not UTF-8; save the file as UTF-8 text"
    );
    assert_eq!(
        file("empty", b" \n"),
        "E0103 F:1:1: the file is empty; begin with schema = \"poinsot.model/1\"; `poinsot schema` prints all keys"
    );
    assert_eq!(
        file("large", &vec![b'#'; 16 * 1024 * 1024 + 1]),
        "E0101 F: the file is larger than 16 MiB; name a model file"
    );
    assert_eq!(
        file("none", HEAD.as_bytes()),
        "E0106 F:1:1: body: the key is missing; add body: Bodies"
    );
    let deep = format!("{HEAD}x = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(file("deep", deep.as_bytes()).starts_with("E0102 F:2:"));
}

#[test]
fn exact_a_telemetry_map_stands_in_its_own_file() {
    let path = std::env::temp_dir().join(format!("poinsot-map-{}.toml", std::process::id()));
    let text = "[telemetry]\nwhere = { log = \"L\" }\n[telemetry.columns]\nanything = { column = \"a\", unit = \"rpm\" }\n";
    std::fs::write(&path, text).unwrap();
    let map = read_telemetry_map(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(map.columns[0].unit, "rpm");
    assert_eq!(map.row_filter[0].1, "L");
    assert_eq!(
        parse_telemetry_map("[telemetri]\n", "map.toml")
            .unwrap_err()
            .to_string(),
        "E0104 map.toml:1:2: telemetri: unknown key; did you mean telemetry?"
    );
}

#[test]
fn exact_a_description_names_what_is_there_and_what_is_unknown() {
    let description = describe(&accepted(&full()));
    assert_eq!(
        description.tree,
        [
            "bus",
            "+- frame  (hold, fixed)",
            "   +- arm  (turn, revolute)",
            "      +- slider  (slide, prismatic)"
        ]
    );
    assert_eq!(description.mass_kg, 112.0);
    let text = description.to_string();
    assert!(text.contains("bus: 100 kg, mass centre (0, 0, 0.1) m, principal moments 0.3, 0.4, 0.5 kg m2; unknown: mass, inertia"));
    assert!(text.contains("w1: spin inertia"));
    assert!(text.contains("imu: bias (prior sigma 0.001)"));
    let json = serde_json::to_value(&description).unwrap();
    assert_eq!(json["sensors"][2]["of"][0], "turn");
    // Two bodies of 1 kg at z = 0.1 and z = 1.1: the mass centre lies between.
    let pair = accepted(&format!(
        "{HEAD}{}{}{}",
        body("a", 1.0),
        body("b", 1.0),
        joint("j", "revolute", "a", "b")
    ));
    let system = describe(&pair).system;
    assert!((system.com_m[2] - 0.6).abs() < 1e-15);
    // 2 x 0.3 + 2 x 1 x 0.5^2 about x.
    assert!((system.principal_kg_m2[1] - 1.1).abs() < 1e-14);
}

proptest! {
    #[test]
    fn prop_arbitrary_text_never_panics(text in "\\PC{0,200}") {
        let _ = parse_model(&text, "m.toml");
        let _ = parse_telemetry_map(&text, "m.toml");
    }

    #[test]
    fn prop_damaged_files_never_panic(at in 0_usize..4000, length in 0_usize..60, by in "[\\[\\]{}=\",.a-z0-9\n -]{0,12}") {
        let mut text = full();
        let (from, to) = (at.min(text.len()), (at + length).min(text.len()));
        text.replace_range(from..to, &by);
        match parse_model(&text, "m.toml") {
            Ok(model) => { let _ = describe(&model).to_string(); }
            Err(error) => {
                prop_assert!(!error.findings.is_empty());
                for finding in &error.findings {
                    let whole = finding.to_string();
                    prop_assert!(!whole.contains('\n'), "{}", whole);
                    prop_assert!(!finding.problem.is_empty() && !finding.remedy.is_empty());
                }
            }
        }
    }

    #[test]
    fn prop_numbers_and_axes_read_back_to_the_last_bit(
        mass in 1e-3_f64..1e4, com in prop::array::uniform3(-5.0_f64..5.0),
        axis in prop::array::uniform3(-1.0_f64..1.0), q in prop::array::uniform4(-1.0_f64..1.0),
        sigma in 1e-9_f64..1.0,
    ) {
        prop_assume!(axis.iter().any(|x| x.abs() > 1e-3) && q.iter().any(|x| x.abs() > 1e-3));
        let text = format!(
            "{HEAD}{}[[body]]\nname = \"l\"\nmass_kg = {mass:?}\ncom_m = {com:?}\ninertia_kg_m2 = {{ xx = 1.0, yy = 1.1, zz = 1.2 }}\n\
             [[joint]]\nname = \"j\"\ntype = \"revolute\"\nparent = \"base\"\nchild = \"l\"\norigin_m = {com:?}\naxis = {axis:?}\nrotation_xyzw = {q:?}\n\
             [[sensor]]\nname = \"g\"\ntype = \"gyro\"\nnoise_rad_s = {sigma:?}\n",
            body("base", 1.0));
        let model = accepted(&text);
        let mut back = accepted(&write_model(&model));
        back.notes.clone_from(&model.notes);
        prop_assert_eq!(back, model);
    }
}
