//! Memory allocations of a fit: none for a further sample. A separate binary, because it has another allocator.
#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use poinsot::bind::bind;
use poinsot::case::read_case;
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{Settings, maximum_likelihood_with};
use poinsot_model::parse_model;
use std::path::Path;

/// Rates of the two records, Hz.
const RATES: [f64; 2] = [20.0, 80.0];
/// Most allocations of a whole fit for a further sample. The two fits may differ by an iteration of some hundred.
const NONE: f64 = 0.1;
/// Cases, and sensors and disturbances that are added to their vehicles.
const CASES: [(&str, &str); 7] = [
    ("data/cases/faults.toml", ""),
    ("data/cases/stsat3_three_slews.toml", ""),
    ("data/cases/pyramid.toml", ""),
    ("data/cases/ma2008_traj1.toml", ""),
    (ARM, ""),
    (ARM, ACCELEROMETERS),
    (ARM, ON_A_LINK),
];
const ARM: &str = "crates/poinsot/tests/all/faults/cases/two_link_arm.toml";
const ACCELEROMETERS: &str = r#"
[[sensor]]
name = "accelerometer"
type = "accelerometer"
body = "lower"
position_m = [0.1, 0.2, 0.0]
noise_m_s2 = 1.0e-4
[[sensor]]
name = "increments"
type = "velocity_increment"
position_m = [0.1, 0.0, 0.3]
noise_m_s = 1.0e-4
"#;
/// A random torque, and sensors on a link: their noise remembers, or the sun is what they see.
const ON_A_LINK: &str = r#"
[environment]
random_torque = { sigma_N_m = 1.0e-3, correlation_s = 5.0 }
[[sensor]]
name = "link_gyro"
type = "gyro"
body = "lower"
noise_rad_s = 1.0e-4
correlation_s = 2.0
[[sensor]]
name = "sun_sensor"
type = "direction"
body = "lower"
reference_N = [0.3, 0.5, 0.8]
noise_rad = 1.0e-4
"#;

/// Samples, and allocations of a fit without diagnosis.
fn fit((case, added): (&str, &str), rate_hz: f64) -> (usize, u64) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut case = read_case(&root.join(case)).unwrap();
    case.rate_hz = rate_hz;
    let text = std::fs::read_to_string(&case.model).unwrap();
    let truth = parse_model(&(text + added), "model.toml").unwrap();
    let mut model = truth.clone();
    for body in model.bodies.iter_mut().filter(|b| b.estimate.any()) {
        body.nominal.I_BBcm_B *= 0.97;
    }
    let study = Study::of_case(&case, &truth, model).unwrap();
    let (tables, _) = study.draw(0);
    let tree = Tree::new(&study.model);
    let bound = bind(&study.model, &tree, &tables).unwrap();
    let problem = bound.problem(&study.model, &tree);
    let samples = bound.segments.iter().map(|s| s.observations.time_s.len());
    let samples: usize = samples.sum();
    let options = Settings {
        undiagnosed: true,
        ..Settings::default()
    };
    // The counter is that of a thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let counted = pool
        .unwrap()
        .install(|| measure(|| assert!(maximum_likelihood_with(&problem, options).is_ok())));
    (samples, counted.count_total)
}

#[test]
fn prop_a_fit_allocates_nothing_for_a_sample() {
    for (case, added) in CASES {
        let [few, many] = RATES.map(|rate| fit((case, added), rate));
        let each = (many.1 as f64 - few.1 as f64) / (many.0 - few.0) as f64;
        println!("{case}{added}: {few:?}, {many:?}, {each:.2} a sample");
        assert!(each < NONE, "{case}{added}: {each:.2} allocations a sample");
    }
}
