//! Physical consistency: log-Cholesky steps keep every unknown body one of positive mass.
#![allow(clippy::unwrap_used, non_snake_case)]

mod vehicle;

use poinsot::{Coordinates, Identified, IdentifyRequest, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{EstimateSet, Model};
use poinsot_spatial::Matrix3;
use poinsot_telemetry::Table;
use vehicle::*;

fn ask_in(model: &Model, table: &Table, coordinates: Coordinates) -> Identified {
    let request = IdentifyRequest {
        coordinates,
        ..request("auto")
    };
    identify_tables(model.clone(), vec![table.clone()], &request).unwrap()
}

/// A body that turns on wheels, with an inertia of its own.
fn turning(I: Matrix3, estimate: EstimateSet, sigma: f64) -> Model {
    let mut model = with_wheels(tree(21, ""));
    model.bodies[0].nominal.I_BBcm_B = I;
    model.bodies[0].estimate = estimate;
    model.sensors = sensors(sigma);
    model
}

/// With good data the coordinates make no difference: numbers and covariance agree to the settling of the fit.
#[test]
fn exact_coordinates_make_no_difference_with_good_data() {
    for estimate in [
        EstimateSet::ALL,
        EstimateSet {
            mass: false,
            ..EstimateSet::ALL
        },
        EstimateSet {
            mass: false,
            com: false,
            inertia: true,
        },
        EstimateSet {
            mass: true,
            com: false,
            inertia: false,
        },
    ] {
        let mut truth = with_thrusters(tree(22, "r"));
        truth.bodies[0].estimate = estimate;
        truth.bodies[1].estimate = EstimateSet::default();
        truth.sensors = sensors(1.0e-4);
        let table = noisy(fly(&truth, &moving(&truth, 3)), 5, 1.0e-4);
        let model = off_nominal(&truth, 0.2);
        let [a, b] = [Coordinates::Physical, Coordinates::Linear]
            .map(|c| ask_in(&model, &table, c).estimate);
        assert_eq!(a.status, Status::Converged);
        let numbers = |e: &poinsot_identify::Estimate| {
            let body = e.bodies[0].clone();
            std::iter::once(body.mass)
                .chain(body.com)
                .chain(body.inertia)
                .map(|n| (n.value.unwrap(), n.sigma.unwrap()))
                .collect::<Vec<_>>()
        };
        for ((x, s), (y, t)) in numbers(&a).into_iter().zip(numbers(&b)) {
            assert!(
                (x - y).abs() <= 1.0e-3 * s,
                "{estimate:?}: {x} {y} sigma {s}"
            );
            assert!((s - t).abs() <= 1.0e-6 * s, "{estimate:?}: sigmas {s} {t}");
        }
    }
}

/// A nearly flat plate whose thickness is far below what the data can tell: linear steps end beyond the plate in
/// about half of the trials, log-Cholesky steps never do, and say where they were held.
#[test]
fn stat_a_plate_stays_physical() {
    let I = turned(poinsot_spatial::Vector3::new(0.3, -0.5, 0.2))
        * Matrix3::from_diagonal(&poinsot_spatial::Vector3::new(6.0, 7.0, 12.9998))
        * turned(poinsot_spatial::Vector3::new(0.3, -0.5, 0.2)).transpose();
    let inertia = EstimateSet {
        mass: false,
        com: false,
        inertia: true,
    };
    let (mut all, mut unsettled, mut unsaid) = (0, 0, 0);
    for estimate in [inertia, EstimateSet::ALL] {
        let sigma = 3.0e-3;
        let truth = turning(I, estimate, sigma);
        let flight = moving(&truth, 9);
        let clean = fly(&truth, &flight);
        // What is nominal lies well inside.
        let mut model = truth.clone();
        model.bodies[0].nominal.I_BBcm_B += Matrix3::identity() * 0.5;
        let (mut impossible, mut held, mut inside) = (0, 0, 0);
        let trials = 8;
        for seed in 0..trials {
            let mut table = noisy(clean.clone(), 100 + seed, sigma);
            if estimate == inertia {
                table = rotation_only(table);
            }
            let linear = ask_in(&model, &table, Coordinates::Linear).estimate;
            let free = ask_in(&model, &table, Coordinates::Physical).estimate;
            if free.status == Status::IterationLimit {
                // Said, with every number withheld; rare.
                unsettled += 1;
                continue;
            }
            assert_ne!(free.status, Status::Rejected, "seed {seed}");
            assert_eq!(
                free.bodies[0].physically_consistent,
                Some(true),
                "seed {seed}"
            );
            let at_edge = free.warnings.iter().any(|w| w.contains("held at the edge"));
            assert_eq!(at_edge, !free.covariance_trustworthy, "seed {seed}");
            let said = linear.bodies[0].physically_consistent == Some(false);
            impossible += u32::from(said);
            held += u32::from(at_edge);
            if !said {
                inside += 1;
                assert!(!at_edge, "seed {seed}");
                for (a, b) in free.bodies[0].inertia.iter().zip(&linear.bodies[0].inertia) {
                    let gap = (a.value.unwrap() - b.value.unwrap()).abs();
                    assert!(gap < 1.0e-3 * a.sigma.unwrap(), "seed {seed}: {gap:e}");
                }
            } else {
                unsaid += u32::from(!at_edge);
                // At the edge the numbers stay within what the data allow.
                for (k, n) in free.bodies[0].inertia.iter().enumerate() {
                    let error = n.value.unwrap() - I[poinsot_identify::TENSOR[k]];
                    assert!(
                        error.abs() < 5.0 * n.sigma.unwrap(),
                        "seed {seed} {k}: {error:e}"
                    );
                }
            }
        }
        println!("{trials} trials: linear impossible {impossible}, held {held}, inside {inside}");
        all += impossible;
    }
    assert!((2..=14).contains(&all), "{all} of 16");
    // The edge is not always noticed where the linear answer is beyond it by less than its sigma.
    println!("{all} impossible, edge not said {unsaid}, unsettled {unsettled}");
    assert!(unsaid <= 4, "{unsaid} of {all} did not say so");
    assert!(unsettled <= 4, "{unsettled} of 16 did not settle");
}

/// Data that contradict every physical body are not made to fit one: the answer is withheld, as before.
#[test]
fn unit_data_beyond_every_body_are_rejected() {
    let I = Matrix3::from_diagonal(&poinsot_spatial::Vector3::new(5.0, 6.0, 14.0));
    let inertia = EstimateSet {
        mass: false,
        com: false,
        inertia: true,
    };
    let truth = turning(I, inertia, 1.0e-4);
    let table = rotation_only(noisy(fly(&truth, &moving(&truth, 9)), 4, 1.0e-4));
    let mut model = truth;
    model.bodies[0].nominal.I_BBcm_B[(2, 2)] = 9.0;
    let answer = ask_in(&model, &table, Coordinates::Physical).estimate;
    assert_eq!(answer.status, Status::Rejected, "{:?}", answer.warnings);
    assert!(answer.bodies[0].inertia.iter().all(|n| n.value.is_none()));
}
