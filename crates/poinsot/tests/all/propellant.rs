//! Mass that leaves with the propellant: simulated, identified, and named where it is not declared.

use poinsot::case::{Case, read_case};
use poinsot::trials::Study;
use poinsot::{Question, identify_tables};
use poinsot_identify::{Estimate, FaultKind, Number, Status, TENSOR};
use poinsot_model::{
    KnownNumber, Model, Origin, Propellant, Uncertain, parse_model, read_model, write_model,
};
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

/// Thrusters that use 6 % more than declared, from a place 2 cm beside the declared one. Where both count as exact, errors are larger
/// than stated. Where they are known to 5 % and 2 cm errors are as large as stated. Where they are hardly known, the data show them.
#[test]
fn stat_uncertain_propellant_use_is_estimated_with_the_mass_properties() {
    let (case, model) = satellite();
    let truth = burning(&model);
    let mut told = truth.clone();
    for thruster in &mut told.thrusters {
        let propellant = thruster.propellant.as_mut().unwrap();
        propellant.specific_impulse *= 1.06;
        propellant.p_BoF_B.y += 0.02;
    }
    let study = Study::of_case(&case, &truth, off(told)).unwrap();
    let known_to = |share: f64| -> Vec<Uncertain> {
        let of = |k: usize| {
            let pair = [
                (KnownNumber::SpecificImpulse(k), share),
                (KnownNumber::PropellantPlace(k), 0.02),
            ];
            pair.map(|(number, sigma)| Uncertain { number, sigma })
        };
        (0..truth.thrusters.len()).flat_map(of).collect()
    };
    let answers = |uncertain: &[Uncertain]| -> Vec<Estimate> {
        let answer = |seed: u64| {
            let mut model = study.model.clone();
            model.knowledge.uncertain = uncertain.to_vec();
            let (tables, _) = study.draw(seed);
            let found = identify_tables(model, tables, &Question::default()).unwrap();
            assert_eq!(found.estimate.status, Status::Converged, "{seed}");
            found.estimate
        };
        (0..6).map(answer).collect()
    };
    let rms = |answers: &[Estimate]| {
        let each = answers.iter().flat_map(|estimate| errors(estimate, &truth));
        let squares: Vec<f64> = each.map(|z| z * z).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let hardly = answers(&known_to(0.5));
    let used: Vec<f64> = hardly
        .iter()
        .flat_map(|estimate| &estimate.known_numbers.effects)
        .filter(|e| e.name.ends_with("specific_impulse"))
        .filter_map(|e| e.estimated.map(|(value, sigma)| (value - WEAK) / sigma))
        .collect();
    let of = [
        rms(&answers(&[])),
        rms(&answers(&known_to(0.05))),
        rms(&hardly),
    ];
    println!(
        "root mean square of error over sigma, exact, 5 %, 50 %: {of:.2?}; specific impulses {used:.2?}"
    );
    assert!(of[0] > 1.5, "{of:?}");
    assert!(of[1..].iter().all(|rms| (0.7..1.4).contains(rms)), "{of:?}");
    assert!(
        !used.is_empty() && used.iter().all(|z| z.abs() < 4.5),
        "{used:?}"
    );
}

/// Errors of the base's mass properties over their sigmas.
fn errors(estimate: &Estimate, truth: &Model) -> impl Iterator<Item = f64> {
    let (bus, true_bus) = (estimate.bodies[0].clone(), truth.bodies[0].nominal);
    let numbers = std::iter::once(bus.mass).chain(bus.com).chain(bus.inertia);
    let inertia = TENSOR.map(|e| true_bus.I_BBcm_B[e]);
    let com = <[f64; 3]>::from(true_bus.p_BoBcm_B);
    let values = std::iter::once(true_bus.mass).chain(com).chain(inertia);
    let z = |(n, x): (Number, f64)| (n.value.unwrap() - x) / n.sigma.unwrap();
    numbers.zip(values).map(z)
}

#[test]
fn unit_propellant_reads_back_as_written() {
    let (_, model) = satellite();
    let model = burning(&model);
    let read = parse_model(&write_model(&model), "written").unwrap();
    assert_eq!(read.thrusters, model.thrusters);
    let uncertain = write_model(&model.with_usual_uncertainty(Origin::Measured));
    let read = parse_model(&uncertain, "written").unwrap();
    let sigma = |number: KnownNumber| {
        read.uncertain()
            .find(|u| u.number == number)
            .map(|u| u.sigma)
    };
    assert_eq!(sigma(KnownNumber::SpecificImpulse(0)), Some(0.01));
    assert_eq!(sigma(KnownNumber::PropellantPlace(0)), Some(5.0e-3));
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
    let alone = refused(
        "specific_impulse_s = 12.0\npropellant_m = [0.15, -0.2, 0.1]\n",
        "uncertainty = { specific_impulse = 0.1 }\n",
    );
    assert!(
        alone.contains("E0106") && alone.contains("uncertainty.specific_impulse"),
        "{alone}"
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
}
