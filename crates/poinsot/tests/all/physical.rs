//! Physical consistency: every unknown body keeps a positive mass density.

use crate::{tables, vehicle};

use poinsot::{Coordinates, Identified, Question, identify_tables};
use poinsot_identify::{Estimate, Status, TENSOR};
use poinsot_model::{EstimateSet, Model};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::Table;
use rayon::prelude::*;
use vehicle::*;

/// Only the tensor is unknown.
const INERTIA: EstimateSet = EstimateSet {
    mass: false,
    com: false,
    inertia: true,
};
/// Second moments along the principal axes, kg m2.
const PLATE: [f64; 3] = [6.9999, 5.9999, 1.0e-4];
const DISC: [f64; 3] = [6.0, 6.0, 0.0];

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
        INERTIA,
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

/// Noise of gyro, attitude, velocity and position, SI.
const SIGMA: f64 = 3.0e-3;

/// One record, solved over all tensors and over physical ones.
struct Trial {
    free: Estimate,
    kept: Estimate,
}

impl Trial {
    /// The unconstrained answer is unphysical. One far outside is rejected and its numbers are withheld.
    fn beyond(&self) -> bool {
        let warned = |w: &&str| w.contains("no distribution of positive mass");
        self.free.bodies[0].physically_consistent == Some(false)
            || self.free.warnings().iter().any(warned)
    }

    /// The physical answer reports that it is at the physical limit.
    fn held(&self) -> bool {
        let warned = |w: &&str| w.contains("at the limit of physical");
        self.kept.warnings().iter().any(warned)
    }

    fn unsettled(&self) -> bool {
        [&self.kept, &self.free]
            .iter()
            .any(|e| e.status == Status::IterationLimit)
    }

    /// Whether the 95 % interval of each element holds the truth.
    fn covered(&self, I: &Matrix3) -> [bool; 6] {
        std::array::from_fn(|k| {
            let number = &self.kept.bodies[0].inertia[k];
            let both = number.value.zip(number.sigma);
            both.is_some_and(|(v, s)| (v - I[TENSOR[k]]).abs() <= 1.96 * s)
        })
    }
}

/// Bodies whose thickness is far below the resolution of the data.
fn trials(
    I: Matrix3,
    estimate: EstimateSet,
    halved: bool,
    seeds: std::ops::Range<u64>,
) -> Vec<Trial> {
    let truth = turning(I, estimate, SIGMA);
    let mut flight = moving(&truth, 9);
    if halved {
        flight.rate_hz *= 2.0;
        flight.duration_s *= 0.5;
    }
    let clean = fly(&truth, &flight);
    // The nominal body is well inside the physical set.
    let mut model = truth.clone();
    model.bodies[0].nominal.I_BBcm_B += Matrix3::identity() * 0.5;
    let trial = |seed: u64| {
        let mut table = noisy(clean.clone(), seed, SIGMA);
        if !estimate.mass {
            table = rotation_only(table);
        }
        let ask = |coordinates| ask_in(&model, &table, coordinates).estimate;
        Trial {
            free: ask(Coordinates::Linear),
            kept: ask(Coordinates::Physical),
        }
    };
    seeds.into_par_iter().map(trial).collect()
}

/// Linear steps end unphysical in about half of the trials, physical ones never. All fits converge. The warning of the
/// physical limit appears exactly if the unconstrained answer is unphysical.
fn stays_physical(second: [f64; 3], count: u64, expected: std::ops::RangeInclusive<u32>) {
    let I = tensor(second);
    let mut impossible = 0;
    for estimate in [INERTIA, EstimateSet::ALL] {
        for (seed, trial) in trials(I, estimate, false, 100..100 + count)
            .iter()
            .enumerate()
        {
            let kept = &trial.kept;
            let bad = [Status::IterationLimit, Status::Rejected];
            assert!(!bad.contains(&kept.status), "seed {seed}");
            assert_eq!(
                kept.bodies[0].physically_consistent,
                Some(true),
                "seed {seed}"
            );
            assert_eq!(trial.held(), trial.beyond(), "seed {seed}");
            assert_eq!(trial.held(), !kept.covariance_trustworthy(), "seed {seed}");
            impossible += u32::from(trial.beyond());
            let pairs = kept.bodies[0]
                .inertia
                .iter()
                .zip(&trial.free.bodies[0].inertia);
            for (k, (a, b)) in pairs.enumerate() {
                let (value, sigma) = (a.value.unwrap(), a.sigma.unwrap());
                if trial.beyond() {
                    // At the limit the numbers remain consistent with the data, and sigma is not smaller.
                    let error = value - I[TENSOR[k]];
                    assert!(error.abs() < 5.0 * sigma, "seed {seed} {k}: {error:e}");
                    let wide = b.sigma.is_none_or(|free| sigma > 0.9 * free);
                    assert!(wide, "seed {seed} {k}: {sigma:e}");
                } else {
                    let gap = (value - b.value.unwrap()).abs();
                    assert!(gap < 1.0e-3 * sigma, "seed {seed}: {gap:e}");
                }
            }
        }
    }
    assert!(expected.contains(&impossible), "{impossible} impossible");
}

/// The table of `docs/validation/physical_edge.md`.
#[test]
#[ignore = "takes minutes"]
fn stat_table_of_bodies_at_the_physical_limit() {
    tables::heading(&[
        "body",
        "unknown",
        "beyond",
        "held",
        "mismatch",
        "unsettled",
        "rejected",
        "impossible",
        "covered, held",
        "worst",
        "covered, all",
        "worst",
    ]);
    let mut least = 100.0_f64;
    for (name, second) in [("plate", PLATE), ("disc", DISC)] {
        for (word, estimate) in [("inertia", INERTIA), ("all", EstimateSet::ALL)] {
            let I = tensor(second);
            let all = trials(I, estimate, true, 1000..1000 + tables::trials(100));
            let count = |of: &dyn Fn(&Trial) -> bool| all.iter().filter(|t| of(t)).count();
            let impossible = count(&|t| t.kept.bodies[0].physically_consistent != Some(true));
            let amiss = count(&|t| t.held() != t.beyond());
            let [held, every] = [
                coverage(all.iter().filter(|t| t.held()), &I),
                coverage(all.iter(), &I),
            ];
            let counts = [
                count(&Trial::beyond),
                count(&Trial::held),
                amiss,
                count(&Trial::unsettled),
                count(&|t| t.kept.status == Status::Rejected),
                impossible,
            ];
            let mut cells = vec![name.to_owned(), word.to_owned()];
            cells.extend(counts.map(|n| n.to_string()));
            let printed = |(mean, worst)| [format!("{mean:.1} %"), format!("{worst:.0}")];
            cells.extend([held, every].into_iter().flat_map(printed));
            tables::row(&cells);
            assert_eq!(amiss, 0, "{name}, {word}");
            least = least.min(every.0);
        }
    }
    assert!(least > 93.0, "{least} % of 95 % intervals hold the truth");
}

/// Percentage of the intervals that hold the truth: of all elements and of the worst.
fn coverage<'a>(trials: impl Iterator<Item = &'a Trial>, I: &Matrix3) -> (f64, f64) {
    let all: Vec<[bool; 6]> = trials.map(|t| t.covered(I)).collect();
    let share = |k: usize| 100.0 * all.iter().filter(|c| c[k]).count() as f64 / all.len() as f64;
    let each: [f64; 6] = std::array::from_fn(share);
    (
        each.iter().sum::<f64>() / 6.0,
        each.into_iter().fold(100.0, f64::min),
    )
}

#[test]
fn stat_a_plate_stays_physical() {
    stays_physical(PLATE, 8, 2..=14);
}

/// Exactly flat, and with two equal moments.
#[test]
fn stat_a_flat_disc_stays_physical() {
    stays_physical(DISC, 10, 2..=18);
}

/// Data that contradict every physical body are not fitted by one: the answer is withheld.
#[test]
fn unit_data_beyond_every_body_are_rejected() {
    let I = Matrix3::from_diagonal(&Vector3::new(5.0, 6.0, 14.0));
    let truth = turning(I, INERTIA, 1.0e-4);
    let table = rotation_only(noisy(fly(&truth, &moving(&truth, 9)), 4, 1.0e-4));
    let mut model = truth;
    model.bodies[0].nominal.I_BBcm_B[(2, 2)] = 9.0;
    let answer = ask_in(&model, &table, Coordinates::Physical).estimate;
    assert_eq!(answer.status, Status::Rejected, "{:?}", answer.warnings());
    assert!(answer.bodies[0].inertia.iter().all(|n| n.value.is_none()));
}
