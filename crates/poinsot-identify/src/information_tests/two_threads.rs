//! A segment followed on one thread and compared on another against the same on one.

use super::{MODEL, colour, finer, noise};
use crate::fit::experiment::Experiment;
use crate::likelihood::{Evaluated, Setting, evaluate};
use crate::problem::Problem;
use crate::problem::parameters::{Equations, Parameters};
use poinsot_dynamics::Tree;
use poinsot_model::parse_model;

/// Every number of the triangle and the residuals as its bits.
fn bits(one: &Evaluated) -> Vec<u64> {
    let mut all = vec![one.chi2, one.cost];
    all.extend(one.channels.iter().flat_map(|c| &c.white).flatten());
    if let Some(triangle) = &one.triangle {
        let r = &triangle.r;
        all.extend((0..r.ncols()).flat_map(|j| (0..r.nrows()).map(move |i| r[(i, j)])));
    }
    all.into_iter().map(f64::to_bits).collect()
}

#[test]
fn exact_two_threads_give_the_bits_of_one() {
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    let mut noise = noise(&tree);
    noise.joint_position = vec![1.0e-6, 2.0e-6];
    noise.wheel_speed = vec![1.0e-2];
    for (translation, shift) in [(true, 0.0), (true, 1.0), (false, 1.0)] {
        let mut segments = [finer(&model, &tree, translation, 50)];
        segments.iter_mut().for_each(colour);
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: &segments,
            noise: &noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let experiment = Experiment::new(&problem, &parameters);
        let mut point = experiment.nominal_point();
        // Faults of joints, wheels and lags that are zero look at both sides of a grid time, others do not.
        for (k, x) in point.x.iter_mut().enumerate() {
            *x += shift * 1.0e-3 * (k as f64).sin() * x.abs().max(0.05);
        }
        let on = |split: bool, with_sensitivities: bool| {
            let setting = Setting {
                split,
                ..experiment.setting()
            };
            let (initial_state, unknown) = (&point.initial_states[0], experiment.unknown[0]);
            let x = &point.x;
            let of = (0, &segments[0]);
            bits(&evaluate(&setting, of, x, initial_state, unknown, with_sensitivities).unwrap())
        };
        for with_sensitivities in [true, false] {
            let (one, two) = (on(false, with_sensitivities), on(true, with_sensitivities));
            assert!(one.len() > 1000);
            assert!(one == two, "{translation} {shift} {with_sensitivities}");
        }
    }
}
