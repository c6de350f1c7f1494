//! Ellipsoid and box of a tensor.

use nalgebra::SymmetricEigen;
use poinsot_figures::Point;
use poinsot_spatial::{Matrix3, Vector3, principal_axes};

/// Least square of a half-edge, relative to the sum of all.
const THIN: f64 = 1.0e-4;
/// Products of inertia below this share of the trace turn a box by less than a picture shows.
const LEVEL: f64 = 5.0e-3;

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
    let (moments, axes) = principal_axes(I);
    let mut axes = [0, 1, 2].map(|k| {
        let axis: Vector3 = axes.column(k).into_owned();
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

/// Half-edges of the homogeneous box with this mass and central inertia, m.
pub(super) fn equivalent_box(mass: f64, I: &Matrix3) -> Option<[Vector3; 3]> {
    if !(mass > 0.0 && I.iter().all(|x| x.is_finite())) {
        return None;
    }
    // Nearly along the body axes it is drawn along them: axes of nearly equal moments would be any.
    let small = LEVEL * I.trace();
    let level = [I.m12, I.m13, I.m23].iter().all(|x| x.abs() < small);
    let shown = if level {
        Matrix3::from_diagonal(&I.diagonal())
    } else {
        *I
    };
    let eigen = SymmetricEigen::new(shown);
    let m = eigen.eigenvalues;
    let half = m.sum() / 2.0;
    Some([0, 1, 2].map(|k| {
        // A rod or a plate keeps a visible thickness.
        let square = 3.0 / mass * (half - m[k]).max(THIN * half);
        eigen.eigenvectors.column(k) * square.max(0.0).sqrt()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_homogeneous_box_gives_its_edges_back() {
        // m/3 (b2 + c2) and permutations, for half-edges 1, 2, 3 and mass 3.
        let I = Matrix3::from_diagonal(&Vector3::new(13.0, 10.0, 5.0));
        let mut lengths = equivalent_box(3.0, &I).unwrap().map(|a| a.norm());
        lengths.sort_by(f64::total_cmp);
        for (found, wanted) in lengths.iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - wanted).abs() < 1.0e-12);
        }
    }
}
