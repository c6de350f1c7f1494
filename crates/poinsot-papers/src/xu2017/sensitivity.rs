//! Sec. 5.6: sensitivity of momentum to each parameter, (63)-(75), and the joint path that maximises it.

use super::least_squares::shown;
use super::natural;
use super::two_body::{TwoBodyReading, equations, rows, transported_back};
use faer::Mat;
use nalgebra::SMatrix;
use poinsot_dynamics::{Kinematics, Motion, Tree, composite, momentum, twist_from_momentum};
use poinsot_spatial::{InertialParameters, Matrix3, Vector3};

/// (68), corrected: with `m1 = M - m0` the derivative of momentum with respect to `m0` is `v0 - v1`.
///
/// ```
/// use poinsot_papers::xu2017::sensitivity::mass_coefficient;
/// use poinsot_spatial::Vector3;
///
/// assert_eq!(mass_coefficient(&Vector3::x(), &Vector3::y()), Vector3::new(1.0, -1.0, 0.0));
/// ```
pub fn mass_coefficient(v0: &Vector3, v1: &Vector3) -> Vector3 {
    v0 - v1
}

/// (72): `K_1..K_18` as three rows of six, columns xx, xy, xz, yy, yz, zz. The body has attitude `A0` and angular
/// velocity `w0` (both in N). They are the partial derivatives (73) of `A0 I A0^T w0`.
///
/// ```
/// use nalgebra::SVector;
/// use poinsot_papers::xu2017::sensitivity::tensor_coefficients;
/// use poinsot_spatial::{Matrix3, Vector3};
///
/// // Columns xx, xy, xz, yy, yz, zz: their sum with the elements is I w.
/// let (I, w) = (Matrix3::new(1.0, 2.0, 3.0, 2.0, 4.0, 5.0, 3.0, 5.0, 6.0), Vector3::new(1.0, -2.0, 3.0));
/// let K = tensor_coefficients(&Matrix3::identity(), &w);
/// assert_eq!(K * SVector::from([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), I * w);
/// ```
pub fn tensor_coefficients(A0: &Matrix3, w0: &Vector3) -> SMatrix<f64, 3, 6> {
    let S = A0.transpose() * w0;
    SMatrix::from_fn(|i, k| {
        let a = A0.row(i);
        match k {
            0 => a[0] * S[0],
            1 => a[1] * S[0] + a[0] * S[1],
            2 => a[2] * S[0] + a[0] * S[2],
            3 => a[1] * S[1],
            4 => a[2] * S[1] + a[1] * S[2],
            _ => a[2] * S[2],
        }
    })
}

/// (75): bounds of the coefficients for an angular rate up to `rate`, columns as in [`tensor_coefficients`].
///
/// ```
/// use poinsot_papers::xu2017::sensitivity::tensor_bounds;
///
/// assert_eq!(tensor_bounds(0.1), [0.1, 0.2, 0.2, 0.1, 0.2, 0.1]);
/// ```
pub fn tensor_bounds(rate: f64) -> [f64; 6] {
    [rate, 2.0 * rate, 2.0 * rate, rate, 2.0 * rate, rate]
}

/// Sensitivity of momentum to the base side of a joint along a path of this joint, given positions and rates at the
/// samples: singular values in natural units, descending, of the directions that the joint can excite. The smallest is to
/// be maximised among paths. All other joints are in the normal configuration; momentum is zero; the robot is nominal.
///
/// `None` if the robot has no mass.
///
/// ```
/// use poinsot_dynamics::{Link, Motion, Tree};
/// use poinsot_papers::xu2017::sensitivity::path_sensitivity;
/// use poinsot_spatial::{MassProperties, Matrix3, Vector3};
///
/// // A base of 2 kg and an arm of 1 kg that turns about z at x = 1 m; its mass centre is 1 m further.
/// let hinge = Link::new(0, Motion::Revolute(0), Vector3::x(), Matrix3::identity(), Vector3::z());
/// let tree = Tree { links: vec![Link::base(), hinge], rotors: vec![], coordinates: vec![0] };
/// let base = MassProperties { mass: 2.0, p_BoBcm_B: Vector3::zeros(), I_BBcm_B: Matrix3::identity() };
/// let arm = MassProperties { mass: 1.0, p_BoBcm_B: Vector3::x(), I_BBcm_B: Matrix3::identity() * 0.5 };
/// let bodies = [base.parameters(), arm.parameters()];
/// // Momentum is linear in the rate of the joint.
/// let weakest = |rate: f64| {
///     let path: Vec<(f64, f64)> = (0..20).map(|k| (0.1 * f64::from(k), rate)).collect();
///     *path_sensitivity(&tree, &bodies, &[0.0], 0, &path).unwrap().last().unwrap()
/// };
/// assert!((weakest(2.0) / weakest(1.0) - 2.0).abs() < 1.0e-6);
/// // One sample has six equations of ten parameters.
/// let found = path_sensitivity(&tree, &bodies, &[0.0], 0, &[(0.0, 1.0)]);
/// assert!(found.unwrap().len() <= 6);
/// ```
pub fn path_sensitivity(
    tree: &Tree,
    bodies: &[InertialParameters],
    normal: &[f64],
    joint: usize,
    path: &[(f64, f64)],
) -> Option<Vec<f64>> {
    let moved = [Motion::Revolute(joint), Motion::Prismatic(joint)];
    let child = tree.links.iter().position(|l| moved.contains(&l.motion))?;
    let mut kinematics = Kinematics::at(tree, normal);
    let (R, p) = (kinematics.R[child], kinematics.p[child]);
    let total = composite(bodies, &kinematics);
    let compose =
        |x: &InertialParameters| [*x, transported_back(&total.with_added(-1.0, x), &R, &p)];
    let mut inner = bodies.to_vec();
    let carried = inner.iter_mut().enumerate();
    for (_, body) in carried.filter(|(b, _)| tree.carries(child, *b)) {
        *body = InertialParameters::ZERO;
    }
    let natural = natural(&composite(&inner, &kinematics).mass_properties()?);
    let mut q = normal.to_vec();
    let mut rates = vec![0.0; normal.len()];
    let mut readings = Vec::with_capacity(path.len());
    let zero = Vector3::zeros();
    for &(position, rate) in path {
        q[joint] = position;
        rates[joint] = rate;
        kinematics.place(tree, &q);
        kinematics.set_velocities(tree, &zero, &zero, &rates);
        let c = momentum(bodies, &kinematics);
        let (l, h) = (c.fixed_rows::<3>(0).into(), c.fixed_rows::<3>(3).into());
        let twist = twist_from_momentum(&composite(bodies, &kinematics), &zero, &zero, &l, &h)?;
        kinematics.set_velocities(tree, &twist.v, &twist.w, &rates);
        readings.push(TwoBodyReading::in_base(&kinematics, child));
    }
    let flat = equations(&rows(&readings, compose));
    let rank = shown(&flat, &natural).map_or(0, |s| s.ncols());
    let matrix = Mat::from_fn(flat.len(), 10, |i, j| flat[i][j] * natural[j]);
    let svd = matrix.thin_svd().ok();
    Some(svd.map_or(Vec::new(), |svd| (0..rank).map(|k| svd.S()[k]).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (72)-(73) against a finite difference of `A0 I A0^T w0`, and (74)-(75) for random attitudes.
    #[test]
    fn exact_coefficients_are_derivatives_and_stay_in_their_bounds() {
        let I = Matrix3::new(30.0, 0.26, 0.37, 0.26, 28.0, -0.29, 0.37, -0.29, 32.0);
        for k in 0..200 {
            let turn = Vector3::new(0.3, -0.7, 0.5) * (0.1 * f64::from(k));
            let A0 = nalgebra::Rotation3::new(turn).into_inner();
            let w0 = Vector3::new((0.9 * f64::from(k)).sin(), 0.4, -0.6).normalize() * 0.03;
            let K = tensor_coefficients(&A0, &w0);
            let elements = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
            let bounds = tensor_bounds(0.03);
            for (column, (i, j)) in elements.into_iter().enumerate() {
                let mut changed = I;
                changed[(i, j)] += 1.0;
                if i != j {
                    changed[(j, i)] += 1.0;
                }
                let slope = A0 * (changed - I) * A0.transpose() * w0;
                assert!((K.column(column) - slope).norm() < 1.0e-15);
                assert!(K.column(column).amax() <= bounds[column] * (1.0 + 1.0e-12));
            }
        }
        let (v0, v1) = (Vector3::x(), Vector3::new(0.0, 2.0, 0.0));
        let P = |m0: f64| v0 * m0 + v1 * (476.0 - m0);
        assert!((mass_coefficient(&v0, &v1) - (P(401.0) - P(400.0))).norm() < 1.0e-12);
    }
}
