//! Every convention of every channel, planted in simulated records: the table of `docs/validation/conventions.md`.
//!
//! The rows are generated from the channels of each record. Each is spoilt as a ground system might write it, and identified from its
//! file as a user would. What is said first must name the convention and the channel, nothing that is trusted may be wrong, and the
//! lines that are printed must lead to the truth.

mod rows;

use crate::faults::off_nominal;
use crate::tables;
use poinsot::case::read_case;
use poinsot::trials::Study;
use poinsot::{Identified, Question, Reading, identify_records};
use poinsot_identify::{BodyEstimate, Estimate};
use poinsot_model::{Model, read_model};
use poinsot_telemetry::{Part, Table, write};
use rayon::prelude::*;
use rows::{Row, Spoil, each, exchange, generated};
use std::path::Path;

/// Sigmas beyond which a trusted number is wrong.
const WRONG: f64 = 5.0;
/// Sigmas of a right record by which a convention has to change the answer to be judged.
const LARGE: f64 = 10.0;
/// Without trials, the test takes each of so many rows.
const DRAWN: usize = 72;

/// A record: name, case, samples a second.
const RECORDS: [(&str, &str, f64); 6] = [
    (
        "two-link arm",
        "tests/all/faults/cases/two_link_arm.toml",
        10.0,
    ),
    ("satellite", "../../data/cases/faults.toml", 10.0),
    ("cubesat", "../../data/cases/cubesat.toml", 4.0),
    ("pyramid", "../../data/cases/pyramid.toml", 5.0),
    (
        "target",
        "../../data/cases/xu2017_target_all_joints.toml",
        10.0,
    ),
    ("thrusters", "../../data/cases/tug_thrusters.toml", 10.0),
];

/// The experiment of a record.
struct Record {
    name: &'static str,
    study: Study,
    truth: Model,
    /// Sigmas of the answer to the record as it is.
    sigmas: Vec<Option<f64>>,
}

/// What is said to a record.
struct Answer {
    said: String,
    passes: bool,
    /// The numbers that are asked for; none of a record that is refused.
    numbers: Vec<(Option<f64>, Option<f64>)>,
    repairs: Vec<String>,
}

/// Numbers of the asked bodies: value and sigma.
fn numbers(estimate: &Estimate) -> Vec<(Option<f64>, Option<f64>)> {
    let of = |b: &BodyEstimate| [std::slice::from_ref(&b.mass), &b.com, &b.inertia].concat();
    let bodies = estimate.bodies.iter().filter(|b| b.asked);
    let own = bodies.flat_map(of);
    own.map(|n| (n.value, n.sigma)).collect()
}

impl Record {
    fn new((name, case, rate_hz): (&'static str, &str, f64)) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(case);
        let mut case = read_case(&path).unwrap();
        case.rate_hz = rate_hz;
        let truth = read_model(&case.model).unwrap();
        let study = Study::of_case(&case, &truth, off_nominal(truth.clone())).unwrap();
        let sigmas = Vec::new();
        let mut record = Self {
            name,
            study,
            truth,
            sigmas,
        };
        let answer = record.ask(&record.table(0), false);
        record.sigmas = answer.numbers.iter().map(|n| n.1).collect();
        record
    }

    fn table(&self, trial: u64) -> Table {
        self.study.draw(trial).0.remove(0)
    }

    /// What is said of a file, or after what was advised.
    fn ask(&self, table: &Table, repair: bool) -> Answer {
        let model = self.study.model.clone();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("telemetry.parquet");
        write(&path, &table.channels).unwrap();
        let records = [vec![Part::File(path)]];
        let question = Question {
            repair,
            ..Question::default()
        };
        match identify_records(model, &records, &Reading::default(), &question) {
            Err(error) => Answer {
                said: error.to_string(),
                passes: false,
                numbers: Vec::new(),
                repairs: Vec::new(),
            },
            Ok(identified) => Answer {
                said: first(&identified),
                passes: identified.passes(),
                numbers: numbers(&identified.estimate),
                repairs: identified
                    .repairs()
                    .into_iter()
                    .map(str::to_owned)
                    .collect(),
            },
        }
    }

    /// True numbers of the asked bodies.
    fn truth(&self) -> Vec<f64> {
        let asked = self.truth.bodies.iter().filter(|b| b.estimate.any());
        asked.flat_map(|b| b.nominal.to_array()).collect()
    }

    /// Largest distance from the truth in these sigmas; infinite without a number.
    fn distance(&self, answer: &Answer, sigmas: &[Option<f64>]) -> f64 {
        if answer.numbers.is_empty() {
            return f64::INFINITY;
        }
        let apart = |(k, x): (usize, f64)| {
            let sigma = (*sigmas.get(k)?)?;
            let value = answer.numbers.get(k)?.0;
            Some(value.map_or(f64::INFINITY, |value| (value - x).abs() / sigma))
        };
        let all = self.truth().into_iter().enumerate();
        all.filter_map(apart).fold(0.0, f64::max)
    }

    /// In sigmas of the answer itself.
    fn error(&self, answer: &Answer) -> f64 {
        let own: Vec<Option<f64>> = answer.numbers.iter().map(|n| n.0.and(n.1)).collect();
        self.distance(answer, &own)
    }

    fn is_wrong(&self, answer: &Answer) -> bool {
        answer.passes && self.error(answer) > WRONG
    }

    fn is_right(&self, answer: &Answer) -> bool {
        answer.passes && self.error(answer) < WRONG
    }
}

/// What an answer says first.
fn first(identified: &Identified) -> String {
    let found = identified.estimate.diagnostics.as_ref();
    let finding = found.and_then(|d| d.findings.first());
    finding.map(|f| f.text.clone()).unwrap_or_default()
}

/// Counts of a row of the table.
#[derive(Default, Clone)]
struct Tally {
    records: usize,
    large: usize,
    named: usize,
    /// Of those that are not named: the right answer.
    right: usize,
    wrong: usize,
    /// Of those named: exit 0 and the right answer after `--repair`.
    repaired: usize,
    missed: Vec<String>,
}

impl Tally {
    fn of(record: &Record, row: &Row, trials: u64) -> Self {
        let mut all = Self::default();
        for trial in tables::first()..tables::first() + trials {
            let mut table = record.table(trial);
            (row.spoil)(&mut table);
            let answer = record.ask(&table, false);
            let effect = record.distance(&answer, &record.sigmas);
            let own = Self::judged(record, row, &table, &answer, effect);
            if std::env::var("POINSOT_TRIALS").is_ok() {
                eprintln!(
                    "{} | {} | {} | {}{}{}{}{} effect {effect:.1} error {:.1}: {}",
                    record.name,
                    row.kind,
                    row.channel,
                    if own.large > 0 { "" } else { "small " },
                    if own.named > 0 { "named " } else { "" },
                    if own.repaired > 0 { "repaired " } else { "" },
                    if own.right > 0 { "right " } else { "" },
                    if own.wrong > 0 { "WRONG " } else { "" },
                    record.error(&answer),
                    own.missed.join("; "),
                );
            }
            all.add(own);
        }
        all
    }

    fn judged(record: &Record, row: &Row, table: &Table, answer: &Answer, effect: f64) -> Self {
        let right = record.is_right(answer);
        let large = effect > LARGE;
        let named = !right && large && row.is_named_by(&answer.said);
        let after = named.then(|| record.ask(table, true));
        let repaired = after.as_ref().is_some_and(|a| record.is_right(a));
        let wrong = [Some(answer), after.as_ref()];
        let wrong = wrong.into_iter().flatten().any(|a| record.is_wrong(a));
        let mut missed = Vec::new();
        if large && !right && !named {
            missed.push(format!("said: {}", answer.said));
        }
        if let Some(after) = after.filter(|_| !repaired) {
            missed.push(format!(
                "said: {}; after {:?}: {} {:.1} sigma: {}",
                answer.said,
                after.repairs,
                after.passes,
                record.error(&after),
                after.said
            ));
        }
        Self {
            records: 1,
            large: usize::from(large),
            named: usize::from(named),
            right: usize::from(right && large),
            wrong: usize::from(wrong),
            repaired: usize::from(repaired),
            missed,
        }
    }

    fn add(&mut self, other: Self) {
        self.records += other.records;
        self.large += other.large;
        self.named += other.named;
        self.right += other.right;
        self.wrong += other.wrong;
        self.repaired += other.repaired;
        self.missed.extend(other.missed);
    }

    fn counts(&self) -> [String; 6] {
        [
            self.records,
            self.large,
            self.named,
            self.right,
            self.wrong,
            self.repaired,
        ]
        .map(|n| n.to_string())
    }
}

/// Each convention of each channel of six records, in `POINSOT_TRIALS` records of other noise; without it a part of the rows.
#[test]
fn stat_conventions_of_every_channel_are_named() {
    let trials = tables::trials(0);
    tables::heading(&[
        "record",
        "convention",
        "channels",
        "records",
        "over 10 sigma",
        "named",
        "right all the same",
        "trusted, wrong",
        "right after advice",
    ]);
    let (mut all, mut told) = (Tally::default(), Tally::default());
    for (place, own) in RECORDS.iter().enumerate() {
        if std::env::var("POINSOT_CASE").is_ok_and(|case| !own.0.contains(&case)) {
            continue;
        }
        let record = Record::new(*own);
        let mut rows = generated(&record.truth, &record.study.exact[0]);
        rows.retain(|r| tables::wanted(&format!("{} of {}", r.kind, r.channel)));
        if trials == 0 {
            let mut k = place;
            rows.retain(|_| {
                k += 1;
                k % DRAWN == 0
            });
        }
        let of = |row: &Row| Tally::of(&record, row, trials.max(1));
        let tallies: Vec<Tally> = rows.par_iter().map(of).collect();
        // All channels of one convention together.
        let mut kinds: Vec<(&str, usize, Tally)> = Vec::new();
        for (row, tally) in rows.iter().zip(tallies) {
            all.add(tally.clone());
            if row.told {
                told.add(tally.clone());
            }
            match kinds.iter_mut().find(|k| k.0 == row.kind) {
                Some((_, channels, sum)) => {
                    *channels += 1;
                    sum.add(tally);
                }
                None => kinds.push((row.kind, 1, tally)),
            }
        }
        for (kind, channels, tally) in kinds {
            let cells = [record.name, kind, &channels.to_string()].map(str::to_owned);
            tables::row(&[cells.to_vec(), tally.counts().to_vec()].concat());
        }
    }
    tables::row(
        &[
            ["all", "", ""].map(str::to_owned).to_vec(),
            all.counts().to_vec(),
        ]
        .concat(),
    );
    assert_eq!(all.wrong, 0, "{:#?}", all.missed);
    let named = told.named + told.right;
    // A miss among the few rows that are drawn is more than one in twenty.
    let least = if trials == 0 { 15 } else { 19 };
    assert!(20 * named >= least * told.large, "{:#?}", told.missed);
}

/// Records that are as declared say nothing.
#[test]
fn stat_right_conventions_are_not_doubted() {
    RECORDS.par_iter().for_each(|own| {
        let record = Record::new(*own);
        for number in 0..3 {
            let answer = record.ask(&record.table(number), false);
            let right = answer.said.is_empty() && record.is_right(&answer);
            assert!(
                right,
                "{}: {}, {:.1} sigma",
                record.name,
                answer.said,
                record.error(&answer)
            );
        }
    });
}

/// Records spoilt in one convention go to the truth with the lines that are proposed, and the answer lists them. Without
/// `--repair` a refusal advises the same lines.
#[test]
fn regress_proposed_lines_lead_to_the_truth() {
    let record = Record::new(RECORDS[0]);
    let names = |all: &[&str]| all.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
    let elbow = names(&["elbow_rad", "elbow_rad_s"]);
    let shoulder = names(&["shoulder_rad", "shoulder_rad_s"]);
    let gyro = names(&["omega_x", "omega_y", "omega_z"]);
    let range = |w: f64| (w / 5.0e-5).round().rem_euclid(65536.0) * 5.0e-5;
    let mut rows = generated(&record.truth, &record.study.exact[0]).into_iter();
    let turned = rows.find(|row| row.kind == "body axes").unwrap();
    let spoilt: [(&str, Spoil); 7] = [
        ("body_velocities = true", turned.spoil),
        (
            "elbow_rad = { column = \"elbow_rad\", sign = -1.0",
            each(&elbow, |q| -q),
        ),
        ("scale = 0.666666667", each(&elbow, |q| 1.5 * q)),
        (
            "shoulder_rad = { column = \"elbow_rad\"",
            exchange(&shoulder, &elbow),
        ),
        ("signed_range", each(&gyro[1..2], range)),
        ("unit = \"deg/s\"", each(&gyro, f64::to_degrees)),
        (
            "sense = \"inertial_to_body\"",
            each(&names(&["q_w"]), |w| -w),
        ),
    ];
    spoilt.par_iter().for_each(|(line, spoil)| {
        let mut table = record.table(0);
        spoil(&mut table);
        let repaired = record.ask(&table, true);
        assert!(
            record.is_right(&repaired),
            "{line}: {} {:.1} sigma",
            repaired.said,
            record.error(&repaired)
        );
        let said = |r: &String| r.starts_with("assumed by --repair: ") && r.contains(line);
        assert!(
            repaired.repairs.iter().any(said),
            "{line}: {:?}",
            repaired.repairs
        );
        let before = record.ask(&table, false);
        assert!(!before.passes, "{line}");
        if before.numbers.is_empty() {
            assert!(before.said.contains("; write "), "{}", before.said);
        }
    });
}
