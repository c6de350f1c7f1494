//! Jacobians of a point of the tree, among them the generalised Jacobian of a free-floating robot (Umetani and
//! Yoshida 1989; Xu et al. 2017, (7)-(10), (15)), in base axes.
//!
//! ```text
//! [v_E; w_E] = J_b [v; w] + J_m q'                 J_b = [[1, -[p_BoE]x], [0, 1]]
//! [v_E; w_E] = (J_m - J_b H_b^-1 H_bm) q'          without momentum
//! ```

use crate::kinematics::Kinematics;
use crate::mass_matrix::MassMatrix;
use crate::tree::{Motion, Tree};
use poinsot_spatial::{Matrix6, Vector3, Vector6, skew};

/// Position from `Bo`, in base axes, m, of the point E of body `i` that lies at `p_CoE_C` in that body.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// kinematics.place(&tree, &[std::f64::consts::FRAC_PI_2]);
/// // The arm points along y.
/// let p_BoE_B = point_of_body(&kinematics, 1, &Vector3::x());
/// assert!((p_BoE_B - Vector3::new(1.0, 1.0, 0.0)).norm() < 1.0e-15);
/// ```
pub fn point_of_body(kinematics: &Kinematics, i: usize, p_CoE_C: &Vector3) -> Vector3 {
    kinematics.p[i] + kinematics.R[i] * p_CoE_C
}

/// `J_b`: twist of a point at `p_BoE_B` per unit base twist (Xu et al. 2017, (8), (10)).
///
/// ```
/// use poinsot_dynamics::base_jacobian;
/// use poinsot_spatial::{Vector3, Vector6};
///
/// // A base that turns about z moves a point 2 m along x in the direction y.
/// let turn = Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0);
/// let twist = base_jacobian(&(Vector3::x() * 2.0)) * turn;
/// assert_eq!(twist, Vector6::new(0.0, 2.0, 0.0, 0.0, 0.0, 1.0));
/// ```
pub fn base_jacobian(p_BoE_B: &Vector3) -> Matrix6 {
    let mut J_b = Matrix6::identity();
    J_b.fixed_view_mut::<3, 3>(0, 3).copy_from(&-skew(p_BoE_B));
    J_b
}

/// Fills `J_m`: twist `[v; w]` of a point E of body `i` at `p_BoE_B` per unit rate of each joint coordinate, the
/// base at rest (Xu et al. 2017, (9)). Joints that do not carry the body get zero.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let p_BoE_B = point_of_body(&kinematics, 1, &Vector3::x());
/// let mut J_m = [Vector6::zeros()];
/// joint_jacobian(&tree, &kinematics, 1, &p_BoE_B, &mut J_m);
/// // The end of the arm is 1 m from the hinge.
/// assert_eq!(J_m[0], Vector6::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
/// ```
pub fn joint_jacobian(
    tree: &Tree,
    kinematics: &Kinematics,
    i: usize,
    p_BoE_B: &Vector3,
    J_m: &mut [Vector6],
) {
    J_m.fill(Vector6::zeros());
    let mut at = i;
    while at > 0 {
        let link = &tree.links[at];
        let axis = link.axis_B(&kinematics.R[at]);
        match link.motion {
            Motion::Revolute(k) => {
                let v = axis.cross(&(p_BoE_B - kinematics.p[at]));
                J_m[k] = Vector6::new(v.x, v.y, v.z, axis.x, axis.y, axis.z);
            }
            Motion::Prismatic(k) => {
                J_m[k] = Vector6::new(axis.x, axis.y, axis.z, 0.0, 0.0, 0.0);
            }
            Motion::Fixed | Motion::Free => {}
        }
        at = link.parent;
    }
}

/// Turns the `J_m` of a point at `p_BoE_B` into the generalised Jacobian `J_m - J_b H_b^-1 H_bm`: twist per unit
/// joint rate while the whole has no momentum. `None` where `H_b` is singular.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let mut mass_matrix = MassMatrix::new(&tree);
/// mass_matrix.set(&tree, &bodies, &kinematics);
/// let p_BoE_B = point_of_body(&kinematics, 1, &Vector3::x());
/// let mut J_m = [Vector6::zeros()];
/// joint_jacobian(&tree, &kinematics, 1, &p_BoE_B, &mut J_m);
/// generalise_jacobian(&mass_matrix, &p_BoE_B, &mut J_m).unwrap();
/// // The base turns back by 0.44 rad/s, so the arm turns by 0.56 rad/s in N.
/// assert!((J_m[0][5] - 0.56).abs() < 1.0e-12);
/// ```
pub fn generalise_jacobian(
    mass_matrix: &MassMatrix,
    p_BoE_B: &Vector3,
    J_m: &mut [Vector6],
) -> Option<()> {
    let factor = mass_matrix.H_b.cholesky()?;
    let J_b = base_jacobian(p_BoE_B);
    for (J, H_bm) in J_m.iter_mut().zip(&mass_matrix.H_bm) {
        *J -= J_b * factor.solve(H_bm);
    }
    Some(())
}
