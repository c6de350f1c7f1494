//! Reads files with the map that their names propose, and settles by the tests of conventions what the names leave open.

use crate::error::Error;
use crate::proposal::{Line, Proposal};
use poinsot_model::parse_telemetry_map;
use poinsot_telemetry::{
    ConventionTest, GyroUnit, Hypothesis, Inspection, Kind, Order, ReadOptions, Sense, Verdict,
    inspect_files,
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
            Err(error) if proposals.iter().all(Proposal::is_plain) => return Err(error),
            Err(guessed) => match inspect_files(files, options) {
                Ok(inspection) => {
                    proposals.clear();
                    inspection
                }
                Err(error) if error.code() == NO_TIME => return Err(guessed),
                Err(error) => return Err(error),
            },
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
    let tables: Vec<String> = written
        .map(|proposal| {
            let mut out = String::new();
            proposal.write(false, false, &mut out);
            out
        })
        .collect();
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
    fn tested(&mut self, test: &ConventionTest) -> impl Iterator<Item = &mut Line> {
        let attitude = test
            .attitude
            .strip_suffix(".q_x..q_w")
            .map(|sensor| format!("sensor = \"{sensor}\","));
        let gyro = test
            .gyro
            .strip_suffix("x..z")
            .unwrap_or_default()
            .to_owned();
        self.lines
            .iter_mut()
            .filter(move |line| match line.key.as_str() {
                "time" => true,
                "attitude" => line.is_of(attitude.as_deref()),
                channel => line.kind == Kind::Rate && channel.starts_with(&gyro),
            })
    }
}

/// Takes what a test of an attitude against a gyro says about what is unsure; returns whether the map changed.
fn settle(proposals: &mut [Proposal], test: &ConventionTest) -> bool {
    // A gyro of another body or in other axes settles nothing.
    let along = |h: &&Hypothesis| h.gyro_axes.axis == [0, 1, 2] && h.gyro_axes.sign == [1; 3];
    let good = std::iter::once(&test.best)
        .chain(&test.twin)
        .chain(&test.as_good);
    let good: Vec<&Hypothesis> = good.filter(along).collect();
    let [only] = good[..] else {
        return false;
    };
    let lines = proposals.iter_mut().flat_map(|p| p.tested(test));
    let unsure = lines.flat_map(|line| {
        let kind = line.kind;
        let unsure = line.choices.iter_mut().filter(|choice| !choice.sure);
        unsure.map(move |choice| (kind, choice))
    });
    match test.verdict {
        Verdict::DeclaredFits if only.is_declared() => {
            unsure.for_each(|(kind, choice)| {
                choice.sure = true;
                choice.shown = kind != Kind::Time;
            });
            false
        }
        Verdict::DeclaredContradicted => unsure.fold(false, |any, (kind, choice)| {
            let word = word_of(only, kind, choice.key).filter(|word| choice.word != *word);
            if let Some(word) = word {
                word.clone_into(&mut choice.word);
            }
            any || word.is_some()
        }),
        _ => false,
    }
}

/// What a hypothesis says of a key where it departs from the declared one.
fn word_of(only: &Hypothesis, kind: Kind, key: &str) -> Option<&'static str> {
    match (key, kind, only.gyro_unit) {
        ("order", ..) if only.order == Order::Wxyz => Some("wxyz"),
        ("sense", ..) if only.sense == Sense::InertialToBody => Some("inertial_to_body"),
        ("unit", Kind::Rate, GyroUnit::DegPerS) => Some("deg/s"),
        ("unit", Kind::Rate, GyroUnit::Rpm) => Some("rpm"),
        ("unit", Kind::Time, GyroUnit::TimeInMilliseconds) => Some("ms"),
        ("unit", Kind::Time, GyroUnit::TimeInMinutes) => Some("min"),
        _ => None,
    }
}
