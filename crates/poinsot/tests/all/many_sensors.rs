//! Several sensors of a kind on any body: gyros and star trackers of different quality on a tug and on its arm.

use crate::shared::undiagnosed;
use crate::shared::{faults, rows, statistics};
use poinsot::Error;
use poinsot::bind::{Bound, bind};
use poinsot::case::{Case, parse_case};
use poinsot::simulate::simulate_trial;
use poinsot::trials::Study;
use poinsot::validate::{Mover, compare_with_telemetry};
use poinsot_dynamics::Tree;
use poinsot_identify::{Estimate, Number, Status, TENSOR};
use poinsot_model::{Model, Origin, SensorKind, parse_model};
use poinsot_telemetry::{Channel, Table};
use poinsot_testkit::Vector3;
use poinsot_testkit::vehicles::tug_with_arm;
use std::path::Path;

/// A tug with an arm and its true numbers.
fn vehicle() -> String {
    tug_with_arm()
        .thruster("jet", "bus", [-0.7, -0.2, 0.1], [0.2, 0.5, 1.0])
        .text()
}

const CASE: &str = r#"
schema = "poinsot.case/1"
model = "tug_truth.toml"
duration_s = 20.0

[initial]
omega_rad_s = [0.1, -0.15, 0.2]

[[joint_motion]]
joint = "elbow"
interpolation = "fourier"
base_frequency_hz = 0.1
sine_rad = [0.8]
cosine_rad = [0.3]

[[firing]]
thruster = "jet"
on_s = 2.0
off_s = 8.0
force_N = 2.0

[[firing]]
thruster = "jet"
on_s = 12.0
off_s = 15.0
force_N = 2.0

[output]
rate_hz = 5.0
seed = 7
"#;

/// Name, type, sigma, further keys.
type Declared<'a> = (&'a str, &'a str, f64, &'a str);

const FINE: Declared = ("fine", "gyro", 1.0e-5, "");
const COARSE: Declared = ("coarse", "gyro", 4.0e-5, "");
const STAR: Declared = ("star", "attitude", 2.0e-5, "");
const SUN: Declared = ("sun", "attitude", 1.0e-4, "");
const SUNLIGHT: Declared = (
    "sunlight",
    "direction",
    2.0e-4,
    "reference_N = [3.0, -1.0, 2.0]\n",
);
/// Rotated on its body, with a small error.
const FIELD: Declared = (
    "field",
    "direction",
    1.0e-3,
    "reference_N = [0.1, 0.4, -0.2]\nrotation_xyzw = [0.5, 0.5, -0.5, 0.5]\nbias = { sigma_rad = 0.01 }\n",
);
const ARM_SUN: Declared = (
    "arm sun",
    "direction",
    1.0e-4,
    "body = \"arm\"\nreference_N = [3.0, -1.0, 2.0]\n",
);
const SPEED: Declared = ("speed", "velocity", 1.0e-4, "");
const ON_ARM: Declared = (
    "on arm",
    "gyro",
    5.0e-6,
    "body = \"arm\"\nbias = \"estimate\"\n",
);
/// Sensors of the base that leave much to an encoder.
const ROUGH: [Declared; 3] = [
    ("rough", "gyro", 2.0e-4, ""),
    ("rough star", "attitude", 4.0e-4, ""),
    ("rough speed", "velocity", 2.0e-3, ""),
];
const ENCODER: Declared = ("encoder", "joint_position", 1.0e-2, "");
/// Camera on the bus that sees the arm: its attitude, and a point near its end.
const CAMERA: Declared = (
    "camera",
    "attitude",
    1.0e-3,
    "body = \"arm\"\nseen_from = \"bus\"\n",
);
const MARKER: Declared = (
    "marker",
    "position",
    5.0e-4,
    "body = \"arm\"\nseen_from = \"bus\"\nposition_m = [0.5, 0.0, 0.0]\n",
);
/// Optical flow of that point.
const FLOW: Declared = (
    "flow",
    "velocity",
    1.0e-3,
    "body = \"arm\"\nseen_from = \"bus\"\nposition_m = [0.5, 0.0, 0.0]\n",
);
const ARM_STAR: Declared = ("arm star", "attitude", 1.0e-5, "body = \"arm\"\n");

fn model(sensors: &[Declared]) -> Model {
    let mut text = vehicle();
    for (name, kind, sigma, more) in sensors {
        let unit = match *kind {
            "gyro" => "rad_s",
            "attitude" | "direction" | "joint_position" => "rad",
            "position" => "m",
            "joint_rate" => "rad_s",
            _ => "m_s",
        };
        text += &format!(
            "\n[[sensor]]\nname = \"{name}\"\ntype = \"{kind}\"\nnoise_{unit} = {sigma:e}\n{more}"
        );
    }
    parse_model(&text, "tug.toml").unwrap()
}

fn case() -> Case {
    written_case(CASE)
}

fn written_case(text: &str) -> Case {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    parse_case(&folder.join("arm.toml"), text.to_owned()).unwrap()
}

/// The motion with sensor columns only, without exact ones.
fn sensed() -> Case {
    written_case(&CASE.replace("seed = 7", "seed = 7\nsensors_only = true"))
}

fn bound(model: &Model, tables: &[Table]) -> Result<Bound, Error> {
    bind(model, &Tree::new(model), tables)
}

fn solved(model: &Model, table: &Table) -> Estimate {
    let tables = [table.clone()];
    let (tree, bound) = (Tree::new(model), bound(model, &tables).unwrap());
    let problem = bound.problem(model, &tree);
    let answer = undiagnosed(&problem);
    assert_eq!(answer.status, Status::Converged);
    answer
}

fn study(model: &Model) -> Study {
    study_of(&case(), model)
}

fn study_of(case: &Case, model: &Model) -> Study {
    Study {
        diagnose: false,
        ..Study::of_case(case, model, model.clone()).unwrap()
    }
}

/// The Cramer-Rao bound of all sensors together.
fn bound_of(model: &Model) -> Vec<(f64, f64)> {
    numbers(&study(model).bound().unwrap())
}

/// Mass, mass centre and inertia of the bus: value and sigma.
fn numbers(estimate: &Estimate) -> Vec<(f64, f64)> {
    let bus = &estimate.bodies[0];
    let all = std::iter::once(&bus.mass)
        .chain(&bus.com)
        .chain(&bus.inertia);
    let pair = |n: &Number| (n.value.unwrap(), n.sigma.unwrap());
    all.map(pair).collect()
}

/// Samples of the sensors of a vehicle, and the joint.
fn written(model: &Model) -> Table {
    let mut table = simulate_trial(&case(), model, 0).unwrap().table;
    let unread = |c: &Channel| match c.name.split_once('_') {
        Some(("r" | "acc" | "domega", _)) => true,
        Some(("v", _)) => model.sensors_of(SensorKind::Velocity).next().is_none(),
        _ => false,
    };
    table.channels.retain(|c| !unread(c));
    table
}

/// Largest difference of values, in sigmas, and of sigmas, relative.
fn gaps(ours: &[(f64, f64)], theirs: &[(f64, f64)]) -> (f64, f64) {
    let pairs = || ours.iter().zip(theirs);
    let value = pairs().map(|(a, b)| (a.0 - b.0).abs() / b.1);
    let sigma = pairs().map(|(a, b)| (a.1 / b.1 - 1.0).abs());
    (value.fold(0.0, f64::max), sigma.fold(0.0, f64::max))
}

fn columns<'t>(table: &'t Table, sensor: &str) -> Vec<&'t Channel> {
    let own = table.channels.iter();
    own.filter(|c| c.sensor == sensor).collect()
}

/// Two gyros at equal times are equivalent to one gyro with their weighted mean.
#[test]
fn exact_two_gyros_are_one_that_reads_their_weighted_mean() {
    let both = model(&[COARSE, STAR, SPEED, FINE]);
    let table = written(&both);
    let [a, b] = [FINE.2, COARSE.2].map(|sigma| 1.0 / (sigma * sigma));
    let mut mean = table.clone();
    mean.channels.retain(|c| c.sensor != COARSE.0);
    let coarse = columns(&table, COARSE.0);
    for channel in mean.channels.iter_mut().filter(|c| c.sensor == FINE.0) {
        let other = coarse.iter().find(|c| c.name == channel.name).unwrap();
        for (x, y) in channel.values.iter_mut().zip(&other.values) {
            *x = (a * *x + b * y) / (a + b);
        }
    }
    let sigma = (1.0 / (a + b)).sqrt();
    let one = model(&[("fine", "gyro", sigma, ""), STAR, SPEED]);
    let (found, expected) = (solved(&both, &table), solved(&one, &mean));
    let (value, sigma) = gaps(&numbers(&found), &numbers(&expected));
    println!("values {value:.1e} sigma, sigmas {sigma:.1e}");
    assert!(value < 1.0e-6 && sigma < 1.0e-7, "{value:e} {sigma:e}");
}

#[test]
fn exact_order_of_declaration_changes_nothing_and_sigma_is_the_bound_of_all() {
    let first = model(&[COARSE, SUN, FINE, STAR, SPEED]);
    let last = model(&[STAR, SPEED, FINE, COARSE, SUN]);
    let table = written(&first);
    let (found, again) = (solved(&first, &table), solved(&last, &table));
    let (value, sigma) = gaps(&numbers(&found), &numbers(&again));
    println!("order: values {value:.1e} sigma, sigmas {sigma:.1e}");
    assert!(value < 1.0e-9 && sigma < 1.0e-9, "{value:e} {sigma:e}");
    let (_, sigma) = gaps(&numbers(&found), &bound_of(&first));
    println!("bound: sigmas {sigma:.1e}");
    assert!(sigma < 5.0e-3, "{sigma:e}");
    // The coarse ones reduce no information.
    let mut few = table.clone();
    few.channels
        .retain(|c| ![COARSE.0, SUN.0].contains(&&*c.sensor));
    let fine = solved(&model(&[FINE, STAR, SPEED]), &few);
    let ours = numbers(&found);
    for ((_, with), (_, without)) in ours.iter().zip(numbers(&fine)) {
        assert!(*with < without * (1.0 + 1.0e-6), "{with:e} {without:e}");
    }
    let names: Vec<&str> = found.fit[0].channels.iter().map(|c| &*c.name).collect();
    let expected = [
        "gyro.coarse",
        "gyro.fine",
        "attitude.star",
        "attitude.sun",
        "velocity",
    ];
    assert_eq!(names, expected);
}

/// Gyro and star tracker on a link: their information is consistent, and reduces sigma.
#[test]
fn exact_sensors_on_a_link_tell_of_the_base() {
    let sensors = [FINE, STAR, SPEED, ON_ARM, ARM_STAR];
    let all = model(&sensors);
    let table = written(&all);
    let found = solved(&all, &table);
    let (_, gap) = gaps(&numbers(&found), &bound_of(&all));
    println!("bound: sigmas {gap:.1e}");
    assert!(gap < 5.0e-3, "{gap:e}");
    let mut base = table.clone();
    base.channels
        .retain(|c| ![ON_ARM.0, ARM_STAR.0].contains(&&*c.sensor));
    let without = solved(&model(&sensors[..3]), &base);
    let truth = all.bodies[0].nominal;
    let ours = numbers(&found);
    let z = (ours[0].0 - truth.mass) / ours[0].1;
    assert!(z.abs() < 4.0, "{z}");
    for ((_, with), (_, without)) in ours.iter().zip(numbers(&without)) {
        assert!(*with < 0.9 * without, "{with:e} {without:e}");
    }
    for channel in &found.fit[0].channels {
        let chi2 = channel.chi2_per_number.unwrap();
        assert!((chi2 - 1.0).abs() < 0.35, "{}: {chi2}", channel.name);
    }
}

#[test]
fn stat_two_gyros_and_two_trackers_are_calibrated() {
    let model = model(&[COARSE, SUN, FINE, STAR, SPEED, ON_ARM, ARM_STAR]);
    let study = study(&model);
    let result = statistics(&rows(&study, 0..60));
    assert!(result.nees.is_some());
    let faults = faults(&result);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn exact_simulate_writes_every_sensor_with_its_errors() {
    let model = model(&[COARSE, FINE, STAR, SUN]);
    let text = format!(
        "{CASE}\n[[output.sensor]]\nname = \"coarse\"\nbias_rad_s = [0.0, 0.0, 0.0]\nscale = [0.1, 0.0, 0.0]\nnonorthogonality_rad = [0.0, 0.0, 0.02]\nlag_s = 0.05\n"
    );
    let case = written_case(&text);
    let table = simulate_trial(&case, &model, 0).unwrap().table;
    for (sensor, count) in [("coarse", 3), ("fine", 3), ("star", 4), ("sun", 4)] {
        assert_eq!(columns(&table, sensor).len(), count, "{sensor}");
    }
    let axes = |sensor: &str| {
        ["x", "y"].map(|k| table.sensor_channel(sensor, &format!("omega_{k}")).unwrap())
    };
    let ([x, y], [u, _]) = (axes("fine"), axes("coarse"));
    for k in 0..x.values.len() {
        let expected = 1.1 * x.values[k] + 0.02 * y.values[k];
        assert!((u.values[k] - expected).abs() < 3.0e-4, "{k}");
        assert!((u.time_s[k] - x.time_s[k] - 0.05).abs() < 1.0e-12);
    }
}

#[test]
fn regress_a_sensor_without_data_and_data_without_sensor_are_said() {
    let both = model(&[COARSE, FINE, STAR]);
    let table = written(&both);
    let said =
        |model: &Model, table: &Table| bound(model, std::slice::from_ref(table)).map(|b| b.repairs);
    let mut without = table.clone();
    without.channels.retain(|c| c.sensor != "coarse");
    let found = said(&both, &without).unwrap().join("\n");
    assert!(
        found.contains("of the gyro 'coarse': the sensor is not used"),
        "{found}"
    );
    let found = said(&model(&[FINE, STAR]), &table).unwrap().join("\n");
    assert!(
        found.contains("'coarse.omega_x' and its companions match no gyro"),
        "{found}"
    );
    let found = said(&both, &table).unwrap().join("\n");
    assert!(
        found.contains("the linear start uses 'fine', maximum likelihood uses all"),
        "{found}"
    );
    let mut nameless = table.clone();
    nameless.channels.retain(|c| c.sensor != "coarse");
    for channel in nameless.channels.iter_mut().filter(|c| c.sensor == "fine") {
        channel.sensor.clear();
    }
    let refused = said(&both, &nameless).unwrap_err().to_string();
    assert!(
        refused.starts_with("E0305") && refused.contains("name no sensor"),
        "{refused}"
    );
    let mut silent = both;
    silent.sensors.iter_mut().for_each(|s| {
        if s.kind == SensorKind::Gyro && s.name == "coarse" {
            s.noise_covariance = None;
        }
    });
    let refused = said(&silent, &table).unwrap_err().to_string();
    assert!(refused.contains("'coarse' declares no noise"), "{refused}");
}

/// A direction is the reference vector rotated by the attitude of the same run.
#[test]
fn exact_a_direction_is_the_turned_reference() {
    let mut quiet = model(&[STAR, SUNLIGHT]);
    quiet
        .sensors
        .iter_mut()
        .for_each(|s| s.noise_covariance = None);
    let table = simulate_trial(&case(), &quiet, 0).unwrap().table;
    // The only sensor of a kind writes columns without a name.
    let axis = |name: String| &table.channel(&name).unwrap().values;
    let seen = ["x", "y", "z"].map(|k| axis(format!("direction_{k}")));
    let q = ["x", "y", "z", "w"].map(|k| axis(format!("q_{k}")));
    let reference = Vector3::new(3.0, -1.0, 2.0).normalize();
    for k in 0..seen[0].len() {
        let [x, y, z, w] = q.map(|c| c[k]);
        let vector = Vector3::new(x, y, z);
        // Rotation with the conjugate quaternion: from N to the body.
        let turned = reference - 2.0 * w * vector.cross(&reference)
            + 2.0 * vector.cross(&vector.cross(&reference));
        let gap = turned - Vector3::new(seen[0][k], seen[1][k], seen[2][k]);
        assert!(gap.amax() < 1.0e-12, "{k}: {gap}");
    }
}

/// No star tracker: two directions, one from a rotated sensor with unknown errors, and a third on the arm.
#[test]
fn stat_directions_without_a_tracker_are_calibrated() {
    let model = model(&[FINE, SUNLIGHT, FIELD, ARM_SUN, SPEED]);
    let study = study_of(&sensed(), &model);
    let result = statistics(&rows(&study, 0..60));
    println!("NEES {:?}", result.nees);
    assert!(result.nees.is_some());
    let faults = faults(&result);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Three orthogonal directions are equivalent to a star tracker: each determines two of three angles, so together they
/// have twice the information.
#[test]
fn exact_three_directions_are_a_tracker_of_half_the_variance() {
    let axes = ["[1.0, 0.0, 0.0]", "[0.0, 2.0, 0.0]", "[0.0, 0.0, -3.0]"]
        .map(|v| format!("reference_N = {v}\n"));
    let [x, y, z] = ["x", "y", "z"];
    let three = model(&[
        FINE,
        (x, "direction", 1.0e-4, &axes[0]),
        (y, "direction", 1.0e-4, &axes[1]),
        (z, "direction", 1.0e-4, &axes[2]),
        SPEED,
    ]);
    let one = model(&[
        FINE,
        ("star", "attitude", 1.0e-4 / 2.0_f64.sqrt(), ""),
        SPEED,
    ]);
    let bound = |model| numbers(&study_of(&sensed(), model).bound().unwrap());
    let (_, sigma) = gaps(&bound(&three), &bound(&one));
    println!("sigmas {sigma:.1e}");
    assert!(sigma < 1.0e-3, "{sigma:e}");
}

/// A reference vector in N given by columns that vary in time gives the same answer, bit by bit, as one in the model.
#[test]
fn exact_a_reference_in_columns_is_that_of_the_model() {
    let declared = model(&[FINE, SUNLIGHT, FIELD, SPEED]);
    let table = simulate_trial(&sensed(), &declared, 0).unwrap().table;
    let mut without = declared.clone();
    let sensor = without
        .sensors
        .iter_mut()
        .find(|s| s.name == "sunlight")
        .unwrap();
    sensor.reference_N = None;
    let mut with_columns = table.clone();
    let times = columns(&table, "sunlight")[0].time_s.clone();
    for (axis, value) in ["x", "y", "z"].iter().zip([3.0, -1.0, 2.0]) {
        with_columns.channels.push(Channel {
            name: format!("reference_{axis}"),
            sensor: "sunlight".to_owned(),
            time_s: times.clone(),
            values: vec![value; times.len()],
            ..Channel::default()
        });
    }
    let (a, b) = (solved(&declared, &table), solved(&without, &with_columns));
    assert_eq!(numbers(&a), numbers(&b));
    let lost = bound(&without, &[table]).map(|b| b.repairs);
    let lost = lost.unwrap_err().to_string();
    assert!(lost.contains("sunlight.reference_x"), "{lost}");
}

/// Columns of a direction and of its reference can have other names.
#[test]
fn regress_columns_of_directions_can_be_mapped() {
    let one = |name: &str, column: &str| {
        format!("\"{name}\" = {{ column = \"{column}\", unit = \"1\" }}\n")
    };
    let map = ["x", "y", "z"].map(|k| {
        one(&format!("field.direction_{k}"), &format!("B{k}"))
            + &one(&format!("field.reference_{k}"), &format!("IGRF{k}"))
    });
    let sensor = "[[sensor]]\nname = \"field\"\ntype = \"direction\"\nnoise_rad = 1e-3\n";
    let text = format!(
        "{}\n{sensor}[telemetry.columns]\n{}",
        vehicle(),
        map.concat()
    );
    let model = parse_model(&text, "m.toml").unwrap();
    assert_eq!(model.telemetry.all.columns.len(), 6);
}

/// The cubesat of the examples with known numbers from a drawing: columns on other axes than the measured directions kept the fit
/// from convergence.
#[test]
fn regress_directions_and_uncertain_known_numbers_converge() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let case = poinsot::case::read_case(&folder.join("cubesat.toml")).unwrap();
    let truth = poinsot_model::read_model(&case.model).unwrap();
    let nominal = poinsot_model::read_model(folder.join("cubesat_model.toml")).unwrap();
    let nominal = nominal.with_usual_uncertainty(Origin::Cad);
    let table = simulate_trial(&case, &truth, 0).unwrap().table;
    let found = solved(&nominal, &table);
    assert_eq!(found.doubts(), Vec::<String>::new());
    assert!(found.iterations < 12, "{}", found.iterations);
    let exact = truth.bodies[0].nominal.I_BBcm_B;
    for (n, at) in found.bodies[0].inertia.iter().zip(TENSOR) {
        let z = (n.value.unwrap() - exact[at]) / n.sigma.unwrap();
        assert!(z.abs() < 4.0, "{at:?}: {z}");
    }
}

/// The cubesat of the examples with both of its directions, and with the sun alone: a gyro bias of 3e-3 rad/s turns by 50 degrees
/// in the record, and from the identity the fit ended far off.
#[test]
fn stat_one_direction_and_a_biased_gyro_are_enough() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let case = poinsot::case::read_case(&folder.join("cubesat.toml")).unwrap();
    let truth = poinsot_model::read_model(&case.model).unwrap();
    let mut nominal = poinsot_model::read_model(folder.join("cubesat_model.toml")).unwrap();
    for trial in 0..3 {
        let table = simulate_trial(&case, &truth, trial).unwrap().table;
        for sensors in [4, 3] {
            nominal
                .sensors
                .retain(|s| sensors == 4 || s.name != "magnetometer");
            let found = solved(&nominal, &table);
            let exact = truth.bodies[0].nominal.I_BBcm_B;
            for (n, at) in found.bodies[0].inertia.iter().zip(TENSOR) {
                let z = (n.value.unwrap() - exact[at]) / n.sigma.unwrap();
                assert!(z.abs() < 4.0, "{trial}, {sensors} sensors, {at:?}: {z}");
            }
        }
        nominal = poinsot_model::read_model(folder.join("cubesat_model.toml")).unwrap();
    }
}

/// A camera that sees a link turn about its joint is one more encoder: both together are an encoder of their weighted mean.
#[test]
fn exact_a_camera_and_an_encoder_are_one_encoder() {
    let [a, b] = [ENCODER.2, CAMERA.2].map(|sigma| 1.0 / (sigma * sigma));
    let sigma = (1.0 / (a + b)).sqrt();
    let with = |more: &[Declared]| bound_of(&model(&[&ROUGH[..], more].concat()));
    let both = with(&[ENCODER, CAMERA]);
    let (_, gap) = gaps(&both, &with(&[("encoder", "joint_position", sigma, "")]));
    let (_, lower) = gaps(&both, &with(&[ENCODER]));
    // The size of the joint's acceleration is found from the encoder's samples and their noise: the two differ in that. Measured: 4e-4
    // and 0.15.
    println!("sigmas {gap:.1e}, without the camera {lower:.1e}");
    assert!(gap < 1.0e-3 && lower > 0.1, "{gap:e} {lower:e}");
}

#[test]
fn exact_a_camera_lowers_sigma_to_the_bound_in_any_order_of_declaration() {
    let [gyro, star, speed] = ROUGH;
    let first = model(&[gyro, star, speed, ENCODER, CAMERA, MARKER]);
    let last = model(&[MARKER, CAMERA, ENCODER, speed, star, gyro]);
    let table = simulate_trial(&sensed(), &first, 0).unwrap().table;
    let (found, again) = (solved(&first, &table), solved(&last, &table));
    let (value, sigma) = gaps(&numbers(&found), &numbers(&again));
    println!("order: values {value:.1e} sigma, sigmas {sigma:.1e}");
    assert!(value < 1.0e-9 && sigma < 1.0e-9, "{value:e} {sigma:e}");
    let bound = numbers(&study_of(&sensed(), &first).bound().unwrap());
    let (_, sigma) = gaps(&numbers(&found), &bound);
    println!("bound: sigmas {sigma:.1e}");
    assert!(sigma < 3.0e-2, "{sigma:e}");
    let mut blind = table.clone();
    blind.channels.retain(|c| !c.name.starts_with("relative_"));
    let without = solved(&model(&[gyro, star, speed, ENCODER]), &blind);
    for ((_, with), (_, without)) in numbers(&found).iter().zip(numbers(&without)) {
        println!("{with:.3e} {without:.3e}");
        assert!(*with < without, "{with:e} {without:e}");
    }
}

/// An encoder with an unknown offset, and a camera that measures attitude and place of the arm.
#[test]
fn stat_a_camera_and_a_biased_encoder_are_calibrated() {
    let [gyro, star, speed] = ROUGH;
    let encoder = ("encoder", "joint_position", 1.0e-3, "bias = \"estimate\"\n");
    let camera = ("camera", "attitude", 5.0e-4, CAMERA.3);
    let marker = ("marker", "position", 2.5e-4, MARKER.3);
    let model = model(&[gyro, star, speed, encoder, camera, marker]);
    let study = study_of(&sensed(), &model);
    let bound = study.bound().unwrap();
    // Encoder less camera at 101 samples; the marker is 0.5 m from the joint.
    let camera = 1.0 / (1.0 / camera.2.powi(2) + (0.5 / marker.2).powi(2));
    let expected = ((encoder.2.powi(2) + camera) / 101.0).sqrt();
    let offset = bound.nuisance.iter().find(|n| n.name == "elbow.offset");
    let sigma = offset.unwrap().number.sigma.unwrap();
    println!("offset {sigma:.3e} rad, of the camera alone {expected:.3e} rad");
    let gap = (sigma / expected - 1.0).abs();
    assert!(gap < 2.0e-2, "{gap:e}");
    let result = statistics(&rows(&study, 0..60));
    println!("NEES {:?}", result.nees);
    assert!(result.nees.is_some());
    let faults = faults(&result);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The pose of the arm in the bus is a turn about the joint's axis, whatever the bus does.
#[test]
fn exact_a_relative_pose_is_that_of_the_joint() {
    let mut quiet = model(&[CAMERA, MARKER]);
    let seen = quiet.sensors.clone();
    for sensor in &seen {
        // The bus seen from the arm.
        quiet.sensors.push(poinsot_model::Sensor {
            name: format!("back {}", sensor.name),
            body: 0,
            seen_from: 1,
            ..sensor.clone()
        });
    }
    quiet
        .sensors
        .iter_mut()
        .for_each(|s| s.noise_covariance = None);
    let table = simulate_trial(&case(), &quiet, 0).unwrap().table;
    let of = |sensor: &str, name: String| &table.sensor_channel(sensor, &name).unwrap().values;
    let turn = |sensor: &str| ["x", "y", "z", "w"].map(|k| of(sensor, format!("relative_q_{k}")));
    let place = |sensor: &str| ["x", "y", "z"].map(|k| of(sensor, format!("relative_r_{k}")));
    let angle = &table.channel("elbow_rad").unwrap().values;
    let (origin, point) = (Vector3::new(0.3, 0.1, 0.2), Vector3::new(0.5, 0.0, 0.0));
    let about_z = |v: &Vector3, a: f64| {
        let (s, c) = a.sin_cos();
        Vector3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
    };
    for (k, a) in angle.iter().enumerate() {
        let half = Vector3::new(0.0, 0.0, (0.5 * a).sin());
        for (sensor, sign) in [("camera", 1.0), ("back camera", -1.0)] {
            let [x, y, z, w] = turn(sensor).map(|c| c[k]);
            // A quaternion and its negative are one rotation.
            let q = Vector3::new(x, y, z) * w.signum();
            assert!((q - half * sign).amax() < 1.0e-12, "{sensor} {k}: {q}");
            assert!((w.abs() - (0.5 * a).cos()).abs() < 1.0e-12, "{sensor} {k}");
        }
        let expected = [
            ("marker", origin + about_z(&point, *a)),
            ("back marker", about_z(&(point - origin), -*a)),
        ];
        for (sensor, expected) in expected {
            let [x, y, z] = place(sensor).map(|c| c[k]);
            let gap = Vector3::new(x, y, z) - expected;
            assert!(gap.amax() < 1.0e-12, "{sensor} {k}: {gap}");
        }
    }
}

/// The velocity of the marker in the bus is that of a point on a turning arm, whatever the bus does.
#[test]
fn exact_a_relative_velocity_is_that_of_the_joint() {
    let mut quiet = model(&[FINE, FLOW]);
    let mut back = quiet.sensors[1].clone();
    back.name = "back".to_owned();
    (back.body, back.seen_from) = (0, 1);
    quiet.sensors.push(back);
    quiet
        .sensors
        .iter_mut()
        .for_each(|s| s.noise_covariance = None);
    let table = simulate_trial(&case(), &quiet, 0).unwrap().table;
    let axes = |sensor: &str| {
        ["x", "y", "z"].map(|k| {
            let name = format!("relative_v_{k}");
            &table.sensor_channel(sensor, &name).unwrap().values
        })
    };
    let joint = |name: &str| &table.channel(name).unwrap().values;
    let (angle, rate) = (joint("elbow_rad"), joint("elbow_rad_s"));
    let (flow, back) = (axes("flow"), axes("back"));
    let (origin, point) = (Vector3::new(0.3, 0.1, 0.2), Vector3::new(0.5, 0.0, 0.0));
    let vector = |of: [&Vec<f64>; 3], k: usize| Vector3::from(of.map(|c| c[k]));
    for (k, (a, rate)) in angle.iter().zip(rate).enumerate() {
        let (s, c) = a.sin_cos();
        let expected = Vector3::new(-s, c, 0.0) * (point.x * rate);
        let gap = vector(flow, k) - expected;
        assert!(gap.amax() < 1.0e-12, "{k}: {gap}");
        // Seen from the arm, the point of the bus turns the other way round.
        let r = point - origin;
        let turned = Vector3::new(c * r.x + s * r.y, c * r.y - s * r.x, r.z);
        let expected = Vector3::new(turned.y, -turned.x, 0.0) * *rate;
        let gap = vector(back, k) - expected;
        assert!(gap.amax() < 1.0e-12, "back {k}: {gap}");
    }
}

/// A measured velocity of the arm in the bus is one more measurement of the joint's rate.
#[test]
fn exact_optical_flow_lowers_sigma_to_the_bound_in_any_order_of_declaration() {
    let [gyro, star, speed] = ROUGH;
    let rate = ("resolver", "joint_rate", 1.0e-2, "");
    let first = model(&[gyro, star, speed, ENCODER, rate, FLOW]);
    let last = model(&[FLOW, rate, ENCODER, speed, star, gyro]);
    let table = simulate_trial(&sensed(), &first, 0).unwrap().table;
    let (found, again) = (solved(&first, &table), solved(&last, &table));
    let (value, sigma) = gaps(&numbers(&found), &numbers(&again));
    println!("order: values {value:.1e} sigma, sigmas {sigma:.1e}");
    assert!(value < 1.0e-9 && sigma < 1.0e-9, "{value:e} {sigma:e}");
    let bound = numbers(&study_of(&sensed(), &first).bound().unwrap());
    let (_, sigma) = gaps(&numbers(&found), &bound);
    println!("bound: sigmas {sigma:.1e}");
    assert!(sigma < 3.0e-2, "{sigma:e}");
    let mut blind = table.clone();
    blind.channels.retain(|c| !c.name.starts_with("relative_"));
    let without = solved(&model(&[gyro, star, speed, ENCODER, rate]), &blind);
    let pairs = numbers(&found).into_iter().zip(numbers(&without));
    let shares: Vec<f64> = pairs
        .map(|((_, with), (_, without))| with / without)
        .collect();
    println!("sigma with the flow over sigma without: {shares:.3?}");
    assert!(shares.iter().all(|s| *s < 1.0), "{shares:?}");
}

/// An optical flow with an unknown bias and scale.
#[test]
fn stat_optical_flow_is_calibrated() {
    let [gyro, star, speed] = ROUGH;
    let encoder = ("encoder", "joint_position", 1.0e-3, "");
    let rate = ("resolver", "joint_rate", 1.0e-2, "");
    let more = format!("{}bias = {{ sigma_m_s = 0.01 }}\n", FLOW.3);
    let flow = ("flow", "velocity", 1.0e-3, more.as_str());
    let model = model(&[gyro, star, speed, encoder, rate, flow]);
    let study = study_of(&sensed(), &model);
    let result = statistics(&rows(&study, 0..60));
    println!("NEES {:?}", result.nees);
    assert!(result.nees.is_some());
    let faults = faults(&result);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// A relative pose is no attitude and no position of the base in N.
#[test]
fn unit_a_relative_pose_does_not_start_the_base() {
    let seen = model(&[FINE, CAMERA, MARKER]);
    let table = simulate_trial(&sensed(), &seen, 0).unwrap().table;
    let names: Vec<&str> = table.channels.iter().map(|c| &*c.name).collect();
    assert!(names.contains(&"relative_q_w") && names.contains(&"relative_r_z"));
    assert!(
        !names.contains(&"q_w") && !names.contains(&"r_x"),
        "{names:?}"
    );
    let found = bound(&seen, std::slice::from_ref(&table)).unwrap();
    let said = found.repairs.join("\n");
    assert!(
        said.contains("no attitude channel: attitude integrated from the gyro, from the identity"),
        "{said}"
    );
    assert!(found.segments[0].samples.translation.is_none());
    assert_eq!(found.segments[0].observations.sensors.len(), 3);
    // Velocity in N needs an attitude in N.
    let fast = model(&[FINE, SPEED, CAMERA, MARKER]);
    let table = simulate_trial(&sensed(), &fast, 0).unwrap().table;
    let refused = bound(&fast, &[table]).map(|_| ()).unwrap_err().to_string();
    assert!(refused.contains("v_x v_y v_z"), "{refused}");
    let mut silent = seen;
    silent.sensors[1].noise_covariance = None;
    let table = simulate_trial(&sensed(), &silent, 0).unwrap().table;
    let refused = bound(&silent, &[table])
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(refused.contains("noise_rad"), "{refused}");
}

/// The declared uncertainty of a camera's mounting was lost: its table was looked for among trackers in inertial axes.
#[test]
fn regress_a_camera_keeps_the_uncertainty_of_its_mounting() {
    let more = format!("{}uncertainty = {{ mounting_rad = 0.01 }}\n", CAMERA.3);
    let model = model(&[FINE, ("camera", "attitude", 1.0e-3, &more)]);
    let sigmas: Vec<f64> = model.knowledge.uncertain.iter().map(|u| u.sigma).collect();
    assert_eq!(sigmas, [0.01]);
}

/// A vehicle with a camera is written and read back as it was.
#[test]
fn exact_a_written_model_keeps_what_sees_and_what_is_seen() {
    let first = model(&[FINE, CAMERA, MARKER]);
    let text = poinsot_model::write_model(&first);
    assert!(text.contains("seen_from = \"bus\""), "{text}");
    let again = parse_model(&text, "again.toml").unwrap();
    assert_eq!(first.sensors, again.sensors);
    let map = "[telemetry]\nattitude = [{ sensor = \"camera\", mrp = [\"a\", \"b\", \"c\"], relative = true }]\n";
    let mapped = parse_model(&format!("{text}\n{map}"), "m.toml").unwrap();
    assert!(mapped.telemetry.all.attitude[0].relative);
    let again = parse_model(&poinsot_model::write_model(&mapped), "m.toml").unwrap();
    assert_eq!(mapped.telemetry, again.telemetry);
}

/// Each camera is compared with what it sees from the body that carries it.
#[test]
fn stat_a_case_is_compared_with_what_every_camera_sees() {
    let back = (
        "back",
        "attitude",
        1.0e-3,
        "body = \"bus\"\nseen_from = \"arm\"\n",
    );
    let model = model(&[FINE, COARSE, STAR, CAMERA, MARKER, back]);
    let table = simulate_trial(&sensed(), &model, 0).unwrap().table;
    let found = compare_with_telemetry(&sensed(), &Mover::of_model(model), &table).unwrap();
    let names: Vec<&str> = found.iter().map(|c| c.file.quantity.as_str()).collect();
    for name in [
        "gyro fine",
        "gyro coarse",
        "attitude",
        "relative_attitude camera",
        "relative_attitude back",
        "relative_position",
    ] {
        let one = found.iter().find(|c| c.file.quantity == name);
        let one = one.unwrap_or_else(|| unreachable!("{name} in {names:?}"));
        // 303 numbers: one sigma of the root mean square is 0.04.
        let rms = one.file.sigmas.unwrap().rms;
        println!("{name}: {rms:.2}");
        assert!((rms - 1.0).abs() < 0.2, "{name}: {rms}");
    }
}

/// Gyro and star tracker on a link alone: the fit starts from the motion that they tell of the base.
#[test]
fn exact_sensors_on_a_link_alone_start_a_fit() {
    for sensors in [
        [STAR, SPEED, ON_ARM],
        [FINE, SPEED, ARM_STAR],
        [SPEED, ON_ARM, ARM_STAR],
    ] {
        let own = model(&sensors);
        let table = simulate_trial(&sensed(), &own, 0).unwrap().table;
        let found = solved(&own, &table);
        let (_, gap) = gaps(&numbers(&found), &bound_of(&own));
        assert!(gap < 0.02, "{gap:e}");
        let truth = &own.bodies[0].nominal;
        for ((value, sigma), x) in numbers(&found).into_iter().zip(truth.to_array()) {
            assert!((value - x).abs() < 4.5 * sigma, "{value} {sigma} {x}");
        }
    }
}
