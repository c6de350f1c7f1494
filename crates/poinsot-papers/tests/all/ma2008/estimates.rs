//! Stated sigmas, undetermined numbers, refusals.

use super::*;

const RATE: f64 = 2.0e-5;
const VELOCITY: f64 = 2.0e-5;
const ATTITUDE: f64 = 5.0e-5;
const JOINT_RATE: f64 = 2.0e-5;

/// The stated sigma equals the scatter: chi-square of the ten numbers over 300 trials, both options.
#[test]
fn stat_sigmas_are_calibrated() {
    let e = flown(1, [1.0, 2.0, 5.0])
        .with_base(unsymmetric())
        .sampled(30, false);
    let run = e.run().unwrap();
    let known = run.known;
    let truth = e.truth();
    for variant in [Variant::KnownMomentum, Variant::UnknownMomentum] {
        let mut model = e.model.clone();
        if variant == Variant::KnownMomentum {
            model.momentum.linear = MomentumKnowledge::Known(known.p_C_N);
            model.momentum.angular = MomentumKnowledge::Known(known.h_C_N);
        }
        let (mut square, mut momentum, mut chi2, trials) = ([0.0; 10], [0.0; 6], 0.0, 300);
        for trial in 0..trials {
            let mut rng = ChaCha8Rng::seed_from_u64(trial);
            let moved: Vec<_> = run
                .raws
                .iter()
                .map(|r| {
                    let mut r = r.clone();
                    r.w_NB_B += vector(&mut rng) * RATE;
                    r.v_NBo_N += vector(&mut rng) * VELOCITY;
                    r.R_NB *= UnitQuaternion::from_scaled_axis(vector(&mut rng) * ATTITUDE);
                    r.rates
                        .iter_mut()
                        .for_each(|q| *q += normal(&mut rng) * JOINT_RATE);
                    r
                })
                .collect();
            let moved = Run {
                raws: moved,
                ..run.clone()
            };
            let answer = ask(&model, &moved, variant, 1.0).unwrap();
            assert_eq!(answer.status, Status::Converged);
            chi2 += answer.fit[0].chi2_per_dof / trials as f64;
            let b = &answer.bodies[0];
            let numbers = std::iter::once(&b.mass).chain(&b.com).chain(&b.inertia);
            let inertia = poinsot_identify::TENSOR.map(|e| truth.I_BBcm_B[e]);
            let c = truth.p_BoBcm_B;
            let true_values = [truth.mass, c.x, c.y, c.z].into_iter().chain(inertia);
            for (k, (n, t)) in numbers.zip(true_values).enumerate() {
                square[k] += ((n.value.unwrap() - t) / n.sigma.unwrap()).powi(2) / trials as f64;
            }
            let m = &answer.momentum[0];
            for k in 0..3 {
                for (slot, n, t) in [
                    (k, m.linear[k], known.p_C_N[k]),
                    (3 + k, m.angular[k], known.h_C_N[k]),
                ] {
                    let z = (n.value.unwrap() - t) / n.sigma.unwrap().max(1.0e-12);
                    momentum[slot] += z * z / trials as f64;
                }
            }
        }
        println!(
            "{variant:?}: mean squared normalised error {square:.2?}, momentum {momentum:.2?}, chi2 {chi2:.3}"
        );
        // 300 trials: the mean square of a normal has sigma 0.08.
        for z2 in square {
            assert!((0.65..1.4).contains(&z2), "{variant:?} {square:?}");
        }
        if variant == Variant::UnknownMomentum {
            assert!(
                momentum.iter().all(|z2| (0.65..1.4).contains(z2)),
                "{momentum:?}"
            );
        }
        assert!((0.85..1.15).contains(&chi2), "{chi2}");
    }
}

#[test]
fn prop_what_motion_does_not_show_is_open() {
    // No motion.
    let still = flown(1, [0.0; 3]);
    let run = still.run().unwrap();
    let rest = Run {
        raws: vec![run.raws[0].clone(); 12],
        positions: vec![run.positions[0]; 12],
        ..run.clone()
    };
    let answer = ask(&still.model, &rest, Variant::UnknownMomentum, 0.0).unwrap();
    assert_eq!(answer.status, Status::NotIdentifiable);
    assert!(answer.bodies[0].mass.value.is_none());
    assert_eq!(answer.identifiability.rank, 0);
    assert!(!answer.identifiability.open.is_empty());
    // At zero momentum with stopped arm there is no motion either.
    let known = run.known;
    assert!(run.raws.iter().all(|r| r.w_NB_B.norm() < 1.0e-12));
    let mut model = still.model.clone();
    model.momentum.linear = MomentumKnowledge::Known(known.p_C_N);
    model.momentum.angular = MomentumKnowledge::Known(known.h_C_N);
    let answer = ask(&model, &run, Variant::KnownMomentum, 0.0).unwrap();
    assert_eq!(answer.status, Status::NotIdentifiable);
    // Known linear momentum without spin: only the mass.
    let mut drifting = flown(1, [0.0; 3]);
    drifting.velocity = [0.02, -0.01, 0.005];
    let run = drifting.run().unwrap();
    let known = run.known;
    let mut model = drifting.model.clone();
    model.momentum.linear = MomentumKnowledge::Known(known.p_C_N);
    model.momentum.angular = MomentumKnowledge::Known(known.h_C_N);
    let answer = ask(&model, &run, Variant::KnownMomentum, 0.0).unwrap();
    assert_eq!(answer.status, Status::Partial);
    let base = &answer.bodies[0];
    assert!((base.mass.value.unwrap() - 1000.0).abs() < 1.0e-8);
    assert!(base.com.iter().all(|n| n.value.is_none()));
    assert!(base.inertia.iter().all(|n| n.value.is_none()));
    // Samples during arm motion without spin: all numbers.
    let moving = flown(1, [0.0; 3]).sampled(200, false);
    let answer = ask(
        &moving.model,
        &moving.run().unwrap(),
        Variant::UnknownMomentum,
        0.0,
    )
    .unwrap();
    assert_eq!(
        answer.status,
        Status::Converged,
        "{:?}",
        answer.identifiability
    );
    // A spin about the axis of the arm's motion in the plane of symmetry, with stops.
    let mut one_axis = flown(2, [0.0, 1.0, 0.0]);
    one_axis.model.joints[0].p_PoCo_P.y = 0.0;
    let answer = ask(
        &one_axis.model,
        &one_axis.run().unwrap(),
        Variant::UnknownMomentum,
        0.0,
    )
    .unwrap();
    assert_eq!(
        answer.status,
        Status::Partial,
        "{:?}",
        answer.identifiability.sigmas_natural
    );
}

/// Known linear and unknown angular momentum, and the reverse: option 1 of one step, option 2 of the other.
#[test]
fn exact_mixed_momentum_gives_the_truth() {
    let mut e = flown(1, [0.0, 1.0, 5.0]).with_base(unsymmetric());
    e.velocity = [0.02, -0.01, 0.005];
    let run = e.run().unwrap();
    let known = run.known;
    for linear in [true, false] {
        let mut model = e.model.clone();
        match linear {
            true => model.momentum.linear = MomentumKnowledge::Known(known.p_C_N),
            false => model.momentum.angular = MomentumKnowledge::Known(known.h_C_N),
        }
        let answer = ask(&model, &run, Variant::KnownMomentum, 0.0).unwrap();
        assert_eq!(answer.status, Status::Converged, "{:?}", answer.warnings());
        let base = &answer.bodies[0];
        assert!((base.mass.value.unwrap() - 1000.0).abs() < 1.0e-8);
        for (n, at) in base.inertia.iter().zip(poinsot_identify::TENSOR) {
            assert!((n.value.unwrap() - unsymmetric().I_BBcm_B[at]).abs() < 1.0e-8);
        }
        let m = &answer.momentum[0];
        for k in 0..3 {
            let (p, h) = (m.linear[k], m.angular[k]);
            assert!((p.value.unwrap() - known.p_C_N[k]).abs() < 1.0e-8);
            assert!((h.value.unwrap() - known.h_C_N[k]).abs() < 1.0e-8);
            let known = poinsot_identify::Source::Known;
            assert_eq!((p.source == known, h.source == known), (linear, !linear));
        }
    }
}

#[test]
fn prop_momentum_in_the_wrong_frame_is_rejected() {
    let mut e = flown(1, [0.0, 0.0, 5.0]).with_base(unsymmetric());
    e.velocity = [0.02, -0.01, 0.005];
    let run = e.run().unwrap();
    let known = run.known;
    let turned = run.raws[0].R_NB.inverse();
    let wrong = [
        (known.p_C_N, turned * Vector3::x() * known.h_C_N.norm()),
        (
            UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 0.4)) * known.p_C_N,
            known.h_C_N,
        ),
        // About the base origin instead of the mass centre.
        (known.p_C_N, known.h_C_N + Vector3::new(0.0, 0.0, 4.0)),
    ];
    for (p, h) in wrong {
        let mut model = e.model.clone();
        model.momentum.linear = MomentumKnowledge::Known(p);
        model.momentum.angular = MomentumKnowledge::Known(h);
        let answer = ask(&model, &run, Variant::KnownMomentum, 0.0).unwrap();
        println!("{:?} {:?}", answer.status, answer.warnings());
        assert_eq!(answer.status, Status::Rejected);
        assert!(answer.bodies[0].mass.value.is_none());
        assert!(answer.warnings()[0].contains("inconsistent with the data"));
    }
}

#[test]
fn prop_bad_questions_are_refused_in_one_line() {
    let e = flown(1, [0.0, 0.0, 5.0]);
    let run = e.run().unwrap();
    let refused = |change: &dyn Fn(&mut Model), variant, code: &str| {
        let mut model = e.model.clone();
        change(&mut model);
        let error = ask(&model, &run, variant, 0.0).unwrap_err().to_string();
        assert!(error.starts_with(code) && !error.contains('\n'), "{error}");
    };
    let free = Variant::UnknownMomentum;
    refused(
        &|m| m.bodies[2].estimate.mass = true,
        free,
        "E0521 body 'link2'",
    );
    refused(
        &|m| m.bodies[0].estimate.com = false,
        free,
        "E0522 body 'base'",
    );
    refused(
        &|m| {
            m.bodies[1..]
                .iter_mut()
                .for_each(|b| b.nominal = MassProperties::ZERO)
        },
        free,
        "E0523",
    );
    refused(
        &|_| (),
        Variant::KnownMomentum,
        "E0524 [momentum] linear_N_s",
    );
    let few = Run {
        raws: run.raws[..2].to_vec(),
        ..run
    };
    let error = ask(&e.model, &few, free, 0.0).unwrap_err().to_string();
    assert!(error.starts_with("E0528"), "{error}");
    // An arm heavier than those studied in the paper gives an answer with a warning.
    let mut heavy = flown(1, [0.0, 0.0, 5.0]);
    scale_arm(&mut heavy.model, 8.0 * 0.093184);
    let answer = ask(&heavy.model, &heavy.run().unwrap(), free, 0.0).unwrap();
    assert_eq!(answer.status, Status::Converged);
    assert!(
        answer.warnings().iter().any(|w| w.contains("0.5 to 50 %")),
        "{:?}",
        answer.warnings()
    );
}

/// A segment of raw samples for the estimators.
fn segment(run: &Run) -> Segment {
    let raws = &run.raws;
    Segment {
        label: "test".to_owned(),
        samples: Samples {
            time_s: (0..raws.len()).map(|k| k as f64).collect(),
            R_NB: raws.iter().map(|r| r.R_NB).collect(),
            w_NB_B: raws.iter().map(|r| r.w_NB_B).collect(),
            translation: Some(Translation {
                v_NBo_N: raws.iter().map(|r| r.v_NBo_N).collect(),
                p_NoBo_N: run.positions[..raws.len()]
                    .iter()
                    .map(|p| p - run.positions[0])
                    .collect(),
            }),
            joint_position: raws.iter().flat_map(|r| r.q.clone()).collect(),
            joint_rate: raws.iter().flat_map(|r| r.rates.clone()).collect(),
            wheel_speed: Vec::new(),
        },
        firings: Vec::new(),
        ..Segment::default()
    }
}

fn noise(seen: f64) -> Noise {
    let one = Matrix3::identity();
    Noise {
        gyro_sensor: None,
        gyro: one * RATE.powi(2),
        attitude: one * ATTITUDE.powi(2),
        velocity: one * VELOCITY.powi(2),
        position: Matrix3::zeros(),
        joint_position: vec![0.0; 6],
        joint_rate: vec![JOINT_RATE.powi(2); 6],
        wheel_speed: Vec::new(),
        seen_gyro: seen,
        seen_velocity: seen,
        seen_joint_rate: seen,
    }
}

fn ask(
    model: &Model,
    run: &Run,
    variant: Variant,
    seen: f64,
) -> Result<poinsot_identify::Estimate, poinsot_files::Faults> {
    let tree = Tree::new(model);
    ma2008::identify(
        &Problem {
            model,
            tree: &tree,
            segments: &[segment(run)],
            noise: &noise(seen),
            relative_accuracy: 1.0,
            pace: None,
        },
        variant,
    )
}
