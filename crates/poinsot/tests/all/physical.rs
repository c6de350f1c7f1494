//! Physical consistency: every unknown body keeps a positive mass density.

use crate::vehicle;

use poinsot::{Coordinates, Identified, Question, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{EstimateSet, Model};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::Table;
use vehicle::*;

fn ask_in(model: &Model, table: &Table, coordinates: Coordinates) -> Identified {
    let request = Question {
        coordinates,
        ..request("auto")
    };
    identify_tables(model.clone(), vec![table.clone()], &request).unwrap()
}

/// A body that rotates by its wheels, with this inertia.
fn turning(I: Matrix3, estimate: EstimateSet, sigma: f64) -> Model {
    let mut model = with_wheels(tree(21, ""));
    model.bodies[0].nominal.I_BBcm_B = I;
    model.bodies[0].estimate = estimate;
    model.sensors = sensors(sigma);
    model
}

/// With good data the coordinates have no effect: numbers and covariance agree within the convergence tolerance.
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

/// The tensor of a body with these second moments along its principal axes, kg m2, rotated relative to B.
fn tensor(second: [f64; 3]) -> Matrix3 {
    let axes = turned(Vector3::new(0.3, -0.5, 0.2));
    let second = Vector3::from(second);
    axes * Matrix3::from_diagonal(&second.map(|s| second.sum() - s)) * axes.transpose()
}

/// Bodies whose thickness is far below the resolution of the data. Linear steps end unphysical in about half of the
/// trials, physical ones never. All fits converge. The warning of the physical limit appears exactly if the
/// unconstrained answer is unphysical. `--example physical_edge` runs more trials and counts intervals.
fn stays_physical(second: [f64; 3], trials: u64, expected: std::ops::RangeInclusive<u32>) {
    let I = tensor(second);
    let inertia = EstimateSet {
        mass: false,
        com: false,
        inertia: true,
    };
    let mut impossible = 0;
    for estimate in [inertia, EstimateSet::ALL] {
        let sigma = 3.0e-3;
        let truth = turning(I, estimate, sigma);
        let flight = moving(&truth, 9);
        let clean = fly(&truth, &flight);
        // The nominal body is well inside the physical set.
        let mut model = truth.clone();
        model.bodies[0].nominal.I_BBcm_B += Matrix3::identity() * 0.5;
        for seed in 0..trials {
            let mut table = noisy(clean.clone(), 100 + seed, sigma);
            if estimate == inertia {
                table = rotation_only(table);
            }
            let linear = ask_in(&model, &table, Coordinates::Linear).estimate;
            let free = ask_in(&model, &table, Coordinates::Physical).estimate;
            let bad = [Status::IterationLimit, Status::Rejected];
            assert!(
                !bad.contains(&free.status),
                "seed {seed}: {:?}",
                free.status
            );
            assert_eq!(
                free.bodies[0].physically_consistent,
                Some(true),
                "seed {seed}"
            );
            let beyond = linear.bodies[0].physically_consistent == Some(false);
            let held = free
                .warnings
                .iter()
                .any(|w| w.contains("at the limit of physical"));
            assert_eq!(held, beyond, "seed {seed}");
            assert_eq!(held, !free.covariance_trustworthy(), "seed {seed}");
            impossible += u32::from(beyond);
            for (k, (a, b)) in free.bodies[0]
                .inertia
                .iter()
                .zip(&linear.bodies[0].inertia)
                .enumerate()
            {
                let (value, sigma) = (a.value.unwrap(), a.sigma.unwrap());
                if beyond {
                    // At the limit the numbers remain consistent with the data, and sigma is not smaller.
                    let error = value - I[poinsot_identify::TENSOR[k]];
                    assert!(error.abs() < 5.0 * sigma, "seed {seed} {k}: {error:e}");
                    assert!(sigma > 0.9 * b.sigma.unwrap(), "seed {seed} {k}: {sigma:e}");
                } else {
                    let gap = (value - b.value.unwrap()).abs();
                    assert!(gap < 1.0e-3 * sigma, "seed {seed}: {gap:e}");
                }
            }
        }
    }
    assert!(expected.contains(&impossible), "{impossible} impossible");
}

#[test]
fn stat_a_plate_stays_physical() {
    stays_physical([6.9999, 5.9999, 1.0e-4], 8, 2..=14);
}

/// Exactly flat, and with two equal moments.
#[test]
fn stat_a_flat_disc_stays_physical() {
    stays_physical([6.0, 6.0, 0.0], 10, 2..=18);
}

/// Data that contradict every physical body are not fitted by one: the answer is withheld.
#[test]
fn unit_data_beyond_every_body_are_rejected() {
    let I = Matrix3::from_diagonal(&Vector3::new(5.0, 6.0, 14.0));
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
