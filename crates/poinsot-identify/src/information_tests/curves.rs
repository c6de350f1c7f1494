//! Curves of the report against the residuals of the fit.

use super::{MODEL, noise, segment};
use crate::fit::experiment::Experiment;
use crate::prediction::curves::predict;
use crate::problem::Problem;
use crate::problem::parameters::{Equations, Parameters};
use nalgebra::Vector3;
use poinsot_dynamics::Tree;
use poinsot_model::parse_model;

/// The residual of every curve is that of the fit: noisy joints, lags, increments and lost mass included.
#[test]
fn exact_curves_have_the_residuals_of_the_fit() {
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let mut later = segment(&model, &tree, true);
    later
        .observations
        .time_s
        .iter_mut()
        .for_each(|t| *t += 10.0);
    later.samples.time_s.iter_mut().for_each(|t| *t += 10.0);
    for firing in &mut later.firings {
        (firing.start_s, firing.end_s) = (firing.start_s + 10.0, firing.end_s + 10.0);
    }
    let segments = [segment(&model, &tree, true), later];
    let mut noise = noise(&tree);
    noise.joint_position.fill(1.0e-8);
    noise.joint_rate.fill(1.0e-6);
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    let mut experiment = Experiment::new(&problem, &parameters);
    experiment.keep_rows = true;
    let mut point = experiment.nominal_point();
    for (k, (x, unknown)) in point.x.iter_mut().zip(&parameters.unknowns).enumerate() {
        match unknown.name.ends_with(".lag") {
            true => *x = 0.03,
            false => *x += 0.01 * (k as f64).sin() * x.abs().max(0.05),
        }
    }
    let evaluated = experiment.evaluate(&point, false).unwrap();
    let predictions = predict(&experiment, &point, usize::MAX);
    assert_eq!(predictions.len(), 2);
    let mut compared = 0;
    for (s, prediction) in predictions.iter().enumerate() {
        let sensors = &segments[s].observations.sensors;
        assert_eq!(prediction.channels.len(), sensors.len());
        for (i, channel) in prediction.channels.iter().enumerate() {
            let kind = sensors[i].kind;
            let rows: Vec<Vector3<f64>> = evaluated[s].kept.of(Some(i)).map(|r| r.raw).collect();
            assert_eq!(channel.time_s.len(), rows.len(), "{kind:?}");
            for (k, raw) in rows.iter().enumerate() {
                for axis in 0..3 {
                    let gap = (channel.residual[axis][k] - raw[axis]).abs();
                    assert!(gap < 1.0e-12, "{s} {kind:?} {k} {axis}: {gap:e}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 400, "{compared}");
}
