//! Forward and inverse dynamics, mass matrix and Jacobians against Pinocchio and MuJoCo on 1,000 random trees.

use crate::setup;
use crate::tree_dynamics::{TreeDynamics, load_tree_dynamics};

use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, Vector3, Vector6};
use poinsot_testkit::trees::TreeCase;

/// Relative to the largest component. The two references differ by 4e-12 in the worst acceleration (median 3e-15), and
/// by 8e-15 elsewhere.
const TOLERANCE: f64 = 1e-11;

struct Ready {
    case: TreeCase,
    asked: TreeDynamics,
    tree: Tree,
    parameters: Vec<InertialParameters>,
    kinematics: Kinematics,
}

fn over_trees(what: &str, mut difference: impl FnMut(&Ready) -> f64) {
    let (mut worst, mut count) = (0.0_f64, 0);
    for (i, (case, asked)) in load_tree_dynamics().unwrap().into_iter().enumerate() {
        let model = setup::model(&case.bodies, &[]);
        let tree = Tree::new(&model);
        let parameters = model
            .bodies
            .iter()
            .map(|b| b.nominal.parameters())
            .collect();
        let mut kinematics = Kinematics::new(&tree);
        let s = &case.state;
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v_NBo_B, &s.w_NB_B, &s.qd);
        let ready = Ready {
            case,
            asked,
            tree,
            parameters,
            kinematics,
        };
        let found = difference(&ready);
        assert!(found < TOLERANCE, "{what}, tree {i}: {found:e}");
        worst = worst.max(found);
        count += 1;
    }
    assert_eq!(count, 1000);
    println!("{what}: {worst:e}");
}

fn apart(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let size = theirs.iter().fold(1e-300, |m: f64, x| m.max(x.abs()));
    let differences = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs() / size);
    // NaN must not count as small.
    differences.fold(
        0.0,
        |m: f64, d| if d.is_nan() { f64::INFINITY } else { m.max(d) },
    )
}

fn vector(x: &[f64]) -> Vector3 {
    Vector3::from_column_slice(&x[..3])
}

fn forward(r: &Ready) -> Vec<f64> {
    let mut dynamics = ForwardDynamics::new(&r.tree);
    let mut joints = vec![0.0; r.tree.dof()];
    let inputs: Vec<_> = r
        .asked
        .force
        .iter()
        .map(|f| JointInput::Force(*f))
        .collect();
    let wrench = &r.asked.wrench_Bo_B;
    dynamics.set_bodies(&r.tree, &r.parameters, &r.kinematics);
    dynamics.add_wrench(0, &vector(wrench), &vector(&wrench[3..]));
    let rates = &r.case.state.qd;
    dynamics
        .solve(&r.tree, &r.kinematics, rates, &inputs, &mut joints)
        .unwrap();
    let (a, alpha) = dynamics.acceleration(0);
    a.iter()
        .chain(alpha.iter())
        .copied()
        .chain(joints)
        .collect()
}

#[test]
fn xval_pinocchio_articulated_body_algorithm() {
    over_trees("aba", |r| {
        apart(&forward(r), &r.asked.pinocchio.acceleration)
    });
}

#[test]
fn xval_mujoco_forward_dynamics() {
    over_trees("mj_forward", |r| {
        apart(&forward(r), &r.asked.mujoco.acceleration)
    });
}

#[test]
fn xval_pinocchio_inverse_dynamics() {
    over_trees("rnea", |r| {
        let mut accelerations = Accelerations::new(&r.tree);
        let given = &r.asked.given;
        accelerations.set_without_base(&r.tree, &r.kinematics, &r.case.state.qd, &given[6..]);
        accelerations.add_base(&r.kinematics, &vector(given), &vector(&given[3..]));
        let mut joints = vec![0.0; r.tree.dof()];
        let base = InverseDynamics::new(&r.tree).solve(
            &r.tree,
            &r.parameters,
            &r.kinematics,
            &accelerations,
            &[],
            &mut joints,
        );
        let base = base.force.iter().chain(base.torque.iter()).copied();
        let ours: Vec<f64> = base.chain(joints).collect();
        apart(&ours, &r.asked.pinocchio.inverse)
    });
}

/// `H_bm q'`: momentum of the joint rates while the base is at rest.
fn of_rates(matrix: &MassMatrix, rates: &[f64]) -> Vector6 {
    let pairs = matrix.H_bm.iter().zip(rates);
    pairs.map(|(h, rate)| h * *rate).sum()
}

#[test]
fn xval_pinocchio_mass_matrix() {
    over_trees("crba", |r| {
        let mut matrix = MassMatrix::new(&r.tree);
        matrix.set(&r.tree, &r.parameters, &r.kinematics);
        let given = &r.asked.given;
        let (base, rates) = (Vector6::from_column_slice(&given[..6]), &given[6..]);
        let upper = matrix.H_b * base + of_rates(&matrix, rates);
        let n = r.tree.dof();
        let lower = (0..n).map(|k| {
            let row = matrix.H_m[k * n..][..n].iter();
            let joints: f64 = row.zip(rates).map(|(h, rate)| h * rate).sum();
            matrix.H_bm[k].dot(&base) + joints
        });
        let ours: Vec<f64> = upper.iter().copied().chain(lower).collect();
        apart(&ours, &r.asked.pinocchio.mass_matrix_times_given)
    });
}

#[test]
fn xval_pinocchio_jacobian_of_the_last_body() {
    over_trees("jacobian", |r| {
        let last = r.tree.bodies() - 1;
        let p = point_of_body(&r.kinematics, last, &Vector3::zeros());
        let mut J_m = vec![Vector6::zeros(); r.tree.dof()];
        joint_jacobian(&r.tree, &r.kinematics, last, &p, &mut J_m);
        let J_b = base_jacobian(&p);
        let s = &r.case.state;
        let (v, w) = (&s.v_NBo_B, &s.w_NB_B);
        let base = Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z);
        let joints: Vector6 = J_m.iter().zip(&s.qd).map(|(j, rate)| j * *rate).sum();
        let twist = J_b * base + joints;
        let load = Vector6::from(r.asked.load_B);
        let upper = J_b.transpose() * load;
        let lower = J_m.iter().map(|j| j.dot(&load));
        let transposed: Vec<f64> = upper.iter().copied().chain(lower).collect();
        apart(twist.as_slice(), &r.asked.pinocchio.tip_twist)
            .max(apart(&transposed, &r.asked.pinocchio.tip_transpose_load))
    });
}

/// With the base twist of zero momentum, the generalised Jacobian gives the twist of the last body. Prescribing the
/// joint accelerations of free joints changes nothing.
#[test]
fn exact_generalised_jacobian_moves_the_tip_without_momentum() {
    for (i, (case, _)) in load_tree_dynamics()
        .unwrap()
        .into_iter()
        .enumerate()
        .step_by(9)
    {
        let model = setup::model(&case.bodies, &[]);
        let tree = Tree::new(&model);
        let parameters: Vec<_> = model
            .bodies
            .iter()
            .map(|b| b.nominal.parameters())
            .collect();
        let rates = &case.state.qd;
        let mut kinematics = Kinematics::at(&tree, &case.state.q);
        let mut matrix = MassMatrix::new(&tree);
        matrix.set(&tree, &parameters, &kinematics);
        let factor = matrix.H_b.cholesky().unwrap();
        let base = -factor.solve(&of_rates(&matrix, rates));
        let base = base.as_slice();
        kinematics.set_velocities(&tree, &vector(base), &vector(&base[3..]), rates);
        let whole = momentum(&parameters, &kinematics);
        let last = tree.bodies() - 1;
        let p = point_of_body(&kinematics, last, &Vector3::new(0.1, -0.2, 0.3));
        let mut J = vec![Vector6::zeros(); tree.dof()];
        joint_jacobian(&tree, &kinematics, last, &p, &mut J);
        generalise_jacobian(&matrix, &p, &mut J).unwrap();
        let found: Vector6 = J.iter().zip(rates).map(|(j, rate)| j * *rate).sum();
        let v = kinematics.v[last] + kinematics.w[last].cross(&(p - kinematics.p[last]));
        let size = 1.0 + v.norm();
        assert!(
            (vector(found.as_slice()) - v).norm() < 1e-11 * size,
            "tree {i}"
        );
        let w = &found.as_slice()[3..];
        assert!(
            (vector(w) - kinematics.w[last]).norm() < 1e-11 * size,
            "tree {i}"
        );
        let terms: f64 = parameters.iter().map(|p| p.I_BBo_B.norm() + p.mass).sum();
        assert!(
            whole.norm() < 1e-11 * terms * size,
            "tree {i}: {}",
            whole.norm()
        );
    }
}

#[test]
fn exact_prescribed_joints_move_like_those_that_a_force_drives_there() {
    for (i, (case, asked)) in load_tree_dynamics()
        .unwrap()
        .into_iter()
        .enumerate()
        .step_by(7)
    {
        let model = setup::model(&case.bodies, &[]);
        let tree = Tree::new(&model);
        let parameters: Vec<_> = model
            .bodies
            .iter()
            .map(|b| b.nominal.parameters())
            .collect();
        let s = &case.state;
        let mut kinematics = Kinematics::at(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v_NBo_B, &s.w_NB_B, &s.qd);
        let mut dynamics = ForwardDynamics::new(&tree);
        let mut found = vec![0.0; tree.dof()];
        dynamics.set_bodies(&tree, &parameters, &kinematics);
        let wrench = &asked.wrench_Bo_B;
        dynamics.add_wrench(0, &vector(wrench), &vector(&wrench[3..]));
        let answer = &asked.pinocchio.acceleration;
        // Every second joint is prescribed to move as under the recorded forces.
        let inputs: Vec<_> = asked
            .force
            .iter()
            .zip(&answer[6..])
            .enumerate()
            .map(|(k, (force, given))| match k % 2 {
                0 => JointInput::Acceleration(*given),
                _ => JointInput::Force(*force),
            })
            .collect();
        dynamics
            .solve(&tree, &kinematics, &s.qd, &inputs, &mut found)
            .unwrap();
        let (a, alpha) = dynamics.acceleration(0);
        let ours: Vec<f64> = a.iter().chain(alpha.iter()).copied().chain(found).collect();
        let difference = apart(&ours, answer);
        assert!(difference < 1e-10, "tree {i}: {difference:e}");
    }
}
