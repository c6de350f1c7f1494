//! Forces of thrusters that may have a common error.

use poinsot::case::read_case;
use poinsot::simulate::simulate_trial;
use poinsot::{Question, identify_tables};
use poinsot_model::{KnownNumber, Model, Origin, read_model};
use std::path::Path;

fn tug() -> Model {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    read_model(cases.join("tug_truth.toml")).unwrap()
}

/// A factor on all thrusts is one on all masses: the data say nothing of it.
#[test]
fn exact_a_common_error_of_all_forces_is_that_of_the_mass() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let case = read_case(&cases.join("tug_thrusters.toml")).unwrap();
    let table = simulate_trial(&case, &tug(), 0).unwrap().table;
    let sigma = |correlation: f64| {
        let mut model = tug().with_usual_uncertainty(Origin::Cad);
        model
            .knowledge
            .uncertain
            .retain(|u| matches!(u.number, KnownNumber::Force(_)));
        model.knowledge.thrust_correlation = correlation;
        let found = identify_tables(model, vec![table.clone()], &Question::default()).unwrap();
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
    let [apart, partly, together] = [0.0, 0.86, 0.99].map(sigma);
    // 5 % each, of twelve or so thrusters of unequal use.
    assert!(apart < 0.03, "{apart}");
    assert!((partly / 0.0468 - 1.0).abs() < 0.05, "{partly}");
    assert!((together / 0.05 - 1.0).abs() < 0.05, "{together}");
}
