//! Ellipsoids of a tensor.

use nalgebra::SymmetricEigen;
use poinsot_figures::Point;
use poinsot_spatial::{Matrix3, Vector3};

/// Symmetric matrix from xx, yy, zz, xy, xz, yz.
pub(super) fn matrix(t: &[f64; 6]) -> Matrix3 {
    let [xx, yy, zz, xy, xz, yz] = *t;
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Principal moments, ascending, and right-handed axes. The largest component of each axis is positive; the first axis
/// is reversed if needed. `None` if a moment is not positive.
pub(super) fn principal(I: &Matrix3) -> Option<([f64; 3], [Vector3; 3])> {
    if !I.iter().all(|x| x.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::new(*I);
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let moments = order.map(|k| eigen.eigenvalues[k]);
    let mut axes = order.map(|k| {
        let axis: Vector3 = eigen.eigenvectors.column(k).into_owned();
        if axis[axis.iamax()] < 0.0 {
            -axis
        } else {
            axis
        }
    });
    if axes[0].cross(&axes[1]).dot(&axes[2]) < 0.0 {
        axes[0] = -axes[0];
    }
    (moments[0] > 0.0).then_some((moments, axes))
}

/// Semi-axes of `x . I x = size^2`; `None` if I is not positive definite.
pub(super) fn inertia_ellipsoid(I: &Matrix3, size: f64) -> Option<[Point; 3]> {
    let (moments, axes) = principal(I)?;
    Some([0, 1, 2].map(|k| (axes[k] * (size / moments[k].sqrt())).into()))
}

/// First-order sigma of each principal moment: `e . dI e` with the covariance of the six elements. Without covariance
/// the sigmas give an upper bound.
pub(super) fn principal_sigmas(
    axes: &[Vector3; 3],
    sigmas: &[f64; 6],
    covariance: Option<&[[f64; 6]; 6]>,
) -> [f64; 3] {
    axes.map(|e| {
        let g = [
            e.x * e.x,
            e.y * e.y,
            e.z * e.z,
            2.0 * e.x * e.y,
            2.0 * e.x * e.z,
            2.0 * e.y * e.z,
        ];
        match covariance {
            Some(c) => {
                let terms = (0..6).flat_map(|i| (0..6).map(move |j| (i, j)));
                let variance: f64 = terms.map(|(i, j)| g[i] * c[i][j] * g[j]).sum();
                variance.max(0.0).sqrt()
            }
            None => g.iter().zip(sigmas).map(|(a, s)| (a * s).abs()).sum(),
        }
    })
}

/// Semi-axes of the homogeneous ellipsoid with this mass and central inertia, m.
pub(super) fn equivalent_ellipsoid(mass: f64, I: &Matrix3) -> Option<[Point; 3]> {
    if !(mass > 0.0 && I.iter().all(|x| x.is_finite())) {
        return None;
    }
    let eigen = SymmetricEigen::new(*I);
    let m = eigen.eigenvalues;
    let half = m.sum() / 2.0;
    Some([0, 1, 2].map(|k| {
        let square = 5.0 / mass * (half - m[k]);
        (eigen.eigenvectors.column(k) * square.max(0.0).sqrt()).into()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_homogeneous_ellipsoid_gives_its_axes_back() {
        // m/5 (b2 + c2) and permutations, for semi-axes 1, 2, 3 and mass 5.
        let I = Matrix3::from_diagonal(&Vector3::new(13.0, 10.0, 5.0));
        let axes = equivalent_ellipsoid(5.0, &I).unwrap();
        let mut lengths = axes.map(|a| a.iter().map(|x| x * x).sum::<f64>().sqrt());
        lengths.sort_by(f64::total_cmp);
        for (found, wanted) in lengths.iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - wanted).abs() < 1.0e-12);
        }
    }
}
