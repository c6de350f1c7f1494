//! Checks unit axes and proper rotations.

use crate::check::Check;
use crate::finding::Key;
use poinsot_files::{list, short};
use poinsot_spatial::{Matrix3, Vector3};

/// Smaller deviations are rounding, and give no note.
const ROUNDING: f64 = 1e-9;
/// Largest |R'R - 1| of a rotation matrix, for seven printed digits.
const ORTHONORMAL: f64 = 1e-6;

impl Check<'_, '_> {
    /// A unit vector from three numbers; `None` if invalid.
    pub fn axis(&mut self, axis: &[f64; 3], key: &Key, what: &str) -> Option<Vector3> {
        let given = Vector3::from(*axis);
        let largest = given.amax();
        if largest < 1e-100 {
            let problem = format!("the {what} has length zero");
            let remedy = "give a direction, for example [0.0, 0.0, 1.0]";
            return self.findings.refused("E0113", key, problem, remedy);
        }
        // A unit vector is kept unchanged, so that a written model reads back equal.
        if (given.norm_squared() - 1.0).abs() <= 8.0 * f64::EPSILON {
            return Some(given);
        }
        let scaled = given / largest;
        self.note_length(key, what, scaled.norm() * largest);
        Some(scaled / scaled.norm())
    }

    fn note_length(&mut self, key: &Key, what: &str, length: f64) {
        if (length - 1.0).abs() > ROUNDING {
            let length = short(length);
            self.note(key, format!("the {what} has length {length}; normalised"));
        }
    }

    /// A rotation from a quaternion or a matrix; identity if neither is given.
    pub fn rotation(
        &mut self,
        xyzw: Option<[f64; 4]>,
        matrix: Option<[[f64; 3]; 3]>,
        key: &Key,
    ) -> Option<Matrix3> {
        let here = key.at("rotation_matrix");
        match (xyzw, matrix) {
            (None, None) => Some(Matrix3::identity()),
            (Some(xyzw), None) => self.quaternion(xyzw, &key.at("rotation_xyzw")),
            (None, Some(rows)) => self.matrix(rows, &here),
            (Some(_), Some(_)) => {
                let problem = "rotation_xyzw is given too";
                self.findings
                    .refused("E0114", &here, problem, "keep one of the two")
            }
        }
    }

    fn quaternion(&mut self, xyzw: [f64; 4], key: &Key) -> Option<Matrix3> {
        let largest = xyzw.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        if largest < 1e-100 {
            let remedy = "write [0.0, 0.0, 0.0, 1.0] for no rotation";
            return self
                .findings
                .refused("E0114", key, "the quaternion is zero", remedy);
        }
        let scaled = xyzw.map(|x| x / largest);
        let norm = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.note_length(key, "quaternion", norm * largest);
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

    fn matrix(&mut self, rows: [[f64; 3]; 3], key: &Key) -> Option<Matrix3> {
        let mut rotation = Matrix3::from(rows).transpose();
        let error = |r: &Matrix3| (r.transpose() * r - Matrix3::identity()).amax();
        let given = error(&rotation);
        if given.is_nan() || given > ORTHONORMAL {
            let lengths: Vec<f64> = rotation.column_iter().map(|c| c.norm()).collect();
            let problem = format!(
                "the matrix R is not orthonormal: R'R differs from 1 by {}, its columns have lengths {}",
                short(given),
                list(&lengths)
            );
            let remedy = "write at least seven digits, or rotation_xyzw";
            return self.findings.refused("E0114", key, problem, remedy);
        }
        if rotation.determinant() < 0.0 {
            let problem = "the matrix has determinant -1: it mirrors (left-handed axes)";
            return self
                .findings
                .refused("E0114", key, problem, "reverse one axis");
        }
        if given > ROUNDING {
            let given = short(given);
            self.note(
                key,
                format!("R'R differs from 1 by {given}; orthonormalised"),
            );
        }
        // Newton iteration for the nearest rotation (Higham 1986); quadratic convergence, so three steps suffice.
        for _ in 0..4 {
            if error(&rotation) <= 1e-14 {
                break;
            }
            rotation =
                0.5 * rotation * (3.0 * Matrix3::identity() - rotation.transpose() * rotation);
        }
        Some(rotation)
    }
}
