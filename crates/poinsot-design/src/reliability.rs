//! Which share of the prior exceeds limits, and which vehicles come first.
//!
//! A vehicle is a vector of independent standard normal numbers, so that `exp(-|z|^2 / 2)` ranks vehicles by how likely they are.
//! First-order reliability (Hasofer and Lind 1974), by the vehicle of a given distance that goes furthest (Tu, Choi and Park 1999,
//! performance measure approach); the share is that of a sample drawn around these vehicles (Melchers 1989, importance sampling).

use poinsot::Error;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Share of the prior that may exceed some limit.
pub(crate) const ALLOWED: f64 = 1.0e-4;
/// Distance, in sigma of the prior, up to which vehicles must hold the limits at first.
pub(crate) const REACH: f64 = 3.0;
/// Step of slopes, in sigma of the prior.
const STEP: f64 = 0.25;
/// Times that the direction of the furthest vehicle is taken anew, and the most quantities for which it is.
const TURNS: usize = 3;
const TURNED: usize = 16;
/// Cosine of a change of direction that is not followed.
const TURNED_ENOUGH: f64 = 0.995;
/// Vehicles of the sample, and their share that is drawn from the prior itself.
const SAMPLE: u64 = 2000;
const PLAIN: f64 = 0.2;
/// The sample is drawn around at most so many vehicles, and around those that lack at most this share of what the furthest adds to the
/// excess of the nominal one.
const CENTRES: usize = 24;
const NEAR_MOST: f64 = 0.3;
/// Largest change of the reach at once.
const REACH_CHANGE: f64 = 1.5;
/// Divisions in two by which it is found.
const REACH_HALVINGS: usize = 8;
/// Distance, sigma, below which two vehicles are one centre of the sample.
const APART: f64 = 1.0;
/// Divisions in two by which the last physical vehicle on a line is found.
const HALVINGS: usize = 20;

/// The vehicles of a prior and what they reach.
pub(crate) trait Fleet: Sync {
    /// How many standard normal numbers a vehicle has.
    fn len(&self) -> usize;

    /// Whether there is such a vehicle.
    fn is_possible(&self, z: &[f64]) -> bool;

    /// Excess over every limit; not positive where it holds.
    ///
    /// # Errors
    /// The vehicle cannot fly.
    fn beyond(&self, z: &[f64]) -> Result<Vec<f64>, Error>;
}

/// A vehicle and its excess over every limit.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// Standard normal numbers.
    pub z: Vec<f64>,
    /// Excess over every limit.
    pub beyond: Vec<f64>,
}

impl Point {
    /// The largest excess.
    pub fn most(&self) -> f64 {
        let all = self.beyond.iter();
        all.fold(f64::NEG_INFINITY, |a, b| a.max(*b))
    }

    /// Distance from the nominal vehicle, sigma.
    fn distance(&self) -> f64 {
        dot(&self.z, &self.z).sqrt()
    }
}

/// Limits over a prior.
pub(crate) struct Reliability {
    /// The nominal vehicle.
    pub nominal: Point,
    /// For every limit the vehicle within the reach that goes furthest.
    pub furthest: Vec<Point>,
    /// Excess that all but [`ALLOWED`] of the vehicles stay below, by a sample, two standard errors included.
    pub tail: f64,
    /// Factor on the reach with which the furthest vehicle goes as far as the tail.
    pub reach_factor: f64,
    /// Share of the vehicles that exceed some limit, and its standard error.
    share: f64,
    error: f64,
}

impl Reliability {
    /// Of all vehicles within `reach` sigma, and of the prior; an excess up to `held` is none.
    ///
    /// # Errors
    /// A vehicle cannot fly.
    pub fn of(fleet: &impl Fleet, (reach, held): (f64, f64), seed: u64) -> Result<Self, Error> {
        let nominal = flown(fleet, vec![0.0; fleet.len()])?;
        let far = far(fleet, &nominal, reach)?;
        let mut found = Self {
            furthest: vec![nominal.clone(); nominal.beyond.len()],
            tail: nominal.most(),
            share: 0.0,
            error: 0.0,
            reach_factor: 1.0,
            nominal,
        };
        let centres = centres(&found.nominal, &far);
        let sample = sample(fleet, &centres, seed)?;
        for point in far.iter().chain(sample.iter().map(|s| &s.1)) {
            found.take(point, reach);
        }
        found.weigh(sample, held);
        found.reach_factor = found.reach_factor(fleet)?;
        Ok(found)
    }

    /// Share of the vehicles that exceed some limit, two standard errors of the sample included.
    pub fn share(&self) -> f64 {
        (self.share + 2.0 * self.error).min(1.0)
    }

    /// Factor on the reach with which the furthest vehicle goes as far as the tail.
    fn reach_factor(&self, fleet: &impl Fleet) -> Result<f64, Error> {
        let most = |a: &&Point, b: &&Point| a.most().total_cmp(&b.most());
        let Some(furthest) = self.furthest.iter().max_by(most) else {
            return Ok(1.0);
        };
        let at = |factor: f64| -> Result<f64, Error> {
            let z = scaled(&furthest.z, factor);
            Ok(flown(fleet, inside(fleet, z))?.most())
        };
        let (mut low, mut high) = (REACH_CHANGE.recip(), REACH_CHANGE);
        if at(low)? > self.tail || at(high)? < self.tail {
            // The last physical vehicle, or not the one that makes the tail.
            return Ok(1.0);
        }
        for _ in 0..REACH_HALVINGS {
            let middle = (low * high).sqrt();
            match at(middle)? < self.tail {
                true => low = middle,
                false => high = middle,
            }
        }
        Ok((low * high).sqrt())
    }

    fn take(&mut self, point: &Point, reach: f64) {
        if point.distance() > reach * (1.0 + f64::EPSILON.sqrt()) {
            return;
        }
        for (k, furthest) in self.furthest.iter_mut().enumerate() {
            if point.beyond[k] > furthest.beyond[k] {
                furthest.clone_from(point);
            }
        }
    }

    /// Tail and share of a sample with weights.
    fn weigh(&mut self, mut sample: Vec<(f64, Point)>, held: f64) {
        sample.sort_by(|a, b| b.1.most().total_cmp(&a.1.most()));
        let all: f64 = sample.iter().map(|s| s.0).sum();
        let (mut sum, mut squares, mut is_tail) = (0.0_f64, 0.0_f64, true);
        for (weight, point) in &sample {
            sum += weight / all;
            squares += (weight / all).powi(2);
            if is_tail {
                self.tail = point.most();
                is_tail = sum + 2.0 * squares.sqrt() <= ALLOWED;
            }
            if point.most() > held {
                (self.share, self.error) = (sum, squares.sqrt());
            } else if !is_tail {
                break;
            }
        }
    }
}

/// Vehicles that are possible, from normal distributions around the centres and from the prior, with their weights.
fn sample(fleet: &impl Fleet, centres: &[Vec<f64>], seed: u64) -> Result<Vec<(f64, Point)>, Error> {
    let one = |number| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number);
        let (z, weight) = drawn(fleet.len(), centres, &mut rng);
        let point = fleet.is_possible(&z).then(|| flown(fleet, z));
        Some(point?.map(|point| (weight, point)))
    };
    (0..SAMPLE).into_par_iter().filter_map(one).collect()
}

/// One draw from the mixture, and the density of the prior over that of the mixture.
fn drawn(n: usize, centres: &[Vec<f64>], rng: &mut ChaCha8Rng) -> (Vec<f64>, f64) {
    let plain = if centres.is_empty() { 1.0 } else { PLAIN };
    let each = (1.0 - plain) / centres.len().max(1) as f64;
    let pick: f64 = rng.random();
    let mut z: Vec<f64> = (0..n).map(|_| StandardNormal.sample(rng)).collect();
    if pick >= plain {
        let k = (((pick - plain) / each) as usize).min(centres.len() - 1);
        z.iter_mut().zip(&centres[k]).for_each(|(z, c)| *z += c);
    }
    let of = |c: &Vec<f64>| each * (dot(c, &z) - 0.5 * dot(c, c)).exp();
    let density = plain + centres.iter().map(of).sum::<f64>();
    (z, 1.0 / density)
}

/// Vehicles at `reach`: along every number, where every limit rises most, and there anew for those that are exceeded most.
fn far(fleet: &impl Fleet, nominal: &Point, reach: f64) -> Result<Vec<Point>, Error> {
    let (n, count) = (fleet.len(), nominal.beyond.len());
    let along = |i: usize| {
        let mut z = vec![0.0; n];
        z[i / 2] = if i.is_multiple_of(2) { reach } else { -reach };
        z
    };
    let mut all = Vec::new();
    let mut tried: Vec<Vec<f64>> = (0..2 * n).map(along).collect();
    // Vehicles, and the limits whose rise is followed from there.
    let mut open = vec![(nominal.clone(), (0..count).collect::<Vec<usize>>())];
    for _ in 0..=TURNS {
        let turned = open.par_iter().map(|(from, limits)| {
            let slopes = slopes(fleet, from)?;
            let turned = |k: &usize| {
                let length = dot(&slopes[*k], &slopes[*k]).sqrt();
                let cosine = dot(&slopes[*k], &from.z) / (length * from.distance());
                let is_old = length == 0.0 || cosine > TURNED_ENOUGH;
                (!is_old).then(|| scaled(&slopes[*k], reach / length))
            };
            Ok(limits.iter().filter_map(turned).collect())
        });
        let turned: Result<Vec<Vec<Vec<f64>>>, Error> = turned.collect();
        tried.extend(turned?.into_iter().flatten());
        if tried.is_empty() {
            break;
        }
        let new = tried.par_drain(..).map(|z| flown(fleet, inside(fleet, z)));
        all.extend(new.collect::<Result<Vec<_>, Error>>()?);
        let best = (0..count).filter_map(|k| Some((furthest(&all, k)?.clone(), vec![k])));
        open = best.collect();
        open.sort_by(|(a, j), (b, k)| b.beyond[k[0]].total_cmp(&a.beyond[j[0]]));
        open.truncate(TURNED);
    }
    Ok(all)
}

/// The vehicle that goes furthest towards a limit.
fn furthest(all: &[Point], limit: usize) -> Option<&Point> {
    all.iter()
        .max_by(|a, b| a.beyond[limit].total_cmp(&b.beyond[limit]))
}

/// Vehicles around which the sample is drawn: those that go furthest, apart from each other.
fn centres(nominal: &Point, far: &[Point]) -> Vec<Vec<f64>> {
    let mut all: Vec<&Point> = far.iter().collect();
    all.sort_by(|a, b| b.most().total_cmp(&a.most()));
    let most = all.first().map_or(0.0, |p| p.most());
    let least = most - NEAR_MOST * (most - nominal.most());
    let mut centres: Vec<Vec<f64>> = Vec::new();
    for point in all.into_iter().take_while(|p| p.most() >= least) {
        let is_apart = |c: &Vec<f64>| {
            let between: Vec<f64> = c.iter().zip(&point.z).map(|(c, z)| c - z).collect();
            dot(&between, &between) > APART * APART
        };
        if centres.len() < CENTRES && centres.iter().all(is_apart) {
            centres.push(point.z.clone());
        }
    }
    centres
}

/// Slope of every limit along every number, towards either side where the other is not physical.
fn slopes(fleet: &impl Fleet, at: &Point) -> Result<Vec<Vec<f64>>, Error> {
    let along = |i: usize| {
        let step = |step: f64| {
            let mut z = at.z.clone();
            z[i] += step;
            fleet.is_possible(&z).then_some((z, step))
        };
        let Some((z, step)) = step(STEP).or_else(|| step(-STEP)) else {
            return Ok(vec![0.0; at.beyond.len()]);
        };
        let risen = fleet.beyond(&z)?.into_iter().zip(&at.beyond);
        Ok(risen.map(|(b, a)| (b - a) / step).collect())
    };
    let columns: Result<Vec<Vec<f64>>, Error> =
        (0..fleet.len()).into_par_iter().map(along).collect();
    let columns = columns?;
    let of = |k: usize| columns.iter().map(|c| c[k]).collect();
    Ok((0..at.beyond.len()).map(of).collect())
}

/// The vehicle, or the last physical one on the way to it.
fn inside(fleet: &impl Fleet, z: Vec<f64>) -> Vec<f64> {
    if fleet.is_possible(&z) {
        return z;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match fleet.is_possible(&scaled(&z, middle)) {
            true => low = middle,
            false => high = middle,
        }
    }
    scaled(&z, low)
}

fn flown(fleet: &impl Fleet, z: Vec<f64>) -> Result<Point, Error> {
    let beyond = fleet.beyond(&z)?;
    Ok(Point { z, beyond })
}

fn scaled(z: &[f64], by: f64) -> Vec<f64> {
    z.iter().map(|z| z * by).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

    /// Limits as a function of the numbers; a vehicle with `z[0] > wall` does not exist.
    struct Plain<F> {
        n: usize,
        wall: f64,
        of: F,
    }

    impl<F: Fn(&[f64]) -> Vec<f64> + Sync> Fleet for Plain<F> {
        fn len(&self) -> usize {
            self.n
        }

        fn is_possible(&self, z: &[f64]) -> bool {
            z[0] <= self.wall
        }

        fn beyond(&self, z: &[f64]) -> Result<Vec<f64>, Error> {
            Ok((self.of)(z))
        }
    }

    fn reliability<F: Fn(&[f64]) -> Vec<f64> + Sync>(n: usize, wall: f64, of: F) -> Reliability {
        Reliability::of(&Plain { n, wall, of }, (3.9, 0.0), 1).unwrap()
    }

    fn normal() -> Normal {
        Normal::new(0.0, 1.0).unwrap()
    }

    /// Shares of closed form: half spaces in many directions, inside and outside a sphere, beside a wall.
    #[test]
    fn exact_shares_of_half_spaces_of_a_sphere_and_behind_a_wall() {
        let tail = |b: f64| normal().sf(b);
        // Six numbers; three limits at 3.9, 4 and 4.2 sigma.
        let three = reliability(6, 9.0, |z| {
            vec![z[0] - 3.9, -z[1] - 4.0, 0.6 * z[2] + 0.8 * z[3] - 4.2]
        });
        let union = tail(3.9) + tail(4.0) + tail(4.2);
        // Thirty numbers, one limit across all.
        let across = reliability(30, 9.0, |z| {
            vec![z.iter().sum::<f64>() / 30.0_f64.sqrt() - 3.8]
        });
        // All but one in 10,000 are below 3.719 sigma.
        let quantile = normal().inverse_cdf(1.0 - ALLOWED) - 3.8;
        println!("tail {:.3}, truth {quantile:.3}", across.tail);
        assert!((0.0..0.1).contains(&(across.tail - quantile)));
        // Bent: the distance from a point seven sigma away, in four numbers, is at most three.
        let bent = reliability(4, 9.0, |z| {
            let away: f64 = (z[0] - 7.0).powi(2) + z[1..].iter().map(|z| z * z).sum::<f64>();
            vec![3.0 - away.sqrt()]
        });
        // One sided in both directions, of two numbers that exceed a limit at a circle of 4.5 sigma.
        let ring = reliability(2, 9.0, |z| {
            vec![z[0].hypot(z[1]) * (1.0 + 1e-3 * z[0]) - 4.5]
        });
        let ring_truth = ChiSquared::new(2.0).unwrap().sf(4.5 * 4.5);
        // Nobody is beyond 0.5 sigma along the first number: 0.7 times it and the second reach 3.9 less often.
        let wall = reliability(2, 0.5, |z| vec![0.6 * z[0] + 0.8 * z[1] - 3.5]);
        let wall_truth = {
            let steps = 20_000;
            let (from, to) = (-9.0, 0.5);
            let h = (to - from) / f64::from(steps);
            let of = |i: i32| {
                let z = from + h * (f64::from(i) + 0.5);
                (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt()
                    * tail((3.5 - 0.6 * z) / 0.8)
                    * h
            };
            (0..steps).map(of).sum::<f64>() / normal().cdf(0.5)
        };
        let bent_truth = {
            // The noncentral square of four numbers around seven, below nine: a Poisson mixture of central ones.
            let (half, mut weight, mut sum) = (24.5_f64, (-24.5_f64).exp(), 0.0);
            for j in 0..200 {
                sum += weight * ChiSquared::new(4.0 + 2.0 * f64::from(j)).unwrap().cdf(9.0);
                weight *= half / f64::from(j + 1);
            }
            sum
        };
        let all = [
            ("three", &three, union),
            ("across", &across, tail(3.8)),
            ("bent", &bent, bent_truth),
            ("wall", &wall, wall_truth),
            ("ring", &ring, ring_truth),
        ];
        for (name, found, truth) in all {
            let (share, error) = (found.share, found.error);
            println!("{name}: {share:.3e} +- {error:.1e}, truth {truth:.3e}");
            assert!((share - truth).abs() < 3.0 * error, "{name}");
            assert!(error < 0.25 * truth && found.share() > truth, "{name}");
        }
    }

    /// The furthest vehicle of a limit that bends: `z0 + 0.2 z1^2` is largest on the sphere where `z0 = 2.5`.
    #[test]
    fn exact_the_furthest_vehicle_of_a_limit_that_bends() {
        let found = reliability(3, 9.0, |z| {
            vec![z[0] + 0.02 * z[1] + 0.2 * z[1] * z[1] - 9.0]
        });
        let far = &found.furthest[0];
        let most = 3.9_f64.powi(2) * 0.2 + 1.25 - 9.0;
        println!("{:?} {} {most}", far.z, far.beyond[0]);
        assert!(far.distance() < 3.9 + 1e-6);
        assert!(far.beyond[0] > most - 0.2, "{} {most}", far.beyond[0]);
    }
}
