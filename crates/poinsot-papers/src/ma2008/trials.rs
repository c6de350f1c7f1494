//! Many noisy trials of both steps, eight in parallel in vector lanes.
//!
//! Every trial adds noise to the six velocities of fixed samples and solves both steps by normal equations, whose sums
//! fit in registers. Condition numbers of 4 to 1000 leave at least ten digits. Trial t is lane `t % 8` of group
//! `t / 8`. Group g uses ChaCha8 stream g, so a trial does not depend on the number of trials.
#![allow(clippy::needless_range_loop)]

use super::arm::Reading;
use super::equations::Known;
use super::lanes::{LANES, V, normals, solve};
use fearless_simd::{Level, dispatch};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

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
    /// Known momentum in base axes.
    p: [f64; 3],
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
        let row = |m: &poinsot_spatial::Matrix3| {
            std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
        };
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
                p: p.into(),
                h: h.into(),
            }
        };
        Self {
            samples: samples.iter().map(fixed).collect(),
            arm_mass: samples.first().map_or(0.0, |s| s.arm.mass),
            known: known.is_some(),
            sigma_v,
            sigma_w,
        }
    }

    /// Runs the groups of eight trials in `groups` and passes each to `sink`.
    pub fn run(&self, seed: u64, groups: std::ops::Range<u64>, mut sink: impl FnMut(&Results)) {
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

    /// One group of trials. Compiled for every instruction set that the machine may have.
    #[inline(always)]
    fn group(&self, words: &[[u64; LANES]], noisy: &mut [[V; 6]]) -> Results {
        self.draw(words, noisy);
        match self.known {
            true => self.option1(noisy),
            false => self.option2(noisy),
        }
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

    /// Option 1 in base axes, (13) and (20): the normal equations are sums of `w w^T`, `a`, `w x a`.
    #[inline(always)]
    fn option1(&self, noisy: &[[V; 6]]) -> Results {
        let m_R = V::all(self.arm_mass);
        let inverse = 1.0 / self.arm_mass;
        let mut W = [V::ZERO; 6];
        let (mut aa, mut ab) = (V::ZERO, V::ZERO);
        let (mut Oa, mut Ob) = ([V::ZERO; 3], [V::ZERO; 3]);
        for k in 0..self.samples.len() {
            let (s, noisy) = (&self.samples[k], &noisy[k]);
            let (v, w) = (
                [noisy[0], noisy[1], noisy[2]],
                [noisy[3], noisy[4], noisy[5]],
            );
            let wr = cross_fixed(&w, &s.rho);
            let mut a = wr;
            for i in 0..3 {
                a[i] = a[i] + v[i] + V::all(s.u[i] - s.p[i] * inverse);
            }
            aa = add_dot(aa, &a, &a);
            ab = add_dot(ab, &a, &v);
            let (wa, wv) = (cross(&w, &a), cross(&w, &v));
            for i in 0..3 {
                Oa[i] = Oa[i] - wa[i];
                Ob[i] = Ob[i] - wv[i];
            }
            add_outer(&mut W, &w);
        }
        let [xx, xy, yy, xz, yz, zz] = W;
        let trace = xx + yy + zz;
        // Columns [a, Omega]; b = -v.
        let N = [
            [aa, V::ZERO, V::ZERO, V::ZERO],
            [Oa[0], trace - xx, V::ZERO, V::ZERO],
            [Oa[1], V::ZERO - xy, trace - yy, V::ZERO],
            [Oa[2], V::ZERO - xz, V::ZERO - yz, trace - zz],
        ];
        let zero = V::ZERO;
        let x = solve(N, [zero - ab, zero - Ob[0], zero - Ob[1], zero - Ob[2]]);
        let m = m_R / x[0];
        let mu = m_R * m / (m_R + m);
        let c = [x[1], x[2], x[3]];

        let mut r = [V::ZERO; 6];
        for k in 0..self.samples.len() {
            let (s, noisy) = (&self.samples[k], &noisy[k]);
            let w = [noisy[3], noisy[4], noisy[5]];
            let g = arm_momentum(s, &w, &c, mu);
            let y = [
                V::all(s.h[0]) - g[0],
                V::all(s.h[1]) - g[1],
                V::all(s.h[2]) - g[2],
            ];
            add_tensor_rhs(&mut r, &w, &y);
        }
        let y = solve(tensor_normal(&W), r);
        pack(m, &c, &y)
    }

    /// Option 2: rows rotated to N, minus those of the first sample.
    #[inline(always)]
    fn option2(&self, noisy: &[[V; 6]]) -> Results {
        let m_R = V::all(self.arm_mass);
        let mut first = [[V::ZERO; 3]; 5];
        let mut N = [[V::ZERO; 4]; 4];
        let mut r = [V::ZERO; 4];
        for k in 0..self.samples.len() {
            let (s, noisy) = (&self.samples[k], &noisy[k]);
            let (v, w) = (
                [noisy[0], noisy[1], noisy[2]],
                [noisy[3], noisy[4], noisy[5]],
            );
            let wr = cross_fixed(&w, &s.rho);
            let mut a = wr;
            for i in 0..3 {
                a[i] = a[i] + v[i] + V::all(s.u[i]);
            }
            let z = V::ZERO;
            let mut T = [
                turn(s, &a),
                turn(s, &[z, w[2], z - w[1]]),
                turn(s, &[z - w[2], z, w[0]]),
                turn(s, &[w[1], z - w[0], z]),
                turn(s, &v),
            ];
            if k == 0 {
                first = T;
                continue;
            }
            subtract(&mut T, &first);
            accumulate(&mut N, &mut r, &T);
        }
        let x = solve(N, r);
        let m = m_R / x[0];
        let mu = m_R * m / (m_R + m);
        let c = [x[1], x[2], x[3]];

        let mut first = [[V::ZERO; 3]; 7];
        let mut N = [[V::ZERO; 6]; 6];
        let mut r = [V::ZERO; 6];
        for k in 0..self.samples.len() {
            let (s, noisy) = (&self.samples[k], &noisy[k]);
            let w = [noisy[3], noisy[4], noisy[5]];
            let g = arm_momentum(s, &w, &c, mu);
            let z = V::ZERO;
            let mut T = [
                turn(s, &[w[0], z, z]),
                turn(s, &[w[1], w[0], z]),
                turn(s, &[z, w[1], z]),
                turn(s, &[w[2], z, w[0]]),
                turn(s, &[z, w[2], w[1]]),
                turn(s, &[z, z, w[2]]),
                turn(s, &g),
            ];
            if k == 0 {
                first = T;
                continue;
            }
            subtract(&mut T, &first);
            accumulate(&mut N, &mut r, &T);
        }
        let y = solve(N, r);
        pack(m, &c, &y)
    }
}

#[inline(always)]
fn pack(m: V, c: &[V; 3], y: &[V; 6]) -> Results {
    [
        m.0, c[0].0, c[1].0, c[2].0, y[0].0, y[1].0, y[2].0, y[3].0, y[4].0, y[5].0,
    ]
}

/// `g = I_R w + h_R + mu (w d.d - d d.w + d x u)`, `d = rho_R - rho_S`, in base axes.
#[inline(always)]
fn arm_momentum(s: &Fixed, w: &[V; 3], c: &[V; 3], mu: V) -> [V; 3] {
    let d = [
        V::all(s.rho[0]) - c[0],
        V::all(s.rho[1]) - c[1],
        V::all(s.rho[2]) - c[2],
    ];
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

/// Adds the elements of `w w^T`.
#[inline(always)]
fn add_outer(W: &mut [V; 6], w: &[V; 3]) {
    W[0] = W[0].plus(w[0], w[0]);
    W[1] = W[1].plus(w[0], w[1]);
    W[2] = W[2].plus(w[1], w[1]);
    W[3] = W[3].plus(w[0], w[2]);
    W[4] = W[4].plus(w[1], w[2]);
    W[5] = W[5].plus(w[2], w[2]);
}

/// `B^T B` from the sums of `w w^T`, lower triangle.
#[inline(always)]
fn tensor_normal(W: &[V; 6]) -> [[V; 6]; 6] {
    let z = V::ZERO;
    let [xx, xy, yy, xz, yz, zz] = *W;
    [
        [xx, z, z, z, z, z],
        [xy, xx + yy, z, z, z, z],
        [z, xy, yy, z, z, z],
        [xz, yz, z, xx + zz, z, z],
        [z, xz, yz, xy, yy + zz, z],
        [z, z, z, xz, yz, zz],
    ]
}

#[inline(always)]
fn add_tensor_rhs(r: &mut [V; 6], w: &[V; 3], y: &[V; 3]) {
    r[0] = r[0].plus(w[0], y[0]);
    r[1] = r[1].plus(w[1], y[0]).plus(w[0], y[1]);
    r[2] = r[2].plus(w[1], y[1]);
    r[3] = r[3].plus(w[2], y[0]).plus(w[0], y[2]);
    r[4] = r[4].plus(w[2], y[1]).plus(w[1], y[2]);
    r[5] = r[5].plus(w[2], y[2]);
}

#[inline(always)]
fn subtract<const W: usize>(T: &mut [[V; 3]; W], first: &[[V; 3]; W]) {
    for j in 0..W {
        for i in 0..3 {
            T[j][i] = T[j][i] - first[j][i];
        }
    }
}

/// Adds three rows `[A | -b]`, given by columns, to `A^T A` (lower triangle) and `A^T b`.
#[inline(always)]
fn accumulate<const N: usize, const W: usize>(
    normal: &mut [[V; N]; N],
    rhs: &mut [V; N],
    T: &[[V; 3]; W],
) {
    for i in 0..N {
        for j in 0..=i {
            normal[i][j] = add_dot(normal[i][j], &T[i], &T[j]);
        }
        rhs[i] = rhs[i] - dot(&T[i], &T[N]);
    }
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
    [
        dot(a, &all(&s.R[0])),
        dot(a, &all(&s.R[1])),
        dot(a, &all(&s.R[2])),
    ]
}
