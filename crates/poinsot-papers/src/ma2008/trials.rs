//! Many noisy trials of both steps, eight in parallel in vector lanes.
//!
//! Every trial adds noise to the six velocities of fixed samples and solves both steps by normal equations, whose sums
//! fit in registers. Condition numbers of 4 to 1000 leave at least ten digits. Trial t is lane `t % 8` of group
//! `t / 8`. Group g uses ChaCha8 stream g, so a trial does not depend on the number of trials.
#![allow(clippy::needless_range_loop)]

use super::Variant;
use super::arm::{Reading, Vehicle};
use super::data::{check, no_velocity, raws};
use super::equations::Known;
use super::lanes::{LANES, V, normals, solve};
use crate::method::Kernel;
use fearless_simd::{Level, dispatch};
use poinsot_files::Faults;
use poinsot_identify::{Problem, Status};
use poinsot_spatial::{MassProperties, Matrix3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// The ten numbers of eight trials: mass kg, mass centre m, elements of the tensor kg m2.
pub type Results = [[f64; LANES]; 10];

/// Fixed samples and the noise of the velocities in base axes.
#[derive(Debug, Clone)]
pub struct Trials {
    samples: Vec<Fixed>,
    arm_mass: f64,
    known: bool,
    sigma_v: [f64; 3],
    sigma_w: [f64; 3],
}

/// Constants of one sample that do not depend on the noise.
#[derive(Debug, Clone, Copy)]
struct Fixed {
    R: [[f64; 3]; 3],
    v: [f64; 3],
    w: [f64; 3],
    rho: [f64; 3],
    I: [[f64; 3]; 3],
    u: [f64; 3],
    h_R: [f64; 3],
    /// `u` less the known linear momentum over the mass of the arm.
    relative: [f64; 3],
    /// Known angular momentum in base axes.
    h: [f64; 3],
}

impl Trials {
    /// Creates trials of option 1 (`known`) or option 2 for one segment. Sigmas are per component of velocity, m/s,
    /// and angular velocity, rad/s, in base axes.
    pub fn new(
        samples: &[Reading],
        known: Option<Known>,
        sigma_v: [f64; 3],
        sigma_w: [f64; 3],
    ) -> Self {
        let arm_mass = samples.first().map_or(0.0, |s| s.arm.mass);
        let row = |m: &Matrix3| std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]));
        let fixed = |s: &Reading| {
            let inverse = s.R_NB.transpose();
            let (p, h) =
                known.map_or_else(Default::default, |k| (inverse * k.p_C_N, inverse * k.h_C_N));
            Fixed {
                R: row(&s.R_NB),
                v: s.v_NBo_B.into(),
                w: s.w_NB_B.into(),
                rho: s.arm.rho_R.into(),
                I: row(&s.arm.I_R),
                u: s.arm.u.into(),
                h_R: s.arm.h_R.into(),
                relative: (s.arm.u - p / arm_mass).into(),
                h: h.into(),
            }
        };
        Self {
            samples: samples.iter().map(fixed).collect(),
            arm_mass,
            known: known.is_some(),
            sigma_v,
            sigma_w,
        }
    }

    /// Runs the groups of eight trials in `groups` and passes each to `sink`.
    pub fn run(&self, seed: u64, groups: Range<u64>, mut sink: impl FnMut(&Results)) {
        let mut noisy = vec![[V::ZERO; 6]; self.samples.len()];
        let mut words = vec![[0_u64; LANES]; 3 * self.samples.len()];
        let base = ChaCha8Rng::seed_from_u64(seed);
        let level = Level::new();
        for group in groups {
            let mut rng = base.clone();
            rng.set_stream(group);
            // Word by word: to fill bytes takes four times as long.
            for word in words.as_flattened_mut() {
                *word = rng.next_u64();
            }
            let result = dispatch!(level, _ => self.group(&words, &mut noisy));
            sink(&result);
        }
    }

    /// Bodies of these trials.
    fn bodies(&self, seed: u64, numbers: Range<u64>) -> Vec<MassProperties> {
        let lanes = LANES as u64;
        let groups = numbers.start / lanes..numbers.end.div_ceil(lanes);
        let mut number = groups.start * lanes;
        let mut bodies = Vec::new();
        self.run(seed, groups, |results| {
            for lane in 0..LANES {
                if numbers.contains(&number) {
                    let numbers = results.map(|of_lanes| of_lanes[lane]);
                    bodies.push(MassProperties::from_array(&numbers));
                }
                number += 1;
            }
        });
        bodies
    }

    /// One group of trials. Compiled for every instruction set that the machine may have.
    #[inline(always)]
    fn group(&self, words: &[[u64; LANES]], noisy: &mut [[V; 6]]) -> Results {
        self.draw(words, noisy);
        let m_R = V::all(self.arm_mass);
        let x: [V; 4] = self.step(noisy, linear, &[V::ZERO; 4]);
        let m = m_R / x[0];
        let mu = m_R * m / (m_R + m);
        let y: [V; 6] = self.step(noisy, angular, &[mu, x[1], x[2], x[3]]);
        [
            m.0, x[1].0, x[2].0, x[3].0, y[0].0, y[1].0, y[2].0, y[3].0, y[4].0, y[5].0,
        ]
    }

    /// Solves a step from its columns `[A | -b]` of every sample: option 1 in base axes, option 2 rotated to N and less
    /// those of the first sample.
    #[inline(always)]
    fn step<const N: usize, const W: usize>(
        &self,
        noisy: &[[V; 6]],
        columns: impl Fn(&Fixed, &[V; 6], &[V; 4]) -> [[V; 3]; W],
        before: &[V; 4],
    ) -> [V; N] {
        let mut first = [[V::ZERO; 3]; W];
        let mut normal = [[V::ZERO; N]; N];
        let mut rhs = [V::ZERO; N];
        for k in 0..self.samples.len() {
            let s = &self.samples[k];
            let mut T = columns(s, &noisy[k], before);
            if !self.known {
                for j in 0..W {
                    T[j] = turn(s, &T[j]);
                }
                if k == 0 {
                    first = T;
                    continue;
                }
                for j in 0..W {
                    T[j] = less(&T[j], &first[j]);
                }
            }
            for i in 0..N {
                for j in 0..=i {
                    normal[i][j] = add_dot(normal[i][j], &T[i], &T[j]);
                }
                rhs[i] = rhs[i] - dot(&T[i], &T[N]);
            }
        }
        solve(normal, rhs)
    }

    /// Noisy velocities: six normal numbers per sample and lane.
    #[inline(always)]
    fn draw(&self, words: &[[u64; LANES]], noisy: &mut [[V; 6]]) {
        for at in 0..self.samples.len() {
            let (s, out) = (&self.samples[at], &mut noisy[at]);
            for k in 0..3 {
                let (a, b) = normals(&words[3 * at + k]);
                out[k] = V::all(s.v[k]).plus(a, V::all(self.sigma_v[k]));
                out[3 + k] = V::all(s.w[k]).plus(b, V::all(self.sigma_w[k]));
            }
        }
    }
}

/// The kernel of a problem whose samples determine the whole base; `None` unless it has one segment, equal noise on the
/// axes of gyro and of velocity, and both momenta known or none.
///
/// Gyro and velocity have their declared noise; attitude, joints and wheels are exact. Both steps are solved without
/// the effect of noise on their regressors, so no sigma is stated.
pub(super) fn kernel(problem: &Problem, variant: Variant) -> Result<Option<Kernel>, Faults> {
    // A kernel does not test what the samples determine.
    if super::identify(problem, variant)?.status != Status::Converged {
        return Ok(None);
    }
    let given = check(problem, variant)?;
    let known = match (given.p_C_N, given.h_C_N) {
        (Some(p_C_N), Some(h_C_N)) => Some(Known { p_C_N, h_C_N }),
        (None, None) => None,
        _ => return Ok(None),
    };
    let [segment] = problem.segments else {
        return Ok(None);
    };
    if segment.samples.translation.is_none() {
        return Err(no_velocity(segment));
    }
    let (raws, _) = raws(problem, segment, &given)?;
    let mut vehicle = Vehicle::new(problem.model, problem.tree);
    let samples: Vec<_> = raws.iter().map(|raw| vehicle.reading(raw)).collect();
    let sigma = |covariance: &Matrix3| {
        let variance = covariance[(0, 0)];
        // The kernel draws in base axes, the velocity is measured in N: only equal noise of all axes is the same.
        (*covariance == Matrix3::identity() * variance).then(|| [variance.sqrt(); 3])
    };
    let noise = problem.noise;
    let (Some(v), Some(w)) = (sigma(&noise.velocity), sigma(&noise.gyro)) else {
        return Ok(None);
    };
    let trials = Trials::new(&samples, known, v, w);
    Ok(Some(Box::new(move |seed, numbers| {
        trials.bodies(seed, numbers)
    })))
}

/// Columns of step 1, (13): `[a, w x | v]`.
#[inline(always)]
fn linear(s: &Fixed, [v0, v1, v2, w0, w1, w2]: &[V; 6], _: &[V; 4]) -> [[V; 3]; 5] {
    let (v, w, z) = ([*v0, *v1, *v2], [*w0, *w1, *w2], V::ZERO);
    let mut a = cross_fixed(&w, &s.rho);
    for i in 0..3 {
        a[i] = a[i] + v[i] + V::all(s.relative[i]);
    }
    [
        a,
        [z, w[2], z - w[1]],
        [z - w[2], z, w[0]],
        [w[1], z - w[0], z],
        v,
    ]
}

/// Columns of step 2, (20): `[B | g]`, with the reduced mass and the mass centre of step 1.
#[inline(always)]
fn angular(s: &Fixed, noisy: &[V; 6], [mu, x, y, z]: &[V; 4]) -> [[V; 3]; 7] {
    let (w, c, zero) = ([noisy[3], noisy[4], noisy[5]], [*x, *y, *z], V::ZERO);
    let g = arm_momentum(s, &w, &c, *mu);
    [
        [w[0], zero, zero],
        [w[1], w[0], zero],
        [zero, w[1], zero],
        [w[2], zero, w[0]],
        [zero, w[2], w[1]],
        [zero, zero, w[2]],
        less(&g, &all(&s.h)),
    ]
}

/// `g = I_R w + h_R + mu (w d.d - d d.w + d x u)`, `d = rho_R - rho_S`, in base axes.
#[inline(always)]
fn arm_momentum(s: &Fixed, w: &[V; 3], c: &[V; 3], mu: V) -> [V; 3] {
    let d = less(&all(&s.rho), c);
    let (dd, dw) = (dot(&d, &d), dot(&d, w));
    let du = cross_fixed(&d, &s.u);
    let mut g = [V::ZERO; 3];
    for i in 0..3 {
        let own = add_dot(V::all(s.h_R[i]), w, &all(&s.I[i]));
        g[i] = own.plus(mu, du[i].plus(w[i], dd).less(d[i], dw));
    }
    g
}

#[inline(always)]
fn all(a: &[f64; 3]) -> [V; 3] {
    [V::all(a[0]), V::all(a[1]), V::all(a[2])]
}

#[inline(always)]
fn less(a: &[V; 3], b: &[V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn add_dot(sum: V, a: &[V; 3], b: &[V; 3]) -> V {
    sum.plus(a[0], b[0]).plus(a[1], b[1]).plus(a[2], b[2])
}

#[inline(always)]
fn dot(a: &[V; 3], b: &[V; 3]) -> V {
    (a[0] * b[0]).plus(a[1], b[1]).plus(a[2], b[2])
}

#[inline(always)]
fn cross(a: &[V; 3], b: &[V; 3]) -> [V; 3] {
    [
        (a[1] * b[2]).less(a[2], b[1]),
        (a[2] * b[0]).less(a[0], b[2]),
        (a[0] * b[1]).less(a[1], b[0]),
    ]
}

#[inline(always)]
fn cross_fixed(a: &[V; 3], b: &[f64; 3]) -> [V; 3] {
    cross(a, &all(b))
}

#[inline(always)]
fn turn(s: &Fixed, a: &[V; 3]) -> [V; 3] {
    let [x, y, z] = &s.R;
    [dot(a, &all(x)), dot(a, &all(y)), dot(a, &all(z))]
}
