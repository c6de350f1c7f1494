//! Sums over the rows of one method, and the statistics made from them.

use super::{Nees, Row, RowNumber};
use indexmap::IndexMap;
use poinsot_formats::{BandedFile, MethodResultFile, NumberResultFile, finite};
use poinsot_identify::Status;
use serde::{Deserialize, Serialize};

/// Number of failed trials named in sums, and in a result; all are counted.
const NAMED: [usize; 2] = [100, 10];
/// Probability outside an interval of a result.
pub const OUTSIDE: f64 = 0.05;

/// A count with a sum.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Squares {
    /// Trials.
    pub count: u64,
    /// Sum of the squares.
    pub sum: f64,
}

/// Sum and maximum.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Iterations {
    sum: u64,
    most: u64,
}

/// Sums over one number of the rows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct NumberSums {
    /// Address; SI units throughout.
    pub name: String,
    /// Sigmas of the Cramer-Rao bound.
    pub bounds: Squares,
    /// Trials that determined it.
    pub trials: u64,
    /// Sum of the errors.
    pub error: f64,
    /// Sum of their squares.
    pub square: f64,
    /// Trials among these without a stated sigma.
    pub unstated: u64,
    /// Sum of the stated variances.
    pub variance: f64,
    /// Trials whose stated 95 % interval holds the truth.
    pub held: u64,
}

impl NumberSums {
    fn of(number: &RowNumber) -> Self {
        let mut sums = Self::default();
        if let Some(bound) = number.bound {
            (sums.bounds.count, sums.bounds.sum) = (1, bound * bound);
        }
        let Some(error) = number.error().filter(|e| e.is_finite()) else {
            return sums;
        };
        (sums.trials, sums.error, sums.square) = (1, error, error * error);
        match number.sigma.filter(|s| s.is_finite()) {
            Some(sigma) => {
                sums.variance = sigma * sigma;
                sums.held = u64::from(number.holds(error));
            }
            None => sums.unstated = 1,
        }
        sums
    }

    fn add(&mut self, more: &Self) {
        self.bounds.count += more.bounds.count;
        self.bounds.sum += more.bounds.sum;
        self.trials += more.trials;
        self.error += more.error;
        self.square += more.square;
        self.unstated += more.unstated;
        self.variance += more.variance;
        self.held += more.held;
    }

    fn result(&self, trials: u64, outside: f64) -> NumberResultFile {
        let n = self.trials as f64;
        let (bias, square) = (self.error / n, self.square / n);
        let spread = ((square - bias * bias).max(0.0) * n / (n - 1.0).max(1.0)).sqrt();
        let stated = self.trials - self.unstated;
        let bound = finite(self.bounds.sum / self.bounds.count as f64).map(f64::sqrt);
        let rmse = BandedFile::mean_square(square, self.trials, outside).root();
        let over = |bound: f64| rmse.over(bound);
        // Over the trials that determined the number, and over all; null where none states an interval.
        let [coverage_answered, coverage_all] = match stated {
            0 => [BandedFile::default(); 2],
            _ => [stated, trials].map(|of| BandedFile::share(self.held, of, outside)),
        };
        NumberResultFile {
            trials: self.trials,
            bound,
            stated: finite((self.variance / stated as f64).sqrt()),
            bias: BandedFile::mean(bias, spread, self.trials, outside),
            rmse,
            rmse_over_bound: bound.map_or_else(BandedFile::default, over),
            coverage_answered,
            coverage_all,
        }
    }

    fn is_possible(&self, trials: u64, answers: u64) -> bool {
        let stated = self.trials.checked_sub(self.unstated);
        let counts = self.trials <= answers && stated.is_some_and(|s| self.held <= s);
        // The square of a mean is at most the mean of the squares, but for rounding.
        let square = self.error * self.error <= 1.000_001 * self.square * self.trials as f64;
        let sums = [self.square, self.variance, self.bounds.sum];
        counts && self.bounds.count <= trials && square && sums.iter().all(is_square)
    }
}

/// Sums over the rows of one method.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Sums {
    /// Method, with variant and settings.
    pub setup: String,
    /// Trials run.
    pub trials: u64,
    /// Trials with a result.
    pub answers: u64,
    /// The first failed or not converged trials: number and reason.
    pub failed: Vec<(u64, String)>,
    /// Number of failed trials.
    pub failures: u64,
    /// Results that are not reliable.
    pub doubted: u64,
    /// Trials by status.
    #[serde(with = "indexmap::map::serde_seq")]
    pub statuses: IndexMap<String, u64>,
    /// One entry per number.
    pub numbers: Vec<NumberSums>,
    /// Normalised squared errors.
    pub nees: Nees,
    /// Sum of chi-square per degree of freedom.
    pub chi2_per_dof: f64,
    /// Sum of chi-square per number of each kind of sensor.
    #[serde(with = "indexmap::map::serde_seq")]
    pub channels: IndexMap<String, f64>,
    /// Iterations taken.
    pub iterations: Iterations,
}

impl Sums {
    /// Adds a row. A failed trial is counted; its numbers, if any, are included.
    pub fn add(&mut self, row: &Row) {
        self.trials += 1;
        for (place, number) in row.numbers.iter().enumerate() {
            if number.estimate.is_some() || number.bound.is_some() {
                self.number(place, &number.name)
                    .add(&NumberSums::of(number));
            }
        }
        let failure = match row.status {
            None => Some(row.evidence.join("; ")),
            Some(Status::IterationLimit | Status::Rejected) => row.status.map(|s| s.name().into()),
            Some(_) => None,
        };
        if let Some(why) = failure {
            self.failures += 1;
            self.failed.push((row.trial, why));
            self.failed.truncate(NAMED[0]);
        }
        let Some(status) = row.status else { return };
        self.answers += 1;
        self.doubted += u64::from(!row.evidence.is_empty());
        *self.statuses.entry(status.name().to_owned()).or_default() += 1;
        // Values that are not finite would hide the others.
        for (name, chi2) in row.channels.iter().filter(|c| c.1.is_finite()) {
            *self.channels.entry(name.clone()).or_default() += chi2;
        }
        self.chi2_per_dof += row.chi2_per_dof.unwrap_or(0.0);
        self.iterations.sum += row.iterations;
        self.iterations.most = self.iterations.most.max(row.iterations);
        if let Some(nees) = row.nees.filter(|n| n.square.is_finite()) {
            self.nees.square += nees.square;
            self.nees.dof += nees.dof;
        }
    }

    /// The sums of a number, which is looked for at `place` first.
    fn number(&mut self, place: usize, name: &str) -> &mut NumberSums {
        let found = position(&self.numbers, place, |n| n.name == name);
        let at = found.unwrap_or_else(|| {
            self.numbers.push(NumberSums {
                name: name.to_owned(),
                ..NumberSums::default()
            });
            self.numbers.len() - 1
        });
        &mut self.numbers[at]
    }

    /// Adds the sums of other trials.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.trials += other.trials;
        self.answers += other.answers;
        self.failures += other.failures;
        self.doubted += other.doubted;
        self.failed.extend(other.failed.iter().cloned());
        self.failed.sort();
        self.failed.truncate(NAMED[0]);
        for (name, count) in &other.statuses {
            *self.statuses.entry(name.clone()).or_default() += count;
        }
        for (name, sum) in &other.channels {
            *self.channels.entry(name.clone()).or_default() += sum;
        }
        self.chi2_per_dof += other.chi2_per_dof;
        self.iterations.sum += other.iterations.sum;
        self.iterations.most = self.iterations.most.max(other.iterations.most);
        self.nees.square += other.nees.square;
        self.nees.dof += other.nees.dof;
        for (place, theirs) in other.numbers.iter().enumerate() {
            self.number(place, &theirs.name).add(theirs);
        }
    }

    /// Whether these are the sums of rows that were read, which state neither bounds nor sensors.
    pub(crate) fn agree_with(&self, mut read: Self) -> bool {
        for own in &self.numbers {
            read.number(0, &own.name).bounds = own.bounds;
        }
        read.channels.clone_from(&self.channels);
        let mut own = self.clone();
        for sums in [&mut own, &mut read] {
            sums.numbers.sort_by(|a, b| a.name.cmp(&b.name));
        }
        own == read
    }

    /// Whether these can be the sums of this many trials.
    pub(crate) fn is_of(&self, trials: u64) -> bool {
        let mut answers = self.statuses.values();
        let possible = |n: &NumberSums| n.is_possible(trials, self.answers);
        self.trials == trials
            && self.failures <= trials
            && (trials - self.failures..=trials).contains(&self.answers)
            && self.failed.len() as u64 == self.failures.min(NAMED[0] as u64)
            && self.doubted <= self.answers
            && answers.try_fold(0_u64, |n, m| n.checked_add(*m)) == Some(self.answers)
            && self.numbers.iter().all(possible)
            && self.nees.dof <= self.answers.saturating_mul(self.numbers.len() as u64)
            && [self.nees.square, self.chi2_per_dof].iter().all(is_square)
    }

    /// The statistics; `outside` is the probability outside each interval.
    pub fn result(&self, outside: f64) -> MethodResultFile {
        let count = self.answers.max(1) as f64;
        let numbers = self.numbers.iter().filter(|n| n.trials > 0);
        let number = |n: &NumberSums| (n.name.clone(), n.result(self.trials, outside));
        let mean = |(name, sum): (&String, &f64)| (name.clone(), sum / count);
        let Nees { square, dof } = self.nees;
        let mut result = MethodResultFile {
            method: self.setup.clone(),
            trials: self.trials,
            failed: BandedFile::share(self.failures, self.trials, outside),
            doubted: BandedFile::share(self.doubted, self.answers, outside),
            statuses: self.statuses.clone(),
            failures: self.failed.iter().take(NAMED[1]).cloned().collect(),
            nees: (dof > 0).then(|| BandedFile::mean_square(square / dof as f64, dof, outside)),
            nees_dof: dof,
            // Exactly zero where no answer has residuals.
            chi2_per_dof: finite(self.chi2_per_dof / count).filter(|chi2| *chi2 > 0.0),
            channels: self.channels.iter().map(mean).collect(),
            iterations: (self.iterations.sum as f64 / count, self.iterations.most),
            seconds_per_trial: None,
            numbers: numbers.map(number).collect(),
            misses: Vec::new(),
        };
        result.misses = result.find_misses();
        result
    }
}

/// Whether a number can be a sum of squares.
fn is_square(x: &f64) -> bool {
    x.is_finite() && *x >= 0.0
}

/// The position of the item that is meant, which most often is `place`.
pub(crate) fn position<T>(list: &[T], place: usize, is: impl Fn(&T) -> bool) -> Option<usize> {
    match list.get(place) {
        Some(item) if is(item) => Some(place),
        _ => list.iter().position(is),
    }
}
