//! Every convention of every channel, planted in simulated records: the table of `docs/validation/conventions.md`.
//!
//! Each record is spoilt as a ground system might write it, and identified as a user would. The first thing that is said must name
//! the convention and the channel, and nothing that is trusted may be wrong.

use crate::faults::off_nominal;
use crate::tables;
use poinsot::case::read_case;
use poinsot::trials::Study;
use poinsot::{Identified, Question, Reading, identify_records, identify_tables};
use poinsot_model::{Model, read_model};
use poinsot_telemetry::{Channel, Part, Table, check_conventions, write};
use rayon::prelude::*;
use std::path::Path;

/// Sigmas beyond which a trusted number is wrong.
const WRONG: f64 = 5.0;

type Spoil = Box<dyn Fn(&mut Table) + Send + Sync>;

/// A convention of a channel, what is to be said, and how a record is spoilt.
struct Row {
    kind: &'static str,
    channel: String,
    said: Vec<String>,
    spoil: Spoil,
}

fn row(kind: &'static str, channel: &str, said: &[&str], spoil: Spoil) -> Row {
    Row {
        kind,
        channel: channel.to_owned(),
        said: said.iter().map(|s| (*s).to_owned()).collect(),
        spoil,
    }
}

fn of<'t>(table: &'t mut Table, starts: &str) -> impl Iterator<Item = &'t mut Channel> {
    let all = table.channels.iter_mut();
    all.filter(move |c| format!("{}.{}", c.sensor, c.name).contains(starts))
}

fn each(name: &str, change: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Spoil {
    let name = name.to_owned();
    Box::new(move |table| {
        for channel in of(table, &name) {
            channel.values.iter_mut().for_each(|x| *x = change(*x));
        }
    })
}

fn exchange(a: &str, b: &str) -> Spoil {
    let (a, b) = (a.to_owned(), b.to_owned());
    Box::new(move |table| {
        for channel in &mut table.channels {
            let (own, other) = match (channel.name.contains(&a), channel.name.contains(&b)) {
                (true, _) => (&a, &b),
                (_, true) => (&b, &a),
                _ => continue,
            };
            channel.name = channel.name.replace(own.as_str(), other);
        }
    })
}

/// A channel counted in steps of an integer of so many bits, read as unsigned.
fn unsigned(name: &str, step: f64) -> Spoil {
    each(name, move |x| (x / step).round().rem_euclid(65536.0) * step)
}

fn joints(names: &[&str]) -> Vec<Row> {
    let mut rows = Vec::new();
    for name in names {
        let factor = |x: f64| each(&format!("{name}_rad"), move |q| q * x);
        rows.push(row("sign", name, &[name, "sign"], factor(-1.0)));
        rows.push(row(
            "ratio 3/2",
            name,
            &[name, "scale = 0.666667"],
            factor(1.5),
        ));
        rows.push(row("ratio 1/2", name, &[name, "scale = 2"], factor(0.5)));
        // Large angles are refused with the same word: no motion can be predicted.
        rows.push(row(
            "degrees",
            name,
            &["unit"],
            factor(1.0_f64.to_degrees()),
        ));
        for turn in [90.0_f64, -135.0, 180.0] {
            let by = turn.to_radians();
            let name = (*name).to_owned();
            let held = name.clone();
            let spoil: Spoil = Box::new(move |table| {
                let position = format!("{held}_rad");
                for channel in of(table, &held).filter(|c| c.name == position) {
                    channel.values.iter_mut().for_each(|q| *q += by);
                }
            });
            rows.push(row("zero", &name, &[&name, "zero"], spoil));
        }
    }
    if let [a, b] = names {
        rows.push(row("exchange", "both joints", &[a, b], exchange(a, b)));
    }
    rows
}

fn wheels(names: &[&str]) -> Vec<Row> {
    let mut rows = Vec::new();
    for name in names {
        let factor = |x: f64| each(name, move |w| w * x);
        rows.push(row("sign", name, &[name, "sign"], factor(-1.0)));
        rows.push(row(
            "degrees",
            name,
            &[name, "unit"],
            factor(1.0_f64.to_degrees()),
        ));
        rows.push(row(
            "rpm",
            name,
            &[name, "unit"],
            factor(30.0 / std::f64::consts::PI),
        ));
    }
    for (i, a) in names.iter().enumerate() {
        for b in &names[i + 1..] {
            rows.push(row(
                "exchange",
                &format!("{a}, {b}"),
                &[a, b],
                exchange(a, b),
            ));
        }
    }
    rows
}

fn thrusters(names: &[&str]) -> Vec<Row> {
    let of = |name: &&str| row("reversed", name, &[name], each(name, |f| -f));
    names.iter().map(of).collect()
}

/// What a gyro beside a tracker can be.
fn rates() -> Vec<Row> {
    let axes = ["omega_x", "omega_y", "omega_z"];
    let mut rows = vec![
        row(
            "degrees",
            "gyro",
            &["gyro in deg/s"],
            each("omega_", f64::to_degrees),
        ),
        row(
            "increments",
            "gyro",
            &["increments = true"],
            each("omega_", |w| 0.1 * w),
        ),
        row(
            "inverse",
            "attitude",
            &["inertial to body"],
            each("q_w", |w| -w),
        ),
    ];
    for (i, a) in axes.iter().enumerate() {
        rows.push(row("sign", a, &["body rates = gyro"], each(a, |w| -w)));
        let step = 5.0e-5;
        rows.push(row("unsigned", a, &[a, "signed_range"], unsigned(a, step)));
        let b = axes[(i + 1) % 3];
        rows.push(row(
            "exchange",
            &format!("{a}, {b}"),
            &["body rates = gyro"],
            exchange(a, b),
        ));
    }
    rows
}

/// A record with its channels.
struct Record {
    name: &'static str,
    case: &'static str,
    rows: fn() -> Vec<Row>,
}

const RECORDS: [Record; 2] = [
    Record {
        name: "two-link arm",
        case: "tests/all/faults/cases/two_link_arm.toml",
        rows: || {
            let mut rows = joints(&["shoulder", "elbow"]);
            rows.extend(rates());
            rows
        },
    },
    Record {
        name: "satellite",
        case: "../../data/cases/faults.toml",
        rows: || {
            let mut rows = wheels(&["wheel1", "wheel2", "wheel3"]);
            rows.extend(thrusters(&["thr1", "thr3"]));
            rows
        },
    },
];

/// What is said first, and whether the answer is trusted and wrong.
fn answered(model: &Model, truth: &Model, table: Table) -> (String, bool) {
    // As a file is read.
    if let Err(error) = check_conventions(&table) {
        return (error.to_string(), false);
    }
    let identified = match identify_tables(model.clone(), vec![table], &Question::default()) {
        Ok(identified) => identified,
        Err(error) => return (error.to_string(), false),
    };
    let trusted = identified.passes();
    let apart = apart(&identified, truth);
    let found = identified.estimate.diagnostics;
    let found = found.map(|d| d.findings).unwrap_or_default();
    let first = found.into_iter().next().map(|f| f.text);
    (first.unwrap_or_default(), trusted && apart > WRONG)
}

/// Largest distance of an inertia from the truth, sigmas.
fn apart(identified: &Identified, truth: &Model) -> f64 {
    let estimate = &identified.estimate;
    let mut apart = 0.0_f64;
    for body in estimate.bodies.iter().filter(|b| b.asked) {
        let true_body = truth.bodies.iter().find(|b| b.name == body.name).unwrap();
        let I = true_body.nominal.I_BBcm_B;
        let elements = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
        for (number, (i, j)) in body.inertia.iter().zip(elements) {
            if let (Some(value), Some(sigma)) = (number.value, number.sigma) {
                apart = apart.max((value - I[(i, j)]).abs() / sigma);
            }
        }
    }
    apart
}

fn study(path: &str) -> (Study, Model) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let mut case = read_case(&path).unwrap();
    case.rate_hz = 10.0;
    let truth = read_model(&case.model).unwrap();
    let model = off_nominal(truth.clone());
    (Study::of_case(&case, &truth, model).unwrap(), truth)
}

/// Each convention of each channel of two records, in `POINSOT_TRIALS` records of other noise; without it of the first channel alone.
#[test]
fn stat_conventions_of_every_channel_are_named() {
    let trials = tables::trials(0);
    tables::heading(&[
        "record",
        "convention",
        "channel",
        "records",
        "named",
        "trusted, wrong",
    ]);
    let (mut all, mut named, mut wrong) = (0, 0, 0);
    let mut missed = Vec::new();
    for record in &RECORDS {
        let (study, truth) = study(record.case);
        let mut rows = (record.rows)();
        if trials == 0 {
            let mut kinds = Vec::new();
            rows.retain(|r| {
                let new = !kinds.contains(&r.kind);
                kinds.push(r.kind);
                new
            });
        }
        let trials = trials.max(1);
        let trial = |row: &Row, number: u64| {
            let (mut tables, _) = study.draw(number);
            tables.iter_mut().for_each(|t| (row.spoil)(t));
            answered(&study.model, &truth, tables.remove(0))
        };
        let of = |row: &Row| -> (u64, u64, Vec<String>) {
            let answers: Vec<(String, bool)> = (0..trials).map(|n| trial(row, n)).collect();
            let right = |said: &str| row.said.iter().all(|word| said.contains(word.as_str()));
            let others = answers.iter().filter(|a| !right(&a.0));
            (
                answers.iter().filter(|a| right(&a.0)).count() as u64,
                answers.iter().filter(|a| a.1).count() as u64,
                others.map(|a| a.0.clone()).collect(),
            )
        };
        let tallies: Vec<_> = rows.par_iter().map(of).collect();
        for (row, (right, bad, others)) in rows.iter().zip(tallies) {
            let cells = [record.name, row.kind, &row.channel].map(str::to_owned);
            let counts = [trials, right, bad].map(|n| n.to_string());
            tables::row(&[cells, counts].concat());
            (all, named, wrong) = (all + trials, named + right, wrong + bad);
            missed.extend(
                others
                    .into_iter()
                    .map(|o| format!("{} of {}: {o}", row.kind, row.channel)),
            );
        }
    }
    tables::row(&[
        "all",
        "",
        "",
        &all.to_string(),
        &named.to_string(),
        &wrong.to_string(),
    ]);
    assert_eq!(wrong, 0, "{missed:#?}");
    assert!(20 * named >= 19 * all, "{named} of {all}: {missed:#?}");
}

/// Records that are as declared say nothing.
#[test]
fn stat_right_conventions_are_not_doubted() {
    for record in &RECORDS {
        let (study, truth) = study(record.case);
        for number in 0..3 {
            let (mut tables, _) = study.draw(number);
            let (said, wrong) = answered(&study.model, &truth, tables.remove(0));
            assert!(said.is_empty() && !wrong, "{}: {said}", record.name);
        }
    }
}

/// Records spoilt in one convention go to the truth with the lines that are proposed, and the answer lists them. Without
/// `--repair` a refusal advises the same lines.
#[test]
fn regress_proposed_lines_lead_to_the_truth() {
    let (study, truth) = study(RECORDS[0].case);
    let spoilt: [(&str, Spoil); 6] = [
        (
            "elbow_rad = { column = \"elbow_rad\", sign = -1.0",
            each("elbow_rad", |q| -q),
        ),
        ("scale = 0.666666667", each("elbow_rad", |q| 1.5 * q)),
        (
            "shoulder_rad = { column = \"elbow_rad\"",
            exchange("shoulder", "elbow"),
        ),
        ("signed_range", unsigned("omega_y", 5.0e-5)),
        ("unit = \"deg/s\"", each("omega_", f64::to_degrees)),
        ("sense = \"inertial_to_body\"", each("q_w", |w| -w)),
    ];
    spoilt.par_iter().for_each(|(line, spoil)| {
        let (mut tables, _) = study.draw(0);
        spoil(&mut tables[0]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("telemetry.parquet");
        write(&path, &tables[0].channels).unwrap();
        let records = [vec![Part::File(path)]];
        let ask = |repair: bool| {
            let question = Question {
                repair,
                ..Question::default()
            };
            let model = study.model.clone();
            identify_records(model, &records, &Reading::default(), &question)
        };
        let identified = ask(true).unwrap();
        assert!(
            identified.passes(),
            "{line}: {:?}",
            identified.estimate.doubts()
        );
        assert!(apart(&identified, &truth) < WRONG, "{line}");
        let said = |r: &&str| r.starts_with("assumed by --repair: ") && r.contains(line);
        let repairs = identified.repairs();
        assert!(repairs.iter().any(said), "{line}: {repairs:?}");
        match ask(false) {
            Err(error) => assert!(error.to_string().contains("; write "), "{error}"),
            Ok(identified) => assert!(!identified.passes(), "{line}"),
        }
    });
}
