//! A flexible mode in the gyro residual of a fit: which frequency explains it best.
//!
//! A mode answers to the rate that the vehicle would have without it by `y'' + 2 zeta w y' + w^2 y = -d . w_NB' / (1 - s)`, w the
//! frequency on the free vehicle and s the share of the inertia that it carries, and the base lacks `J^-1 d y'`. At each frequency the
//! residual is therefore compared with the answer of an oscillator to the predicted rate about every axis, and with its free
//! oscillation; what a rigid fit takes up (a constant, a trend, the rate itself) is projected out. It is the score test of a
//! mode, over its frequency.

use crate::fit::experiment::Experiment;
use crate::likelihood::Evaluated;
use crate::problem::segment::Segment;
use nalgebra::{Cholesky, Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::TAU;

/// Damping ratios of the scan, and of its refinement.
const DAMPING: [f64; 2] = [0.004, 0.03];
const FINE_DAMPING: [f64; 5] = [0.001, 0.004, 0.012, 0.03, 0.08];
/// Steps of the frequency: by a share of it, and by a share of a period over the record.
const STEP: f64 = 0.003;
const OF_PERIOD: f64 = 0.25;
/// Periods in a record, and samples in a period, at the ends of the scan.
const PERIODS: f64 = 2.0;
const SAMPLES: f64 = 2.3;
/// Most readings of a segment that are compared.
const MOST: usize = 4096;
/// Refinements of the best frequency, each four times as fine.
const REFINEMENTS: usize = 3;
/// Frequencies on each side at which a steady wave is tried, and their distance in those of a record.
const STEADY: i32 = 20;
const STEADY_STEP: f64 = 0.1;
/// Columns that a rigid fit takes up, and those of the mode.
const RIGID: usize = 5;
const ALL: usize = 10;
/// Numbers of a wave of constant amplitude: two on each axis.
const AMPLITUDES: usize = 6;

type Square = SMatrix<f64, ALL, ALL>;
type Sides = SMatrix<f64, ALL, 3>;

/// The mode that explains most of a residual.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Oscillation {
    /// On the free vehicle.
    pub frequency_Hz: f64,
    pub damping_ratio: f64,
    /// How much it lowers chi-square.
    pub decrease: f64,
    /// How much of that a wave of constant amplitude near its frequency does: an imbalance, a limit cycle, an alias.
    pub steady: f64,
    /// `J^-1 d d^T / (1 - s)` by its answer to the motion.
    pub driven: Matrix3<f64>,
    /// Where the free oscillation moves the rate: sum of `a a^T` of its amplitudes.
    pub free: Matrix3<f64>,
}

/// Residual and rate of the best gyro in a segment.
pub(super) struct Series {
    pub time_s: Vec<f64>,
    /// Of the rigid vehicle, as predicted: the noise of the readings would drive an oscillator that explains it.
    pub rate: Vec<Vector3<f64>>,
    pub white: Vec<Vector3<f64>>,
    sigma: Vector3<f64>,
    of_rigid: (Square, Sides),
}

impl Series {
    /// At most so many samples; `None` without a gyro.
    pub fn of(segment: &Segment, one: &Evaluated, most: usize) -> Option<Self> {
        let o = &segment.observations;
        let gyro = o.best_gyro()?;
        let channel = one.channels.iter().find(|c| c.name == gyro.name)?;
        let rates = o.rates().take(most);
        let (time_s, rate): (Vec<f64>, Vec<_>) = rates.map(|(k, w)| (o.time_s[k], w)).unzip();
        let sigma = Vector3::from_fn(|i, _| gyro.covariance[(i, i)].sqrt());
        let white: Vec<_> = channel.white.iter().take(time_s.len()).copied().collect();
        let pairs = rate.iter().zip(&white);
        let predicted = |(w, e): (&Vector3<f64>, &Vector3<f64>)| w - e.component_mul(&sigma);
        Some(Self {
            rate: pairs.map(predicted).collect(),
            time_s,
            white,
            sigma,
            of_rigid: (Square::zeros(), Sides::zeros()),
        })
    }
}

/// A wave of constant amplitude in a residual.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wave {
    pub frequency_Hz: f64,
    /// How much it lowers chi-square.
    pub decrease: f64,
    /// Chance of as much in white noise, at most: the sum of that of all frequencies (Bonferroni).
    pub chance: f64,
}

/// The wave of constant amplitude up to a frequency that explains most of a residual; `None` where the record is too short for one.
pub(crate) fn wave(experiment: &Experiment, evaluated: &[Evaluated], most_Hz: f64) -> Option<Wave> {
    let all = series(experiment, evaluated);
    let span = all.iter().map(Series::span).fold(0.0, f64::max);
    let count = (most_Hz * span / OF_PERIOD) as usize;
    let first = (PERIODS / OF_PERIOD) as usize;
    strongest(&all, (first..=count).map(|k| OF_PERIOD * k as f64 / span))
}

fn strongest(all: &[Series], frequencies: impl Iterator<Item = f64>) -> Option<Wave> {
    let of = |frequency_Hz| (frequency_Hz, steady(all, frequency_Hz));
    let tried: Vec<(f64, f64)> = frequencies.map(of).collect();
    let (frequency_Hz, decrease) = *tried.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let numbers = ChiSquared::new((AMPLITUDES * all.len()) as f64).ok()?;
    Some(Wave {
        frequency_Hz,
        decrease,
        chance: (tried.len() as f64 * numbers.sf(decrease)).min(1.0),
    })
}

fn series(experiment: &Experiment, evaluated: &[Evaluated]) -> Vec<Series> {
    let segments = experiment.problem.segments.iter().zip(evaluated);
    let all = segments.filter_map(|(segment, one)| Series::of(segment, one, MOST));
    let all = all.filter(|s| s.white.len() == s.time_s.len() && s.time_s.len() > 4 * ALL);
    all.map(Series::summed).collect()
}

/// The best mode by one scan over all segments; `None` without a gyro, or in too short a record.
pub(crate) fn oscillation(experiment: &Experiment, evaluated: &[Evaluated]) -> Option<Oscillation> {
    let all = series(experiment, evaluated);
    let spans = all.iter().map(Series::span);
    let span = spans.fold(0.0, f64::max);
    let steps = all.iter().map(|s| s.span() / s.time_s.len() as f64);
    let step = steps.fold(f64::INFINITY, f64::min);
    if span <= 0.0 {
        return None;
    }
    let (lowest, highest) = (PERIODS / span, 1.0 / (SAMPLES * step));
    let mut best: Option<Oscillation> = None;
    let mut f = lowest;
    while f < highest {
        for damping in DAMPING {
            best = better(best, scored(&all, f, damping));
        }
        f += (STEP * f).max(OF_PERIOD / span);
    }
    let mut width = best?.frequency_Hz * STEP;
    for _ in 0..REFINEMENTS {
        let centre = best?.frequency_Hz;
        for k in -4_i32..=4 {
            for damping in FINE_DAMPING {
                let f = centre + width * 0.25 * f64::from(k);
                best = better(best, scored(&all, f, damping));
            }
        }
        width *= 0.25;
    }
    let centre = best?.frequency_Hz;
    let near = |k: i32| centre + STEADY_STEP * f64::from(k) / span;
    let steady = strongest(&all, (-STEADY..=STEADY).map(near))?.decrease;
    best.map(|b| Oscillation { steady, ..b })
}

/// How much a wave of constant amplitude lowers chi-square.
fn steady(all: &[Series], f: f64) -> f64 {
    let of = |series: &Series| {
        let (gram, sides) = series.sums(TAU * f, 0.0);
        let fitted = |count| solved(&gram, &sides, count).map(|x| x.component_mul(&sides).sum());
        Some(fitted(RIGID + 2)? - fitted(RIGID)?)
    };
    all.iter().filter_map(of).sum()
}

fn better(a: Option<Oscillation>, b: Option<Oscillation>) -> Option<Oscillation> {
    let by_decrease = |a: &Oscillation, b: &Oscillation| a.decrease.total_cmp(&b.decrease);
    a.into_iter().chain(b).max_by(by_decrease)
}

/// A frequency and damping ratio over all segments.
fn scored(all: &[Series], f: f64, damping: f64) -> Option<Oscillation> {
    let mut sum = Oscillation {
        frequency_Hz: f,
        damping_ratio: damping,
        ..Oscillation::default()
    };
    for series in all {
        let (gram, sides) = series.sums(TAU * f, damping);
        let rigid = solved(&gram, &sides, RIGID)?;
        let whole = solved(&gram, &sides, ALL)?;
        let fitted = |x: &Sides| x.component_mul(&sides).sum();
        let decrease = fitted(&whole) - fitted(&rigid);
        sum.decrease += decrease;
        for axis in 0..3 {
            let raw = whole.column(axis) * series.sigma[axis];
            for j in 0..3 {
                sum.driven[(axis, j)] -= raw[RIGID + 2 + j] * decrease;
            }
        }
        for row in [RIGID, RIGID + 1] {
            let a = whole.row(row).transpose().component_mul(&series.sigma);
            sum.free += a * a.transpose();
        }
    }
    sum.driven /= sum.decrease.max(f64::MIN_POSITIVE);
    sum.decrease.is_finite().then_some(sum)
}

/// The least-squares coefficients of the first `count` columns; the others are zero.
fn solved(gram: &Square, sides: &Sides, count: usize) -> Option<Sides> {
    let mut scale = SVector::<f64, ALL>::repeat(0.0);
    for k in 0..count {
        let length = gram[(k, k)].sqrt();
        scale[k] = if length > 0.0 { 1.0 / length } else { 0.0 };
    }
    let scaled = Square::from_fn(|i, j| {
        let own = f64::from(u8::from(i == j));
        gram[(i, j)] * scale[i] * scale[j] + own * if i < count { 1.0e-9 } else { 1.0 }
    });
    let right = Sides::from_fn(|i, j| sides[(i, j)] * scale[i]);
    let x = Cholesky::new(scaled)?.solve(&right);
    Some(Sides::from_fn(|i, j| x[(i, j)] * scale[i]))
}

impl Series {
    fn span(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(a), Some(b)) => b - a,
            _ => 0.0,
        }
    }

    /// Sums of the products of the columns with each other and with the residual; what a rigid fit takes up is summed once.
    fn sums(&self, omega: f64, damping: f64) -> (Square, Sides) {
        let mut products = [[0.0; ALL]; ALL - RIGID];
        let mut with_residual = [[0.0; 3]; ALL - RIGID];
        let mut step = Step::new(omega, damping, 0.0);
        let mut states = [Vector2::zeros(); 3];
        let mut free = Vector2::new(1.0, 0.0);
        let span = self.span();
        for k in 0..self.time_s.len() {
            if k > 0 {
                let h = self.time_s[k] - self.time_s[k - 1];
                if (h - step.h).abs() > 1.0e-9 * h {
                    step = Step::new(omega, damping, h);
                }
                let slope = (self.rate[k] - self.rate[k - 1]) / h;
                for (state, slope) in states.iter_mut().zip(slope.iter()) {
                    *state = step.driven(state, -slope);
                }
                free = step.phi * free;
            }
            let [one, t, x, y, z] = self.rigid(k, span);
            let own = [
                free.x,
                free.y / omega,
                states[0].y,
                states[1].y,
                states[2].y,
            ];
            let [a, b, c, d, e] = own;
            let (all, white) = ([one, t, x, y, z, a, b, c, d, e], &self.white[k]);
            for (i, own) in own.iter().enumerate() {
                for (sum, other) in products[i].iter_mut().zip(&all) {
                    *sum += own * other;
                }
                for (sum, residual) in with_residual[i].iter_mut().zip(white.iter()) {
                    *sum += own * residual;
                }
            }
        }
        let (mut gram, mut sides) = self.of_rigid;
        for (i, (products, with_residual)) in products.iter().zip(&with_residual).enumerate() {
            for (j, product) in products.iter().enumerate() {
                gram[(RIGID + i, j)] = *product;
                gram[(j, RIGID + i)] = *product;
            }
            for (axis, product) in with_residual.iter().enumerate() {
                sides[(RIGID + i, axis)] = *product;
            }
        }
        (gram, sides)
    }

    /// What a rigid fit takes up: a constant, a trend, the rate.
    fn rigid(&self, k: usize, span: f64) -> [f64; RIGID] {
        let w = &self.rate[k];
        [1.0, (self.time_s[k] - self.time_s[0]) / span, w.x, w.y, w.z]
    }

    /// With the sums of what a rigid fit takes up.
    fn summed(mut self) -> Self {
        let (mut gram, mut sides) = (Square::zeros(), Sides::zeros());
        for k in 0..self.time_s.len() {
            let columns = self.rigid(k, self.span());
            for (i, a) in columns.iter().enumerate() {
                for (j, b) in columns.iter().enumerate() {
                    gram[(i, j)] += a * b;
                }
                for axis in 0..3 {
                    sides[(i, axis)] += a * self.white[k][axis];
                }
            }
        }
        self.of_rigid = (gram, sides);
        self
    }
}

/// An oscillator over an interval, exact for a constant input.
struct Step {
    h: f64,
    phi: Matrix2<f64>,
    stiffness: f64,
}

impl Step {
    fn new(omega: f64, damping: f64, h: f64) -> Self {
        let (a, b) = (damping * omega, omega * (1.0 - damping * damping).sqrt());
        let (sin, cos) = (b * h).sin_cos();
        let fade = (-a * h).exp();
        let phi = Matrix2::new(
            cos + a / b * sin,
            sin / b,
            -omega * omega / b * sin,
            cos - a / b * sin,
        );
        Self {
            h,
            phi: phi * fade,
            stiffness: omega * omega,
        }
    }

    fn driven(&self, state: &Vector2<f64>, input: f64) -> Vector2<f64> {
        let rest = Vector2::new(input / self.stiffness, 0.0);
        self.phi * (state - rest) + rest
    }
}
