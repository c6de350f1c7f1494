//! Files and tables in memory pass the same checks: bitwise equal answers, equal faults.

use crate::shared::stsat3;
use poinsot::identify::read_options;
use poinsot::{
    IdentifyRequest, Question, Reading, estimate_file, identify, identify_records, identify_tables,
};
use poinsot_model::read_model;
use poinsot_telemetry::{MemoryColumns, Part, Table, Values, read, write};

use std::sync::Arc;

/// The first slews of the shipped record.
fn record() -> Table {
    let model = read_model(stsat3().join("model.toml")).unwrap();
    let options = read_options(&model, &model.telemetry, false, false);
    let mut table = read(&[stsat3().join("multiaxis/telemetry_noisy.csv")], &options).unwrap();
    for c in &mut table.channels {
        c.values.truncate(1500);
        c.time_s = c.time_s.iter().take(1500).copied().collect();
    }
    table
}

fn scale(table: &mut Table, prefix: &str, factor: f64) {
    let named = table
        .channels
        .iter_mut()
        .filter(|c| c.name.starts_with(prefix));
    named.flat_map(|c| &mut c.values).for_each(|v| *v *= factor);
}

fn stick(table: &mut Table, name: &str) {
    let channel = table.channels.iter_mut().find(|c| c.name == name).unwrap();
    let value = channel.values[700];
    channel.values[700..1000].fill(value);
}

/// Answer or error text, without file names.
fn told(answer: Result<poinsot::Identified, poinsot::Error>, file: &str) -> String {
    match answer {
        Ok(identified) => {
            let file = estimate_file(&identified);
            let findings: Vec<&str> = identified
                .findings
                .iter()
                .map(|f| f.text.as_str())
                .collect();
            format!("{:?} {} {findings:?}", file.bodies, file.status)
        }
        // What to write into a map is advised for files alone.
        Err(error) => format!("{} {}", error.code(), error.list[0].problem)
            .replace(file, "")
            .replace(": ", " ")
            .replace("  ", " "),
    }
}

/// Introduces a fault into a table.
type Plant = fn(&mut Table);

#[test]
fn prop_a_fault_found_in_a_file_is_found_in_memory() {
    let faults: [(&str, Plant); 5] = [
        ("none", |_| ()),
        ("wheels in rpm", |t| {
            scale(t, "wheel", 30.0 / std::f64::consts::PI)
        }),
        ("rates in deg/s", |t| {
            scale(t, "omega", 180.0 / std::f64::consts::PI)
        }),
        ("a gyro axis that sticks", |t| stick(t, "omega_x")),
        ("a rate of 1e9", |t| t.channels[0].values[3] = 1.0e9),
    ];
    let model = read_model(stsat3().join("model.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, plant) in faults {
        let mut table = record();
        plant(&mut table);
        let path = folder.path().join("telemetry.parquet");
        write(&path, &table.channels).unwrap();
        let request = IdentifyRequest::new(stsat3().join("model.toml"), [&path]);
        let from_file = told(identify(&request), &path.display().to_string());
        let options = read_options(&model, &model.telemetry, false, false);
        let from_memory = match read(std::slice::from_ref(&path), &options) {
            Ok(mut table) => {
                table.sources.clear();
                told(
                    identify_tables(model.clone(), vec![table], &Question::default()),
                    "",
                )
            }
            Err(error) => told(Err(error), &path.display().to_string()),
        };
        assert_eq!(from_file, from_memory, "{name}");
    }
}

#[test]
fn regress_one_record_twice_in_memory_is_refused() {
    let model = read_model(stsat3().join("model.toml")).unwrap();
    let tables = [(); 2].map(|()| Table {
        sources: Vec::new(),
        ..record()
    });
    let tables = tables.to_vec();
    let answer = identify_tables(model, tables, &Question::default());
    let error = answer.err().unwrap().to_string();
    assert!(
        error.contains("its content is that of segment 1"),
        "{error}"
    );
}

/// One record by every way of input: file, bytes, stream, columns in memory.
#[test]
fn exact_every_door_gives_the_same_bits() {
    let path = stsat3().join("multiaxis/telemetry_noisy.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let head: Vec<&str> = text.lines().take(1501).collect();
    let text = head.join("\n") + "\n";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("telemetry.csv");
    std::fs::write(&file, &text).unwrap();
    let names: Vec<&str> = head[0].split(',').collect();
    let cell = |line: &str, k: usize| line.split(',').nth(k).unwrap().parse().unwrap_or(f64::NAN);
    let columns = names.iter().enumerate().map(|(k, name)| {
        let values = head[1..].iter().map(|line| cell(line, k)).collect();
        ((*name).to_owned(), Values::Numbers(values))
    });
    let memory = MemoryColumns {
        name: "<arrays>".to_owned(),
        columns: columns.collect(),
    };
    let doors = [
        Part::File(file),
        Part::bytes("telemetry.csv", text.clone().into_bytes()),
        Part::stream("<stream>", &mut text.as_bytes()).unwrap(),
        Part::Memory(Arc::new(memory)),
    ];
    let answers = doors.map(|part| {
        let model = read_model(stsat3().join("model.toml")).unwrap();
        let question = Question::default();
        let answer = identify_records(model, &[vec![part]], &Reading::default(), &question);
        let file = estimate_file(&answer.unwrap());
        let numbers = (
            &file.bodies,
            &file.covariance,
            &file.nuisance,
            &file.momentum,
        );
        serde_json::to_string(&numbers).unwrap()
    });
    assert!(answers.iter().all(|a| *a == answers[0]));
}
