//! Measures of difference between two results.

use crate::Matrix3;
use nalgebra::{Dim, Matrix, RawStorage};

/// `|a - b| / scale` in the Frobenius norm, for vectors and matrices of any one shape.
///
/// `scale` is the size of the terms of the result, not of the result itself, which may cancel to zero. With zero scale
/// the absolute difference is returned. NaN anywhere gives infinity, so that `apart(..) < tolerance` cannot pass on
/// it.
pub fn apart<R, C, SA, SB>(a: &Matrix<f64, R, C, SA>, b: &Matrix<f64, R, C, SB>, scale: f64) -> f64
where
    R: Dim,
    C: Dim,
    SA: RawStorage<f64, R, C>,
    SB: RawStorage<f64, R, C>,
{
    assert_eq!(a.shape(), b.shape(), "compared shapes differ");
    let squares: f64 = a.iter().zip(b.iter()).map(|(x, y)| (x - y).powi(2)).sum();
    relative(squares.sqrt(), scale)
}

/// `|a - b|` relative to the larger of `|a|` and `|b|`, Frobenius norm; zero for two zeros.
#[cfg(test)]
pub(crate) fn apart_relative<R, C, SA, SB>(
    a: &Matrix<f64, R, C, SA>,
    b: &Matrix<f64, R, C, SB>,
) -> f64
where
    R: Dim,
    C: Dim,
    SA: RawStorage<f64, R, C>,
    SB: RawStorage<f64, R, C>,
{
    let size = |squares: f64| squares.sqrt();
    let larger = size(a.iter().map(|x| x * x).sum()).max(size(b.iter().map(|x| x * x).sum()));
    apart(a, b, larger)
}

/// `|a - b| / scale` of two numbers, with the rules of [`apart`].
pub fn scalars_apart(a: f64, b: f64, scale: f64) -> f64 {
    relative((a - b).abs(), scale)
}

fn relative(difference: f64, scale: f64) -> f64 {
    let ratio = if scale == 0.0 {
        difference
    } else {
        difference / scale
    };
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}

/// Rotation angle between two attitudes, rad, 0 to pi.
///
/// It uses sine and cosine together, so it is accurate both for 1e-15 rad and near pi. NaN anywhere gives infinity.
pub fn attitude_apart(R_NA: &Matrix3, R_NB: &Matrix3) -> f64 {
    let R_AB = R_NA.transpose() * R_NB;
    let twice_sine = ((R_AB[(2, 1)] - R_AB[(1, 2)]).powi(2)
        + (R_AB[(0, 2)] - R_AB[(2, 0)]).powi(2)
        + (R_AB[(1, 0)] - R_AB[(0, 1)]).powi(2))
    .sqrt();
    let angle = twice_sine.atan2(R_AB.trace() - 1.0);
    if angle.is_nan() { f64::INFINITY } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Vector3, turn};

    #[test]
    fn exact_attitude_apart_is_the_angle_of_the_turn() {
        let start = turn(Vector3::new(0.3, -1.2, 0.7));
        let axis = Vector3::new(2.0, -1.0, 2.0) / 3.0;
        for angle in [0.0, 1e-12, 1e-6, 0.1, 1.0, 3.0, std::f64::consts::PI - 1e-6] {
            let found = attitude_apart(&start, &(start * turn(axis * angle)));
            assert!(
                (found - angle).abs() < 1e-15 + 1e-15 * angle,
                "{angle}: {found}"
            );
        }
    }

    #[test]
    fn unit_not_a_number_is_infinitely_far() {
        let a = Vector3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(apart(&a, &Vector3::zeros(), 1.0), f64::INFINITY);
        assert_eq!(apart_relative(&a, &Vector3::zeros()), f64::INFINITY);
        assert_eq!(scalars_apart(f64::NAN, 0.0, 0.0), f64::INFINITY);
        let broken = Matrix3::identity() * f64::NAN;
        assert_eq!(attitude_apart(&broken, &Matrix3::identity()), f64::INFINITY);
    }

    #[test]
    fn unit_scale_divides() {
        let (a, b) = (Vector3::new(3.0, 4.0, 0.0), Vector3::zeros());
        assert_eq!(apart(&a, &b, 10.0), 0.5);
        assert_eq!(apart_relative(&a, &b), 1.0);
        assert_eq!(apart_relative(&b, &b), 0.0);
        assert_eq!(scalars_apart(3.0, 1.0, 4.0), 0.5);
    }
}
