use crate::{Matrix3, Vector3, Vector6};

/// The matrix `[a]x` with `[a]x b = a x b`.
///
/// ```
/// use poinsot_spatial::{Vector3, skew};
///
/// assert_eq!(skew(&Vector3::x()) * Vector3::y(), Vector3::z());
/// ```
#[inline]
pub fn skew(a: &Vector3) -> Matrix3 {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// The linear part of a twist, momentum or wrench.
///
/// ```
/// use poinsot_spatial::{Vector3, angular, linear, stacked};
///
/// let twist = stacked(&Vector3::x(), &Vector3::z());
/// assert_eq!((linear(&twist), angular(&twist)), (Vector3::x(), Vector3::z()));
/// ```
#[inline]
pub fn linear(x: &Vector6) -> Vector3 {
    x.fixed_rows::<3>(0).into()
}

/// The angular part of a twist, momentum or wrench.
///
/// ```
/// use poinsot_spatial::{Vector3, Vector6, angular};
///
/// assert_eq!(angular(&Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 2.0)), Vector3::z() * 2.0);
/// ```
#[inline]
pub fn angular(x: &Vector6) -> Vector3 {
    x.fixed_rows::<3>(3).into()
}

/// The twist, momentum or wrench of a linear and an angular part.
///
/// ```
/// use poinsot_spatial::{Vector3, Vector6, stacked};
///
/// assert_eq!(stacked(&Vector3::x(), &Vector3::z()), Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0));
/// ```
#[inline]
pub fn stacked(linear: &Vector3, angular: &Vector3) -> Vector6 {
    let (l, a) = (linear, angular);
    Vector6::new(l.x, l.y, l.z, a.x, a.y, a.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_skew_is_the_cross_product() {
        let a = Vector3::new(1.0, -2.0, 3.0);
        let b = Vector3::new(0.3, 0.7, -1.1);
        assert_eq!(skew(&a) * b, a.cross(&b));
    }
}
