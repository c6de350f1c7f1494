//! The speed of a wheel or the position of a joint, with changes at random, from noisy or rounded samples.
//!
//! The slope of a wheel's speed changes at its samples, or all along by white noise; a joint's acceleration changes all along. A sample is the value or the slope, its rounding error and white noise; the rounding error stays in part from sample to
//! sample. With the state `x = [value, slope, acceleration, rounding]`, `x' = F x` over an interval, `x+ = x + d s v` for each change
//! along its direction d, and at a sample `x+ = diag(1, 1, 1, a) x + [0, 0, 0, q v]`, all v normal. The samples give the posterior of the whole
//! motion. It is a Markov process itself: with `L` the information that the later samples hold of the state, a change along d has the
//! variance `s2 / (1 + s2 d^T L d)` and a mean that follows the state (Fraser and Potter 1969, backward information filter). Its mean is
//! the motion that drives the prediction. The error of value, slope and acceleration is taken as a Markov process with their
//! covariances at neighbouring times ([`ErrorProcess`]): exact for white noise.
//!
//! White noise of the third derivative, of density q over an interval h, is three changes at its end: the columns of the root of the
//! covariance `q [h^5/20, h^4/8, h^3/6; h^4/8, h^3/3, h^2/2; h^3/6, h^2/2, h]`. That of the second is two, and
//! the motion within an interval is known from its ends: its mean is a cubic, and its integral has the variance `q h^5 / 720` about that.

use crate::fit::part_of_record::picked;
use crate::problem::error_process::{ErrorProcess, ErrorStep};
use crate::problem::segment::RateParts;
use nalgebra::{Const, Dim, Matrix, Matrix3, SMatrix, SVector, StorageMut};

/// Components of the state. The acceleration is one where it changes all along, and a rounding error, the last one, where samples are
/// rounded: two to four numbers.
const VALUE: usize = 0;
const SLOPE: usize = 1;
const ACCELERATION: usize = 2;
/// How much wider than the samples and changes say the value and slope of a wheel are before them.
const DIFFUSE: f64 = 1.0e3;
/// The same of the motion of a joint, relative to the range of its samples.
const RANGES: f64 = 30.0;
/// White noise beside a rounding error, over its variance: keeps what a sample tells finite.
const WHITE: f64 = 1.0e-3;
/// Degrees of freedom of the changes: most are small, as between two manoeuvres, and some large. Measured: docs/validation/pyramid.md.
const TAILS: f64 = 2.0;
/// Intervals before and after one with which its changes share their size.
const SHARED: usize = 4;
/// Most renewals of their sizes, which end where none changes by more than the accuracy.
const RENEWALS: usize = 20;
/// Relative accuracy of the size of the changes: the error of a rate grows with its square root, that of a value with its sixth root.
const ACCURACY: f64 = 0.05;
/// Range of that size: changes that move the value by this share of the noise until the next one, or of a joint until the end, and by this
/// multiple of it until the next one.
const RANGE: [f64; 2] = [1.0e-3, 1.0e4];

/// One sample of an input: a wheel's speed, rad/s, or a joint's position, rad or m.
#[derive(Debug, Clone, Copy)]
pub struct InputSample {
    /// Grid time.
    pub at: usize,
    /// What was read.
    pub value: f64,
    /// Variance of white noise.
    pub white: f64,
    /// Variance of the rounding error.
    pub rounding: f64,
    /// Correlation of the rounding error with that of the sample before.
    pub memory: f64,
    /// Whether it is a sample of the slope, per second, with white noise alone.
    pub of_slope: bool,
}

impl InputSample {
    /// A sample with white noise alone.
    pub fn white(at: usize, value: f64, variance: f64) -> Self {
        Self {
            at,
            value,
            white: variance,
            rounding: 0.0,
            memory: 0.0,
            of_slope: false,
        }
    }

    /// A sample of the slope.
    pub fn slope(at: usize, value: f64, variance: f64) -> Self {
        Self {
            of_slope: true,
            ..Self::white(at, value, variance)
        }
    }

    /// The same noise as a rounding error, with this correlation to that of the sample before.
    pub fn rounded(self, memory: f64) -> Self {
        Self {
            white: WHITE * self.white,
            rounding: self.white,
            memory,
            ..self
        }
    }

    /// The row that it reads of the state, and what it reads beyond the level.
    fn of_state<const N: usize>(&self, level: f64, rounded: bool) -> (SVector<f64, N>, f64) {
        if self.of_slope {
            return (unit(SLOPE), self.value);
        }
        let mut row: SVector<f64, N> = unit(VALUE);
        if rounded {
            row[N - 1] = 1.0;
        }
        (row, self.value - level)
    }

    /// Variance of its noise.
    fn total(&self) -> f64 {
        self.white + self.rounding
    }

    /// Variance of what is new in the rounding error.
    fn fresh(&self) -> f64 {
        (1.0 - self.memory * self.memory) * self.rounding
    }
}

/// What of a motion changes at random, and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Changes {
    /// Its slope, at some times.
    SlopeAtTimes,
    /// Its slope, all along.
    Slope,
    /// The slope of that, all along.
    Acceleration,
}

impl Changes {
    /// Numbers of the motion.
    fn numbers(self) -> usize {
        if self == Self::Acceleration { 3 } else { 2 }
    }

    /// How many changes stand for those of an interval.
    fn count(self) -> usize {
        match self {
            Self::SlopeAtTimes => 1,
            Self::Slope => 2,
            Self::Acceleration => 3,
        }
    }
}

/// Standard deviations of changes all along, before each grid time, over that in an interval of typical length.
pub(crate) fn all_along(time_s: &[f64], typical_s: f64) -> Vec<f64> {
    let intervals = time_s.windows(2);
    let intervals = intervals.map(|w| ((w[1] - w[0]) / typical_s).sqrt());
    std::iter::once(0.0).chain(intervals).collect()
}

/// Samples of an input on a grid, and when its motion changes.
pub(crate) struct InputSamples<'a> {
    pub time_s: &'a [f64],
    /// Standard deviation of the change before each grid time over that of a plain one; zero where there is none.
    pub changes: &'a [f64],
    pub of: Changes,
    /// In order of time, at most one value at a grid time.
    pub samples: &'a [InputSample],
}

/// What the samples say of the motion.
pub(crate) struct InputPosterior {
    pub mean: InputMean,
    pub errors: ErrorProcess,
    /// -2 ln of the probability density of the samples, less a constant.
    pub deviance: f64,
}

/// Its mean.
#[derive(Default)]
pub(crate) struct InputMean {
    /// Value and slope at every grid time.
    pub value: Vec<f64>,
    pub slope: Vec<f64>,
    /// Slope of the slope; zero where that changes at some times alone.
    pub acceleration: Vec<f64>,
    /// Mean square of the changes before every grid time, their sum.
    squares: Vec<f64>,
}

impl InputMean {
    fn push(&mut self, [value, slope, acceleration]: [f64; 3], squares: f64) {
        self.value.push(value);
        self.slope.push(slope);
        self.acceleration.push(acceleration);
        self.squares.push(squares);
    }

    /// The mean motion at a grid time.
    fn at(&self, k: usize) -> [f64; 3] {
        [self.value[k], self.slope[k], self.acceleration[k]]
    }
}

/// What later samples hold of the state: -2 ln of their density is `x^T L x - 2 eta^T x` and a constant.
struct Information<const N: usize> {
    L: SMatrix<f64, N, N>,
    eta: SVector<f64, N>,
    /// Logarithm of the determinant, less that of a factor.
    log_det: f64,
    factor: f64,
}

impl<const N: usize> Information<N> {
    fn take(&mut self, sample: &InputSample, level: f64, rounded: bool) {
        let (h, value) = sample.of_state::<N>(level, rounded);
        self.L += h * h.transpose() / sample.white;
        self.eta += h * (value / sample.white);
    }

    /// Goes back over a normal change along a direction with this variance: what the later samples make of it.
    fn before_change(&mut self, along: &SVector<f64, N>, variance: f64) -> Change<N> {
        let held = self.L * along;
        let unit = 1.0 + variance * along.dot(&held);
        let own = variance / unit;
        let mean = own * along.dot(&self.eta);
        self.eta -= held * mean;
        self.L -= held * held.transpose() * own;
        self.factor *= unit;
        // A logarithm of many takes no longer than that of one.
        if self.factor > LARGE {
            self.log_det += self.factor.ln();
            self.factor = 1.0;
        }
        Change {
            own,
            mean,
            follows: -held * own,
        }
    }

    /// Goes back over an interval without a change.
    fn before_line(&mut self, h: f64, of: Changes) {
        back_over_line(h, of, &mut self.eta);
        back_over_line(h, of, &mut self.L);
        self.L.transpose_mut();
        back_over_line(h, of, &mut self.L);
    }

    /// Goes back over a rounding error of which this share stays.
    fn before_fading(&mut self, memory: f64) {
        self.eta[N - 1] *= memory;
        fade(&mut self.L, memory);
    }
}

/// What rounding errors share with other components, where this share of them stays.
fn fade<const N: usize>(of: &mut SMatrix<f64, N, N>, memory: f64) {
    of.row_mut(N - 1).scale_mut(memory);
    of.column_mut(N - 1).scale_mut(memory);
}

/// Takes states over an interval without a change, one in each column.
fn over_line<const N: usize, C: Dim, S: StorageMut<f64, Const<N>, C>>(
    h: f64,
    of: Changes,
    x: &mut Matrix<f64, Const<N>, C, S>,
) {
    for mut x in x.column_iter_mut() {
        x[VALUE] += h * x[SLOPE];
        if of == Changes::Acceleration {
            x[VALUE] += 0.5 * h * h * x[ACCELERATION];
            x[SLOPE] += h * x[ACCELERATION];
        }
    }
}

/// Takes what is held of states back over it.
fn back_over_line<const N: usize, C: Dim, S: StorageMut<f64, Const<N>, C>>(
    h: f64,
    of: Changes,
    held: &mut Matrix<f64, Const<N>, C, S>,
) {
    for mut x in held.column_iter_mut() {
        if of == Changes::Acceleration {
            x[ACCELERATION] += 0.5 * h * h * x[VALUE] + h * x[SLOPE];
        }
        x[SLOPE] += h * x[VALUE];
    }
}

/// A change along a direction of the state, given the state before it: normal about `mean + follows . x`.
struct Change<const N: usize> {
    own: f64,
    mean: f64,
    follows: SVector<f64, N>,
}

impl<const N: usize> Change<N> {
    /// The mean change; the state goes with it.
    fn along(&self, direction: &SVector<f64, N>, x: &mut SVector<f64, N>) -> f64 {
        let change = self.mean + self.follows.dot(x);
        *x += direction * change;
        change
    }

    /// What follows the state, of a covariance with an earlier one.
    fn follow(&self, direction: &SVector<f64, N>, with_earlier: &mut SMatrix<f64, N, N>) {
        *with_earlier += direction * with_earlier.tr_mul(&self.follows).transpose();
    }

    /// The covariance of the state after it; the variance of the change.
    fn spread(&self, direction: &SVector<f64, N>, P: &mut SMatrix<f64, N, N>) -> f64 {
        let with_state = *P * self.follows;
        let variance = self.own + self.follows.dot(&with_state);
        let cross = direction * with_state.transpose();
        *P += cross + cross.transpose() + direction * direction.transpose() * variance;
        variance
    }
}

/// Directions of the changes at the end of an interval, in the order of time; those that count come last.
fn directions<const N: usize>(of: Changes, h: f64) -> [SVector<f64, N>; 3] {
    let all = match of {
        Changes::SlopeAtTimes => return [unit(SLOPE); 3],
        Changes::Slope => [
            [0.0; 3],
            [h / 12.0_f64.sqrt(), 0.0, 0.0],
            [0.5 * h, 1.0, 0.0],
        ],
        Changes::Acceleration => [
            [h * h / 720.0_f64.sqrt(), 0.0, 0.0],
            [h * h / 48.0_f64.sqrt(), h / 12.0_f64.sqrt(), 0.0],
            [h * h / 6.0, 0.5 * h, 1.0],
        ],
    };
    all.map(|own| SVector::from_fn(|i, _| own.get(i).copied().unwrap_or(0.0)))
}

/// A product of determinants of which the logarithm is taken.
const LARGE: f64 = 1.0e100;

/// The direction of a component.
fn unit<const N: usize>(i: usize) -> SVector<f64, N> {
    SVector::from_fn(|k, _| if k == i { 1.0 } else { 0.0 })
}

/// The way from the first state on, from one grid time to the next.
struct Path<const N: usize> {
    /// Lengths of the intervals.
    h: Vec<f64>,
    /// At the end of each interval, in the order of time.
    changes: Vec<Change<N>>,
    of: Changes,
    /// What stays and is new of the rounding error at the end of each interval with a sample; empty where nothing is rounded.
    rounding: Vec<Option<(f64, Change<N>)>>,
}

impl<const N: usize> Path<N> {
    /// The mean state at the end of an interval; the sum of squares of the mean changes, and the mean change of the rounding error.
    fn along(&self, k: usize, x: &mut SVector<f64, N>) -> [f64; 2] {
        over_line(self.h[k], self.of, x);
        let mut squares = 0.0;
        for (change, direction) in self.changes(k) {
            squares += change.along(&direction, x).powi(2);
        }
        let rounding = self.rounding(k).map(|(memory, change)| {
            x[N - 1] *= memory;
            change.along(&unit(N - 1), x)
        });
        [squares, rounding.unwrap_or(0.0)]
    }

    /// From the covariance at its start: that of both ends, at its end, and the variance of all changes.
    fn spread(&self, k: usize, P: &SMatrix<f64, N, N>) -> Spread<N> {
        let mut together = *P;
        over_line(self.h[k], self.of, &mut together);
        let mut after = together.transpose();
        over_line(self.h[k], self.of, &mut after);
        let mut variance = 0.0;
        for (change, direction) in self.changes(k) {
            change.follow(&direction, &mut together);
            variance += change.spread(&direction, &mut after);
        }
        if let Some((memory, change)) = self.rounding(k) {
            together.row_mut(N - 1).scale_mut(*memory);
            fade(&mut after, *memory);
            change.follow(&unit(N - 1), &mut together);
            change.spread(&unit(N - 1), &mut after);
        }
        Spread {
            together,
            after,
            variance,
        }
    }

    fn changes(&self, k: usize) -> impl Iterator<Item = (&Change<N>, SVector<f64, N>)> {
        let count = self.of.count();
        let own = &self.changes[count * k..count * (k + 1)];
        own.iter()
            .zip(directions(self.of, self.h[k]).into_iter().skip(3 - count))
    }

    fn rounding(&self, k: usize) -> Option<&(f64, Change<N>)> {
        self.rounding.get(k)?.as_ref()
    }
}

/// Covariances over an interval: of both ends, and at its end; and the variance of all changes.
struct Spread<const N: usize> {
    together: SMatrix<f64, N, N>,
    after: SMatrix<f64, N, N>,
    variance: f64,
}

/// The state at the first grid time, and the way from there.
struct Start<const N: usize> {
    level: f64,
    mean: SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
    path: Path<N>,
    log_det: f64,
    /// Standard deviations before the samples.
    sigmas: SVector<f64, N>,
}

impl InputSamples<'_> {
    /// Standard deviation of the best sample.
    fn noise(&self) -> Option<f64> {
        let values = self.samples.iter().filter(|s| !s.of_slope);
        values.map(|s| s.total().sqrt()).reduce(f64::min)
    }

    /// The start with the standard deviation of a plain change at each grid time; `None` without samples.
    fn start<const N: usize>(&self, sizes: &[f64]) -> Option<Start<N>> {
        let level = self.samples.iter().find(|s| !s.of_slope)?.value;
        let (held, path) = self.backward(sizes, level);
        let sigmas = self.before_samples(sizes)?;
        let D = SMatrix::from_diagonal(&sigmas);
        let unit = (SMatrix::<f64, N, N>::identity() + D * held.L * D).cholesky()?;
        let covariance = D * unit.inverse() * D;
        let mean = covariance * held.eta;
        Some(Start {
            level,
            mean,
            covariance,
            path,
            log_det: held.log_det + held.factor.ln() + unit.determinant().ln(),
            sigmas,
        })
    }

    /// Standard deviations of the first state before the samples.
    fn before_samples<const N: usize>(&self, sizes: &[f64]) -> Option<SVector<f64, N>> {
        let span = self.time_s.last()? - self.time_s.first()?;
        let first = self.samples.iter().take_while(|s| s.at == 0);
        let rounding = first.map(|s| s.rounding).sum::<f64>().sqrt();
        let all = if self.of == Changes::Acceleration {
            let values = self.samples.iter().filter(|s| !s.of_slope);
            let values: Vec<f64> = values.map(|s| s.value).collect();
            let [least, most] = [f64::min, f64::max].map(|of| values.iter().copied().reduce(of));
            let wide = RANGES * (self.noise()? + most? - least?);
            let rate = values.len() as f64 / span;
            [wide, wide * rate, wide * rate * rate]
        } else {
            let largest = sizes.iter().fold(0.0, |a: f64, b| a.max(*b));
            let wide = DIFFUSE * (self.noise()? + largest * span);
            [wide, wide / span, rounding]
        };
        let own = |i: usize, _| all.get(i).copied().unwrap_or(rounding);
        Some(SVector::from_fn(own))
    }

    /// The posterior with the standard deviation of a plain change at each grid time; `None` without samples.
    pub fn posterior(&self, sizes: &[f64]) -> Option<InputPosterior> {
        match self.numbers() {
            2 => self.posterior_of::<2>(sizes),
            3 => self.posterior_of::<3>(sizes),
            _ => self.posterior_of::<4>(sizes),
        }
    }

    /// Numbers of the state.
    fn numbers(&self) -> usize {
        self.of.numbers() + usize::from(self.is_rounded())
    }

    fn is_rounded(&self) -> bool {
        self.samples.iter().any(|s| s.rounding > 0.0)
    }

    fn posterior_of<const N: usize>(&self, sizes: &[f64]) -> Option<InputPosterior> {
        let start = self.start::<N>(sizes)?;
        let motion = |P: &SMatrix<f64, N, N>| start.motion(P);
        let mut errors = ErrorProcess::new(motion(&start.covariance), []);
        let mut within = self.within(sizes);
        let mean = start.forward(|covariances| {
            let step = ErrorStep::between(covariances.map(motion));
            errors.push(&ErrorStep {
                within: within.next().unwrap_or(0.0),
                ..step
            });
        });
        Some(InputPosterior {
            mean,
            errors,
            deviance: self.deviance(&start, sizes),
        })
    }

    /// Variance of the integral over each interval, its ends given.
    fn within(&self, sizes: &[f64]) -> impl Iterator<Item = f64> {
        let ends = self.time_s.windows(2).zip(&sizes[1..]);
        ends.zip(&self.changes[1..]).map(|((t, size), change)| {
            let h = t[1] - t[0];
            match self.of {
                Changes::Slope => (size * change).powi(2) * h.powi(4) / 720.0,
                Changes::SlopeAtTimes | Changes::Acceleration => 0.0,
            }
        })
    }

    /// What all samples hold of the first state, and the way back to it.
    fn backward<const N: usize>(&self, sizes: &[f64], level: f64) -> (Information<N>, Path<N>) {
        let n = self.time_s.len();
        let (count, rounded) = (self.of.count(), self.is_rounded());
        let mut samples = self.samples.iter().rev().peekable();
        let mut held = Information {
            L: SMatrix::zeros(),
            eta: SVector::zeros(),
            log_det: 0.0,
            factor: 1.0,
        };
        let mut path = Path {
            h: self.time_s.windows(2).map(|w| w[1] - w[0]).collect(),
            changes: Vec::with_capacity(count * (n - 1)),
            of: self.of,
            rounding: Vec::new(),
        };
        for k in (1..n).rev() {
            let mut rounding = None;
            while let Some(sample) = samples.next_if(|s| s.at == k) {
                held.take(sample, level, rounded);
                if rounded && !sample.of_slope {
                    let change = held.before_change(&unit(N - 1), sample.fresh());
                    held.before_fading(sample.memory);
                    rounding = Some((sample.memory, change));
                }
            }
            if rounded {
                path.rounding.push(rounding);
            }
            let h = path.h[k - 1];
            let variance = (sizes[k] * self.changes[k]).powi(2);
            for direction in directions(self.of, h)[3 - count..].iter().rev() {
                path.changes.push(held.before_change(direction, variance));
            }
            held.before_line(h, self.of);
        }
        samples.for_each(|sample| held.take(sample, level, rounded));
        path.changes.reverse();
        path.rounding.reverse();
        (held, path)
    }

    /// -2 ln of the probability density of the samples, less a constant: the determinants, and the squares of samples, changes and start
    /// along the mean motion, each over its variance.
    fn deviance<const N: usize>(&self, start: &Start<N>, sizes: &[f64]) -> f64 {
        let (mut x, rounded) = (start.mean, self.is_rounded());
        let over = |square: f64, by: f64| if by > 0.0 { square / by } else { 0.0 };
        let mut samples = self.samples.iter().peekable();
        let mut sum = start.log_det;
        for j in 0..N {
            sum += over(x[j].powi(2), start.sigmas[j].powi(2));
        }
        for (k, size) in sizes.iter().enumerate() {
            let mut rounding = 0.0;
            if let Some(before) = k.checked_sub(1) {
                let squares;
                [squares, rounding] = start.path.along(before, &mut x);
                sum += over(squares, (size * self.changes[k]).powi(2));
            }
            while let Some(sample) = samples.next_if(|s| s.at == k) {
                let (h, value) = sample.of_state::<N>(start.level, rounded);
                sum += over(rounding.powi(2), sample.fresh());
                sum += over((value - h.dot(&x)).powi(2), sample.white);
            }
        }
        sum
    }

    /// The posterior that the samples make most probable, and its standard deviations of the changes.
    pub fn most_probable(&self) -> Option<(InputPosterior, Vec<f64>)> {
        match self.numbers() {
            2 => self.with_tails::<2>(self.most_probable_size::<2>()?),
            3 => self.with_tails::<3>(self.most_probable_size::<3>()?),
            _ => self.with_tails::<4>(self.most_probable_size::<4>()?),
        }
    }

    /// The size of normal changes that the samples make most probable.
    fn most_probable_size<const N: usize>(&self) -> Option<f64> {
        let count = self.changes.iter().filter(|c| **c > 0.0).count().max(1);
        let span = self.time_s.last()? - self.time_s.first()?;
        let (noise, rate) = (self.noise()?, count as f64 / span);
        let slopes = self.samples.iter().filter(|s| s.of_slope);
        let slopes = slopes.map(|s| s.white.sqrt()).reduce(f64::min);
        let range = match self.of {
            // The slope that a change makes, over the time until the end and until the next one.
            Changes::Acceleration => {
                let [slow, fast] = [span.recip(), rate].map(|rate| {
                    [noise * rate, slopes.unwrap_or(noise * rate)].map(|size| size * rate)
                });
                [
                    RANGE[0] * slow[0].min(slow[1]),
                    RANGE[1] * fast[0].max(fast[1]),
                ]
            }
            Changes::Slope | Changes::SlopeAtTimes => RANGE.map(|of| of * (noise * rate)),
        };
        let cost = |log: f64| {
            let sizes = vec![log.exp(); self.time_s.len()];
            let start = self.start::<N>(&sizes);
            start.map_or(f64::INFINITY, |start| self.deviance(&start, &sizes))
        };
        Some(least(cost, range.map(f64::ln), ACCURACY).exp())
    }

    /// The posterior with changes of Student's t-distribution, from that of normal ones: each change has a size of its own,
    /// renewed from the mean squares of those about it (Lange, Little and Taylor 1989). When exactly a slope changed between
    /// two samples they do not tell, so that neighbours share a size.
    fn with_tails<const N: usize>(&self, mut size: f64) -> Option<(InputPosterior, Vec<f64>)> {
        let mut sizes = vec![size; self.time_s.len()];
        let places = self.changes.iter().enumerate().skip(1);
        let places: Vec<usize> = places.filter(|(_, c)| **c > 0.0).map(|(k, _)| k).collect();
        let shared = match self.of {
            // A torque steps; an acceleration goes on.
            Changes::Slope => SHARED / 2,
            Changes::SlopeAtTimes | Changes::Acceleration => SHARED,
        };
        for _ in 0..RENEWALS {
            let found = self.start::<N>(&sizes)?.forward(|_| ());
            let of = self.of.count() as f64;
            let square = |k: &usize| found.squares[*k] / (of * self.changes[*k].powi(2));
            let own: Vec<f64> = places.iter().map(square).collect();
            let width = |i: usize| {
                let near = i.saturating_sub(shared)..(i + shared + 1).min(own.len());
                let (count, sum) = (near.len() as f64, own[near].iter().sum::<f64>());
                (TAILS + sum / (size * size)) / (TAILS + count)
            };
            let widths: Vec<f64> = (0..own.len()).map(width).collect();
            let sum: f64 = own.iter().zip(&widths).map(|(s, w)| s / w).sum();
            size = (sum / own.len().max(1) as f64).sqrt();
            let mut most = 0.0_f64;
            for (k, w) in places.iter().zip(&widths) {
                let new = size * w.sqrt();
                most = most.max((new / sizes[*k] - 1.0).abs());
                sizes[*k] = new;
            }
            if most < ACCURACY {
                break;
            }
        }
        Some((self.posterior_of::<N>(&sizes)?, sizes))
    }
}

impl<const N: usize> Start<N> {
    /// The mean motion from the first state on; `on` takes the covariances at the start of each interval, of both ends, and at its end.
    fn forward(&self, mut on: impl FnMut([&SMatrix<f64, N, N>; 3])) -> InputMean {
        let (mut x, mut P) = (self.mean, self.covariance);
        let mut all = InputMean::default();
        let of = |x: &SVector<f64, N>| {
            let acceleration = match self.path.of {
                Changes::Acceleration => x[ACCELERATION],
                Changes::Slope | Changes::SlopeAtTimes => 0.0,
            };
            [self.level + x[VALUE], x[SLOPE], acceleration]
        };
        all.push(of(&x), 0.0);
        for k in 0..self.path.h.len() {
            let spread = self.path.spread(k, &P);
            let [squares, _] = self.path.along(k, &mut x);
            on([&P, &spread.together, &spread.after]);
            P = spread.after;
            all.push(of(&x), squares + spread.variance);
        }
        all
    }

    /// The part of value, slope and acceleration.
    fn motion(&self, P: &SMatrix<f64, N, N>) -> Matrix3<f64> {
        let numbers = self.path.of.numbers();
        let own = |i: usize| i < numbers;
        Matrix3::from_fn(|i, j| if own(i) && own(j) { P[(i, j)] } else { 0.0 })
    }
}

/// The samples with correlated errors, where some in a row are equal: they are rounded, and the mean of a run is known as well as
/// one of them. The mean motion is better that of independent errors: a run does not tell when the value began to stay, and
/// errors said to stay from there on pull a level towards where it came from, by a fifth of a step.
pub(crate) fn rounded(samples: &[InputSample]) -> Option<Vec<InputSample>> {
    let runs = samples.chunk_by(|a, b| a.value == b.value);
    let all = runs.flat_map(|run| {
        let n = run.len() as f64;
        run.iter().enumerate().map(move |(i, s)| match n > 1.0 {
            true => s.rounded(if i > 0 { (n - 1.0) / (n + 1.0) } else { 0.0 }),
            false => *s,
        })
    });
    let all: Vec<InputSample> = all.collect();
    all.iter().any(|s| s.memory > 0.0).then_some(all)
}

/// The motion of a joint between noisy samples of its position and, where they are measured, of its rate: its acceleration is
/// taken to change by white noise, of a size that the samples determine (a smoothing spline of fifth degree: Wahba 1978).
#[derive(Debug, Clone)]
pub struct JointMotion {
    /// Mean position at every grid time, rad or m.
    pub position: Vec<f64>,
    /// Mean rate, rad/s or m/s.
    pub rate: Vec<f64>,
    /// Mean acceleration, rad/s2 or m/s2.
    pub acceleration: Vec<f64>,
    /// What they err by.
    pub errors: ErrorProcess,
    /// The part of them that measured rates make; empty without these.
    pub of_rates: Vec<RateParts>,
}

impl JointMotion {
    /// At the times of a grid, s, from samples of positions and rates at some of them, in order; `None` without positions, or at one time
    /// alone. `rounds`: whether equal positions in a row have one rounding error in common.
    ///
    /// ```
    /// use poinsot_identify::{InputSample, JointMotion};
    ///
    /// // A tenth of a rad/s, read every second to 1e-3 rad.
    /// let time_s: Vec<f64> = (0..50).map(f64::from).collect();
    /// let read = |k: usize| 0.1 * k as f64 + 1.0e-3 * (7.0 * k as f64).sin();
    /// let samples: Vec<_> = (0..50).map(|k| InputSample::white(k, read(k), 1.0e-6)).collect();
    /// let motion = JointMotion::new(&time_s, (&samples, &[]), false).unwrap();
    /// assert!((motion.rate[25] - 0.1).abs() < 2.0e-4);
    /// assert!(motion.errors.initial[(1, 1)].sqrt() < 1.0e-3);
    /// ```
    pub fn new(
        time_s: &[f64],
        (positions, rates): (&[InputSample], &[InputSample]),
        rounds: bool,
    ) -> Option<Self> {
        let span = time_s.last()? - time_s.first()?;
        if span <= 0.0 {
            return None;
        }
        let changes = all_along(time_s, span / (time_s.len() - 1).max(1) as f64);
        let measured = in_order(positions, rates);
        let of = InputSamples {
            time_s,
            changes: &changes,
            of: Changes::Acceleration,
            samples: &measured,
        };
        let (found, sizes) = of.most_probable()?;
        let posterior = |samples: &[InputSample]| InputSamples { samples, ..of }.posterior(&sizes);
        let errors = match rounds.then(|| rounded(positions)).flatten() {
            Some(rounded) => posterior(&in_order(&rounded, rates))?.errors,
            None => found.errors,
        };
        // The mean is linear in the samples.
        let nothing = with_values(positions, |_| 0.0);
        let part = |value: fn(&InputSample) -> f64| {
            let samples = in_order(&nothing, &with_values(rates, value));
            Some(posterior(&samples)?.mean)
        };
        let mut of_rates = Vec::new();
        if !rates.is_empty() {
            let [rates, ones] = [part(|s| s.value)?, part(|_| 1.0)?];
            of_rates.extend((0..time_s.len()).map(|k| RateParts {
                rates: rates.at(k),
                ones: ones.at(k),
            }));
        }
        Some(Self {
            position: found.mean.value,
            rate: found.mean.slope,
            acceleration: found.mean.acceleration,
            errors,
            of_rates,
        })
    }

    /// The motion at some of its grid times.
    #[must_use]
    pub fn at_times(&self, kept: &[usize]) -> Self {
        let of = |all: &[f64]| picked(all, kept);
        Self {
            position: of(&self.position),
            rate: of(&self.rate),
            acceleration: of(&self.acceleration),
            errors: self.errors.at_times(kept),
            of_rates: picked(&self.of_rates, kept),
        }
    }
}

/// Samples of value and slope in order of time.
fn in_order(values: &[InputSample], slopes: &[InputSample]) -> Vec<InputSample> {
    let mut all = [values, slopes].concat();
    all.sort_by_key(|sample| sample.at);
    all
}

fn with_values(samples: &[InputSample], value: impl Fn(&InputSample) -> f64) -> Vec<InputSample> {
    let with = |s: &InputSample| InputSample {
        value: value(s),
        ..*s
    };
    samples.iter().map(with).collect()
}

/// Where a function of one number with one minimum is least, by golden section (Kiefer 1953).
pub(crate) fn least(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], accuracy: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut c = b - golden * (b - a);
    let mut d = a + golden * (b - a);
    let (mut at_c, mut at_d) = (f(c), f(d));
    while b - a > accuracy {
        if at_c <= at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = f(d);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Posterior mean, covariance of the speeds at two times, and deviance, against the dense normal distribution of all
    /// samples: with white noise, and with rounding errors of which six tenths stay.
    #[test]
    fn exact_the_posterior_is_that_of_the_dense_normal_distribution() {
        for memory in [None, Some(0.6)] {
            let time_s = [0.0, 0.4, 0.5, 0.9, 1.3, 1.5, 2.1, 2.5];
            let changes = [0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0];
            let (variance, change) = (0.01, 0.7);
            let samples = [(0, 3.0), (1, 3.2), (3, 3.9), (5, 3.8), (6, 3.1), (7, 2.9)];
            let samples = samples.map(|(at, speed)| {
                let white = InputSample::white(at, speed, variance);
                let first = |a: f64| if at == 0 { 0.0 } else { a };
                memory.map_or(white, |a| white.rounded(first(a)))
            });
            let all = InputSamples {
                time_s: &time_s,
                changes: &changes,
                of: Changes::SlopeAtTimes,
                samples: &samples,
            };
            let found = all.posterior(&[change; 8]).unwrap();
            // Speed at every time, of start, slope and the three changes.
            let from = [None, Some(0.0), Some(0.5), Some(1.3), Some(2.1)];
            let row = |t: f64| from.map(|s: Option<f64>| s.map_or(1.0, |s| (t - s).max(0.0)));
            let A = DMatrix::from_fn(8, 5, |i, j| row(time_s[i])[j]);
            let wide = DIFFUSE * (samples[0].total().sqrt() + change * 2.5);
            let sizes = [wide, wide / 2.5, change, change, change];
            let P = DMatrix::from_diagonal(&DVector::from_iterator(5, sizes.map(|s| s * s)));
            let noise = DMatrix::from_fn(6, 6, |i, j| {
                let apart = i.abs_diff(j) as i32;
                let stays = samples[1].rounding * memory.unwrap_or(0.0).powi(apart);
                if i == j { samples[1].total() } else { stays }
            });
            let y = DVector::from_iterator(6, samples.iter().map(|s| s.value - 3.0));
            let own = DMatrix::from_fn(6, 5, |i, j| A[(samples[i].at, j)]);
            let weights = noise.clone().try_inverse().unwrap();
            let known = P.clone().try_inverse().unwrap();
            let information = own.transpose() * &weights * &own + &known;
            let covariance = information.clone().try_inverse().unwrap();
            let numbers = &covariance * own.transpose() * &weights * &y;
            let mean = &A * &numbers;
            let left = &A * &covariance * A.transpose();
            for (k, j) in [(2, 2), (4, 3), (6, 4)] {
                let square = numbers[j].powi(2) + covariance[(j, j)];
                assert!(
                    (found.mean.squares[k] - square).abs() < 1.0e-6 * square,
                    "{k}"
                );
            }
            for (k, speed) in found.mean.value.iter().enumerate() {
                assert!((speed - 3.0 - mean[k]).abs() < 1.0e-5, "{k}");
            }
            let white: f64 = samples.iter().map(|s| s.white.ln()).sum();
            let left_over = &y - &own * &numbers;
            let square = left_over.dot(&(weights * &left_over)) + numbers.dot(&(known * &numbers));
            let det = noise.determinant().ln() + (P * information).determinant().ln();
            let expected = det - white + square;
            let off = (found.deviance - expected).abs();
            assert!(off < 1.0e-5 * expected.abs(), "{off}");
            let same =
                |a: f64, b: f64, k: usize| assert!((a - b).abs() < 1.0e-4 * left[(k, k)], "{k}");
            let mut P = found.errors.initial;
            let mut cross = P;
            for (k, step) in found.errors.steps().enumerate() {
                same(P[(0, 0)], left[(k, k)], k);
                same((step.memory * P)[(0, 0)], left[(k + 1, k)], k);
                if memory.is_none() {
                    same(cross[(0, 0)], left[(k, 0)], k);
                }
                P = step.memory * P * step.memory.transpose() + step.fresh;
                cross = step.memory * cross;
            }
        }
    }

    /// The same of a joint, whose third derivative is white noise, from positions and rates: means and covariances of neighbouring times of
    /// position, rate and acceleration.
    #[test]
    fn exact_the_posterior_of_a_joint_is_that_of_the_dense_normal_distribution() {
        let time_s = [0.0_f64, 0.4, 0.5, 0.9, 1.3, 1.5, 2.1, 2.5];
        let (change, typical) = (0.7_f64, 2.5_f64 / 7.0);
        let intervals = time_s.windows(2).map(|w| ((w[1] - w[0]) / typical).sqrt());
        let changes: Vec<f64> = std::iter::once(0.0).chain(intervals).collect();
        let samples: Vec<InputSample> = vec![
            InputSample::white(0, 3.0, 0.01),
            InputSample::slope(0, 0.2, 0.04),
            InputSample::white(1, 3.2, 0.01),
            InputSample::slope(2, 0.5, 0.04),
            InputSample::white(3, 3.9, 0.01),
            InputSample::white(5, 3.8, 0.01),
            InputSample::slope(6, -0.4, 0.04),
            InputSample::white(7, 2.9, 0.01),
        ];
        let all = InputSamples {
            time_s: &time_s,
            changes: &changes,
            of: Changes::Acceleration,
            samples: &samples,
        };
        let found = all.posterior(&[change; 8]).unwrap();
        let prior = all.before_samples::<3>(&[change; 8]).unwrap();
        // Of two derivatives of the value, at two times: what each change of the acceleration before them moves, by Simpson's rule.
        let moved = |order: usize, t: f64| match order {
            0 => 0.5 * t * t,
            1 => t,
            _ => 1.0,
        };
        let covariance = |(a, s): (usize, f64), (b, t): (usize, f64)| {
            let n = 2000;
            let h = s.min(t) / f64::from(n);
            let at = |u: f64| moved(a, s - u) * moved(b, t - u);
            let weight = |k: i32| f64::from([2, 4][(k % 2) as usize]);
            let inner: f64 = (1..n).map(|k| weight(k) * at(f64::from(k) * h)).sum();
            let noise = (at(0.0) + inner + at(s.min(t))) * h / 3.0 * change * change / typical;
            let start = |order: usize, t: f64| {
                [[1.0, t, 0.5 * t * t], [0.0, 1.0, t], [0.0, 0.0, 1.0]][order]
            };
            let (x, y) = (start(a, s), start(b, t));
            noise + (0..3).map(|i| x[i] * y[i] * prior[i].powi(2)).sum::<f64>()
        };
        let of = |s: &InputSample| (usize::from(s.of_slope), time_s[s.at]);
        let n = samples.len();
        let C = DMatrix::from_fn(n, n, |i, j| {
            let white = if i == j { samples[i].white } else { 0.0 };
            covariance(of(&samples[i]), of(&samples[j])) + white
        });
        let y = samples.iter().map(|s| s.of_state::<3>(3.0, false).1);
        let y = DVector::from_iterator(n, y);
        let weights = C.clone().try_inverse().unwrap();
        let toward = |x: (usize, f64)| {
            DVector::from_iterator(n, samples.iter().map(|s| covariance(x, of(s))))
        };
        let left = |a: (usize, f64), b: (usize, f64)| {
            covariance(a, b) - toward(a).dot(&(&weights * toward(b)))
        };
        // The dense inverse is that much off: the start is a thousand times wider than what is left.
        const EQUAL: f64 = 1.0e-2;
        let mut P = found.errors.initial;
        for (k, step) in found.errors.steps().enumerate() {
            let mean = |order: usize| toward((order, time_s[k])).dot(&(&weights * &y));
            let sigma = |order: usize| left((order, time_s[k]), (order, time_s[k])).sqrt();
            assert!(
                (found.mean.value[k] - 3.0 - mean(0)).abs() < EQUAL * sigma(0),
                "{k}"
            );
            assert!(
                (found.mean.slope[k] - mean(1)).abs() < EQUAL * sigma(1),
                "{k}"
            );
            let off = found.mean.acceleration[k] - mean(2);
            assert!(off.abs() < EQUAL * sigma(2), "{k}");
            let onward = step.memory * P;
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let unit = sigma(i) * sigma(j);
                let here = left((i, time_s[k]), (j, time_s[k]));
                assert!((P[(i, j)] - here).abs() < EQUAL * unit, "{k} {i} {j}");
                let there = left((i, time_s[k + 1]), (j, time_s[k]));
                let next = (i, time_s[k + 1]);
                let unit = left(next, next).sqrt() * sigma(j);
                let off = (onward[(i, j)] - there).abs();
                assert!(off < EQUAL * unit, "{k} {i} {j}");
            }
            P = step.memory * P * step.memory.transpose() + step.fresh;
        }
        let white: f64 = samples.iter().map(|s| s.white.ln()).sum();
        let expected = C.determinant().ln() - white + y.dot(&(weights * &y));
        let off = (found.deviance - expected).abs();
        assert!(off < 1.0e-5 * expected.abs(), "{off}");
    }

    /// A speed whose slope changes all along has the same posterior on a grid with seven times more between two of its samples; its
    /// integral over an interval, the ends given, has the variance that the finer grid gives it.
    #[test]
    fn exact_a_speed_is_the_same_on_a_finer_grid() {
        const PARTS: usize = 8;
        let times = |parts: usize| -> Vec<f64> {
            let n = 6 * parts;
            (0..=n).map(|k| 0.5 * k as f64 / parts as f64).collect()
        };
        let read = [3.0, 3.4, 3.1, 2.2, 2.6, 3.3, 3.2];
        let all = |parts: usize| {
            let at = |(k, value): (usize, &f64)| InputSample::white(k * parts, *value, 0.01);
            let samples: Vec<InputSample> = read.iter().enumerate().map(at).collect();
            let time_s = times(parts);
            let mut changes = vec![(parts as f64).sqrt().recip(); time_s.len()];
            changes[0] = 0.0;
            InputSamples {
                time_s: &time_s,
                changes: &changes,
                of: Changes::Slope,
                samples: &samples,
            }
            .posterior(&vec![0.7; time_s.len()])
            .unwrap()
        };
        let (coarse, fine) = (all(1), all(PARTS));
        for k in 0..read.len() {
            let [a, b] = [coarse.mean.at(k), fine.mean.at(k * PARTS)];
            assert!((a[0] - b[0]).abs() < 1.0e-8 && (a[1] - b[1]).abs() < 1.0e-8);
        }
        assert!((coarse.deviance - fine.deviance).abs() < 1.0e-6);
        let places: Vec<usize> = (0..read.len()).map(|k| k * PARTS).collect();
        let thinned = fine.errors.at_times(&places);
        for (a, b) in coarse.errors.steps().zip(thinned.steps()) {
            assert!((a.memory - b.memory).amax() < 1.0e-6 && (a.fresh - b.fresh).amax() < 1.0e-9);
        }
        // Covariance of the first end, the second, and the integral of the cubics from time to time.
        let h = 0.5 / PARTS as f64;
        for (whole, parts) in coarse.errors.steps().zip((0..6).map(|k| k * PARTS)) {
            let mut C = DMatrix::<f64>::zeros(5, 5);
            for i in 0..2 {
                (C[(i, i)], C[(i + 2, i)], C[(i, i + 2)], C[(i + 2, i + 2)]) = (1.0, 1.0, 1.0, 1.0);
            }
            for step in (parts..parts + PARTS).map(|k| fine.errors.step(k).unwrap()) {
                let mut on = DMatrix::<f64>::identity(5, 5);
                let memory = step.memory.fixed_view::<2, 2>(0, 0);
                on.view_mut((2, 2), (2, 2)).copy_from(&memory);
                let begin = nalgebra::RowVector2::new(0.5 * h, h * h / 12.0);
                let end = nalgebra::RowVector2::new(0.5 * h, -h * h / 12.0);
                on.view_mut((4, 2), (1, 2))
                    .copy_from(&(begin + end * memory));
                let mut new = DMatrix::<f64>::zeros(5, 2);
                new.view_mut((2, 0), (2, 2)).fill_with_identity();
                new.view_mut((4, 0), (1, 2)).copy_from(&end);
                let fresh = step.fresh.fixed_view::<2, 2>(0, 0);
                C = &on * C * on.transpose() + &new * fresh * new.transpose();
                C[(4, 4)] += step.within;
            }
            let ends = C.view((0, 0), (4, 4)).clone_owned();
            let with = C.view((4, 0), (1, 4)).clone_owned();
            let left = C[(4, 4)] - (&with * ends.try_inverse().unwrap() * with.transpose())[(0, 0)];
            assert!((left / whole.within - 1.0).abs() < 1.0e-6, "{left}");
        }
    }

    /// Noisy and rounded readings of smooth motions: position and rate err by what is stated.
    #[test]
    fn stat_the_motion_of_a_joint_errs_by_what_is_stated() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let time_s: Vec<f64> = (0..1500).map(|k| 0.1 * f64::from(k)).collect();
        for (sigma, step) in [(5.0e-4_f64, 0.0_f64), (2.0e-5, 1.7e-3), (1.0e-5, 0.0)] {
            let (mut squares, mut count) = ([0.0_f64; 2], 0.0_f64);
            for _ in 0..4 {
                let tones: Vec<[f64; 2]> =
                    (0..3).map(|_| [0.2 + 0.02 * normal(), normal()]).collect();
                let turn = |t: f64, [w, p]: &[f64; 2]| [(w * t + p).sin(), w * (w * t + p).cos()];
                let sum = |t: f64, i: usize| -> f64 {
                    tones.iter().map(|tone| 0.3 * turn(t, tone)[i]).sum()
                };
                let mut read = |(k, t): (usize, &f64)| {
                    let x: f64 = sum(*t, 0) + sigma * normal();
                    let x = if step > 0.0 {
                        (x / step).round() * step
                    } else {
                        x
                    };
                    InputSample::white(k, x, sigma * sigma + step * step / 12.0)
                };
                let samples: Vec<InputSample> = time_s.iter().enumerate().map(&mut read).collect();
                let found = JointMotion::new(&time_s, (&samples, &[]), step > 0.0).unwrap();
                let mut P = found.errors.initial;
                for (k, s) in found.errors.steps().enumerate() {
                    let off = [
                        found.position[k] - sum(time_s[k], 0),
                        found.rate[k] - sum(time_s[k], 1),
                    ];
                    (0..2).for_each(|i| squares[i] += off[i] * off[i] / P[(i, i)]);
                    count += 1.0;
                    P = s.memory * P * s.memory.transpose() + s.fresh;
                }
            }
            // Neighbours err alike: 6000 instants are some hundred independent ones. Rates of a motion without any change of
            // acceleration that is sudden are better than stated.
            let rms = squares.map(|s| (s / count).sqrt());
            assert!(
                (0.7..1.3).contains(&rms[0]) && rms[1] < 1.3,
                "{sigma} {step} {rms:?}"
            );
        }
    }

    /// The size of the changes that made the samples is found.
    #[test]
    fn stat_the_size_of_the_changes_is_found() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (sigma, change) = (0.05, 0.2);
        let time_s: Vec<f64> = (0..1200).map(|k| 0.25 * f64::from(k)).collect();
        let changes: Vec<f64> = (0..1200).map(|k| f64::from(k % 2)).collect();
        let (mut speed, mut slope) = (100.0, 0.0);
        let mut samples = Vec::new();
        for (k, changes) in changes.iter().enumerate() {
            let read = speed + sigma * normal();
            samples.push(InputSample::white(k, read, sigma * sigma));
            if *changes > 0.0 {
                slope += change * normal();
            }
            speed += 0.25 * slope;
        }
        let all = InputSamples {
            time_s: &time_s,
            changes: &changes,
            of: Changes::SlopeAtTimes,
            samples: &samples,
        };
        let size = all.most_probable_size::<2>().unwrap();
        // 600 changes: their size is known to 3 %, and less by what noise hides of them.
        assert!((size / change - 1.0).abs() < 0.2, "{size}");
    }
}
