//! Records of public bug reports, rebuilt by programs that share nothing with this one: what is missing is refused by name, and what
//! is written in another form is read. Each answer is compared with the vehicle that made the record.

use crate::reported::{AGREES, Record};
use poinsot::{Identified, identify};

/// Mass, mass centre and inertia (xx, xy, yy, xz, yz, zz) of the tool of the four-joint arm.
const TOOL: [f64; 10] = [
    9.0, 0.03, -0.05, 0.16, 0.14, 0.01, 0.11, -0.015, 0.008, 0.09,
];
/// Inertia of the satellite, and its mass centre.
const SATELLITE: [f64; 6] = [14.2, 0.35, 17.1, -0.22, 0.5, 11.3];
const CENTRE: [f64; 3] = [0.062, -0.031, 0.104];

/// Every determined number of the first requested body agrees with the truth, and nothing is against the answer.
fn agrees(found: &Identified, mass: Option<f64>, com: Option<[f64; 3]>, inertia: [f64; 6]) {
    assert!(found.passes(), "{:?}", found.estimate.doubts());
    let body = found.estimate.bodies.iter().find(|b| b.asked).unwrap();
    let com = com.into_iter().flatten();
    let pairs = body
        .com
        .iter()
        .zip(com)
        .chain(body.inertia.iter().zip(inertia));
    for (number, truth) in pairs.chain(mass.map(|m| (&body.mass, m))) {
        let (value, sigma) = (number.value.unwrap(), number.sigma.unwrap());
        let off = (value - truth) / sigma;
        assert!(
            off.abs() < AGREES,
            "{value} +- {sigma} is not {truth}: {off} sigma"
        );
    }
}

fn is_the_tool(found: &Identified) {
    let [mass, x, y, z, inertia @ ..] = TOOL;
    agrees(found, Some(mass), Some([x, y, z]), inertia);
}

#[test]
fn regress_a_joint_whose_column_has_another_name_is_refused_with_the_line_that_maps_it() {
    let said = Record::new("joint_with_another_name", &[], "").refusal();
    let line = r#"J4_rad = { column = "J4_position", unit = "rad" }"#;
    assert!(said.starts_with("E0301 "), "{said}");
    assert!(
        said.contains(line) && said.contains("locked_at_rad"),
        "{said}"
    );
    let map = format!("\n[telemetry.columns]\n{line}\n");
    is_the_tool(&Record::new("joint_with_another_name", &[], &map).answer());
    // Held at another place than it is: the answer says how much hangs on that.
    let held = ("child = \"L4\"\n", "child = \"L4\"\nlocked_at_rad = 0.3\n");
    let found = Record::new("joint_with_another_name", &[held], "").answer();
    is_the_tool(&found);
    let assumed = found.repairs().join("\n");
    let effect = "assumed: J4 locked at 0.3 rad; 0.1 rad off would change tool.";
    assert!(assumed.contains(effect), "{assumed}");
    let sigmas: Vec<f64> = assumed
        .split(effect)
        .nth(1)
        .into_iter()
        .flat_map(|rest| rest.split_whitespace().filter_map(|word| word.parse().ok()))
        .collect();
    // 0.3 rad move the mass centre by 260 sigma.
    assert!(sigmas[0] > 30.0, "{assumed}");
    assert!(
        assumed.contains("no geared rotors in the joints; 1 % of the inertia"),
        "{assumed}"
    );
}

#[test]
fn regress_a_joint_with_a_rate_alone_is_not_locked() {
    let map = "\n[telemetry.columns]\nJ4_rad = { column = \"J4_position\", unit = \"rad\" }\n";
    let held = ("child = \"L1\"\n", "child = \"L1\"\nlocked_at_rad = 0.2\n");
    let gone = ("name = \"J1\"", "name = \"K1\"");
    let rate = "K1_rad_s = { column = \"J1_rad_s\", unit = \"rad/s\" }\n";
    let said = Record::new(
        "joint_with_another_name",
        &[held, gone],
        &format!("{map}{rate}"),
    )
    .refusal();
    assert!(
        said.contains("no channel 'K1_rad', but 'K1_rad_s' says that the joint moves"),
        "{said}"
    );
}

#[test]
fn regress_a_finger_that_mimics_another_shares_its_column() {
    let said = Record::new("mimic_joint", &[], "").refusal();
    assert!(said.contains("no channel 'F2_m'"), "{said}");
    let map = "\n[telemetry.columns]\nF2_m = { column = \"F1_m\", unit = \"m\", scale = 1.0 }\nF2_m_s = { column = \"F1_m_s\", unit = \"m/s\", scale = 1.0 }\n";
    is_the_tool(&Record::new("mimic_joint", &[], map).answer());
}

#[test]
fn regress_a_gyro_on_a_link_that_is_fixed_to_the_base() {
    is_the_tool(&Record::new("imu_on_fixed_link", &[], "").answer());
}

#[test]
fn regress_one_row_per_value() {
    agrees(
        &Record::new("one_row_per_value", &[], "").answer(),
        None,
        None,
        SATELLITE,
    );
}

#[test]
fn regress_angle_increments_of_a_gyro() {
    let map = ["x", "y", "z"].map(|k| {
        format!("omega_{k} = {{ column = \"omega_{k}\", unit = \"rad\", increments = true }}\n")
    });
    let map = format!("\n[telemetry.columns]\n{}", map.concat());
    agrees(
        &Record::new("angle_increments", &[], &map).answer(),
        None,
        None,
        SATELLITE,
    );
}

#[test]
fn regress_sixteen_bits_read_as_unsigned() {
    let signed = (
        "unit = \"deg/s\" }",
        "unit = \"deg/s\", signed_range = 163.84 }",
    );
    agrees(
        &Record::new("unsigned_gyro", &[signed], "").answer(),
        None,
        None,
        SATELLITE,
    );
}

#[test]
fn regress_valves_that_open_and_close_late() {
    let late = (
        "nominal_N = 5.0,",
        "nominal_N = 5.0, opens_late_s = 0.008, closes_late_s = 0.002,",
    );
    let found = Record::new("late_valves", &[late], "").answer();
    agrees(&found, Some(120.0), Some(CENTRE), SATELLITE);
}

/// Attitude and rate are relative to the orbital frame: taken as inertial, they give I_xy 3.6 sigma off.
#[test]
fn regress_attitude_relative_to_the_orbital_frame() {
    let map = "\n[telemetry]\norbital_frame = { rate_rad_s = 0.00108, rates = true }\n";
    agrees(
        &Record::new("orbital_frame", &[], map).answer(),
        None,
        None,
        SATELLITE,
    );
}

/// Inertia of the small satellite.
const SMALL: [f64; 6] = [0.138, 0.002, 0.109, -0.0013, 0.0008, 0.066];

/// What the program itself proposes leads to the truth.
#[test]
fn regress_reported_records_are_right_after_repair() {
    let repaired = |name| {
        let record = Record::new(name, &[], "");
        let mut request = record.request();
        request.question.repair = true;
        identify(&request).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    for name in [
        "rates_in_world_axes",
        "joint_of_other_sign",
        "joint_within_one_turn",
        "joint_behind_a_pulley",
    ] {
        is_the_tool(&repaired(name));
    }
    agrees(&repaired("held_attitude"), None, None, SATELLITE);
    agrees(&repaired("unknown_torque"), None, None, SMALL);
    agrees(&repaired("mirrored_sun_sensor"), None, None, SMALL);
}

/// The mass centre is then the origin, and nominal is far away.
#[test]
fn regress_the_velocity_of_the_mass_centre_is_doubted() {
    let found = Record::new("velocity_of_mass_centre", &[], "").answer();
    let doubts = format!("{:?}", found.estimate.doubts());
    assert!(
        !found.passes() && doubts.contains("mass centre"),
        "{doubts}"
    );
}

#[test]
fn regress_a_mass_centre_alone_is_told_what_else_to_ask_for() {
    let said = Record::new("mass_centre_alone", &[], "").refusal();
    assert!(said.contains("add \"inertia\" to estimate"), "{said}");
    let both = ("estimate = [\"com\"]", "estimate = [\"com\", \"inertia\"]");
    let found = Record::new("mass_centre_alone", &[both], "").answer();
    assert!(found.passes(), "{:?}", found.estimate.doubts());
}
