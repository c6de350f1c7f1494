//! Joints that springs move, identified from records of the articulated bodies of the simulation: `docs/validation/flexible.md`.

use crate::tables;
use poinsot::case::{Case, parse_case};
use poinsot::predict::predict_case;
use poinsot::simulate::simulate_case;
use poinsot::trials::Study;
use poinsot::{Error, Question, identify_tables};
use poinsot_identify::{Estimate, Number};
use poinsot_model::{Model, SpringDamper, SpringNumber, read_model};
use poinsot_spatial::TENSOR;
use poinsot_telemetry::Table;
use std::path::Path;

const JOINTS: [(&str, &str); 2] = [("hinged_panel", "hinge"), ("slosh", "slosh")];

/// The case up to its third slew, and its true vehicle.
fn case(name: &str) -> (Case, Model) {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    let path = cases.join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("duration_s = 200.0", "duration_s = 115.0");
    let truth = read_model(cases.join(format!("{name}_truth.toml"))).unwrap();
    (parse_case(&path, text).unwrap(), truth)
}

/// The vehicle with an unknown inertia of its base, some per cent off, and unknown numbers of its spring.
fn asked(truth: &Model, joint: &str, unknown: &[SpringNumber]) -> Model {
    let mut model = truth.clone();
    model.bodies[0].estimate.inertia = true;
    let I = &mut model.bodies[0].nominal.I_BBcm_B;
    for (k, share) in [(0, 0.93), (1, 1.06), (2, 0.95)] {
        I[(k, k)] *= share;
    }
    let at = model.joint(joint).unwrap();
    let joint = &mut model.joints[at];
    joint.spring_unknown = unknown.to_vec();
    for number in unknown {
        *number.of(joint.spring_damper.as_mut().unwrap()) *= 0.9;
    }
    model
}

fn drawn(case: &Case, truth: &Model, model: &Model, trial: u64) -> Vec<Table> {
    Study::of_case(case, truth, model.clone())
        .unwrap()
        .draw(trial)
        .0
}

fn off(number: &Number, truth: f64) -> f64 {
    (number.value.unwrap() - truth) / number.sigma.unwrap()
}

fn answer(model: &Model, tables: Vec<Table>) -> Result<Estimate, Error> {
    Ok(identify_tables(model.clone(), tables, &Question::default())?.estimate)
}

#[test]
fn stat_a_vehicle_is_identified_with_the_spring_of_its_joint() {
    tables::heading(&[
        "joint",
        "trials",
        "answered",
        "rms z",
        "largest z",
        "rms z of the spring",
    ]);
    for (name, joint) in JOINTS {
        let (case, truth) = case(name);
        let unknown = [SpringNumber::Stiffness, SpringNumber::Damping];
        let model = asked(&truth, joint, &unknown);
        let trials = tables::trials(1);
        let (mut z, mut spring, mut answered) = (Vec::new(), Vec::new(), 0);
        for trial in 0..trials {
            let found = answer(&model, drawn(&case, &truth, &model, trial)).unwrap();
            if !found.covariance_trustworthy() {
                continue;
            }
            answered += 1;
            let I = truth.bodies[0].nominal.I_BBcm_B;
            let all = found.bodies[0].inertia.iter().zip(TENSOR);
            z.extend(all.map(|(number, at)| off(number, I[at])));
            let numbers = truth.joints[truth.joint(joint).unwrap()].spring_numbers();
            for (number, true_value) in numbers.filter(|(n, _)| unknown.contains(n)) {
                let name = format!("{joint}.{}", number.name());
                let own = found.nuisance.iter().find(|n| n.name == name).unwrap();
                spring.push(off(&own.number, true_value));
            }
        }
        let rms = |all: &[f64]| (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
        let largest = |all: &[f64]| all.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
        tables::row(&[
            joint.to_owned(),
            trials.to_string(),
            answered.to_string(),
            format!("{:.2}", rms(&z)),
            format!("{:.1}", largest(&z).max(largest(&spring))),
            format!("{:.2}", rms(&spring)),
        ]);
        assert_eq!(answered, trials, "{joint}");
        assert!(
            largest(&z) < 4.5 && largest(&spring) < 4.5,
            "{joint}: {z:?} {spring:?}"
        );
    }
}

#[test]
fn stat_a_prediction_states_what_the_fit_of_its_record_states() {
    let (case, truth) = case("hinged_panel");
    let model = asked(&truth, "hinge", &[]);
    let mut vehicle = truth.clone();
    vehicle.bodies[0].estimate = model.bodies[0].estimate;
    let predicted = predict_case(&case, vehicle, 1.0).unwrap().bound;
    let found = answer(&model, drawn(&case, &truth, &model, 5)).unwrap();
    let pairs = predicted.bodies[0]
        .inertia
        .iter()
        .zip(&found.bodies[0].inertia);
    for (before, after) in pairs {
        let ratio = after.sigma.unwrap() / before.sigma.unwrap();
        assert!((0.9..1.1).contains(&ratio), "{before:?}: {ratio}");
    }
}

#[test]
fn exact_a_column_of_the_joint_takes_the_place_of_its_spring() {
    let (case, truth) = case("hinged_panel");
    let model = asked(&truth, "hinge", &SpringNumber::ALL);
    let text = std::fs::read_to_string(case.path()).unwrap();
    let text = text
        .replace("sensors_only = true", "")
        .replace("200.0", "60.0");
    let read = parse_case(case.path(), text).unwrap();
    let mut tables = drawn(&read, &truth, &model, 1);
    let all = simulate_case(&read, &truth).unwrap().table;
    let joint = all
        .channels
        .into_iter()
        .filter(|c| c.name.starts_with("hinge"));
    tables[0].channels.extend(joint);
    assert!(tables[0].channel("hinge_rad").is_some());
    let with_spring = answer(&model, tables.clone()).unwrap();
    let mut without = model.clone();
    without.joints[0].spring_damper = None;
    without.joints[0].spring_unknown.clear();
    let without_spring = answer(&without, tables).unwrap();
    assert_eq!(with_spring.bodies, without_spring.bodies);
    let said = "assumed: hinge moves as 'hinge_rad' says, and its spring_damper has no effect";
    assert!(with_spring.remarks.iter().any(|r| r.words.ends_with(said)));
}

#[test]
fn unit_what_is_not_identified_beside_a_passive_joint_is_refused() {
    let (case, truth) = case("hinged_panel");
    let model = asked(&truth, "hinge", &[]);
    let tables = drawn(&case, &truth, &model, 1);
    let refused = |model: &Model| {
        let error = answer(model, tables.clone()).unwrap_err();
        assert_eq!(error.list[0].code, "E0408", "{error}");
        error.list[0].problem.clone()
    };
    let mut other = model.clone();
    other.wheels[0].body = 1;
    assert!(refused(&other).contains("a wheel on what it carries"));
    let linear = Question {
        method: "linear".to_owned(),
        ..Question::default()
    };
    let error = identify_tables(model, tables.clone(), &linear)
        .err()
        .unwrap();
    assert!(
        error.to_string().contains("joints that springs move"),
        "{error}"
    );
}

#[test]
fn unit_a_spring_of_negative_stiffness_is_no_motion() {
    let (case, truth) = case("slosh");
    let mut model = asked(&truth, "slosh", &[]);
    let tables = drawn(&case, &truth, &model, 1);
    model.joints[0].spring_damper = Some(SpringDamper {
        stiffness: -1.0,
        rest: 0.0,
        damping: 0.0,
    });
    assert!(answer(&model, tables).is_err());
}
