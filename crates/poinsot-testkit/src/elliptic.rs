//! Jacobi's elliptic functions and Legendre's first integral, by parameter `m = k^2`, `0 <= m <= 1`.

use std::f64::consts::FRAC_PI_2;

/// Sufficient steps: the arithmetic-geometric mean doubles its digits at every step.
const AGM_STEPS: usize = 16;

/// Sufficient duplications: a spread of 1e-300 to 1 is about 1000 bits, and each step removes two.
const DUPLICATIONS: usize = 600;

/// `K` by the complementary parameter `m1 = 1 - m`.
pub(crate) fn complete_first_by_complement(m1: f64) -> f64 {
    if m1 <= 0.0 {
        return f64::INFINITY;
    }
    let (mut a, mut b) = (1.0, m1.sqrt());
    for _ in 0..AGM_STEPS {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// `F` of the angle in -pi..pi with the given sine and cosine, by the complementary parameter. It keeps digits of a
/// small cosine and small `m1` that angle and `m` would lose.
pub(crate) fn first_by_sine_cosine(s: f64, c: f64, m1: f64) -> f64 {
    let within = s * carlson_rf(c * c, m1 * s * s + c * c, 1.0);
    if c < 0.0 {
        (2.0 * complete_first_by_complement(m1)).copysign(s) - within
    } else {
        within
    }
}

/// Carlson's symmetric integral `R_F` by duplication (Carlson 1995, algorithm for R_F).
fn carlson_rf(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    for _ in 0..DUPLICATIONS {
        let mean = (x + y + z) / 3.0;
        let (dx, dy, dz) = (1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean);
        // The remainder of the series is of sixth order: below 1e-17.
        if dx.abs().max(dy.abs()).max(dz.abs()) < 1.5e-3 {
            let e2 = dx * dy - dz * dz;
            let e3 = dx * dy * dz;
            return (1.0 + (e2 / 24.0 - 0.1 - 3.0 * e3 / 44.0) * e2 + e3 / 14.0) / mean.sqrt();
        }
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let shift = rx * (ry + rz) + ry * rz;
        (x, y, z) = (0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift));
    }
    f64::INFINITY // two zeros, where the integral diverges
}

/// `[sn, cn, dn](u | m)` by the complementary parameter `m1 = 1 - m`: descending Landen transformations (Bulirsch 1965,
/// procedure `sncndn`).
pub(crate) fn jacobi_by_complement(u: f64, m1: f64) -> [f64; 3] {
    if m1 <= 0.0 {
        return [u.tanh(), 1.0 / u.cosh(), 1.0 / u.cosh()];
    }
    // Down: arithmetic-geometric means of 1 and sqrt(m1), until the functions are circular.
    let (mut arithmetic, mut geometric) = ([1.0; AGM_STEPS], [m1.sqrt(); AGM_STEPS]);
    let mut last = 0;
    while arithmetic[last] - geometric[last] > 1e-8 * arithmetic[last] && last + 1 < AGM_STEPS {
        arithmetic[last + 1] = 0.5 * (arithmetic[last] + geometric[last]);
        geometric[last + 1] = (arithmetic[last] * geometric[last]).sqrt();
        last += 1;
    }
    let limit = 0.5 * (arithmetic[last] + geometric[last]);
    let (sin, cos) = (u * limit).sin_cos();
    if sin.abs() < 1e-100 {
        return [sin, cos, 1.0];
    }
    // Upwards: cotangent `c = cn / sn` (times the mean) and dn, without cancellation.
    let (mut c, mut dn) = (limit * cos / sin, 1.0);
    let mut previous = cos / sin;
    for k in (0..=last).rev() {
        let product = previous * c;
        c *= dn;
        dn = (geometric[k] + product) / (arithmetic[k] + product);
        previous = c / arithmetic[k];
    }
    let sn = (1.0 / c.hypot(1.0)).copysign(sin);
    [sn, c * sn, dn]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The complete integral of the first kind, `K(m)`; infinite at `m = 1`.
    fn complete_first(m: f64) -> f64 {
        complete_first_by_complement(1.0 - m)
    }

    /// The integral of the first kind `F(phi, m)` for any real `phi` (rad); infinite beyond pi/2 at `m = 1`.
    fn incomplete_first(phi: f64, m: f64) -> f64 {
        let half_turns = (phi / PI).round();
        let (s, c) = (phi - half_turns * PI).sin_cos();
        let rest = first_by_sine_cosine(s, c, 1.0 - m);
        if half_turns == 0.0 {
            rest // K may be infinite
        } else {
            2.0 * half_turns * complete_first(m) + rest
        }
    }

    /// `[sn, cn, dn](u | m)`.
    fn jacobi(u: f64, m: f64) -> [f64; 3] {
        jacobi_by_complement(u, 1.0 - m)
    }

    #[test]
    fn xval_scipy_complete_integral() {
        for (m, expected) in [
            (0.0, FRAC_PI_2),
            (0.1, 1.612_441_348_720_219_2),
            (0.5, 1.854_074_677_301_371_9),
            (0.9, 2.578_092_113_348_173_3),
            (0.999, 4.841_132_560_550_296),
        ] {
            assert!(
                (complete_first(m) / expected - 1.0_f64).abs() < 1e-15,
                "{m}"
            );
        }
    }

    #[test]
    fn xval_scipy_incomplete_integral() {
        for (phi, m, expected) in [
            (0.3, 0.2, 0.300_890_995_913_463_8),
            (1.2, 0.9, 1.564_898_134_506_671_3),
            (-0.7, 0.5, -0.728_770_305_718_190_2),
            (2.5, 0.7, 3.476_875_190_644_891_6),
            (-4.0, 0.95, -6.795_850_720_474_278),
            (10.0, 0.3, 10.867_848_645_988_321),
        ] {
            let found = incomplete_first(phi, m);
            assert!(
                (found / expected - 1.0_f64).abs() < 2e-15,
                "{phi} {m} {found}"
            );
        }
    }

    #[test]
    fn xval_scipy_jacobi_functions() {
        for (u, m, expected) in [
            (
                0.5,
                0.0,
                [0.479_425_538_604_203, 0.877_582_561_890_372_8, 1.0],
            ),
            (
                0.2,
                0.3,
                [
                    0.198_280_638_262_807_56,
                    0.980_145_289_480_133,
                    0.994_085_225_997_765_4,
                ],
            ),
            (
                1.0,
                0.5,
                [
                    0.803_001_824_895_643_9,
                    0.595_976_567_672_140_7,
                    0.823_161_001_631_596_3,
                ],
            ),
            (
                -2.3,
                0.5,
                [
                    -0.949_089_886_417_601_1,
                    -0.315_005_376_937_958_27,
                    0.741_359_692_558_149_6,
                ],
            ),
            (
                3.7,
                0.9,
                [
                    0.911_681_826_495_137_7,
                    -0.410_896_881_514_680_7,
                    0.501_948_824_597_329_6,
                ],
            ),
            (
                0.8,
                0.999,
                [
                    0.664_090_967_696_759_2,
                    0.747_651_781_662_815_2,
                    0.747_946_658_149_468_8,
                ],
            ),
            (
                5.0,
                0.01,
                [
                    -0.962_583_808_896_383_8,
                    0.270_984_152_397_386_55,
                    0.995_356_380_453_006_5,
                ],
            ),
            (
                12.0,
                0.7,
                [
                    0.427_645_598_157_449_3,
                    -0.903_946_482_031_186_1,
                    0.933_800_551_329_667,
                ],
            ),
            (
                2.0,
                1.0,
                [
                    0.964_027_580_075_816_9,
                    0.265_802_228_834_079_7,
                    0.265_802_228_834_079_7,
                ],
            ),
            (
                -1.5,
                0.25,
                [
                    -0.987_052_287_311_241_6,
                    0.160_398_822_045_693_7,
                    0.869_730_961_578_586_8,
                ],
            ),
            (
                7.3,
                0.9999,
                [
                    0.999_852_950_020_556_3,
                    -0.017_148_712_347_895_074,
                    0.019_850_665_665_345_272,
                ],
            ),
        ] {
            let found = jacobi(u, m);
            for (a, b) in found.iter().zip(expected) {
                // SciPy is accurate to a few units in the last place times |u|.
                assert!((a - b).abs() < 1e-14, "{u} {m} {found:?}");
            }
        }
    }

    #[test]
    fn exact_jacobi_inverts_the_integral() {
        for m in [0.0, 0.2, 0.6, 0.99, 0.999_999] {
            for k in -20..=20 {
                let phi = 0.15 * f64::from(k);
                let [sn, cn, _] = jacobi(incomplete_first(phi, m), m);
                let tolerance = 1e-14 / (1.0 - m).sqrt().max(1e-2);
                assert!((sn - phi.sin()).abs() < tolerance, "{m} {phi}");
                assert!((cn - phi.cos()).abs() < tolerance, "{m} {phi}");
            }
        }
    }
}
