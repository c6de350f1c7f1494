//! The command `follow`: the on-board filter on rows of telemetry as they arrive.

use crate::bind::RELATIVE_ACCURACY;
use crate::channel_names::position;
use crate::error::{Error, check_accuracy};
use crate::identify::{mapped, read_options};
use crate::onboard::{FollowedNumber, OnBoard};
use poinsot_model::{JointKind, Model, read_model};
use poinsot_onboard::{GroundFilter, Health, Sample, SensorCounts};
use poinsot_telemetry::{Part, ReadOptions, read_parts};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Longest gap in steps of the first two samples, and at least in seconds.
const GAP: f64 = 5.0;
const GAP_S: f64 = 0.5;
/// Longest time to reach a sigma that is said, in times of the record so far: its power of time is that of a factor of two in time.
const FORESEEN: f64 = 1.0e3;
/// Most lines whose sigmas are kept for that; then every second one.
const KEPT: usize = 4096;

/// What the filter knows at a time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Followed {
    /// Time of the record, s.
    pub time_s: f64,
    /// What the numbers are worth.
    #[serde(serialize_with = "as_word")]
    pub health: Health,
    /// The unknown numbers.
    #[serde(serialize_with = "by_address")]
    pub numbers: Vec<FollowedNumber>,
    /// Measurements of gyro, attitude and position that were used and left out.
    #[serde(flatten, serialize_with = "by_sensor")]
    pub counts: [SensorCounts; 3],
}

impl Followed {
    /// As the text of one JSON object.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Whether all numbers are determined.
    pub fn is_determined(&self) -> bool {
        self.health == Health::Determined
    }
}

fn as_word<S: Serializer>(health: &Health, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(match health {
        Health::Converging => "converging",
        Health::Determined => "determined",
        Health::Inconsistent => "inconsistent",
        Health::Stale => "stale",
    })
}

fn by_address<S: Serializer>(numbers: &[FollowedNumber], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(numbers.iter().map(|number| (&number.address, number)))
}

fn by_sensor<S: Serializer>(counts: &[SensorCounts; 3], serializer: S) -> Result<S::Ok, S::Error> {
    let counts = counts.map(|c| BTreeMap::from([("accepted", c.accepted), ("gated", c.gated)]));
    serializer.collect_map(["gyro", "attitude", "position"].into_iter().zip(counts))
}

/// How the sigma of a number falls.
#[derive(Debug, Clone, Default)]
struct Course {
    /// Time since the first sample and sigma of every line, s.
    sigmas: Vec<[f64; 2]>,
    /// When the wanted one was reached, s since the first sample.
    reached_s: Option<f64>,
}

impl Course {
    fn take(&mut self, elapsed_s: f64, sigma: f64) {
        if self.sigmas.last().is_none_or(|[t, _]| *t < elapsed_s) {
            self.sigmas.push([elapsed_s, sigma]);
        }
        if self.sigmas.len() > KEPT {
            self.sigmas = self.sigmas.iter().copied().step_by(2).collect();
        }
    }

    /// When a sigma is reached, s since the first sample, if it falls as it did from half of the time on.
    fn reaches(&mut self, elapsed_s: f64, sigma: f64, wanted: f64) -> Option<f64> {
        if sigma <= wanted {
            return Some(*self.reached_s.get_or_insert(elapsed_s));
        }
        self.reached_s = None;
        let half = self.sigmas.partition_point(|[t, _]| *t <= 0.5 * elapsed_s);
        let [then_s, before] = *self.sigmas.get(half.checked_sub(1)?)?;
        let power = (before / sigma).ln() / (elapsed_s / then_s).ln();
        let times = (sigma / wanted).powf(1.0 / power);
        (power > 0.0 && times <= FORESEEN).then_some(elapsed_s * times)
    }
}

/// The filter of a model with what was read so far.
pub struct Follower {
    model: Model,
    on_board: OnBoard,
    filter: Option<Box<GroundFilter>>,
    options: ReadOptions,
    /// Where rows come from, in messages.
    file: PathBuf,
    /// Lines before the first row, and the number of those from there on.
    head: String,
    rows: u64,
    /// The last row that was read, which begins the next batch.
    last: String,
    /// The beginning of a row.
    part: String,
    /// Time of the newest sample, s.
    newest: f64,
    /// Time of the last line that was given, s.
    told: f64,
    /// Shortest time between two lines, s.
    every_s: f64,
    /// Wanted half-width of a 95 % interval in natural units.
    accuracy: f64,
    /// Time of the first sample, s.
    first: f64,
    courses: Vec<Course>,
}

impl Follower {
    /// A filter for a model file, with a map in place of the model's. Lines come at most every `every_s` seconds of the record.
    ///
    /// # Errors
    /// A file cannot be read, or the filter does not support the model.
    pub fn new(model: &Path, map: Option<&Path>, every_s: f64) -> Result<Self, Error> {
        Self::of(mapped(read_model(model)?, map)?, every_s)
    }

    /// A filter for a model with its map. Lines come at most every `every_s` seconds of the record; infinite: none.
    ///
    /// # Errors
    /// The filter does not support the model.
    pub fn of(model: Model, every_s: f64) -> Result<Self, Error> {
        let options = ReadOptions {
            check_conventions: false,
            one_run: false,
            ..read_options(&model, &model.telemetry, false, false)
        };
        Ok(Self {
            on_board: OnBoard::new(&model, None)?,
            model,
            filter: None,
            options,
            file: PathBuf::from("rows"),
            head: String::new(),
            rows: 0,
            last: String::new(),
            part: String::new(),
            newest: f64::NEG_INFINITY,
            told: f64::NEG_INFINITY,
            every_s,
            accuracy: RELATIVE_ACCURACY,
            first: f64::NAN,
            courses: Vec::new(),
        })
    }

    /// The same of a file, with another wanted half-width of the 95 % intervals, in natural units.
    ///
    /// # Errors
    /// E0001: the half-width is no positive number.
    pub fn wanting(mut self, file: &Path, accuracy: f64) -> Result<Self, Error> {
        check_accuracy(accuracy)?;
        (self.file, self.accuracy) = (file.to_owned(), accuracy);
        Ok(self)
    }

    /// The model with its map.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What the filter assumes, one assumption a line.
    pub fn assumed(&self) -> &[String] {
        &self.on_board.assumed
    }

    /// Takes text that has arrived, and returns what is known at its times.
    ///
    /// # Errors
    /// The rows cannot be read.
    pub fn push(&mut self, text: &str) -> Result<Vec<Followed>, Error> {
        self.part.push_str(text);
        let end = self.part.rfind('\n').map_or(0, |at| at + 1);
        let rest = self.part.split_off(end);
        let lines = std::mem::replace(&mut self.part, rest);
        let head = lines.split_inclusive('\n');
        let head = head.take_while(|line| self.last.is_empty() && !is_row(line));
        let (head, rows) = lines.split_at(head.map(str::len).sum());
        self.head.push_str(head);
        let mut filled = rows.lines().filter(|line| !line.trim().is_empty());
        let Some(last) = filled.next_back() else {
            return Ok(Vec::new());
        };
        let table = format!("{}{}{rows}", self.head, self.last);
        let (before, again) = (self.rows, self.last.lines().count() as u64);
        let head = self.head.lines().count() as u64;
        self.rows += rows.lines().count() as u64;
        self.last = format!("{last}\n");
        if again == 0 && filled.next().is_none() {
            return Ok(Vec::new());
        }
        let name = self.file.display().to_string();
        let part = Part::stream(&name, &mut table.as_bytes());
        let part = part.map_err(|e| Error::io(&self.file, "cannot be read", &e))?;
        let found = self.push_parts(&[part]);
        found.map_err(|mut error| {
            // Its lines are those of this batch.
            let places = error.list.iter_mut().map(|fault| &mut fault.place);
            let rows = places.filter(|place| place.line > head);
            rows.for_each(|place| place.line += before - again);
            error
        })
    }

    /// Takes a batch of at least two rows, and returns what is known at its times. The first row is the last one of the batch before, between which
    /// and the next one wheel speeds are interpolated.
    ///
    /// # Errors
    /// The rows cannot be read.
    pub fn push_parts(&mut self, parts: &[Part]) -> Result<Vec<Followed>, Error> {
        let table = read_parts(parts, &self.options)?;
        if self.filter.is_none() {
            // A joint with a column moves; where it is locked counts without one.
            let joints = self.model.joints.iter_mut();
            for joint in joints.filter(|joint| joint.kind != JointKind::Fixed) {
                if table.sensor_channel("", &position(joint)).is_some() {
                    joint.locked_at = None;
                }
            }
            self.on_board = OnBoard::new(&self.model, None)?;
            self.on_board.check_channels(&self.model, &table)?;
        }
        self.options.origin = table.origin;
        let samples = self.on_board.samples(&self.model, &table);
        Ok(self.take(&samples))
    }

    /// What is known at a time of the record, s; at its end where none is given. `None` before the second row.
    pub fn at(&mut self, time_s: Option<f64>) -> Option<Followed> {
        self.known(time_s.unwrap_or(self.newest))
    }

    /// What is known at the end.
    pub fn end(&mut self) -> Option<Followed> {
        self.filter.as_mut()?.flush();
        self.at(None)
    }

    fn take(&mut self, samples: &[Sample]) -> Vec<Followed> {
        let mut out = Vec::new();
        for pair in samples.windows(2) {
            if self.filter.is_none() {
                let configuration = &mut self.on_board.configuration;
                let step_s = pair[1].time_s - pair[0].time_s;
                configuration.longest_gap_s = (GAP * step_s).max(GAP_S);
                configuration.stale_s = 2.0 * configuration.longest_gap_s;
                // The capacity is that of the largest configuration.
                self.filter = GroundFilter::new(*configuration).ok().map(Box::new);
                self.first = pair[0].time_s;
            }
            let newest = self.newest;
            for sample in pair.iter().filter(|s| s.time_s > newest) {
                if let Some(filter) = &mut self.filter {
                    // A refused sample is not counted; what follows from refusals shows in the health.
                    let _ = filter.push(sample);
                }
            }
            self.newest = self.newest.max(pair[1].time_s);
            if self.newest >= self.told + self.every_s {
                self.told = self.newest;
                out.extend(self.known(self.newest));
            }
        }
        out
    }

    fn known(&mut self, time_s: f64) -> Option<Followed> {
        let filter = self.filter.as_ref()?;
        let answer = filter.answer(time_s);
        let board = &self.on_board;
        let mut numbers = board.numbers(&self.model, &answer, self.accuracy);
        self.courses.resize(numbers.len(), Course::default());
        let elapsed_s = time_s - self.first;
        for (number, course) in numbers.iter_mut().zip(&mut self.courses) {
            let reached = course.reaches(elapsed_s, number.sigma, number.wanted_sigma);
            course.take(elapsed_s, number.sigma);
            number.reached_at_s = reached.map(|s| self.first + s);
        }
        Some(Followed {
            time_s,
            health: answer.health,
            numbers,
            counts: filter.counts(),
        })
    }
}

/// Whether a line is a row: it begins with a number.
fn is_row(line: &str) -> bool {
    let first = line.trim_start_matches([' ', '\t', '"', '+', '-', '.']);
    first.starts_with(|c: char| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sigma that falls with any power of time is foreseen at its time, within a thousand times the record so far.
    #[test]
    fn exact_a_power_of_time_is_foreseen_where_that_is_of_use() {
        for power in [1.5, 1.0, 0.5, 0.2, 0.05, 0.01, 1.0e-3, 0.0, -0.5] {
            for ratio in [1.001, 1.05, 1.5, 4.0, 40.0] {
                let mut course = Course::default();
                let sigma = |t: f64| 3.0 * t.powf(-power);
                (1..100).for_each(|k| course.take(f64::from(k), sigma(f64::from(k))));
                let wanted = sigma(100.0) / ratio;
                let own_s = 100.0 * f64::powf(ratio, 1.0 / power);
                let said = course.reaches(100.0, sigma(100.0), wanted);
                if power > 0.0 && own_s <= 1.0e5 {
                    let error = said.unwrap() / own_s - 1.0;
                    assert!(error.abs() < 1.0e-6, "{power} {ratio}: {said:?}, {own_s}");
                } else {
                    assert_eq!(said, None, "{power} {ratio}");
                }
                assert_eq!(course.reaches(100.0, wanted, wanted), Some(100.0));
            }
        }
    }
}
