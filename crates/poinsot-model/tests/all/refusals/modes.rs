//! Refusals of flexible modes.

use crate::refusals::{Case, GOOD};
use poinsot_files::Faults;
use poinsot_model::{Model, parse_model};

/// A mode on the link of [`GOOD`], with these keys changed or added.
macro_rules! mode {
    ($keys:literal) => {
        concat!(
            "[[mode]]\nname = \"panel\"\nbody = \"link1\"\nfrequency_Hz = 0.3\n",
            $keys,
            "\n[[sensor]]\nname = \"gyro\""
        )
    };
}

const GYRO: &str = "[[sensor]]\nname = \"gyro\"";

pub const CASES: &[Case] = &[
    (
        GYRO,
        mode!("damping_ratio = 0.5"),
        r#"accepted, notes ["line 35: mode[0].frequency_Hz (mode \"panel\"): nothing excites this mode: it participates neither in translation nor in rotation; give one"]"#,
    ),
    (
        GYRO,
        mode!("damping_ratio = 1.0"),
        r#"E0108 m.toml:36:17: mode[0].damping_ratio (mode "panel") = 1.0: the damping ratio must be below 1; give 0.005 for half a per cent"#,
    ),
    (
        GYRO,
        mode!("damping_ratio = -0.1"),
        r#"E0108 m.toml:36:17: mode[0].damping_ratio (mode "panel") = -0.1: the damping ratio is negative; give 0.005 for half a per cent"#,
    ),
    (
        GYRO,
        mode!("damping = 0.1"),
        r#"E0104 m.toml:36:1: mode[0].damping (mode "panel") = 0.1: unknown key; did you mean damping_ratio?"#,
    ),
    (
        GYRO,
        mode!("translation_kg = [1.0, 0.0, 0.0]"),
        r#"E0105 m.toml:36:1: mode[0].translation_kg (mode "panel") = [1.0, 0.0, 0.0]: wrong unit; write translation_kg05 and convert the number"#,
    ),
    (
        GYRO,
        mode!("rotation_kg05_m = [1.0, 0.0]"),
        r#"E0107 m.toml:36:19: mode[0].rotation_kg05_m (mode "panel") = [1.0, 0.0]: the list has 2 entries; write a list of 3 numbers"#,
    ),
    (
        GYRO,
        mode!("inertia_slope_kg05_m = { zx = 1.0 }"),
        r#"E0104 m.toml:36:26: mode[0].inertia_slope_kg05_m.zx (mode "panel") = 1.0: unknown key; remove it; known here: xx, yy, zz, xy, xz, yz"#,
    ),
    (
        GYRO,
        mode!("estimate = [\"inertia\"]"),
        r#"E0107 m.toml:36:13: mode[0].estimate[0] (mode "panel") = "inertia": the word is not one of those allowed here; write "frequency", "damping", "translation", "rotation", "inertia_slope"; did you mean "inertia_slope"?"#,
    ),
    (
        GYRO,
        mode!("translation_kg05 = [12.0, 0.0, 17.0]"),
        r#"E0115 m.toml:36:20: mode[0].translation_kg05 (mode "panel") = [12.0, 0.0, 17.0]: the mode moves 433 kg, but the vehicle has 412 kg; correct it: the square of its length is below the mass of the vehicle"#,
    ),
    (
        GYRO,
        mode!("rotation_kg05_m = [0.0, 0.0, 5.8]"),
        r#"E0115 m.toml:36:19: mode[0].rotation_kg05_m (mode "panel") = [0.0, 0.0, 5.8]: no positive inertia is left of the vehicle without what this mode and those before it carry; correct the participations: the squares of their rotations are below the vehicle's moments of inertia"#,
    ),
    (
        GYRO,
        mode!("[[mode]]\nname = \"panel\"\nbody = \"link2\"\nfrequency_Hz = 0.0"),
        r#"E0110 m.toml:37:8: mode[1].name = "panel": mode[0] has the same name; rename one of them
E0111 m.toml:38:8: mode[1].body (mode "panel") = "link2": there is no body of this name; did you mean "link1"?
E0108 m.toml:39:16: mode[1].frequency_Hz (mode "panel") = 0.0: the frequency must be greater than zero; give a positive number"#,
    ),
    (
        GYRO,
        mode!("[[mode]]\nname = \"boom\"\nfrequency = 1.0"),
        r#"E0106 m.toml:36:1: mode[1].body (mode "boom"): the key is missing; add body: Name of the body that carries it
E0105 m.toml:38:1: mode[1].frequency (mode "boom") = 1.0: missing unit; write frequency_Hz"#,
    ),
];

fn with(modes: &[String]) -> Result<Model, Faults> {
    parse_model(
        &GOOD.replacen(GYRO, &format!("{}{GYRO}", modes.concat()), 1),
        "m.toml",
    )
}

fn mode(name: usize, rotation: f64) -> String {
    format!(
        "[[mode]]\nname = \"m{name}\"\nbody = \"bus\"\nfrequency_Hz = 1.0\nrotation_kg05_m = [{rotation:?}, 0.0, 0.0]\n"
    )
}

#[test]
fn unit_six_modes_are_accepted_and_seven_are_not() {
    let modes: Vec<String> = (0..7).map(|k| mode(k, 0.1)).collect();
    assert_eq!(with(&modes[..6]).unwrap().modes.len(), 6);
    assert_eq!(
        with(&modes).unwrap_err().to_string(),
        "E0119 m.toml:62:1: mode[6]: the file has 7 modes; keep to the 6 of the lowest frequencies"
    );
}

#[test]
fn exact_what_modes_carry_together_is_held_against_the_vehicle() {
    // Moment about x of the bus, with the link: what two modes about x carry adds up.
    let alone = with(&[mode(0, 5.6)]);
    assert!(alone.is_ok());
    let both = with(&[mode(0, 5.6), mode(1, 5.6)]).unwrap_err().to_string();
    assert!(
        both.starts_with("E0115 m.toml:41:19: mode[1].rotation_kg05_m (mode \"m1\")"),
        "{both}"
    );
}

/// A panel of 4 kg, its mass centre 0.5 m from a hinge along x at 0.4 m: turned by an angle it moves along z.
#[test]
fn exact_a_panel_and_a_tank_are_modes_in_closed_form() {
    let text = format!(
        "{GOOD}\n{}",
        r#"
[[panel]]
name = "wing"
body = "bus"
hinge_m = [0.0, 0.4, 0.0]
axis = [1.0, 0.0, 0.0]
mass_kg = 4.0
com_m = [0.0, 0.5, 0.0]
inertia_kg_m2 = { xx = 0.5, yy = 0.1, zz = 0.6 }
stiffness_N_m_per_rad = 6.0
damping_N_m_s_per_rad = 0.06
[[tank]]
name = "fuel"
body = "bus"
position_m = [0.0, 0.0, 0.5]
mass_kg = 4.0
stiffness_N_per_m = 16.0
estimate = ["frequency"]
"#
    );
    let model = parse_model(&text, "model.toml").unwrap();
    let names: Vec<&str> = model.modes.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["wing", "fuel_x", "fuel_y", "fuel_z"]);
    // About the hinge 0.5 + 4 x 0.25 = 1.5 kg m2: 2 rad/s.
    let wing = &model.modes[0].mode;
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1.0e-12, "{a} {b}");
    near(wing.frequency_Hz, 1.0 / std::f64::consts::PI);
    near(wing.damping_ratio, 0.06 / (2.0 * 3.0));
    let root = 1.5_f64.sqrt();
    near(wing.translation.z, 4.0 * 0.5 / root);
    near(wing.rotation.x, (0.5 + 4.0 * 0.5 * 0.9) / root);
    let fuel = &model.modes[1];
    near(fuel.mode.frequency_Hz, 1.0 / std::f64::consts::PI);
    near(fuel.mode.translation.x, 2.0);
    near(fuel.mode.rotation.y, 1.0);
    assert!(fuel.estimate.frequency && !fuel.estimate.damping);
    // Written as modes, it reads back equal.
    let again = parse_model(&poinsot_model::write_model(&model), "again.toml").unwrap();
    assert_eq!(again.modes, model.modes);
}

#[test]
fn unit_a_panel_that_does_not_oscillate_is_refused() {
    let panel = r#"
[[tank]]
name = "fuel"
body = "bus"
position_m = [0.0, 0.0, 0.5]
mass_kg = 4.0
stiffness_N_per_m = 1.0
damping_N_s_per_m = 4.0
"#;
    let text = format!("{GOOD}\n{panel}");
    let error = parse_model(&text, "model.toml").unwrap_err().to_string();
    assert!(
        error.contains("E0115") && error.contains("1 times the critical one"),
        "{error}"
    );
}
