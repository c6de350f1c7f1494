//! A random external torque as a state of the filter.

use poinsot::identify::read_options;
use poinsot::{Identified, Question, identify_tables};
use poinsot_model::{Model, Nuisance, RandomTorque, read_model};
use poinsot_telemetry::{Table, read};
use std::path::Path;

fn record() -> (Model, Table) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/stsat3");
    let model = read_model(folder.join("model.toml")).unwrap();
    let options = read_options(&model, &model.telemetry, false, false);
    let table = read(&[folder.join("multiaxis/telemetry_noisy.csv")], &options).unwrap();
    (model, table)
}

fn answer(model: &Model, table: &Table) -> Identified {
    let request = Question {
        method: "maximum_likelihood".to_owned(),
        ..Question::default()
    };
    identify_tables(model.clone(), vec![table.clone()], &request).unwrap()
}

/// Tensor with its sigmas, and the deviance.
fn numbers(answer: &Identified) -> (Vec<[f64; 2]>, f64) {
    let inertia = answer.estimate.bodies[0].inertia;
    let pairs = inertia.map(|n| [n.value.unwrap(), n.sigma.unwrap()]);
    let deviance = answer.estimate.diagnostics.as_ref().unwrap().deviance;
    (pairs.to_vec(), deviance)
}

/// With infinite correlation time it is an unknown constant torque with a prior: equal answer, sigma and likelihood.
#[test]
fn exact_a_random_torque_that_never_forgets_is_a_constant_with_a_prior() {
    let (mut model, table) = record();
    let sigma_N_m = 3.0e-6;
    model.environment.random_torque = Some(RandomTorque {
        sigma_N_m,
        // In 240 s it changes by 2e-11 N m; the data resolve 2e-9 N m.
        correlation_s: 1.0e13,
    });
    let (process, own) = numbers(&answer(&model, &table));
    model.environment.random_torque = None;
    let (without, plain) = numbers(&answer(&model, &table));
    model.environment.disturbance_torque_inertial = Nuisance::Prior(sigma_N_m);
    let (constant, other) = numbers(&answer(&model, &table));
    println!("deviance {own:.4} {other:.4}, without {plain:.4}");
    // The total difference is 44; the process is linearised about zero torque.
    assert!((own - other).abs() < 0.2, "deviance {own} {other}");
    assert!(plain - own > 20.0 || own - plain > 20.0);
    for (a, (b, c)) in process.iter().zip(constant.iter().zip(&without)) {
        println!("{a:?} {b:?} without {c:?}");
    }
    for (a, b) in process.iter().zip(&constant) {
        assert!((a[0] - b[0]).abs() < 1.0e-2 * b[1]);
        assert!((a[1] / b[1] - 1.0).abs() < 1.0e-3);
    }
    let moved = process
        .iter()
        .zip(&without)
        .any(|(a, b)| a[1] > 1.01 * b[1]);
    assert!(moved, "so small a torque tests nothing");
}

/// A torque with short correlation time averages out, so it costs less accuracy than a long one. Prints both run
/// times: with one unknown per interval the first took half an hour.
#[test]
fn regress_a_torque_that_soon_forgets_is_a_state_like_one_that_lasts() {
    let (mut model, table) = record();
    let mut sigma = |correlation_s: f64| {
        model.environment.random_torque = Some(RandomTorque {
            sigma_N_m: 1.0e-4,
            correlation_s,
        });
        let start = std::time::Instant::now();
        let found = answer(&model, &table);
        println!(
            "{correlation_s} s, {} samples: {:.2} s",
            found.estimate.fit[0].samples,
            start.elapsed().as_secs_f64()
        );
        numbers(&found).0[0][1]
    };
    let (lasting, soon) = (sigma(10.0), sigma(0.1));
    assert!(soon < lasting, "{soon} {lasting}");
}
