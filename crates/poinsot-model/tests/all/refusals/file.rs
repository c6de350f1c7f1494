//! Refusals of the file as a whole, of momentum, environment and the telemetry table.

use crate::refusals::{Case, GOOD};
use poinsot_model::{KnownNumber, parse_model};

pub const CASES: &[Case] = &[
    (
        r#"schema = "poinsot.model/1""#,
        r#"schema = "poinsot.model/2""#,
        r#"E0103 m.toml:1:10: schema = "poinsot.model/2": this program does not support this format; write schema = "poinsot.model/1""#,
    ),
    (
        r#"schema = "poinsot.model/1""#,
        r#"schema = 1"#,
        r#"E0103 m.toml:1:10: schema = 1: this program does not support this format; write schema = "poinsot.model/1""#,
    ),
    (
        r#"schema = "poinsot.model/1"
"#,
        r#""#,
        r#"E0103 m.toml:1:1: schema: the key is missing; write schema = "poinsot.model/1""#,
    ),
    (
        r#"name = "test""#,
        r#"name = "#,
        r#"E0102 m.toml:2:8: not valid TOML: string values must be quoted, expected literal string; correct it here"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
name = "test""#,
        r#"E0102 m.toml:3:1: not valid TOML: duplicate key; correct it here"#,
    ),
    (
        r#"[[thruster]]"#,
        r#"[[jet]]"#,
        r#"E0104 m.toml:27:3: jet: unknown key; remove it; known here: schema, name, source, exact, nominal_within, thrust_correlation, body, joint, wheel, thruster, mode, panel, tank, sensor, momentum, environment, telemetry"#,
    ),
    (
        r#"[[wheel]]"#,
        r#"[[wheels]]"#,
        r#"E0104 m.toml:22:3: wheels: unknown key; did you mean wheel?"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
environment = { gravity = "point_mass" }"#,
        r#"E0106 m.toml:3:15: environment.gm_m3_s2: the key is missing; add gm_m3_s2: Gravitational parameter of the attracting body, m3/s2"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
environment = { gravity_gradient = true }"#,
        r#"E0106 m.toml:3:36: environment.gravity_gradient = true: the key has no effect without gravity = "point_mass"; remove it, or write gravity = "point_mass""#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
momentum = { linear_N_s = "zeros" }"#,
        r#"E0107 m.toml:3:27: momentum.linear_N_s = "zeros": the word is not one of those allowed here; write "estimate", "zero" or a list of 3 numbers; did you mean "zero"?"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
momentum = { linear = "zero" }"#,
        r#"E0105 m.toml:3:14: momentum.linear = "zero": missing unit; write linear_N_s"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
telemetry.columns = { omgea_x = { column = "w", unit = "deg/s" } }"#,
        r#"E0111 m.toml:3:33: telemetry.columns.omgea_x = { column = "w", unit = "deg/s" }: this vehicle has no channel of this name; did you mean omega_x?"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
telemetry.columns = { omega_x = { column = "w" } }"#,
        r#"E0212 m.toml:3:33: telemetry.columns.omega_x = { column = "w" }: there is no unit; write unit = "...", one of: rad/s, mrad/s, deg/s, mdeg/s, deg/h, arcsec/s, rpm, rev/s; or units_row = true where the file has a row of units"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
telemetry.where = { log = 3 }"#,
        r#"E0107 m.toml:3:27: telemetry.where.log = 3: a number is here, but another type is needed; write text in quotes"#,
    ),
];

/// A momentum is a speed only over a spin inertia that is known.
#[test]
fn unit_a_momentum_needs_a_wheel_whose_spin_inertia_is_known() {
    let refused = |model: &str, channel: &str| {
        let map =
            format!("[telemetry.columns]\n{channel} = {{ column = \"H\", unit = \"N m s\" }}\n");
        parse_model(&format!("{model}{map}"), "m.toml").map_err(|e| e.to_string())
    };
    let estimated = GOOD.replacen(
        "spin_inertia_kg_m2 = 4.113e-4",
        "spin_inertia_kg_m2 = 4.113e-4\nestimate = true",
        1,
    );
    let error = refused(&estimated, "wheel1_rad_s").unwrap_err();
    assert!(error.starts_with("E0212 m.toml:"), "{error}");
    assert!(
        error.ends_with("telemetry.columns.wheel1_rad_s.unit = \"N m s\": the speed is this momentum over a spin inertia, and no wheel has a known one; remove estimate = true of the wheel, or map a column of the speed"),
        "{error}"
    );
    let error = refused(GOOD, "joint1_rad_s").unwrap_err();
    assert!(error.contains("no wheel has a known one"), "{error}");
    let known = |model: &poinsot_model::Model| {
        model
            .uncertain()
            .any(|u| matches!(u.number, KnownNumber::SpinInertia(_)))
    };
    assert!(known(&parse_model(GOOD, "m.toml").unwrap()));
    assert!(!known(&refused(GOOD, "wheel1_rad_s").unwrap()));
}
