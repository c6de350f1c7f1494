//! Residuals of a measured direction.

use poinsot_spatial::{Matrix3, Vector3};

/// Takes a vector to two axes across a direction; its component along the direction is lost.
///
/// The axes follow the direction without a branch but for its sign (Duff et al. 2017).
pub(crate) fn across(direction: &Vector3) -> Matrix3 {
    let [x, y, z] = (*direction).into();
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    Matrix3::new(
        1.0 + sign * x * x * a,
        sign * b,
        -sign * x,
        b,
        sign + y * y * a,
        -y,
        0.0,
        0.0,
        0.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_two_axes_across_are_orthonormal() {
        for k in 0..200 {
            let s = f64::from(k);
            let d = Vector3::new(s.sin(), (1.7 * s).cos(), (0.3 * s).sin()).normalize();
            let E = across(&d);
            let two = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
            assert!((E * E.transpose() - two).amax() < 1e-14);
            assert!((E * d).amax() < 1e-14);
        }
    }
}
