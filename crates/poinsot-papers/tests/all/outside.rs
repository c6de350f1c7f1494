//! Studies of the papers against an independent implementation: `validation/papers`, NumPy only.

use crate::kim2010::{fly, identify};
use crate::xu2017::{linear_null, truth};
use poinsot::study::{Cell, Context, Findings, Verbs, run, studies};
use poinsot_papers::kim2010::NAMES;
use poinsot_papers::xu2017::studies::robot::{IDENTIFIED, printed_bodies};
use poinsot_papers::xu2017::studies::together;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn outside(name: &str) -> Value {
    let path = repository().join("validation/papers").join(name);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn study(paper: &str, name: &str) -> Findings {
    let (_, study) = studies()
        .find(|s| s.0 == paper && s.1.name == name)
        .unwrap();
    run(study, &repository().join("data")).unwrap()
}

/// The numbers of the row with this first cell.
fn row(findings: &Findings, table: &str, row: &str) -> Vec<f64> {
    let table = findings.tables.iter().find(|t| t.name == table).unwrap();
    let cells = table.rows.iter().find(|r| r[0].text() == row).unwrap();
    let number = |c: &Cell| match c {
        Cell::Number(x, _) => Some(*x),
        _ => None,
    };
    cells[1..].iter().filter_map(number).collect()
}

/// Every number agrees within a relative tolerance.
fn near(label: &str, ours: &[f64], theirs: &[f64], share: f64) {
    assert_eq!(ours.len(), theirs.len(), "{label}");
    for (a, b) in ours.iter().zip(theirs) {
        assert!(
            (a - b).abs() <= share * b.abs(),
            "{label}: ours {ours:?}, outside {theirs:?}"
        );
    }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

/// A constant velocity offset and a gyro bias in both options.
#[test]
fn xval_offset_and_bias_in_both_options() {
    let (theirs, ours) = (outside("ma2008.json"), study("ma2008", "advantages"));
    for cell in theirs["offset"].as_array().unwrap() {
        let (size, axis) = (cell["m_s"].as_f64().unwrap(), text(&cell["axis"]));
        let title = format!("Table 1 base, {size} m/s along {axis}");
        near(
            &title,
            &row(&ours, "offset", &title),
            &numbers(&cell["mass_kg"]),
            1.0e-5,
        );
    }
    for cell in theirs["bias"].as_array().unwrap() {
        let title = format!("Table 1 base, 1e-4 rad/s about {}", text(&cell["axis"]));
        let percent: Vec<f64> = numbers(&cell["tensor"]).iter().map(|x| 100.0 * x).collect();
        near(&title, &row(&ours, "bias", &title), &percent, 0.01);
    }
}

/// Errors of the tensor at 3 % noise in four interpretations; medians of 200 trials scatter.
#[test]
fn xval_four_readings_of_three_per_cent() {
    let (theirs, ours) = (outside("ma2008.json"), study("ma2008", "readings"));
    for cell in theirs["noise"].as_array().unwrap() {
        let [largest, known] = ["largest", "known"].map(|k| cell[k].as_bool().unwrap());
        let scaling = if largest {
            "largest component's maximum"
        } else {
            "each component's own maximum"
        };
        let title = format!("{scaling}, option {}", if known { 1 } else { 2 });
        let percent: Vec<f64> = numbers(&cell["tensor"]).iter().map(|x| 100.0 * x).collect();
        near(&title, &row(&ours, "readings", &title), &percent, 0.25);
    }
}

/// Bounds of mass and tensor against span of motion, moving joints and mass ratio.
#[test]
fn xval_bounds_of_the_claims() {
    let (theirs, ours) = (outside("ma2008.json"), study("ma2008", "reach"));
    let names = [("span", "factor"), ("ratio", "ratio"), ("joints", "moves")];
    for (table, key) in names {
        for cell in theirs[table].as_array().unwrap() {
            let title = match key {
                "factor" => format!("{}", cell[key].as_f64().unwrap()),
                "ratio" => format!("{}", 100.0 * cell[key].as_f64().unwrap()),
                _ => match numbers(&cell[key]).as_slice() {
                    [one] => format!("{}", one + 1.0),
                    [_, _] => "1 and 2".to_owned(),
                    _ => "1, 2, 3 (trajectory 1)".to_owned(),
                },
            };
            let both = [numbers(&cell["known"]), numbers(&cell["unknown"])].concat();
            let percent: Vec<f64> = both.iter().map(|x| 100.0 * x).collect();
            let found = &row(&ours, table, &title)[..4];
            near(&format!("{table} {title}"), found, &percent, 0.01);
        }
    }
}

/// (75) overestimates the products by a factor of two; all joints together against one.
#[test]
fn xval_looseness_of_75_and_all_joints_at_once() {
    let theirs = outside("xu2017.json");
    let ours = study("xu2017", "coefficients");
    for axis in ["x", "y", "z"] {
        let largest = numbers(&theirs["largest"][axis]);
        near(
            axis,
            &row(&ours, "bounds", &format!("dL_{axis}")),
            &largest,
            0.005,
        );
    }
    let shipped = repository().join("data");
    let context = Context {
        data: &shipped,
        tools: &Verbs,
    };
    let cases = together::cases(&context).unwrap();
    for (case, key) in cases.iter().zip(["alone", "together"]) {
        let (found, _) = together::answer(&context, case, "xu2017", None).unwrap();
        let condition = theirs[key]["condition"].as_f64().unwrap();
        near(key, &[together::condition(&found)], &[condition], 1.0e-3);
    }
}

/// Every number agrees within an absolute tolerance.
fn close(label: &str, ours: &[f64], theirs: &[f64], distance: f64) {
    assert_eq!(ours.len(), theirs.len(), "{label}");
    for (a, b) in ours.iter().zip(theirs) {
        assert!(
            (a - b).abs() <= distance,
            "{label}: ours {ours:?}, outside {theirs:?}"
        );
    }
}

/// The columns of Table 2 without noise, for one slew and for three of 17 deg.
#[test]
fn xval_columns_of_table_2() {
    let (theirs, ours) = (outside("kim2010.json"), study("kim2010", "table2"));
    // In the study's table the printed numbers are between the columns.
    for (column, at) in [("batch", 1), ("conventional", 3), ("suggested", 5)] {
        let found = NAMES.map(|name| row(&ours, "columns", name)[at]);
        close(column, &found, &numbers(&theirs["one"][column]), 1.0e-4);
    }
    let record = fly("stsat3_three_slews_17deg.toml", false);
    for column in ["batch", "conventional", "pre-estimate", "suggested"] {
        let answer = identify(record.clone(), "kim2010", Some(column));
        let report = answer.method_report.unwrap();
        let values = report.numbers[..6].iter().map(|n| n.value.unwrap());
        let found: Vec<f64> = values.collect();
        close(column, &found, &numbers(&theirs["17deg"][column]), 2.0e-4);
    }
}

/// The column "considering pre-estimate" from the other columns of Table 2.
#[test]
fn xval_inversion_of_table_2() {
    let (theirs, ours) = (outside("kim2010.json"), study("kim2010", "pre-estimate"));
    let theirs = &theirs["inversion"];
    let at_once = "every product with the other product of its row as (15) gives it, all at once";
    let found = row(&ours, "readings", at_once);
    close(
        at_once,
        &found[..3],
        &numbers(&theirs["pre_estimate"]),
        1.0e-5,
    );
}

/// The number of combinations determined by momentum (of 70 numbers), and the unobservable part of the errors in
/// Tables 6 to 12.
#[test]
fn xval_52_of_70_and_the_error_of_tables_6_to_12() {
    let theirs = &outside("xu2017.json")["determined"];
    let null = linear_null();
    let rank = 70 - null.count() as u64;
    assert_eq!(Some(rank), theirs["rank"].as_u64());
    let share = null.share(&printed_bodies(), &truth());
    let outside = theirs["error_undetermined"].as_f64().unwrap();
    close("share", &[share], &[outside], 1.0e-3);
    let masses: f64 = IDENTIFIED.iter().map(|b| b[0]).sum();
    let sum = theirs["sum_of_masses"].as_f64().unwrap();
    close("masses", &[masses], &[sum], 1.0e-9);
}
