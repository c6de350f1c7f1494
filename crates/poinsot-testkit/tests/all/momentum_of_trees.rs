//! Momentum by definition against Pinocchio and MuJoCo on the recorded trees.

use poinsot_testkit::Vector3;
use poinsot_testkit::compare::{apart, scalars_apart};
use poinsot_testkit::momentum_sum::{
    angular_momentum_about, kinetic_energy, locked_inertia, momentum_about_base, system_momentum,
};
use poinsot_testkit::trees::{TreeCase, load_trees};

const TOLERANCE: f64 = 1e-12;

/// The largest difference over all trees is below [`TOLERANCE`].
fn all_trees_agree<const N: usize>(names: [&str; N], differences: impl Fn(&TreeCase) -> [f64; N]) {
    let trees = load_trees().unwrap();
    assert_eq!(trees.len(), 1000);
    let mut worst = [0.0_f64; N];
    for tree in &trees {
        for (w, d) in worst.iter_mut().zip(differences(tree)) {
            *w = w.max(d);
        }
    }
    for (name, w) in names.iter().zip(worst) {
        println!("{name}: {w:.1e}");
        assert!(w < TOLERANCE, "{name}: {w:e}");
    }
}

fn engine_apart(
    tree: &TreeCase,
    mass: f64,
    com: [f64; 3],
    l: [f64; 3],
    h_com: [f64; 3],
    energy: f64,
) -> [f64; 5] {
    let s = system_momentum(&tree.bodies, &[], &tree.state).unwrap();
    [
        scalars_apart(s.mass, mass, mass),
        apart(&s.p_NScm_N, &Vector3::from(com), s.scale_p),
        apart(&s.l_S_N, &Vector3::from(l), s.scale_l),
        apart(&s.h_SScm_N, &Vector3::from(h_com), s.scale_h),
        scalars_apart(
            kinetic_energy(&tree.bodies, &[], &tree.state),
            energy,
            energy,
        ),
    ]
}

const NAMES: [&str; 5] = ["mass", "mass centre", "linear", "angular", "energy"];

#[test]
fn xval_pinocchio_momentum_of_1000_trees() {
    all_trees_agree(NAMES, |tree| {
        let p = &tree.pinocchio;
        engine_apart(tree, p.mass, p.com, p.l, p.h_com, p.kinetic_energy)
    });
}

#[test]
fn xval_mujoco_momentum_of_1000_trees() {
    all_trees_agree(NAMES, |tree| {
        let m = &tree.mujoco;
        engine_apart(tree, m.mass, m.com, m.l, m.h_com, m.kinetic_energy)
    });
}

#[test]
fn xval_pinocchio_locked_inertia_and_momentum_about_the_base() {
    all_trees_agree(["locked inertia", "momentum"], |tree| {
        let H = tree.pinocchio.locked_inertia();
        let momentum = tree.pinocchio.momentum_about_base();
        let own = momentum_about_base(&tree.bodies, &[], &tree.state);
        let s = system_momentum(&tree.bodies, &[], &tree.state).unwrap();
        let arm = (s.p_NScm_N - tree.state.p_NBo_N).norm();
        [
            apart(&locked_inertia(&tree.bodies, &tree.state), &H, H.norm()),
            apart(&own, &momentum, s.scale_l * (1.0 + arm) + s.scale_h),
        ]
    });
}

#[test]
fn exact_angular_momentum_moves_with_its_point() {
    all_trees_agree(["shift of the point"], |tree| {
        let s = system_momentum(&tree.bodies, &[], &tree.state).unwrap();
        let P = Vector3::new(0.3, -2.0, 1.1);
        let about = angular_momentum_about(&tree.bodies, &[], &tree.state, &P);
        let arm = s.p_NScm_N - P;
        let shifted = s.h_SScm_N + arm.cross(&s.l_S_N);
        [apart(&about, &shifted, s.scale_h + arm.norm() * s.scale_l)]
    });
}
