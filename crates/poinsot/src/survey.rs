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
    /// Reads the files of one record. A column named in `own` is that of a joint, wheel or thruster of the model.
    pub fn of(files: &[PathBuf], options: &ReadOptions, own: &[String]) -> Result<Self, Error> {
        let heads = files.iter().filter_map(|path| Proposal::of(path, own));
        Self::with(files, options, heads.collect())
    }

    /// The same with proposals that may have been changed.
    pub fn with(
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
            let mut changed = false;
            for test in &inspection.conventions {
                changed |= settle(&mut proposals, test);
            }
            if !changed {
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

    /// The map with what is likely; `None` where all names are standard.
    pub fn likely_map(&self) -> Option<String> {
        likely(&self.proposals)
    }
}

fn likely(proposals: &[Proposal]) -> Option<String> {
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

impl Proposal {
    /// The lines of the attitude, the gyro and the times of a test.
    fn tested(&mut self, [attitude, gyro]: &[String; 2]) -> impl Iterator<Item = &mut Line> {
        let sensor = attitude.strip_suffix(".q_x..q_w");
        let sensor = sensor.map(|sensor| format!("sensor = \"{sensor}\","));
        let gyro = gyro.strip_suffix("x..z").unwrap_or_default().to_owned();
        let own = move |line: &&mut Line| match line.key.as_str() {
            "time" => true,
            "attitude" => line.is_of(sensor.as_deref()),
            channel => line.kind == Kind::Rate && channel.starts_with(&gyro),
        };
        self.lines.iter_mut().filter(own)
    }
}

/// Takes what a test of an attitude against a gyro says about what is unsure; returns whether the map changed.
fn settle(proposals: &mut [Proposal], test: &ConventionTest) -> bool {
    // A gyro of another body or in other axes settles nothing.
    let mut good = test.good.iter().filter(|h| h.is_along());
    let (Some(only), None, "attitude") = (good.next(), good.next(), test.kinds[0]) else {
        return false;
    };
    let repairs = only.repairs();
    let fits = test.verdict == Verdict::DeclaredFits && only.is_declared();
    let mut changed = false;
    for line in proposals.iter_mut().flat_map(|p| p.tested(&test.between)) {
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
