//! The equivalent single body and the two-body steps, by linear solver and swarm.

use super::*;

/// The paper prints 1e-11 to 1e-14 percent.
#[test]
fn exact_single_body_from_accelerations_to_1e_10() {
    let (nominal, table) = own_single_body();
    let data = bound(nominal.clone(), std::slice::from_ref(&table));
    let found = sequence(&data.problem(), Order::Outward, &Solver::default()).unwrap();
    assert_eq!(found.form, Some(Form::Acceleration));
    let e = ask(&nominal, vec![table], "linear").estimate;
    let worst = worst_of_whole(&e, &total());
    println!("linear, accelerations: {worst:.1e}");
    assert!(worst < 1.0e-10, "{worst:e}");
    assert!(
        e.method_report
            .unwrap()
            .note
            .contains("measured accelerations")
    );
}

#[test]
fn exact_swarm_reaches_the_linear_solution_of_the_single_body() {
    let (nominal, table) = own_single_body();
    let data = bound(nominal, &thinned(vec![table], 2));
    let x = particle(&total());
    let mut before = f64::INFINITY;
    for iterations in [100, 400, 1600] {
        let swarm = Swarm {
            iterations,
            seed: 3,
            ..Swarm::default()
        };
        let solver = Solver {
            kind: Kind::Swarm,
            swarm,
            ..Solver::default()
        };
        let found = sequence(&data.problem(), Order::Outward, &solver).unwrap();
        let y = particle(&found.steps[0].found);
        let worst = (0..10)
            .map(|k| ((y[k] - x[k]) / x[k]).abs())
            .fold(0.0, f64::max);
        println!("{iterations} iterations: {worst:.1e}");
        assert!(worst < before);
        before = worst;
    }
    assert!(before < 1.0e-9, "{before:e}");
}

#[test]
fn xval_mujoco_single_body_by_momentum_to_1e_7() {
    let nominal = model("xu2017/model.toml");
    let e = ask(&nominal, runs(&nominal, &["C1"]), "linear").estimate;
    let worst = worst_of_whole(&e, &total());
    println!("linear, momentum: {worst:.1e}");
    assert!(worst < 1.0e-7, "{worst:e}");
    assert_eq!(e.identifiability.determined.len(), 10);
    assert!(e.bodies.iter().all(|b| b.mass.value.is_none()));
}

#[test]
fn xval_mujoco_two_body_runs_in_both_orders_to_1e_7() {
    let nominal = model("xu2017/model.toml");
    for variant in ["linear", "linear-inward"] {
        let e = ask(&nominal, runs(&nominal, &ALL), variant).estimate;
        assert_eq!(e.status, Status::Partial);
        assert_eq!(
            (e.identifiability.rank, e.identifiability.parameters),
            (52, 70)
        );
        assert_eq!(e.identifiability.determined.len(), 52);
        let worst = worst_combination(&e, &truth());
        println!("{variant}: {worst:.1e}");
        assert!(worst < 1.0e-7, "{worst:e}");
        assert!(e.bodies.iter().all(|b| b.mass.value.is_none()));
        // Both orders agree with the certificate, so sigma is not widened.
        assert!(e.identifiability.determined.iter().all(|c| c.sigma > 0.0));
    }
}

/// The swarm as a user calls it: its distance from the linear solution is within its sigma, and the result is
/// reproducible.
#[test]
fn exact_swarm_answers_within_its_sigma() {
    let all = properties(&truth());
    let mut m = model("xu2017/model.toml");
    for (body, properties) in m.bodies.iter_mut().zip(&all).take(6) {
        body.nominal = *properties;
        body.estimate = EstimateSet::default();
    }
    let found = ask(&m, thinned(runs(&m, &["C7"]), 4), "swarm");
    let e = &found.estimate;
    println!("{:?} {:?}", e.status, e.warnings());
    let b = &e.bodies[6];
    let (worst, n) = errors(b, &all[6]);
    println!("{worst:.1e}");
    assert!(n == 10 && e.status == Status::Converged);
    let sigmas =
        |n: &poinsot_identify::Number, x: f64| ((n.value.unwrap() - x) / n.sigma.unwrap()).abs();
    assert!(sigmas(&b.mass, all[6].mass) < 1.0 + 1.0e-6);
    for k in 0..3 {
        assert!(sigmas(&b.com[k], all[6].p_BoBcm_B[k]) < 1.0 + 1.0e-6);
    }
    for (n, at) in b.inertia.iter().zip(poinsot_identify::TENSOR) {
        assert!(sigmas(n, all[6].I_BBcm_B[at]) < 1.0 + 1.0e-6);
    }
    assert_eq!(e.variant.as_deref(), Some("swarm"));
    let again = ask(&m, thinned(runs(&m, &["C7"]), 4), "swarm");
    assert_eq!(again.estimate, *e);
}
