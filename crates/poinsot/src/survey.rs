//! Reads files with the map that their names propose, and settles by the tests of conventions what the names leave open.

use crate::error::Error;
use crate::proposal::{Choice, Line, Proposal};
use poinsot_model::parse_telemetry_map;
use poinsot_telemetry::{
    Change, ConventionTest, Inspection, Kind, Order, ReadOptions, Repair, Sense, Verdict,
    inspect_files, parse_unit,
};
use std::path::PathBuf;

/// Most changes of the map: order with sense, unit of the gyro, unit of the times, and one to confirm.
const CHANGES: usize = 4;

/// Code of a file without the standard column of the time.
const NO_TIME: &str = "E0207";

/// What the files hold.
pub(crate) struct Survey {
    pub proposals: Vec<Proposal>,
    pub inspection: Inspection,
}

impl Survey {
    /// Reads the files of one record with the maps that are proposed.
    pub fn of(
        files: &[PathBuf],
        options: &ReadOptions,
        mut proposals: Vec<Proposal>,
    ) -> Result<Self, Error> {
        let mut inspection = match read(files, options, &proposals) {
            Ok(inspection) => inspection,
            Err(guessed) => {
                proposals.clear();
                inspect_files(files, options).map_err(|plain| match plain.code() {
                    NO_TIME => guessed,
                    _ => plain,
                })?
            }
        };
        for _ in 0..CHANGES {
            let tests = inspection.conventions.iter();
            let changes = tests.filter(|test| settle(&mut proposals, test));
            if changes.count() == 0 {
                break;
            }
            inspection = read(files, options, &proposals)?;
        }
        Ok(Self {
            proposals,
            inspection,
        })
    }

    /// The lines of all maps.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.proposals.iter().flat_map(|p| &p.lines)
    }
}

/// The map with what is likely; `None` where all names are standard.
pub(crate) fn likely(proposals: &[Proposal]) -> Option<String> {
    let written = proposals.iter().filter(|p| !p.is_plain());
    let tables: Vec<String> = written.map(|p| p.text(false, false)).collect();
    (!tables.is_empty()).then(|| tables.join("\n"))
}

fn read(
    files: &[PathBuf],
    options: &ReadOptions,
    proposals: &[Proposal],
) -> Result<Inspection, Error> {
    let mut options = options.clone();
    if let Some(map) = likely(proposals) {
        options.map = parse_telemetry_map(&map, "the proposed map")?;
    }
    inspect_files(files, &options)
}

/// Takes what a test of an attitude against a gyro says about what is unsure; returns whether the map changed.
fn settle(proposals: &mut [Proposal], test: &ConventionTest) -> bool {
    // A gyro of another body or in other axes settles nothing.
    let mut good = test.good.iter().filter(|h| h.is_along());
    let (Some(only), None, "attitude") = (good.next(), good.next(), test.kinds[0]) else {
        return false;
    };
    // The attitude, the gyro and the times of the test.
    let [attitude, gyro] = &test.between;
    let sensor = attitude.strip_suffix(".q_x..q_w").unwrap_or_default();
    let gyro = gyro.strip_suffix("x..z").unwrap_or_default();
    let own = |line: &&mut Line| match line.key.as_str() {
        "time" => true,
        "attitude" => line.sensor == sensor,
        channel => line.kind == Kind::Rate && channel.starts_with(gyro),
    };
    let repairs = only.repairs();
    let fits = test.verdict == Verdict::DeclaredFits && only.is_declared();
    let mut changed = false;
    let lines = proposals.iter_mut().flat_map(|p| &mut p.lines);
    for line in lines.filter(own) {
        let kind = line.kind;
        for choice in line.choices.iter_mut().filter(|choice| !choice.sure) {
            choice.sure = fits;
            choice.shown |= fits && kind != Kind::Time;
            let word = |repair: &Repair| word_of(repair.change, kind, choice);
            let word = repairs.iter().find_map(word);
            if let Some(word) = word.filter(|_| test.is_contradicted()) {
                changed |= choice.word != word;
                word.clone_into(&mut choice.word);
            }
        }
    }
    changed
}

/// What a change makes of a key.
fn word_of(change: Change, kind: Kind, choice: &Choice) -> Option<&'static str> {
    match (choice.key, kind, change) {
        ("order", _, Change::Attitude(Order::Wxyz, _)) => Some("wxyz"),
        ("sense", _, Change::Attitude(_, Sense::InertialToBody)) => Some("inertial_to_body"),
        ("unit", Kind::Rate, Change::Factor(x)) | ("unit", Kind::Time, Change::Clock(x)) => {
            Some(parse_unit(&choice.word).ok()?.times(x)?.symbol)
        }
        _ => None,
    }
}
