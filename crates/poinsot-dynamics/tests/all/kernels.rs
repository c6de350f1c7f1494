//! Momentum kernels against Pinocchio, MuJoCo and momentum by definition, on the 1,000 recorded trees.

use crate::setup;

use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, UnitQuaternion, Vector3, Vector6};
use poinsot_testkit::momentum_sum::*;
use poinsot_testkit::trees::{TreeCase, load_trees};

const TOLERANCE: f64 = 1e-12;

/// A recorded tree as a `Tree`, at its recorded state.
struct Ready {
    case: TreeCase,
    tree: Tree,
    parameters: Vec<InertialParameters>,
    kinematics: Kinematics,
    /// Sums of term magnitudes: linear, angular about the base origin.
    scale: [f64; 2],
}

fn ready(case: TreeCase, wheels: &[KitWheel]) -> Ready {
    let model = setup::model(&case.bodies, wheels);
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
    let scale = scale(&case);
    Ready {
        case,
        tree,
        parameters,
        kinematics,
        scale,
    }
}

fn scale(case: &TreeCase) -> [f64; 2] {
    let mut scale = [0.0; 2];
    for (i, body) in case.bodies.iter().enumerate() {
        let m = body_motion(&case.bodies, &case.state, i);
        let arm = (m.p_NCcm_N - case.state.p_NBo_N).norm();
        scale[0] += body.mass * m.v_NCcm_N.norm();
        scale[1] += body.mass * arm * m.v_NCcm_N.norm() + body.I_CCcm_C.norm() * m.w_NC_N.norm();
    }
    scale
}

/// Largest relative difference of the linear and angular part, each with its own scale.
fn apart(a: &Vector6, b: &Vector6, scale: [f64; 2]) -> f64 {
    let d = a - b;
    let l = d.fixed_rows::<3>(0).norm() / scale[0];
    let h = d.fixed_rows::<3>(3).norm() / scale[1];
    if l.is_nan() || h.is_nan() {
        f64::INFINITY
    } else {
        l.max(h)
    }
}

fn over_trees(what: &str, mut difference: impl FnMut(&Ready) -> f64) {
    let mut worst = 0.0_f64;
    for (i, case) in load_trees().unwrap().into_iter().enumerate() {
        let found = difference(&ready(case, &[]));
        assert!(found < TOLERANCE, "{what}, tree {i}: {found:e}");
        worst = worst.max(found);
    }
    println!("{what}: {worst:e}");
}

fn regressor_momentum(ready: &Ready) -> Vector6 {
    let mut Y = vec![[0.0; 6]; 10 * ready.parameters.len()];
    momentum_regressor(&ready.kinematics, &mut Y);
    let pi = ready.parameters.iter().flat_map(|p| p.to_array());
    Y.iter()
        .zip(pi)
        .map(|(column, p)| Vector6::from(*column) * p)
        .sum()
}

#[test]
fn xval_pinocchio_momentum() {
    over_trees("momentum", |r| {
        let ours = momentum(&r.parameters, &r.kinematics);
        apart(&ours, &r.case.pinocchio.momentum_about_base(), r.scale)
    });
}

#[test]
fn xval_pinocchio_regressor_times_parameters() {
    over_trees("regressor", |r| {
        let theirs = r.case.pinocchio.momentum_about_base();
        apart(&regressor_momentum(r), &theirs, r.scale)
    });
}

#[test]
fn xval_pinocchio_locked_inertia() {
    over_trees("locked inertia", |r| {
        let ours = composite(&r.parameters, &r.kinematics).locked_inertia();
        let theirs = r.case.pinocchio.locked_inertia();
        // Blocks of different units, each relative to its own size.
        let blocks = [(0, 0), (0, 3), (3, 0), (3, 3)].map(|at| {
            let theirs = theirs.fixed_view::<3, 3>(at.0, at.1);
            (ours.fixed_view::<3, 3>(at.0, at.1) - theirs).norm() / theirs.norm().max(1e-300)
        });
        blocks.into_iter().fold(0.0, f64::max)
    });
}

#[test]
fn xval_mujoco_momentum_and_mass_centre() {
    over_trees("momentum about the mass centre", |r| {
        let m = momentum(&r.parameters, &r.kinematics);
        let l = Vector3::new(m[0], m[1], m[2]);
        let h = Vector3::new(m[3], m[4], m[5]);
        let whole = composite(&r.parameters, &r.kinematics);
        let c = whole.p_BoScm_B();
        let theirs = &r.case.mujoco;
        let R = r.case.state.R_NB;
        let dl = (R * l - Vector3::from(theirs.l)).norm() / r.scale[0];
        let scale_h = r.scale[1] + c.norm() * r.scale[0];
        let dh = (R * (h - c.cross(&l)) - Vector3::from(theirs.h_com)).norm() / scale_h;
        let com = r.case.state.p_NBo_N + R * c;
        let dc = (com - Vector3::from(theirs.com)).norm() / (1.0 + com.norm());
        let dm = (whole.mass - theirs.mass).abs() / theirs.mass;
        [dl, dh, dc, dm].into_iter().fold(0.0, f64::max)
    });
}

#[test]
fn exact_momentum_equals_definition_with_wheels() {
    let cases = load_trees().unwrap().into_iter().step_by(7);
    for (i, mut case) in cases.enumerate() {
        let last = case.bodies.len() - 1;
        let wheels = [
            wheel(0, [1.0, 0.0, 0.0], 0.3),
            wheel(last, [2.0, -1.0, 2.0], 0.04),
            wheel(last / 2, [0.0, 3.0, -4.0], 1.7),
        ];
        case.state.wheel_speeds = vec![120.0, -300.0, 4.0];
        let expected = momentum_about_base(&case.bodies, &wheels, &case.state);
        let r = ready(case, &wheels);
        let js: Vec<f64> = wheels.iter().map(|w| w.spin_inertia).collect();
        let speed = &r.case.state.wheel_speeds;
        let h_w = wheel_momentum(&r.tree, &r.kinematics, &js, speed);
        let wheel_part = Vector6::new(0.0, 0.0, 0.0, h_w.x, h_w.y, h_w.z);
        let scale = [r.scale[0], r.scale[1] + 60.0];
        let ours = momentum(&r.parameters, &r.kinematics) + wheel_part;
        let found = apart(&ours, &expected, scale);
        assert!(found < TOLERANCE, "tree {i}: {found:e}");

        let mut columns = [[0.0; 6]; 3];
        wheel_regressor(&r.tree, &r.kinematics, speed, &mut columns);
        let linear: Vector6 = columns
            .iter()
            .zip(&js)
            .map(|(c, js)| Vector6::from(*c) * *js)
            .sum();
        assert!((linear - wheel_part).norm() < 1e-13 * 60.0, "tree {i}");
    }
}

#[test]
fn exact_twist_from_momentum_is_the_inverse() {
    for (i, case) in load_trees().unwrap().into_iter().enumerate().step_by(3) {
        let mut r = ready(case, &[]);
        let s = r.case.state.clone();
        let whole = momentum(&r.parameters, &r.kinematics);
        let zero = Vector3::zeros();
        r.kinematics.set_velocities(&r.tree, &zero, &zero, &s.qd);
        let joints = momentum(&r.parameters, &r.kinematics);
        let half = |m: &Vector6, at| m.fixed_rows::<3>(at).into_owned();
        let h = composite(&r.parameters, &r.kinematics);
        let twist = twist_from_momentum(
            &h,
            &half(&whole, 0),
            &half(&whole, 3),
            &half(&joints, 0),
            &half(&joints, 3),
        )
        .unwrap();
        // Round-off grows with the condition number of the composite and the offset of its mass centre.
        let moments = h.I_SScm_B().symmetric_eigenvalues();
        let amplify = (h.I_BBo_B.norm() / moments.min()).max(1.0);
        let speed = 1.0 + s.v_NBo_B.norm() + s.w_NB_B.norm();
        let tolerance = TOLERANCE * amplify * speed;
        assert!((twist.w - s.w_NB_B).norm() < tolerance, "tree {i}");
        assert!((twist.v - s.v_NBo_B).norm() < 10.0 * tolerance, "tree {i}");
    }
}

#[test]
fn unit_shift_to_body() {
    let R = UnitQuaternion::from_euler_angles(0.3, -1.1, 2.0);
    let p = Vector3::new(3.0, -7.0, 0.5);
    let (l, h) = (Vector3::new(1.0, 2.0, -3.0), Vector3::new(0.4, 0.1, 9.0));
    let P = R * l;
    let H = R * h + p.cross(&P);
    let (l2, h2) = shift_to_body(&R, &p, &P, &H);
    assert!((l - l2).norm() + (h - h2).norm() < 1e-13);
}

fn wheel(host: usize, axis: [f64; 3], spin_inertia: f64) -> KitWheel {
    KitWheel {
        host,
        axis_C: Vector3::from(axis).normalize(),
        spin_inertia,
    }
}

/// Momentum with wheels, and first moment, for one set of joint positions.
fn moved(r: &Ready, kinematics: &mut Kinematics, q: &[f64], rates: &[f64]) -> (Vector6, Vector3) {
    let s = &r.case.state;
    kinematics.place(&r.tree, q);
    kinematics.set_velocities(&r.tree, &s.v_NBo_B, &s.w_NB_B, rates);
    let h = wheel_momentum(&r.tree, kinematics, &[0.04], &[-300.0]);
    let all = momentum(&r.parameters, kinematics);
    let whole = composite(&r.parameters, kinematics);
    (all + Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z), whole.mc_B)
}

#[test]
fn exact_joint_slopes_are_differences_of_the_momentum() {
    let mut slopes = JointSlopes::default();
    for (i, case) in load_trees().unwrap().into_iter().enumerate().step_by(11) {
        let last = case.bodies.len() - 1;
        let r = ready(case, &[wheel(last, [2.0, -1.0, 2.0], 0.04)]);
        let s = &r.case.state;
        slopes.fill(&r.tree, &r.parameters, &r.kinematics, &[0.04], &[-300.0]);
        let mut kinematics = r.kinematics.clone();
        let step = 1.0e-5;
        for (k, slope) in slopes.of.iter().enumerate() {
            let mut at = |dq: f64, dr: f64| {
                let (mut q, mut rates) = (s.q.clone(), s.qd.clone());
                q[k] += dq;
                rates[k] += dr;
                moved(&r, &mut kinematics, &q, &rates)
            };
            let (further, back) = (at(step, 0.0), at(-step, 0.0));
            let (faster, slower) = (at(0.0, step), at(0.0, -step));
            let (half, scale) = (0.5 / step, [r.scale[0], r.scale[1] + 12.0]);
            // Measured: 1e-8 of the momentum, the error of the finite differences.
            let close = |a: &Vector6, b: &Vector6| apart(a, b, scale) < 1.0e-6;
            assert!(
                close(&slope.position, &((further.0 - back.0) * half)),
                "tree {i}, joint {k}"
            );
            assert!(
                close(&slope.rate, &((faster.0 - slower.0) * half)),
                "tree {i}, joint {k}"
            );
            let mc = (further.1 - back.1) * half;
            assert!(
                (slope.first_moment - mc).norm() < 1.0e-6 * (1.0 + mc.norm()),
                "tree {i}"
            );
        }
    }
}
