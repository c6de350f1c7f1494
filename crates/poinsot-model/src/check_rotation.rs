//! Checks unit axes and proper rotations.

use crate::finding::{Findings, Key};
use poinsot_files::{list, short};
use poinsot_spatial::{Matrix3, Vector3};

/// Smaller deviations are rounding, and give no note.
const ROUNDING: f64 = 1e-9;
/// Largest |R'R - 1| of a rotation matrix, for seven printed digits.
const ORTHONORMAL: f64 = 1e-6;

/// A unit vector from three numbers; `None` if invalid.
pub(crate) fn check_axis(
    axis: &[f64; 3],
    key: &Key,
    what: &str,
    findings: &mut Findings<'_, '_>,
) -> Option<Vector3> {
    let given = Vector3::from(*axis);
    let largest = given.amax();
    if largest < 1e-100 {
        findings.refuse(
            "E0113",
            key,
            format!("the {what} has length zero"),
            "give a direction, for example [0.0, 0.0, 1.0]",
        );
        return None;
    }
    // A unit vector is kept unchanged, so that a written model reads back equal.
    if (given.norm_squared() - 1.0).abs() <= 8.0 * f64::EPSILON {
        return Some(given);
    }
    let scaled = given / largest;
    let length = scaled.norm() * largest;
    if (length - 1.0).abs() > ROUNDING {
        findings.note(
            key,
            format!("the {what} has length {}; normalised", short(length)),
        );
    }
    Some(scaled / scaled.norm())
}

/// A rotation from a quaternion or a matrix; identity if neither is given.
pub(crate) fn check_rotation(
    xyzw: Option<&[f64; 4]>,
    matrix: Option<&[[f64; 3]; 3]>,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Matrix3> {
    match (xyzw, matrix) {
        (None, None) => Some(Matrix3::identity()),
        (Some(xyzw), None) => check_quaternion(xyzw, &key.at("rotation_xyzw"), findings),
        (None, Some(rows)) => check_matrix(rows, &key.at("rotation_matrix"), findings),
        (Some(_), Some(_)) => {
            findings.refuse(
                "E0114",
                &key.at("rotation_matrix"),
                "rotation_xyzw is given too",
                "keep one of the two",
            );
            None
        }
    }
}

fn check_quaternion(
    xyzw: &[f64; 4],
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Matrix3> {
    let largest = xyzw.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    if largest < 1e-100 {
        findings.refuse(
            "E0114",
            key,
            "the quaternion is zero",
            "write [0.0, 0.0, 0.0, 1.0] for no rotation",
        );
        return None;
    }
    let scaled = xyzw.map(|x| x / largest);
    let norm = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    let length = norm * largest;
    if (length - 1.0).abs() > ROUNDING {
        findings.note(
            key,
            format!("the quaternion has length {}; normalised", short(length)),
        );
    }
    let [x, y, z, w] = scaled.map(|a| a / norm);
    let rotation = Matrix3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    );
    Some(rotation)
}

fn check_matrix(
    rows: &[[f64; 3]; 3],
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Matrix3> {
    let mut rotation = Matrix3::from_fn(|i, j| {
        rows.get(i)
            .and_then(|row| row.get(j))
            .copied()
            .unwrap_or(0.0)
    });
    let error = |r: &Matrix3| (r.transpose() * r - Matrix3::identity()).amax();
    let given = error(&rotation);
    if given.is_nan() || given > ORTHONORMAL {
        let lengths: Vec<f64> = rotation.column_iter().map(|c| c.norm()).collect();
        findings.refuse(
            "E0114",
            key,
            format!(
                "the matrix R is not orthonormal: R'R differs from 1 by {}, its columns have lengths {}",
                short(given),
                list(&lengths)
            ),
            "write at least seven digits, or rotation_xyzw",
        );
        return None;
    }
    if rotation.determinant() < 0.0 {
        findings.refuse(
            "E0114",
            key,
            "the matrix has determinant -1: it mirrors (left-handed axes)",
            "reverse one axis",
        );
        return None;
    }
    if given > ROUNDING {
        findings.note(
            key,
            format!("R'R differs from 1 by {}; orthonormalised", short(given)),
        );
    }
    // Newton iteration for the nearest rotation (Higham 1986); quadratic convergence, so three steps suffice.
    for _ in 0..4 {
        if error(&rotation) <= 1e-14 {
            break;
        }
        rotation = 0.5 * rotation * (3.0 * Matrix3::identity() - rotation.transpose() * rotation);
    }
    Some(rotation)
}
