//! Valves that open and close a little off the times of the telemetry, and forces with a common error.

use crate::tables;
use poinsot::case::read_case;
use poinsot::simulate::simulate_trial;
use poinsot::{Identified, Question, identify_tables};
use poinsot_model::{Model, Origin, read_model};
use poinsot_telemetry::Table;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::path::{Path, PathBuf};

/// Error of every switching time, s: up to four times the noise of the gyro each. With 20 ms the flight strays by half a radian from what
/// the telemetry predicts, beyond what is linear, and the answer is "not converged".
const TIMING_S: f64 = 3.0e-3;
/// Probability that a right estimator fails.
const FALSE_ALARM: f64 = 1.0e-3;

fn data(name: &str) -> PathBuf {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    cases.join(name)
}

fn tug() -> Model {
    let mut model = read_model(&data("tug_truth.toml")).unwrap();
    for thruster in &mut model.thrusters {
        thruster.timing_sigma_s = TIMING_S;
    }
    model
}

fn flown(model: &Model, trial: u64) -> Table {
    let case = read_case(&data("tug_thrusters.toml")).unwrap();
    simulate_trial(&case, model, trial).unwrap().table
}

fn identified(model: Model, table: Table) -> Identified {
    identify_tables(model, vec![table], &Question::default()).unwrap()
}

/// Errors of the ten numbers, in their sigmas.
fn errors(found: &Identified, truth: &Model) -> Vec<f64> {
    let (body, nominal) = (&found.estimate.bodies[0], &truth.bodies[0].nominal);
    let I = &nominal.I_BBcm_B;
    let order = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
    let inertia = order.map(|(i, j)| I[(i, j)]);
    let com = body.com.iter().zip(nominal.p_BoBcm_B.iter().copied());
    let all = std::iter::once((&body.mass, nominal.mass)).chain(com);
    let all = all.chain(body.inertia.iter().zip(inertia));
    all.map(|(n, truth)| (n.value.unwrap() - truth) / n.sigma.unwrap())
        .collect()
}

#[test]
fn stat_answers_with_errors_of_switching_times_are_calibrated() {
    let truth = tug();
    let n = tables::trials(8);
    let answer = |trial: u64| identified(truth.clone(), flown(&truth, trial));
    let all: Vec<Identified> = (0..n).into_par_iter().map(answer).collect();
    let z: Vec<f64> = all.iter().flat_map(|f| errors(f, &truth)).collect();
    let square = z.iter().map(|z| z * z).sum::<f64>();
    let passed = all.iter().filter(|f| f.passes()).count() as u64;
    let largest = z.iter().fold(0.0, |a: f64, z| a.max(z.abs()));
    println!(
        "{passed} of {n}, rms z {:.2}, largest {largest:.1}",
        (square / z.len() as f64).sqrt()
    );
    // The ten numbers of a trial correlate: as if they were four.
    let squares = ChiSquared::new(4.0 * n as f64).unwrap();
    let limits = [0.5 * FALSE_ALARM, 1.0 - 0.5 * FALSE_ALARM]
        .map(|p| squares.inverse_cdf(p) / (4.0 * n as f64));
    let mean = square / z.len() as f64;
    assert!(mean > limits[0] && mean < limits[1], "{mean} {limits:?}");
    assert!(passed + 1 >= n, "{passed} of {n}");
}

#[test]
fn stat_switching_times_that_are_taken_as_exact_are_noticed() {
    let truth = tug();
    let mut exact = truth.clone();
    for thruster in &mut exact.thrusters {
        thruster.timing_sigma_s = 0.0;
    }
    for trial in 0..3 {
        let found = identified(exact.clone(), flown(&truth, trial));
        assert!(!found.passes(), "{trial}");
    }
}

/// A factor on all thrusts is one on all masses: the data say nothing of it.
#[test]
fn exact_a_common_error_of_all_forces_is_that_of_the_mass() {
    let sigma = |correlation: f64| {
        let mut model = tug().with_usual_uncertainty(Origin::Cad);
        model
            .knowledge
            .uncertain
            .retain(|u| matches!(u.number, poinsot_model::KnownNumber::Force(_)));
        model.knowledge.thrust_correlation = correlation;
        let found = identified(model, flown(&tug(), 0));
        let remarks: Vec<String> = found
            .estimate
            .remarks
            .iter()
            .map(|r| r.words.clone())
            .collect();
        assert!(
            remarks.iter().any(|r| r.contains("thrust_correlation")),
            "{remarks:?}"
        );
        let mass = &found.estimate.bodies[0].mass;
        mass.sigma.unwrap() / mass.value.unwrap()
    };
    let [apart, together] = [0.0, 0.99].map(sigma);
    // 5 % each, of twelve or so thrusters of unequal use.
    assert!(apart < 0.03, "{apart}");
    assert!((together / 0.05 - 1.0).abs() < 0.05, "{together}");
}
