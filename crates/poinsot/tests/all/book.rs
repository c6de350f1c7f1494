//! The snippets of the book, compiled and run as tests.

use crate::shared::shipped;

#[test]
fn exact_book_state() {
    let shipped = shipped();
    // ANCHOR: state
    use poinsot_dynamics::{Kinematics, Tree, composite, momentum, twist_from_momentum};
    use poinsot_model::read_model;
    use poinsot_spatial::Vector3;

    let model = read_model(shipped.join("ma2008/model.toml")).unwrap();
    let tree = Tree::new(&model);
    let bodies: Vec<_> = model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();

    let q = vec![0.3; tree.dof()];
    let rates = vec![0.05; tree.dof()];
    let (v_NBo_B, w_NB_B) = (
        Vector3::new(0.01, -0.02, 0.03),
        Vector3::new(0.04, 0.05, -0.06),
    );
    let mut kinematics = Kinematics::at(&tree, &q);

    // Momentum of the joint motion with the base at rest: c(q, q').
    kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::zeros(), &rates);
    let c = momentum(&bodies, &kinematics);

    // The momentum [l; h] of the whole motion, and the twist of the base back from it.
    kinematics.set_velocities(&tree, &v_NBo_B, &w_NB_B, &rates);
    let lh = momentum(&bodies, &kinematics);
    let part = |x: &poinsot_spatial::Vector6, at| Vector3::new(x[at], x[at + 1], x[at + 2]);
    let whole = composite(&bodies, &kinematics);
    let twist = twist_from_momentum(
        &whole,
        &part(&lh, 0),
        &part(&lh, 3),
        &part(&c, 0),
        &part(&c, 3),
    )
    .unwrap();

    assert!((twist.v - v_NBo_B).norm() < 1e-14);
    assert!((twist.w - w_NB_B).norm() < 1e-14);
    // ANCHOR_END: state
}

#[test]
fn exact_book_regressor() {
    let shipped = shipped();
    // ANCHOR: regressor
    use poinsot_dynamics::{Kinematics, Tree, momentum, momentum_regressor};
    use poinsot_model::read_model;
    use poinsot_spatial::{Vector3, Vector6};

    let model = read_model(shipped.join("xu2017/model.toml")).unwrap();
    let tree = Tree::new(&model);
    let bodies: Vec<_> = model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();

    let mut kinematics = Kinematics::new(&tree);
    let q: Vec<f64> = (0..tree.dof()).map(|k| 0.2 * k as f64 - 0.5).collect();
    let rates: Vec<f64> = q.iter().map(|x| 0.1 - x).collect();
    kinematics.place(&tree, &q);
    kinematics.set_velocities(
        &tree,
        &Vector3::new(0.1, 0.2, -0.1),
        &Vector3::new(0.03, -0.01, 0.02),
        &rates,
    );

    let mut Y = vec![[0.0; 6]; 10 * tree.bodies()];
    momentum_regressor(&kinematics, &mut Y);
    let by_regressor: Vector6 = Y
        .iter()
        .zip(bodies.iter().flat_map(|b| b.to_array()))
        .map(|(column, parameter)| Vector6::from(*column) * parameter)
        .sum();

    let direct = momentum(&bodies, &kinematics);
    assert!((by_regressor - direct).norm() < 1e-12 * direct.norm());
    // ANCHOR_END: regressor
}

#[test]
fn stat_book_identify() {
    let shipped = shipped();
    // ANCHOR: identify
    use poinsot::{IdentifyRequest, identify};
    use poinsot_identify::Status;

    let identified = identify(&IdentifyRequest::new(
        shipped.join("stsat3/model.toml"),
        [shipped.join("stsat3/multiaxis/telemetry_noisy.csv")],
    ))
    .unwrap();

    assert_eq!(identified.estimate.status, Status::Converged);
    let spacecraft = &identified.estimate.bodies[0];
    let I_xx = spacecraft.inertia[0];
    // The truth of this simulation is 13.916 kg m2.
    assert!((I_xx.value.unwrap() - 13.916).abs() < 4.0 * I_xx.sigma.unwrap());
    // ANCHOR_END: identify
}

#[test]
fn stat_book_information() {
    let shipped = shipped();
    // ANCHOR: information
    use poinsot::predict::predict;

    let rank = |case: &str| {
        let prediction = predict(&shipped.join("cases").join(case), 1.0).unwrap();
        prediction.bound.identifiability.rank
    };
    // One slew about one axis determines three of the six inertia numbers, three slews determine all.
    assert_eq!(rank("stsat3_kim2010.toml"), 3);
    assert_eq!(rank("stsat3_three_slews.toml"), 6);
    // ANCHOR_END: information
}
