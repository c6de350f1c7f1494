//! Linear systems and normal numbers for eight trials in parallel.
//!
//! Index loops instead of closures: a closure does not inherit the instruction set of its caller.
#![allow(clippy::needless_range_loop)]

pub(super) use poinsot_solve::lanes::{LANES, V};

/// Solves a symmetric system by `L D L^T`; only the lower triangle is used.
#[inline(always)]
pub fn solve<const N: usize>(mut A: [[V; N]; N], mut b: [V; N]) -> [V; N] {
    let mut inverse = [V::ZERO; N];
    for j in 0..N {
        inverse[j] = V::all(1.0) / A[j][j];
        for i in j + 1..N {
            let l = A[i][j] * inverse[j];
            for k in j + 1..=i {
                A[i][k] = A[i][k].less(l, A[k][j]);
            }
            b[i] = b[i].less(l, b[j]);
        }
    }
    for i in (0..N).rev() {
        let mut x = b[i];
        for k in i + 1..N {
            x = x.less(A[k][i], b[k]);
        }
        b[i] = x * inverse[i];
    }
    b
}

/// Two independent standard normal numbers per lane (Box and Muller 1958) from 64 random bits each: 32
/// for the radius, which reaches 6.8 sigma, 32 for the angle.
#[inline(always)]
pub fn normals(words: &[u64; LANES]) -> (V, V) {
    // A uniform number in (0, 1): 32 bits below the leading one of [1, 2), plus half a step, minus one.
    let mut radius = [0.0; LANES];
    let mut turn = [0.0; LANES];
    for k in 0..LANES {
        let high = (words[k] >> 32) << 20;
        let low = (words[k] & 0xffff_ffff) << 20;
        radius[k] = f64::from_bits(ONE | high | 1 << 19) - 1.0;
        turn[k] = f64::from_bits(ONE | low | 1 << 19) - 1.5;
    }
    let mut r = logarithm(V(radius));
    for k in 0..LANES {
        r.0[k] = (-2.0 * r.0[k]).sqrt();
    }
    let (sin, cos) = sine_cosine_of_turn(V(turn));
    (r * cos, r * sin)
}

const ONE: u64 = 0x3ff0_0000_0000_0000;

/// Natural logarithm for (0, 1): exponent, and the series of `2 artanh((m-1)/(m+1))` for a mantissa in [0.707, 1.414).
/// Relative error below 1e-14.
#[inline(always)]
fn logarithm(x: V) -> V {
    let (mut m, mut e) = ([0.0; LANES], [0.0; LANES]);
    for k in 0..LANES {
        // This addition moves the boundary between exponents from 1 to sqrt(1/2).
        let bits = x.0[k].to_bits() + (ONE - 0x3fe6_a09e_667f_3bcd);
        m[k] = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) + 0x3fe6_a09e_667f_3bcd);
        // The exponent as a double without integer conversion: 2^52 + e minus 2^52 + 1023.
        e[k] = f64::from_bits(0x4330_0000_0000_0000 | (bits >> 52))
            - (4_503_599_627_370_496.0 + 1023.0);
    }
    let (m, one) = (V(m), V::all(1.0));
    let s = (m - one) / (m + one);
    let t = s * s;
    let mut p = V::all(1.0 / 19.0);
    for c in [17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        p = V::all(1.0 / c).plus(p, t);
    }
    (s + s) * p + V(e) * V::all(std::f64::consts::LN_2)
}

/// Sine and cosine of `2 pi t`, t in [-0.5, 0.5]: Taylor series of the half-reduced angle; error below
/// 1e-13.
#[inline(always)]
fn sine_cosine_of_turn(t: V) -> (V, V) {
    // A quarter of the angle is in [-pi/4, pi/4]; the angle is doubled twice.
    let a = t * V::all(std::f64::consts::FRAC_PI_2);
    let z = a * a;
    let mut s = V::all(1.0 / 6_227_020_800.0);
    for c in [-39_916_800.0, 362_880.0, -5040.0, 120.0, -6.0, 1.0] {
        s = V::all(1.0 / c).plus(s, z);
    }
    let s = s * a;
    let mut c1 = V::all(1.0 / 87_178_291_200.0);
    for c in [-479_001_600.0, 3_628_800.0, -40_320.0, 720.0, -24.0, 2.0] {
        c1 = V::all(1.0 / c).plus(c1, z);
    }
    // c1 z = 1 - cos a keeps accuracy for small angles.
    let (c, one) = (V::all(1.0) - c1 * z, V::all(1.0));
    let (s2, c2) = ((s + s) * c, one - (s + s) * s);
    ((s2 + s2) * c2, one - (s2 + s2) * s2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn unit_logarithm_sine_cosine() {
        for i in 1..2000 {
            let x = f64::from(i) / 2000.0;
            let l = logarithm(V::all(x)).0[3];
            assert!(
                (l - x.ln()).abs() < 2.0e-14 * (1.0 + x.ln().abs()),
                "{x} {l}"
            );
            let t = x - 0.5;
            let (s, c) = sine_cosine_of_turn(V::all(t));
            let (es, ec) = (std::f64::consts::TAU * t).sin_cos();
            assert!((s.0[0] - es).abs() < 2.0e-13, "{t}: {} {es}", s.0[0]);
            assert!((c.0[0] - ec).abs() < 2.0e-13, "{t}: {} {ec}", c.0[0]);
        }
        let tiny = 0.5 / 4_294_967_296.0;
        assert!((logarithm(V::all(tiny)).0[0] - f64::ln(tiny)).abs() < 1.0e-12);
    }

    #[test]
    fn stat_normals_have_the_moments_of_a_normal() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let (mut sums, mut tail, n) = ([0.0; 4], 0_u32, 100_000);
        for _ in 0..n {
            let words = [(); LANES].map(|()| rng.next_u64());
            let (a, b) = normals(&words);
            for x in a.0.into_iter().chain(b.0) {
                for (k, s) in sums.iter_mut().enumerate() {
                    *s += x.powi(k as i32 + 1);
                }
                tail += u32::from(x.abs() > 3.0);
            }
        }
        let count = f64::from(n) * 16.0;
        let m = sums.map(|s| s / count);
        assert!(m[0].abs() < 4.0e-3 && (m[1] - 1.0).abs() < 6.0e-3);
        assert!(m[2].abs() < 1.5e-2 && (m[3] - 3.0).abs() < 4.0e-2, "{m:?}");
        // P(|x| > 3) = 0.0026998
        assert!((f64::from(tail) / count - 0.002_699_8).abs() < 2.0e-4);
    }

    #[test]
    fn exact_solve_of_a_known_system() {
        let A = [[4.0, 0.0, 0.0], [1.0, 3.0, 0.0], [-2.0, 0.5, 5.0]].map(|r| r.map(V::all));
        // Full matrix times (1, -2, 3).
        let b = [4.0 - 2.0 - 6.0, 1.0 - 6.0 + 1.5, -2.0 - 1.0 + 15.0].map(V::all);
        let x = solve(A, b);
        for (x, e) in x.iter().zip([1.0, -2.0, 3.0]) {
            assert!((x.0[5] - e).abs() < 1.0e-14);
        }
    }
}
