//! Mergeable sums over many trials.
//!
//! A campaign can run in pieces on several machines; each writes its sums as JSON, and `Sums::merge` adds them.

use super::{Trial, estimated_numbers};
use crate::error::Error;
use crate::written::{result_json, write_file};
use poinsot_formats::{ResultFile, read_result};
use poinsot_identify::{Estimate, Status};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Schema of the file.
pub const SUMS_SCHEMA: &str = "poinsot.trials/2";

/// Number of failed trials listed; all are counted.
const NAMED_FAILURES: usize = 100;

/// Sums over one number of the answers.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NumberSums {
    /// Name, for example `base.mass`; SI units throughout.
    pub name: String,
    /// Sigma of the Cramer-Rao bound if equal in every trial; absent if the number is not identifiable.
    pub bound: Option<f64>,
    /// If the truth differs between trials: trials with a bound, and the sum of its squares.
    #[serde(default)]
    pub bounds: (u64, f64),
    /// Trials that determined it.
    pub trials: u64,
    /// Sum of the errors.
    pub error: f64,
    /// Sum of their squares.
    pub square: f64,
    /// Trials among these without a stated sigma.
    #[serde(default)]
    pub unstated: u64,
    /// Sum of the stated variances.
    pub variance: f64,
    /// Trials whose stated 95 % interval holds the truth.
    pub held: u64,
}

/// Sums over trials of one set-up.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Sums {
    /// `poinsot.trials/2`.
    pub schema: String,
    /// Name and options of the set-up.
    pub setup: String,
    /// Trial range of every piece (end exclusive), in order.
    pub ranges: Vec<(u64, u64)>,
    /// Trials run.
    pub trials: u64,
    /// Trials with a result.
    pub answers: u64,
    /// The first failed or not converged trials: number and reason.
    pub failed: Vec<(u64, String)>,
    /// Number of failed trials.
    #[serde(default)]
    pub failures: u64,
    /// Results that are not reliable.
    #[serde(default)]
    pub doubted: u64,
    /// Trials by status.
    pub statuses: Vec<(String, u64)>,
    /// One entry per number.
    pub numbers: Vec<NumberSums>,
    /// Sum of the normalised squared errors, and of their degrees of freedom.
    pub nees: (f64, u64),
    /// Sum of chi-square per degree of freedom.
    pub chi2_per_dof: f64,
    /// Sum of chi-square per number of each kind of sensor.
    pub channels: Vec<(String, f64)>,
    /// Sum and maximum of the iterations.
    pub iterations: (u64, u64),
    /// CPU time of the trials, s.
    pub seconds: f64,
}

impl Sums {
    /// Empty sums; `bound` gives the reference sigma of every number.
    pub fn new(setup: &str, bound: Option<&Estimate>) -> Self {
        let bounds = bound.map(estimated_numbers).unwrap_or_default();
        let named: Vec<(String, f64)> = bounds.into_iter().map(|(n, _, s)| (n, s)).collect();
        Self::with_bound(setup, &named)
    }

    /// Empty sums with the bound's sigmas by name.
    pub fn with_bound(setup: &str, bound: &[(String, f64)]) -> Self {
        let number = |(name, sigma): &(String, f64)| NumberSums {
            name: name.clone(),
            bound: Some(*sigma),
            ..NumberSums::default()
        };
        Self {
            schema: SUMS_SCHEMA.to_owned(),
            setup: setup.to_owned(),
            numbers: bound
                .iter()
                .filter(|b| b.1.is_finite())
                .map(number)
                .collect(),
            ..Self::default()
        }
    }

    /// Adds a trial. A failed trial is counted; its numbers, if any, are included.
    pub fn add(&mut self, trial: &Trial) {
        self.trials += 1;
        match self.ranges.last_mut() {
            Some(last) if last.1 == trial.number => last.1 += 1,
            _ => self.ranges.push((trial.number, trial.number + 1)),
        }
        let answer = match &trial.outcome {
            Ok(answer) => answer,
            Err(why) => return self.fail(trial.number, why),
        };
        if matches!(answer.status, Status::IterationLimit | Status::Rejected) {
            self.fail(trial.number, answer.status.name());
        }
        self.doubted += u64::from(!answer.doubts.is_empty());
        self.answers += 1;
        *entry(&mut self.statuses, answer.status.name()) += 1;
        // Values that are not finite would hide the others.
        for (name, chi2) in answer.channels.iter().filter(|c| c.1.is_finite()) {
            *entry(&mut self.channels, name) += chi2;
        }
        if answer.chi2_per_dof.is_finite() {
            self.chi2_per_dof += answer.chi2_per_dof;
        }
        let taken = answer.iterations as u64;
        self.iterations = (self.iterations.0 + taken, self.iterations.1.max(taken));
        if let Some((square, dof)) = answer.nees.filter(|n| n.0.is_finite()) {
            self.nees.0 += square;
            self.nees.1 += dof as u64;
        }
        let reach = poinsot_formats::HALF_WIDTH_95;
        for (place, number) in answer.numbers.iter().enumerate() {
            if !number.error.is_finite() {
                continue;
            }
            let sums = self.number(place, &number.name);
            sums.trials += 1;
            sums.error += number.error;
            sums.square += number.error * number.error;
            if !number.sigma.is_finite() {
                sums.unstated += 1;
                continue;
            }
            sums.variance += number.sigma * number.sigma;
            sums.held += u64::from(number.error.abs() <= reach * number.sigma);
        }
    }

    fn fail(&mut self, trial: u64, why: &str) {
        self.failures += 1;
        if self.failed.len() < NAMED_FAILURES {
            self.failed.push((trial, why.to_owned()));
        }
    }

    /// Adds the bound of one trial, if every trial has its own true values.
    pub fn add_bound(&mut self, bound: &[(String, f64)]) {
        for (place, (name, sigma)) in bound.iter().enumerate() {
            if !sigma.is_finite() {
                continue;
            }
            let sums = self.number(place, name);
            sums.bounds = (sums.bounds.0 + 1, sums.bounds.1 + sigma * sigma);
        }
    }

    /// The sums of a name, which is looked for at `place` first.
    fn number(&mut self, place: usize, name: &str) -> &mut NumberSums {
        let at = position(&self.numbers, place, |n| n.name == name);
        let at = at.unwrap_or_else(|| {
            self.numbers.push(NumberSums {
                name: name.to_owned(),
                ..NumberSums::default()
            });
            self.numbers.len() - 1
        });
        &mut self.numbers[at]
    }

    /// Adds another piece of the same campaign.
    ///
    /// # Errors
    /// The pieces have different set-ups or contain the same trial.
    pub fn merge(&mut self, other: &Self) -> Result<(), String> {
        if self.setup != other.setup {
            return Err(format!("'{}' is not '{}'", other.setup, self.setup));
        }
        for (a, b) in &other.ranges {
            if let Some((c, d)) = self.ranges.iter().find(|(c, d)| a < d && c < b) {
                return Err(format!("trials {a} to {b} and {c} to {d} overlap"));
            }
        }
        self.ranges.extend(&other.ranges);
        self.ranges.sort_unstable();
        self.ranges = joined(&self.ranges);
        self.trials += other.trials;
        self.answers += other.answers;
        self.failures += other.failures;
        self.doubted += other.doubted;
        self.failed.extend(other.failed.iter().cloned());
        self.failed.sort();
        self.failed.truncate(NAMED_FAILURES);
        for (name, count) in &other.statuses {
            *entry(&mut self.statuses, name) += count;
        }
        for (name, sum) in &other.channels {
            *entry(&mut self.channels, name) += sum;
        }
        self.chi2_per_dof += other.chi2_per_dof;
        self.iterations.0 += other.iterations.0;
        self.iterations.1 = self.iterations.1.max(other.iterations.1);
        self.nees = (self.nees.0 + other.nees.0, self.nees.1 + other.nees.1);
        self.seconds += other.seconds;
        for (place, theirs) in other.numbers.iter().enumerate() {
            let ours = self.number(place, &theirs.name);
            ours.bound = ours.bound.or(theirs.bound);
            ours.bounds = (
                ours.bounds.0 + theirs.bounds.0,
                ours.bounds.1 + theirs.bounds.1,
            );
            ours.trials += theirs.trials;
            ours.error += theirs.error;
            ours.square += theirs.square;
            ours.unstated += theirs.unstated;
            ours.variance += theirs.variance;
            ours.held += theirs.held;
        }
        Ok(())
    }

    /// Whether these are sums of the trials of a range, each counted once.
    pub(crate) fn is_of(&self, range: (u64, u64)) -> bool {
        let statuses = self
            .statuses
            .iter()
            .try_fold(0, |n: u64, (_, m)| n.checked_add(*m));
        let number = |n: &NumberSums| {
            let stated = n.trials.checked_sub(n.unstated);
            let finite = [n.error, n.square, n.variance]
                .iter()
                .all(|x| x.is_finite());
            n.trials <= self.answers && stated.is_some_and(|s| n.held <= s) && finite
        };
        self.ranges == [range]
            && self.trials == range.1 - range.0
            && self.answers <= self.trials
            && self.failures <= self.trials
            && self.doubted <= self.answers
            && statuses == Some(self.answers)
            && self.numbers.iter().all(number)
    }

    /// Reads a file of [`Self::write`].
    ///
    /// # Errors
    /// The file cannot be read, is of another schema, or was changed.
    pub fn read(path: &Path) -> Result<Self, Error> {
        read_result(path)
    }

    /// Writes the sums as JSON, atomically.
    ///
    /// # Errors
    /// Writing fails.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        write_file(path, result_json(path, self, true)?.as_bytes())
    }
}

impl ResultFile for Sums {
    const SCHEMA: &'static str = SUMS_SCHEMA;
    const EARLIER: &'static [&'static str] = &["poinsot.trials/1"];
}

/// The position of the item that is meant, which most often is `place`.
pub(crate) fn position<T>(list: &[T], place: usize, is: impl Fn(&T) -> bool) -> Option<usize> {
    match list.get(place) {
        Some(item) if is(item) => Some(place),
        _ => list.iter().position(is),
    }
}

/// Sorted ranges; adjacent ones are joined.
fn joined(ranges: &[(u64, u64)]) -> Vec<(u64, u64)> {
    let mut all: Vec<(u64, u64)> = Vec::new();
    for &(first, past) in ranges {
        match all.last_mut() {
            Some(last) if last.1 == first => last.1 = past,
            _ => all.push((first, past)),
        }
    }
    all
}

fn entry<'a, T: Default>(list: &'a mut Vec<(String, T)>, name: &str) -> &'a mut T {
    let at = list.iter().position(|(n, _)| n == name);
    let at = at.unwrap_or_else(|| {
        list.push((name.to_owned(), T::default()));
        list.len() - 1
    });
    &mut list[at].1
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::{Answer, TrialNumber, statistics_of};
    use super::*;

    fn trial(number: u64) -> Trial {
        let wave = (number as f64).sin();
        Trial {
            number,
            outcome: if number == 3 {
                Err("no".to_owned())
            } else {
                Ok(Answer {
                    status: Status::Converged,
                    doubts: Vec::new(),
                    iterations: 2 + number as usize % 2,
                    chi2_per_dof: 1.0 + 0.1 * wave,
                    channels: vec![("gyro".to_owned(), 1.0 - 0.1 * wave)],
                    numbers: vec![TrialNumber {
                        name: "base.mass".to_owned(),
                        value: 1.0 + wave,
                        error: wave,
                        sigma: 0.5,
                    }],
                    nees: Some((wave * wave / 0.25, 1)),
                })
            },
        }
    }

    fn sums(trials: std::ops::Range<u64>) -> Sums {
        let mut sums = Sums::new("made", None);
        trials.for_each(|n| sums.add(&trial(n)));
        sums
    }

    #[test]
    fn exact_sums_of_pieces_are_the_sums_of_the_whole() {
        let whole = sums(0..20);
        let mut merged = sums(12..20);
        merged.merge(&sums(0..12)).unwrap();
        assert_eq!(merged.ranges, [(0, 20)]);
        let (a, b) = (statistics_of(&whole), statistics_of(&merged));
        assert_eq!((a.trials, a.failures, a.iterations.1), (20, 1, 3));
        assert!((a.parameters[0].rmse - b.parameters[0].rmse).abs() < 1.0e-14);
        assert!((a.parameters[0].coverage - b.parameters[0].coverage).abs() < 1.0e-14);
        assert!((a.nees.unwrap().0 - b.nees.unwrap().0).abs() < 1.0e-13);
    }

    #[test]
    fn unit_pieces_that_overlap_or_differ_are_refused() {
        let why = sums(0..12).merge(&sums(10..20)).unwrap_err();
        assert!(why.contains("overlap"), "{why}");
        let mut other = sums(20..25);
        other.setup = "another".to_owned();
        assert!(sums(0..12).merge(&other).unwrap_err().contains("another"));
    }

    #[test]
    fn unit_a_file_of_sums_reads_equal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sums.json");
        sums(0..20).write(&path).unwrap();
        let (mut read, made) = (Sums::read(&path).unwrap(), sums(0..20));
        // Parsing may change the last bit.
        let gap = read.numbers[0].square - made.numbers[0].square;
        assert!(gap.abs() < 1.0e-14);
        read.numbers[0].square = made.numbers[0].square;
        assert_eq!(read, made);
        std::fs::write(&path, "{}").unwrap();
        let error = Sums::read(&path).unwrap_err().to_string();
        assert!(error.contains("sums.json"), "{error}");
    }
}
