//! Records without attitude with exchanged columns or wrong time units.

use crate::shared::stsat3;
use poinsot::{Error, Identified, IdentifyRequest, Question, identify, identify_tables};
use poinsot_model::{Model, parse_model, read_model};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::{Channel, ReadOptions, Table, read, write};
use poinsot_testkit::rigid_body::{AsymmetricTop, Spin};
use std::sync::Arc;

fn model() -> Model {
    read_model(stsat3().join("model.toml")).unwrap()
}

/// The first minutes of three slews, gyro and wheels only.
fn gyro_and_wheels() -> Table {
    let files = [stsat3().join("multiaxis/telemetry_noisy.csv")];
    let mut table = read(&files, &ReadOptions::default()).unwrap();
    table.channels.retain(|c| !c.name.starts_with("q_"));
    for c in &mut table.channels {
        c.values.truncate(1500);
        c.time_s = c.time_s.iter().take(1500).copied().collect();
    }
    table
}

fn refusal(answer: Result<Identified, Error>) -> String {
    answer.map_or_else(|e| e.to_string(), |_| "answered".to_owned())
}

fn rename(table: &mut Table, from: &str, to: &str) {
    let channel = table.channels.iter_mut().find(|c| c.name == from);
    to.clone_into(&mut channel.unwrap().name);
}

/// They were called deg/s: rates divided by 57 are below the declared noise, where everything fits.
#[test]
fn stat_exchanged_gyro_axes_are_named_as_such() {
    let mut table = gyro_and_wheels();
    rename(&mut table, "omega_x", "held");
    rename(&mut table, "omega_y", "omega_x");
    rename(&mut table, "held", "omega_y");
    let estimate = identify_tables(model(), vec![table], &Question::default())
        .unwrap()
        .estimate;
    let found = estimate.diagnostics.unwrap().findings;
    let right = "other axes of the gyro (y, x, z) would explain 100 % of the misfit";
    assert!(found[0].text.starts_with(right), "{}", found[0].text);
}

/// A model that no interpretation of the rates makes right: no unit error is reported.
#[test]
fn stat_a_wrong_wheel_axis_is_not_called_a_unit() {
    let mut model = model();
    let tilt = nalgebra::Vector3::new(0.8, 0.6, 0.0);
    model.wheels[0].axis_B = tilt;
    let found = identify_tables(model, vec![gyro_and_wheels()], &Question::default()).unwrap();
    let said: Vec<&str> = found.findings.iter().map(|f| f.text.as_str()).collect();
    assert!(said.is_empty(), "{said:?}");
}

/// Times too large by a factor of 1000: the fit ran for minutes without naming the time.
#[test]
fn stat_times_in_milliseconds_are_refused_before_the_fit() {
    let mut table = gyro_and_wheels();
    for c in &mut table.channels {
        c.time_s = c.time_s.iter().map(|t| 1.0e3 * t).collect();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("telemetry.parquet");
    write(&path, &table.channels).unwrap();
    let request = IdentifyRequest::new(stsat3().join("model.toml"), [path]);
    let error = refusal(identify(&request));
    assert!(error.contains("E0220"), "{error}");
    assert!(error.contains("the times are probably in ms"), "{error}");
}

/// A cubesat that coasts at 45 deg/s under a gyro of 1 Hz with a large bias: at a 57th of its rates, which is below the noise, another
/// record would fit as well, and deg/s were advised.
#[test]
fn regress_a_fast_spin_is_not_called_a_unit() {
    let text = "schema = \"poinsot.model/1\"\nname = \"spinner\"\nexact = true\n[[body]]\nname = \"bus\"\nmass_kg = 3\n\
                com_m = [0, 0, 0]\ninertia_kg_m2 = { xx = 0.0385, yy = 0.0387, zz = 0.0069 }\nestimate = [\"inertia\"]\n\
                prior = { inertia_kg_m2 = 2e-4 }\n\
                [[sensor]]\nname = \"gyro\"\ntype = \"gyro\"\nbias = \"estimate\"\nnoise_rad_s = 1.6e-3\n";
    let model = parse_model(text, "m.toml").unwrap();
    let start = Spin {
        w_NB_B: Vector3::new(2.0e-3, -0.79, 1.0e-4),
        R_NB: Matrix3::identity(),
    };
    let body = AsymmetricTop::new(&model.bodies[0].nominal.I_BBcm_B, &start).unwrap();
    let time_s: Arc<[f64]> = (0..600).map(f64::from).collect();
    let mut seed = 1_u64;
    // The sum of twelve uniform numbers, of variance 1.
    let mut normal = || {
        let mut one = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| one()).sum::<f64>() - 6.0
    };
    let mut channel = |k: usize| Channel {
        name: format!("omega_{}", ["x", "y", "z"][k]),
        sensor: String::new(),
        unit: "rad/s".into(),
        frame: "body".into(),
        values: (time_s.iter())
            .map(|t| body.at(*t).w_NB_B[k] + [-0.16, 0.0, -0.02][k] + 1.6e-3 * normal())
            .collect(),
        time_s: time_s.clone(),
    };
    let table = Table {
        channels: vec![channel(0), channel(1), channel(2)],
        ..Table::default()
    };
    let found = identify_tables(model, vec![table], &Question::default()).unwrap();
    let said: Vec<&str> = found.findings.iter().map(|f| f.text.as_str()).collect();
    assert!(said.is_empty(), "{said:?}");
}
