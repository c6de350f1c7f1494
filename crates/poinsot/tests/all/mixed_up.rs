//! Records without attitude with exchanged columns or wrong time units.

use crate::shared::stsat3;
use poinsot::{Error, Identified, IdentifyRequest, Question, identify, identify_tables};
use poinsot_model::{Model, read_model};
use poinsot_telemetry::{ReadOptions, Table, read, write};

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
    let right = "other axes of the gyro (body axes = (y, x, z)) would explain 100 % of the misfit";
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
