//! Memory allocations of a fit: few for a sample, whatever the number of evaluations. A binary of its own, because it has another
//! allocator.
#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use poinsot::bind::bind;
use poinsot::case::read_case;
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{FitOptions, Problem, maximum_likelihood_with};
use poinsot_model::read_model;
use std::path::Path;

/// Rates of the two records, Hz.
const RATES: [f64; 2] = [5.0, 20.0];
/// Cases, with the most allocations of a whole fit for a further sample. Where joints move, the linear start makes lists for each.
const CASES: [(&str, f64); 5] = [
    ("examples/cases/faults.toml", 1.0),
    ("examples/cases/stsat3_three_slews.toml", 1.0),
    ("examples/cases/pyramid.toml", 1.0),
    (
        "crates/poinsot/examples/faults/cases/two_link_arm.toml",
        8.0,
    ),
    ("examples/cases/ma2008_traj1.toml", 8.0),
];

/// Samples, and allocations of a fit without diagnosis.
fn fit(case: &str, rate_hz: f64) -> (usize, u64) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut case = read_case(&root.join(case)).unwrap();
    case.rate_hz = rate_hz;
    let truth = read_model(&case.model).unwrap();
    let mut model = truth.clone();
    for body in model.bodies.iter_mut().filter(|b| b.estimate.any()) {
        body.nominal.I_BBcm_B *= 0.97;
    }
    let study = Study::of_case(&case, &truth, model).unwrap();
    let (tables, _) = study.draw(0);
    let tree = Tree::new(&study.model);
    let bound = bind(&study.model, &tree, &tables).unwrap();
    let problem = Problem {
        model: &study.model,
        tree: &tree,
        segments: &bound.segments,
        noise: &bound.noise,
        relative_accuracy: 1.0,
    };
    let samples = bound.segments.iter().map(|s| s.observations.time_s.len());
    let samples: usize = samples.sum();
    let options = FitOptions {
        undiagnosed: true,
        ..FitOptions::default()
    };
    // The counter is that of a thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let counted = pool
        .unwrap()
        .install(|| measure(|| assert!(maximum_likelihood_with(&problem, options).is_ok())));
    (samples, counted.count_total)
}

#[test]
fn prop_a_fit_allocates_little_for_a_sample() {
    for (case, most) in CASES {
        let [few, many] = RATES.map(|rate| fit(case, rate));
        let each = (many.1 as f64 - few.1 as f64) / (many.0 - few.0) as f64;
        println!("{case}: {few:?}, {many:?}, {each:.2} a sample");
        assert!(each < most, "{case}: {each:.2} allocations a sample");
    }
}
