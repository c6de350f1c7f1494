//! Particle swarm of Sec. 4, (53)-(58).
//!
//! The paper prints neither swarm size nor weights nor ranges; [`Swarm::default`] has ours. Every particle has its own
//! random stream (ChaCha8, stream = particle), and each iteration uses the best position of the previous one. The
//! result is therefore identical for any number of threads.

use fearless_simd::{Level, dispatch};
use poinsot_files::{Faults, Pace, check_memory, check_time};
use poinsot_solve::lanes::{LANES, V};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Position of a particle, (53): the ten numbers of (61) or (62).
pub type Particle = [f64; 10];

/// Particles evaluated by one task.
const BLOCK: usize = 10;
/// Work (particles times samples) above which an iteration is distributed over threads.
const WORTH: usize = 200_000;
/// Memory of a particle: twice its position and cost, its speed and its random stream, bytes.
const OF_PARTICLE: f64 = 640.0;
/// Least time of the cost of one particle at one sample, s.
const OF_COST: f64 = 1.0e-9;
/// A coordinate closer to its bound than this fraction of the range is on it.
const ON_BOUND: f64 = 1.0e-9;

/// Objective function.
pub trait Objective: Sync {
    /// Cost of every particle.
    fn costs(&self, particles: &[Particle], out: &mut [f64]);
    /// Number of samples behind one cost.
    fn samples(&self) -> usize;
}

/// Cost of one particle for a chunk of samples.
pub trait Cost<const N: usize>: Sync {
    /// A particle in the form used by the cost.
    type Body: Copy;

    /// Converts a particle for the cost.
    fn body(&self, x: &Particle) -> Self::Body;

    /// Cost of one particle for each sample of a chunk, which holds N numbers of every sample.
    fn cost(chunk: &[V; N], body: &Self::Body) -> V;
}

/// An objective that is a mean over samples, eight in parallel.
pub struct Mean<C, const N: usize> {
    cost: C,
    chunks: Vec<[V; N]>,
    samples: usize,
}

impl<C: Cost<N>, const N: usize> Mean<C, N> {
    /// The mean of a cost over samples of N numbers each.
    pub(super) fn of(cost: C, samples: impl ExactSizeIterator<Item = Vec<f64>>) -> Self {
        let count = samples.len();
        let mut chunks = vec![[V::ZERO; N]; count.div_ceil(LANES)];
        for (k, numbers) in samples.enumerate() {
            for (lane, x) in chunks[k / LANES].iter_mut().zip(numbers) {
                lane.0[k % LANES] = x;
            }
        }
        Self {
            cost,
            chunks,
            samples: count,
        }
    }
}

impl<C: Cost<N>, const N: usize> Objective for Mean<C, N> {
    fn costs(&self, particles: &[Particle], out: &mut [f64]) {
        dispatch!(Level::new(), _ => self.means(particles, out));
    }

    fn samples(&self) -> usize {
        self.samples
    }
}

/// Particles whose sums fit in the L1 cache.
const NEAR: usize = 64;

impl<C: Cost<N>, const N: usize> Mean<C, N> {
    /// Costs of particles. Compiled for every instruction set that the machine may have.
    #[inline(always)]
    fn means(&self, particles: &[Particle], out: &mut [f64]) {
        let none = self.cost.body(&[0.0; 10]);
        for (particles, out) in particles.chunks(NEAR).zip(out.chunks_mut(NEAR)) {
            let mut sums = [V::ZERO; NEAR];
            let mut bodies = [none; NEAR];
            for (x, body) in particles.iter().zip(bodies.iter_mut()) {
                *body = self.cost.body(x);
            }
            // One chunk of samples stays in the cache while all particles are evaluated.
            for chunk in &self.chunks {
                for (body, total) in bodies.iter().zip(sums.iter_mut()).take(particles.len()) {
                    *total = *total + C::cost(chunk, body);
                }
            }
            for (out, total) in out.iter_mut().zip(&sums) {
                *out = total.0.iter().sum::<f64>() / self.samples.max(1) as f64;
            }
        }
    }
}

/// Parameters of the swarm.
#[derive(Debug, Clone, PartialEq)]
pub struct Swarm {
    /// Particles, `n_p`.
    pub particles: usize,
    /// Largest number of iterations, `N_max`.
    pub iterations: usize,
    /// Weight `w` of the old velocity at the first and the last iteration; linear in between.
    pub weight: [f64; 2],
    /// `c1` and `c2`.
    pub attraction: [f64; 2],
    /// Stop after this many iterations without improvement.
    pub patience: usize,
    /// Seed.
    pub seed: u64,
}

impl Default for Swarm {
    fn default() -> Self {
        Self {
            particles: 50,
            iterations: 4000,
            weight: [0.8, 0.6],
            attraction: [1.49445, 1.49445],
            patience: 400,
            seed: 0,
        }
    }
}

impl Swarm {
    /// As [`fly`], within the limits of memory and time.
    ///
    /// # Errors
    /// E0006 with both figures.
    pub(super) fn fly(&self, range: &Range, objective: &dyn Objective) -> Result<Flight, Faults> {
        let what = format!("the {} particles of the swarm", self.particles);
        let (particles, fewest) = (self.particles as f64, self.iterations.min(self.patience));
        check_memory(&what, particles * OF_PARTICLE)?;
        let seconds = OF_COST * particles * objective.samples() as f64 * fewest as f64;
        check_time(&what, seconds / rayon::current_num_threads() as f64)?;
        let pace = Pace::new(what);
        let flight = fly(self, range, objective, |_, _, _| {
            pace.check(1, fewest).is_ok()
        });
        pace.over().map(|()| flight)
    }
}

/// Box constraints on the particles. A coordinate with equal bounds is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// Lower bounds.
    pub low: Particle,
    /// Upper bounds.
    pub high: Particle,
}

impl Range {
    /// `centre` minus and plus `half`.
    pub fn around(centre: &Particle, half: &Particle) -> Self {
        Self {
            low: std::array::from_fn(|d| centre[d] - half[d]),
            high: std::array::from_fn(|d| centre[d] + half[d]),
        }
    }

    fn width(&self, d: usize) -> f64 {
        self.high[d] - self.low[d]
    }

    /// Whether a position is inside.
    pub fn holds(&self, x: &Particle) -> bool {
        (0..10).all(|d| x[d] >= self.low[d] && x[d] <= self.high[d])
    }

    /// Coordinates on a bound of the range.
    pub fn touched(&self, x: &Particle) -> Vec<usize> {
        let near = |d: &usize| {
            let gap = (x[*d] - self.low[*d]).min(self.high[*d] - x[*d]);
            self.width(*d) > 0.0 && gap <= ON_BOUND * self.width(*d)
        };
        (0..10).filter(near).collect()
    }
}

/// Result of the swarm.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    /// Best position, (55).
    pub best: Particle,
    /// Its cost.
    pub cost: f64,
    /// Best cost after every iteration.
    pub history: Vec<f64>,
    /// Coordinates on a bound of the range.
    pub on_bound: Vec<usize>,
}

/// Minimises within a range; `watch` receives the best position after every iteration, and says whether to go on.
///
/// ```
/// use poinsot_papers::xu2017::swarm::{Objective, Particle, Range, Swarm, fly};
///
/// /// Squared distance from (0.1, ..., 0.1).
/// struct Bowl;
/// impl Objective for Bowl {
///     fn costs(&self, particles: &[Particle], out: &mut [f64]) {
///         for (x, cost) in particles.iter().zip(out) {
///             *cost = x.iter().map(|x| (x - 0.1) * (x - 0.1)).sum();
///         }
///     }
///     fn samples(&self) -> usize {
///         1
///     }
/// }
///
/// let range = Range::around(&[0.0; 10], &[1.0; 10]);
/// let flight = fly(&Swarm::default(), &range, &Bowl, |_, _, _| true);
/// assert!(flight.best.iter().all(|x| (x - 0.1).abs() < 0.01));
/// ```
pub fn fly(
    swarm: &Swarm,
    range: &Range,
    objective: &dyn Objective,
    mut watch: impl FnMut(usize, &Particle, f64) -> bool,
) -> Flight {
    let n = swarm.particles.max(1);
    let die = |particle: usize| {
        let mut die = ChaCha8Rng::seed_from_u64(swarm.seed);
        die.set_stream(particle as u64);
        die
    };
    let mut dice: Vec<ChaCha8Rng> = (0..n).map(die).collect();
    let anywhere = |die: &mut ChaCha8Rng| {
        std::array::from_fn(|d| range.low[d] + range.width(d) * die.random::<f64>())
    };
    let mut x: Vec<Particle> = dice.iter_mut().map(anywhere).collect();
    let mut v = vec![[0.0; 10]; n];
    let mut cost = vec![f64::INFINITY; n];
    evaluate(objective, &x, &mut cost);
    let mut own = x.clone();
    let mut own_cost = cost.clone();
    let mut leader = least(&own_cost);
    let mut history = vec![own_cost[leader]];
    let mut last_change = 0;
    for k in 1..=swarm.iterations {
        let share = k as f64 / swarm.iterations as f64;
        let w = swarm.weight[0] + (swarm.weight[1] - swarm.weight[0]) * share;
        let best = own[leader];
        for i in 0..n {
            let pulls = (w, swarm.attraction);
            step(
                &mut x[i],
                &mut v[i],
                [&own[i], &best],
                pulls,
                range,
                &mut dice[i],
            );
        }
        evaluate(objective, &x, &mut cost);
        for i in 0..n {
            if cost[i] < own_cost[i] {
                own_cost[i] = cost[i];
                own[i] = x[i];
            }
        }
        let before = history[k - 1];
        leader = least(&own_cost);
        history.push(own_cost[leader]);
        let goes_on = watch(k, &own[leader], own_cost[leader]);
        if own_cost[leader] < before {
            last_change = k;
        }
        if !goes_on || k - last_change >= swarm.patience {
            break;
        }
    }
    Flight {
        best: own[leader],
        cost: own_cost[leader],
        on_bound: range.touched(&own[leader]),
        history,
    }
}

/// (57) and (58), clamped to the range.
#[inline]
fn step(
    x: &mut Particle,
    v: &mut Particle,
    [own, best]: [&Particle; 2],
    (w, [c1, c2]): (f64, [f64; 2]),
    range: &Range,
    die: &mut ChaCha8Rng,
) {
    for d in 0..10 {
        let fastest = 0.5 * range.width(d);
        let pull = c1 * die.random::<f64>() * (own[d] - x[d])
            + c2 * die.random::<f64>() * (best[d] - x[d]);
        v[d] = (w * v[d] + pull).clamp(-fastest, fastest);
        x[d] += v[d];
        if x[d] < range.low[d] || x[d] > range.high[d] {
            x[d] = x[d].clamp(range.low[d], range.high[d]);
            v[d] = 0.0;
        }
    }
}

fn evaluate(objective: &dyn Objective, x: &[Particle], cost: &mut [f64]) {
    if x.len() * objective.samples() > WORTH {
        x.par_chunks(BLOCK)
            .zip(cost.par_chunks_mut(BLOCK))
            .for_each(|(x, cost)| objective.costs(x, cost));
    } else {
        objective.costs(x, cost);
    }
}

/// Index of the least cost; the first if several are equal.
fn least(cost: &[f64]) -> usize {
    let better = |a: usize, b: usize| if cost[b] < cost[a] { b } else { a };
    (0..cost.len()).fold(0, better)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances along the axes, summed as the paper sums norms of residuals. Next to a distance of 0.5 fixed by the
    /// range, another one is resolved to 1e-16. The root of a sum of squares resolves only 1e-8.
    struct Bowl(Particle);

    impl Objective for Bowl {
        fn costs(&self, particles: &[Particle], out: &mut [f64]) {
            for (x, out) in particles.iter().zip(out) {
                *out = x.iter().zip(&self.0).map(|(a, b)| (a - b).abs()).sum();
            }
        }

        fn samples(&self) -> usize {
            1_000_000
        }
    }

    #[test]
    fn exact_same_bits_on_any_number_of_threads() {
        let bowl = Bowl(std::array::from_fn(|d| 0.1 * d as f64));
        let range = Range::around(&[0.0; 10], &[2.0; 10]);
        let swarm = Swarm {
            iterations: 200,
            seed: 7,
            ..Swarm::default()
        };
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| fly(&swarm, &range, &bowl, |_, _, _| true))
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(5));
        assert!(one.history.windows(2).all(|w| w[1] <= w[0]));
        let other = fly(&Swarm { seed: 8, ..swarm }, &range, &bowl, |_, _, _| true);
        assert_ne!(one.best, other.best);
    }

    #[test]
    fn exact_a_range_without_the_answer_ends_on_its_bound() {
        let bowl = Bowl([1.0; 10]);
        let mut range = Range::around(&[0.0; 10], &[2.0; 10]);
        range.high[3] = 0.5;
        let end = fly(&Swarm::default(), &range, &bowl, |_, _, _| true);
        assert_eq!(end.on_bound, [3]);
        assert_eq!(end.best[3], 0.5);
        for d in (0..10).filter(|d| *d != 3) {
            let error = (end.best[d] - 1.0).abs();
            assert!(error < 1.0e-9, "coordinate {d}: {error:e}");
        }
    }
}
