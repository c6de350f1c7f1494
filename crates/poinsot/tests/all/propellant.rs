//! Mass that leaves with the propellant: simulated, identified, and named where it is not declared.

use poinsot::case::{Case, read_case};
use poinsot::simulate::run;
use poinsot::trials::Study;
use poinsot::{Question, identify_tables};
use poinsot_identify::{FaultKind, Status};
use poinsot_model::{Model, Propellant, parse_model, read_model, write_model};
use poinsot_spatial::Vector3;
use std::path::Path;

/// Specific impulse, s: so low that a record of 80 s shows the mass that is lost.
const WEAK: f64 = 12.0;

fn satellite() -> (Case, Model) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut case = read_case(&root.join("data/cases/faults.toml")).unwrap();
    case.rate_hz = 10.0;
    let model = read_model(&case.model).unwrap();
    (case, model)
}

/// With a tank beside the mass centre.
fn burning(model: &Model) -> Model {
    let mut model = model.clone();
    for thruster in &mut model.thrusters {
        thruster.propellant = Some(Propellant {
            specific_impulse: WEAK,
            p_BoF_B: Vector3::new(0.15, -0.2, 0.1),
        });
    }
    model
}

fn off(mut model: Model) -> Model {
    let bus = &mut model.bodies[0].nominal;
    bus.mass *= 1.05;
    bus.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
    bus.I_BBcm_B *= 0.93;
    model
}

#[test]
fn xval_a_vehicle_that_burns_propellant_is_identified_at_the_start_of_its_record() {
    let (case, model) = satellite();
    let truth = burning(&model);
    let study = Study::of_case(&case, &truth, off(truth.clone())).unwrap();
    let question = Question::default();
    let found = identify_tables(study.model.clone(), study.exact.clone(), &question).unwrap();
    let estimate = &found.estimate;
    assert_eq!(estimate.status, Status::Converged);
    let diagnostics = estimate.diagnostics.as_ref().unwrap();
    // Samples without noise: what is left is the integration's error.
    assert!(diagnostics.chi2 < 1.0e-3, "{:.2e}", diagnostics.chi2);
    let bus = &estimate.bodies[0];
    let mass = bus.mass.value.unwrap();
    let true_mass = truth.bodies[0].nominal.mass;
    assert!((mass / true_mass - 1.0).abs() < 1.0e-8, "{mass}");
}

#[test]
fn stat_propellant_that_nobody_declared_is_named() {
    let (case, model) = satellite();
    let truth = burning(&model);
    let study = Study::of_case(&case, &truth, off(model)).unwrap();
    let (tables, _) = study.draw(1);
    let found = identify_tables(study.model.clone(), tables, &Question::default()).unwrap();
    let diagnostics = found.estimate.diagnostics.as_ref().unwrap();
    let first = diagnostics.findings.first().unwrap();
    assert_eq!(first.fault, FaultKind::PropellantUse, "{}", first.text);
    assert!(!found.passes());
}

#[test]
fn unit_propellant_reads_back_as_written() {
    let (_, model) = satellite();
    let model = burning(&model);
    let read = parse_model(&write_model(&model), "written").unwrap();
    assert_eq!(read.thrusters, model.thrusters);
}

#[test]
fn cli_propellant_without_specific_impulse_is_refused() {
    let (_, model) = satellite();
    let text = write_model(&burning(&model));
    let refused = |from: &str, to: &str| {
        let changed = text.replace(from, to);
        assert_ne!(changed, text);
        parse_model(&changed, "test").unwrap_err().to_string()
    };
    let missing = refused("specific_impulse_s = 12.0\n", "");
    assert!(
        missing.contains("E0106") && missing.contains("specific_impulse_s"),
        "{missing}"
    );
    let negative = refused("specific_impulse_s = 12.0", "specific_impulse_s = -12.0");
    assert!(
        negative.contains("E0108") && negative.contains("-12"),
        "{negative}"
    );
}

#[test]
fn cli_what_cannot_lose_mass_says_so() {
    let (case, model) = satellite();
    let truth = burning(&model);
    let study = Study::of_case(&case, &truth, truth.clone()).unwrap();
    let question = Question {
        method: "linear".to_owned(),
        ..Question::default()
    };
    let refused = identify_tables(truth.clone(), study.exact.clone(), &question);
    let refused = refused.map(|_| ()).unwrap_err().to_string();
    assert!(refused.contains("propellant use"), "{refused}");
    let scenario = case.bind(&truth).unwrap();
    let bodies: Vec<_> = truth
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let refused = run(&case, &truth, Some(&bodies), &scenario, |_, _| {});
    let refused = refused.map(|_| ()).unwrap_err().to_string();
    assert!(refused.contains("specific_impulse_s"), "{refused}");
}
