//! Noise-free problems with a known answer: momentum, wheels, thrusters, subsets, repairs, units.

mod telemetry;

use crate::vehicle;

use poinsot::{Error, Identified, identify_tables};
use poinsot_dynamics::{Start, StartVelocity};
use poinsot_identify::{Number, Source, Status};
use poinsot_model::{EstimateSet, Model, Momentum, MomentumKnowledge, Nuisance, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::Table;
use vehicle::*;

const METHODS: [&str; 2] = ["linear", "maximum_likelihood"];

/// Adds drift and rotation that give this momentum about the mass centre.
fn with_momentum(flight: Flight, l_S_N: Vector3, h_SScm_N: Vector3) -> Flight {
    Flight {
        start: Start {
            velocity: StartVelocity::Momentum { l_S_N, h_SScm_N },
            ..flight.start
        },
        rate_hz: 20.0,
        ..flight
    }
}

fn drifting(model: &Model, seed: u64) -> (Flight, Vector3, Vector3) {
    let (P, h) = (Vector3::new(5.0, -8.0, 3.0), Vector3::new(2.0, 3.0, -2.5));
    (with_momentum(moving(model, seed), P, h), P, h)
}

fn nuisance(answer: &Identified, name: &str) -> Number {
    let list = &answer.estimate.nuisance;
    list.iter().find(|n| n.name == name).unwrap().number
}

fn repaired(answer: &Identified, words: &str) -> bool {
    answer.repairs().iter().any(|r| r.contains(words))
}

fn assert_found(answer: &Identified, truth: &Model, tolerance: f64, what: &str) {
    let e = &answer.estimate;
    assert_eq!(e.status, Status::Converged, "{what}: {:?}", e.warnings());
    for (at, body) in truth.bodies.iter().enumerate() {
        if body.estimate.any() {
            let error = worst_error(answer, truth, at);
            println!("{what}: {} off by {error:.1e}", body.name);
            assert!(error < tolerance, "{what}: {} {error:.1e}", body.name);
        }
    }
}

/// Round-off for the linear method; interpolation of joint motion for the fit.
fn tolerance(method: &str) -> f64 {
    match method {
        "linear" => 1.0e-9,
        _ => 1.0e-6,
    }
}

/// Thrust rotates with the attitude, which is interpolated: fourth order in the sample distance.
const THRUST: f64 = 1.0e-6;
/// The fit interpolates wheel speeds linearly: second order in the sample distance.
const WHEELS: f64 = 2.0e-4;

#[test]
fn exact_momentum_estimated_given_or_partly_given() {
    use MomentumKnowledge::{Estimate, Known};
    let mut model = known_arm(11);
    let (flight, P, h) = drifting(&model, 11);
    for (linear, angular) in [
        (Estimate, Estimate),
        (Known(P), Known(h)),
        (Known(P), Estimate),
        (Estimate, Known(h)),
    ] {
        model.momentum = Momentum { linear, angular };
        for method in METHODS {
            let table = fly(&model, &flight);
            let answer = ask(&off_nominal(&model, 0.1), vec![table], method);
            let what = format!("{linear:?} {angular:?} {method}");
            assert_eq!(answer.estimate.status, Status::Converged, "{what}");
            assert_found(&answer, &model, tolerance(method), &what);
            let found = &answer.estimate.momentum[0];
            for k in 0..3 {
                let off = (found.linear[k].value.unwrap() - P[k]).abs();
                assert!(off < 100.0 * tolerance(method), "{what}: P {off:.1e}");
                let off = (found.angular[k].value.unwrap() - h[k]).abs();
                assert!(off < 100.0 * tolerance(method), "{what}: h {off:.1e}");
            }
        }
    }
}

#[test]
fn exact_zero_momentum_given() {
    let mut model = known_arm(12);
    let zero = MomentumKnowledge::Known(Vector3::zeros());
    model.momentum = Momentum {
        linear: zero,
        angular: zero,
    };
    let flight = with_momentum(moving(&model, 12), Vector3::zeros(), Vector3::zeros());
    for method in METHODS {
        let table = fly(&model, &flight);
        let answer = ask(&off_nominal(&model, 0.1), vec![table], method);
        assert_eq!(answer.estimate.status, Status::Converged);
        assert_found(&answer, &model, tolerance(method), method);
    }
}

#[test]
fn exact_every_segment_has_its_own_momentum() {
    let model = known_arm(13);
    let parts = [
        (Vector3::new(5.0, -8.0, 3.0), Vector3::new(2.0, 3.0, -2.5)),
        (Vector3::new(-4.0, 1.0, 9.0), Vector3::new(-3.0, 1.0, 0.5)),
    ];
    let tables: Vec<Table> = parts
        .iter()
        .zip(30..)
        .map(|((P, h), seed)| fly(&model, &with_momentum(moving(&model, seed), *P, *h)))
        .collect();
    for method in METHODS {
        let answer = ask(&off_nominal(&model, 0.1), tables.clone(), method);
        assert_found(&answer, &model, tolerance(method), method);
        assert_eq!(answer.estimate.momentum.len(), 2);
        for (found, (P, h)) in answer.estimate.momentum.iter().zip(&parts) {
            for k in 0..3 {
                assert!((found.linear[k].value.unwrap() - P[k]).abs() < 1.0e-3);
                assert!((found.angular[k].value.unwrap() - h[k]).abs() < 1.0e-3);
            }
        }
    }
}

#[test]
fn exact_spin_inertia_follows_from_a_known_body() {
    let mut truth = with_wheels(known_arm(14));
    truth.sensors = sensors(1.0e-4);
    let mut asked = off_nominal(&truth, 0.1);
    for wheel in &mut asked.wheels {
        wheel.estimate = true;
        wheel.spin_inertia *= 1.3;
    }
    let (flight, ..) = drifting(&truth, 14);
    for method in METHODS {
        let answer = ask(&asked, vec![fly(&truth, &flight)], method);
        let tolerance = match method {
            "linear" => tolerance(method),
            _ => WHEELS,
        };
        assert_found(&answer, &truth, tolerance, method);
        for wheel in &truth.wheels {
            let found = nuisance(&answer, &format!("{}.spin_inertia", wheel.name));
            let error = (found.value.unwrap() / wheel.spin_inertia - 1.0).abs();
            println!("{method} {} {error:.1e}", wheel.name);
            assert!(error < tolerance, "{method}: {error:.1e}");
            assert_eq!(found.source, Source::Data);
        }
    }
}

#[test]
fn exact_spin_inertia_without_a_scale_is_null() {
    let mut model = with_wheels(tree(15, ""));
    for wheel in &mut model.wheels {
        wheel.estimate = true;
    }
    let (flight, ..) = drifting(&model, 15);
    for method in METHODS {
        let answer = ask(&model, vec![fly(&model, &flight)], method);
        for wheel in &model.wheels {
            let found = nuisance(&answer, &format!("{}.spin_inertia", wheel.name));
            assert_eq!(found.value, None, "{method} {}", wheel.name);
            assert_eq!(found.source, Source::Open);
        }
        let bus = &answer.estimate.bodies[0];
        assert!(bus.mass.value.is_none() && bus.inertia.iter().all(|n| n.value.is_none()));
        assert!(!answer.passes());
    }
}

/// Without forces, the motion of a drifting body does not depend on its mass (FINDINGS: with wheels 9, never the
/// mass).
#[test]
fn exact_wheels_never_show_the_mass() {
    for noise in [1.0e-5, 1.0e-7] {
        let mut truth = with_wheels(tree(51, ""));
        truth.sensors = sensors(noise);
        let table = noisy(fly(&truth, &moving(&truth, 51)), 3, noise);
        for method in METHODS {
            let answer = ask(&off_nominal(&truth, 0.05), vec![table.clone()], method);
            let mass = answer.estimate.bodies[0].mass;
            assert_eq!(mass.value, None, "{method} {noise}: {mass:?}");
        }
    }
}

/// Wheel motion between samples at 10 Hz must not reject a correct model.
#[test]
fn stat_wheels_read_at_10_hz_do_not_reject_a_right_model() {
    let mut truth = with_wheels(known_arm(28));
    truth.sensors = sensors(1.0e-5);
    let table = noisy(fly(&truth, &moving(&truth, 28)), 28, 1.0e-5);
    for method in METHODS {
        let answer = ask(&off_nominal(&truth, 0.05), vec![table.clone()], method);
        let e = &answer.estimate;
        assert_eq!(e.status, Status::Converged, "{method}: {:?}", e.warnings());
        assert!(e.fit[0].chi2_per_dof < 1.5, "{method}");
    }
}

#[test]
fn exact_a_thruster_stronger_than_declared() {
    let mut truth = with_thrusters(tree(16, ""));
    truth.sensors = sensors(1.0e-6);
    let mut asked = off_nominal(&truth, 0.1);
    asked.thrusters[1].scale = Nuisance::Estimate;
    let (mut flight, ..) = drifting(&truth, 16);
    flight.plan.firings[1].force *= 1.07;
    let mut table = fly(&truth, &flight);
    let column = channel(&mut table, "thr2_N");
    column.values.iter_mut().for_each(|f| *f /= 1.07);
    for method in METHODS {
        let answer = ask(&asked, vec![table.clone()], method);
        assert_found(&answer, &truth, THRUST, method);
        let found = nuisance(&answer, "thr2.scale").value.unwrap();
        println!("{method}: scale {found}");
        assert!((found - 0.07).abs() < THRUST);
    }
}

#[test]
fn exact_subsets_of_what_may_be_asked() {
    let (mass, com, inertia) = (true, true, true);
    for set in [
        EstimateSet {
            inertia,
            ..EstimateSet::default()
        },
        EstimateSet {
            com,
            inertia,
            ..EstimateSet::default()
        },
        EstimateSet {
            mass,
            inertia,
            ..EstimateSet::default()
        },
        EstimateSet {
            mass,
            ..EstimateSet::default()
        },
    ] {
        let mut truth = with_thrusters(tree(17, ""));
        truth.sensors = sensors(1.0e-6);
        truth.bodies[0].estimate = set;
        let (flight, ..) = drifting(&truth, 17);
        for method in METHODS {
            let asked = off_nominal(&truth, 0.1);
            let answer = ask(&asked, vec![fly(&truth, &flight)], method);
            assert_found(&answer, &truth, THRUST, &format!("{set:?} {method}"));
            let bus = &answer.estimate.bodies[0];
            let source = |asked| if asked { Source::Data } else { Source::Known };
            assert_eq!(bus.mass.source, source(set.mass));
            assert!(bus.com.iter().all(|n| n.source == source(set.com)));
            assert!(bus.inertia.iter().all(|n| n.source == source(set.inertia)));
        }
    }
}

fn refusal(model: &Model, tables: Vec<Table>, method: &str) -> Error {
    let answer = identify_tables(model.clone(), tables, &request(method));
    answer.err().unwrap()
}

#[test]
fn exact_a_product_of_unknowns_is_refused() {
    for mass in [false, true] {
        let mut model = with_thrusters(tree(18, ""));
        model.bodies[0].estimate = EstimateSet {
            mass,
            com: true,
            inertia: false,
        };
        let (flight, ..) = drifting(&model, 18);
        let error = refusal(&model, vec![fly(&model, &flight)], "linear");
        assert!(error.to_string().contains("E0401"), "{error}");
        assert_eq!(error.kind(), poinsot::ErrorKind::Input);
    }
}

#[test]
fn exact_without_motion_nothing_is_said() {
    let mut model = tree(19, "r");
    model.sensors = sensors(1.0e-4);
    let mut flight = flight(&model, 19, &[Drive::Stands(0.3)]);
    flight.start = Start::at_rest();
    for method in METHODS {
        let answer = ask(&model, vec![fly(&model, &flight)], method);
        assert_eq!(answer.estimate.status, Status::NotIdentifiable, "{method}");
        assert!(!answer.passes());
        assert_eq!(answer.estimate.identifiability.rank, 0);
        for body in &answer.estimate.bodies {
            let numbers = std::iter::once(&body.mass)
                .chain(&body.com)
                .chain(&body.inertia)
                .chain(&body.barycentric);
            for number in numbers {
                assert_eq!((number.value, number.sigma), (None, None), "{method}");
                assert_eq!(number.source, Source::Open);
            }
        }
        let (system, _) = answer.estimate.system.as_ref().unwrap();
        assert!(system.mass.value.is_none() && system.com.iter().all(|n| n.value.is_none()));
        assert!(answer.estimate.identifiability.determined.is_empty());
    }
}

#[test]
fn prop_a_known_body_that_is_wrong_shows_in_chi_square() {
    let mut truth = with_wheels(known_arm(20));
    truth.sensors = sensors(1.0e-5);
    let (flight, ..) = drifting(&truth, 20);
    for method in METHODS {
        let table = noisy(fly(&truth, &flight), 20, 1.0e-5);
        let right = ask(&truth, vec![table.clone()], method);
        let chi2 = right.estimate.fit[0].chi2_per_dof;
        println!("{method}: right arm {chi2:.2}");
        assert!((0.8..1.25).contains(&chi2), "{method}: {chi2}");
        let doubts = &right.estimate.doubts();
        assert!(
            right.estimate.covariance_trustworthy(),
            "{method}: {doubts:?}"
        );
        let mut asked = truth.clone();
        asked.bodies[1].nominal.mass *= 1.1;
        let wrong = ask(&asked, vec![table], method);
        let chi2 = wrong.estimate.fit[0].chi2_per_dof;
        println!("{method}: wrong arm {chi2:.2e}");
        assert!(chi2 > 100.0);
        assert!(!wrong.estimate.covariance_trustworthy());
        assert!(!wrong.estimate.warnings().is_empty());
    }
}
