//! Files: MuJoCo's runs, shipped cases, names on the command line.

use super::*;
use poinsot_papers::Named;

#[test]
fn xval_mujoco_runs_give_the_truth() {
    let truth = table1().bodies[0].nominal;
    for run in ["traj1", "traj2", "traj2b", "traj1_wrist"] {
        let folder = shipped().join("ma2008");
        for variant in [Variant::UnknownMomentum, Variant::KnownMomentum] {
            let mut model = read_model(folder.join("model.toml")).unwrap();
            let options = read_options(&model, &model.telemetry, false, false);
            let file = folder.join(run).join("telemetry.parquet");
            let tables = vec![read(&[file], &options).unwrap()];
            if variant == Variant::KnownMomentum {
                let k = start_momentum(run);
                model.momentum.linear = MomentumKnowledge::Known(k.p_C_N);
                model.momentum.angular = MomentumKnowledge::Known(k.h_C_N);
            }
            let found = identify_tables(model, tables, &request(variant)).unwrap();
            let e = &found.estimate;
            assert_eq!(
                e.status,
                Status::Converged,
                "{run} {variant:?} {:?}",
                e.warnings()
            );
            let base = &e.bodies[0];
            assert!(
                (base.mass.value.unwrap() / truth.mass - 1.0).abs() < 1.0e-9,
                "{run} {:?}",
                base.mass
            );
            for k in 0..3 {
                assert!(base.com[k].value.unwrap().abs() < 1.0e-9, "{run}");
            }
            for (k, e) in poinsot_identify::TENSOR.iter().enumerate() {
                let gap = base.inertia[k].value.unwrap() - truth.I_BBcm_B[*e];
                assert!(
                    gap.abs() < 1.0e-9 * 166.67,
                    "{run} {variant:?} {k}: {gap:e}"
                );
            }
        }
    }
}

/// Momentum at the first sample of a recorded run, from its stated initial state and the true model.
fn start_momentum(run: &str) -> Known {
    let text =
        std::fs::read_to_string(shipped().join("ma2008").join(run).join("truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
    let three = |key: &str| -> Vector3 {
        let v = &truth["source"]["initial"][key];
        Vector3::from_fn(|k, _| v[k].as_f64().unwrap())
    };
    let model = table1();
    let raw = ma2008::Raw {
        R_NB: UnitQuaternion::identity(),
        v_NBo_N: three("v_inertial_m_s"),
        w_NB_B: three("omega_body_rad_s"),
        q: vec![0.0; 6],
        rates: vec![0.0; 6],
        wheel_speed: Vec::new(),
    };
    let (bodies, state) = kit(&model, &raw, raw.v_NBo_N);
    let mass: f64 = bodies.iter().map(|b| b.mass).sum();
    let centre: Vector3 = (0..bodies.len())
        .map(|i| bodies[i].mass * body_motion(&bodies, &state, i).p_NCcm_N)
        .sum::<Vector3>()
        / mass;
    Known {
        p_C_N: linear_momentum(&bodies, &state),
        h_C_N: angular_momentum_about(&bodies, &[], &state, &centre),
    }
}

fn request(variant: Variant) -> Question {
    Question {
        variant: Some(variant.name().to_owned()),
        ..Question::by("ma2008")
    }
}

#[test]
fn cli_method_and_variant_names() {
    let folder = shipped().join("ma2008");
    let request = |method: &str, variant: Option<&str>| {
        let telemetry = [folder.join("traj1/telemetry.parquet")];
        let mut request = IdentifyRequest::new(folder.join("model.toml"), telemetry).by(method);
        request.question.variant = variant.map(str::to_owned);
        request
    };
    let found = identify(&request("ma2008", None)).unwrap();
    assert_eq!(found.estimate.variant.as_deref(), Some("unknown-momentum"));
    assert!(
        found
            .estimate
            .method_report
            .unwrap()
            .numbers
            .iter()
            .any(|n| n.name.contains("(35)") && n.value.is_some())
    );
    for (method, variant, told) in [
        (
            "ma2008",
            Some("option1"),
            "unknown-momentum, known-momentum",
        ),
        ("linear", Some("known-momentum"), "no variants"),
        ("ma2009", None, "ma2008"),
        ("ma2008", Some("known-momentum"), "E0524"),
    ] {
        let error = identify(&request(method, variant))
            .err()
            .unwrap()
            .to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn prop_two_segments_share_the_base() {
    let first = flown(1, [0.0, 0.0, 5.0]).with_base(unsymmetric());
    let second = flown(2, [0.0, 1.0, 5.0]).with_base(unsymmetric());
    let data = vec![
        readings(&first.model, &first.run().unwrap().raws),
        readings(&second.model, &second.run().unwrap().raws),
    ];
    assert!(error(&two_step(&data, None), &unsymmetric()) < 1.0e-9);
}

/// Every shipped case with ideal sensors: the identification gives the true values.
#[test]
fn exact_shipped_cases_give_the_truth() {
    let folder = shipped().join("ma2008");
    let mut count = 0;
    for entry in std::fs::read_dir(folder.join("cases")).unwrap() {
        let path = entry.unwrap().path();
        let case = read_case(&path).unwrap();
        let mut truth = read_model(&case.model).unwrap();
        truth.sensors.clear();
        let table = simulate_case(&case, &truth).unwrap().table;
        let model = read_model(folder.join("model.toml")).unwrap();
        let asked = request(Variant::UnknownMomentum);
        let found = identify_tables(model, vec![table], &asked).unwrap();
        let e = &found.estimate;
        let orbital = path.to_string_lossy().contains("orbital");
        // With 7500 m/s, the relevant 0.02 m/s have five digits less.
        let limit = if orbital { 1.0e-7 } else { 1.0e-9 };
        assert_eq!(e.status, Status::Converged, "{path:?}");
        let mass = e.bodies[0].mass.value.unwrap();
        assert!((mass / 1000.0 - 1.0).abs() < limit, "{path:?}: {mass}");
        for (number, (i, j)) in e.bodies[0].inertia.iter().zip(poinsot_identify::TENSOR) {
            let t = if i == j { 166.67 } else { 0.0 };
            assert!(
                (number.value.unwrap() - t).abs() < limit * 166.67,
                "{path:?} {number:?}"
            );
        }
        count += 1;
    }
    assert_eq!(count, 8);
}
