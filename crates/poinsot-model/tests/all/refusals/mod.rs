//! Every refusal with its complete message.

mod bodies;
mod file;
mod joints;
mod modes;
mod sensors;

use poinsot_model::parse_model;

/// A base, a link on a revolute joint, a wheel, a thruster, a gyro and joint encoders.
const GOOD: &str = r#"schema = "poinsot.model/1"
name = "test"
[[body]]
name = "bus"
mass_kg = 400.0
com_m = [0.0, 0.0, 0.1]
inertia_kg_m2 = { xx = 30.0, yy = 28.0, zz = 32.0, xy = 0.26, xz = 0.37, yz = -0.29 }
estimate = true
[[body]]
name = "link1"
mass_kg = 12.0
com_m = [0.0, 0.0, 0.15]
inertia_kg_m2 = { xx = 0.51, yy = 0.5, zz = 0.2 }
[[joint]]
name = "joint1"
type = "revolute"
parent = "bus"
child = "link1"
origin_m = [0.357, -0.010, 0.419]
rotation_xyzw = [0.0, 0.0, 0.0, 1.0]
axis = [0.0, 0.0, 1.0]
[[wheel]]
name = "wheel1"
body = "bus"
axis = [1.0, 0.0, 0.0]
spin_inertia_kg_m2 = 4.113e-4
[[thruster]]
name = "thr1"
body = "bus"
position_m = [-0.7, -0.2, 0.0]
force_direction = [-1.0, 0.0, 0.0]
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1.0e-4
[[sensor]]
name = "encoders"
type = "joint_position"
quantisation_rad = 2.4e-5
"#;

/// Replaced text in [`GOOD`], new text, and the message.
type Case = (&'static str, &'static str, &'static str);

/// All cases, by subject.
const CASES: [&[Case]; 5] = [
    file::CASES,
    bodies::CASES,
    joints::CASES,
    modes::CASES,
    sensors::CASES,
];

#[test]
fn exact_every_refusal_says_where_what_and_what_to_do() {
    let mut wrong = String::new();
    for (from, to, expected) in CASES.into_iter().flatten() {
        assert_eq!(GOOD.matches(from).count(), 1, "{from} must occur once");
        let message = match parse_model(&GOOD.replacen(from, to, 1), "m.toml") {
            Ok(model) => format!("accepted, notes {:?}", model.notes),
            Err(error) => error.to_string(),
        };
        if message != *expected {
            wrong.push_str(&format!("<<<{from}|||{to}|||{message}>>>\n"));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn unit_the_unchanged_file_is_accepted() {
    let model = parse_model(GOOD, "m.toml").unwrap();
    assert_eq!(model.bodies.len(), 2);
    assert_eq!(model.notes, Vec::<String>::new());
    assert_eq!(model.sensors[1].of, [0]);
}
