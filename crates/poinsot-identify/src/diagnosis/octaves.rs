//! How large a residual is, octave by octave of its frequency, in units of the declared noise.
//!
//! Haar's transform (Haar 1910) turns a white residual of unit variance into coefficients that are independent and of
//! unit variance again, level by level: differences of neighbours, of pairs, of fours. The energy of a level is
//! therefore chi-square distributed exactly, however short the record; a fit only reduces it. A level is half the Allan
//! variance at its averaging time (Percival and Walden 2000, section 8.6). Slow parameters (mass properties, momentum,
//! biases) depend on the slow levels: excess there makes sigmas too small even if the total chi-square is correct.

use super::channels::outlier_threshold;
use crate::likelihood::Evaluated;
use crate::problem::loss::Loss;
use crate::problem::settings::Settings;
use poinsot_spatial::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Numbers up to which the tail of chi-square is computed exactly, and not after Wilson and Hilferty 1931.
const EXACT_TAIL: usize = 1000;

/// Energy of one level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Octave {
    /// Readings over which the residual is averaged and compared with its neighbour: 1, 2, 4 and so on.
    pub readings: usize,
    /// Coefficients, all axes together.
    pub numbers: usize,
    /// Sum of their squares.
    pub square: f64,
}

impl Octave {
    /// Mean square; 1 where the residual is white and as large as declared.
    pub fn mean_square(&self) -> f64 {
        self.square / self.numbers.max(1) as f64
    }

    /// p-value of the sum for coefficients of this variance.
    pub(crate) fn p_value(&self, variance: f64) -> f64 {
        let n = self.numbers as f64;
        let scaled = self.square / variance;
        if self.numbers == 0 || scaled.is_nan() {
            return 1.0;
        }
        if self.numbers <= EXACT_TAIL {
            return ChiSquared::new(n).map_or(1.0, |c| c.sf(scaled));
        }
        let spread = 2.0 / (9.0 * n);
        let z = ((scaled / n).cbrt() - 1.0 + spread) / spread.sqrt();
        Normal::standard().sf(z)
    }

    /// Both together.
    pub(crate) fn plus(self, other: &Self) -> Self {
        Self {
            readings: self.readings.max(other.readings),
            numbers: self.numbers + other.numbers,
            square: self.square + other.square,
        }
    }
}

/// The levels of a whitened residual, the fastest first, the mean last. A loss that bounds single readings weighs them here
/// as it did in the fit, and outliers are left out.
pub(crate) fn octaves(white: &[Vector3], numbers: usize, loss: Loss) -> Vec<Octave> {
    let mut series: Vec<Vector3> = match loss {
        Loss::Gaussian => white.to_vec(),
        _ => {
            let limit = outlier_threshold(numbers);
            let usual = white.iter().filter(|w| w.norm_squared() <= limit);
            usual
                .map(|w| w * loss.weight(w.norm_squared(), numbers).sqrt())
                .collect()
        }
    };
    let mut list = Vec::new();
    let mut readings = 1;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    while series.len() > 1 {
        let pairs = series.chunks_exact(2);
        let square = pairs
            .clone()
            .map(|p| half * (p[0] - p[1]))
            .map(|d| d.norm_squared())
            .sum();
        list.push(Octave {
            readings,
            numbers: numbers * (series.len() / 2),
            square,
        });
        series = pairs.map(|p| half * (p[0] + p[1])).collect();
        readings *= 2;
    }
    list.extend(series.first().map(|mean| Octave {
        readings,
        numbers,
        square: mean.norm_squared(),
    }));
    list
}

/// Whether every octave of every residual is as large as the declared noise says, all tests together at `false_alarm`.
pub(crate) fn consistent(evaluated: &[Evaluated], settings: &Settings) -> bool {
    chance(evaluated, settings) > settings.false_alarm
}

/// Chance that some octave of the residuals is as unlikely as the least likely one, at most (Bonferroni). NaN where one is.
pub(crate) fn chance(evaluated: &[Evaluated], settings: &Settings) -> f64 {
    let channels = evaluated.iter().flat_map(|e| &e.channels);
    let levels = channels.flat_map(|c| octaves(&c.white, c.numbers, settings.loss));
    let each: Vec<f64> = levels.map(|level| level.p_value(1.0)).collect();
    let together = each.iter().map(|p| p * each.len() as f64);
    together.fold(1.0, |a, b| if a.is_nan() || a <= b { a } else { b })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    pub(crate) fn white(n: usize, seed: u64) -> Vec<Vector3> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || StandardNormal.sample(&mut random);
        (0..n)
            .map(|_| Vector3::new(draw(), draw(), draw()))
            .collect()
    }

    #[test]
    fn exact_the_levels_hold_all_of_the_energy() {
        let w = white(1024, 1);
        let all: f64 = w.iter().map(Vector3::norm_squared).sum();
        let levels = octaves(&w, 3, Loss::Gaussian);
        let sum: f64 = levels.iter().map(|o| o.square).sum();
        assert!((sum / all - 1.0).abs() < 1.0e-12);
        assert_eq!(levels.len(), 11);
        assert_eq!(levels.iter().map(|o| o.numbers).sum::<usize>(), 3 * 1024);
    }

    /// p-values of white residuals are uniform, for short and long records.
    #[test]
    fn stat_chances_of_white_residuals_are_even() {
        for n in [41, 300, 3000] {
            let (mut low, mut count) = (0, 0);
            for seed in 0..400 {
                for level in octaves(&white(n, seed), 3, Loss::Gaussian) {
                    low += usize::from(level.p_value(1.0) < 0.01);
                    count += 1;
                }
            }
            let share = low as f64 / count as f64;
            let scatter = (0.01 / count as f64).sqrt();
            assert!((share - 0.01).abs() < 4.0 * scatter, "{n}: {share}");
        }
    }

    #[test]
    fn exact_a_constant_stands_in_the_mean_alone() {
        let levels = octaves(&[Vector3::new(0.5, 0.0, 0.0); 64], 3, Loss::Gaussian);
        let (mean, rest) = levels.split_last().unwrap();
        assert!(rest.iter().all(|o| o.square < 1.0e-20));
        assert!((mean.square - 64.0 * 0.25).abs() < 1.0e-12);
    }

    #[test]
    fn exact_the_tail_of_many_numbers_is_that_of_chi_square() {
        let at = |numbers: usize, excess: f64| {
            let n = numbers as f64;
            Octave {
                readings: 1,
                numbers,
                square: n + excess * (2.0 * n).sqrt(),
            }
        };
        for excess in [0.0, 3.0, 6.0] {
            let (few, more) = (
                at(EXACT_TAIL, excess).p_value(1.0),
                at(EXACT_TAIL + 1, excess).p_value(1.0),
            );
            assert!((few / more - 1.0).abs() < 0.05, "{excess}: {few} {more}");
        }
    }
}
