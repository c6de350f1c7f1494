//! Designs after an answer: what both records together tell, vehicles of the posterior, and answers of another vehicle.
#![allow(clippy::unwrap_used, non_snake_case)]

use poinsot::bind::bind;
use poinsot::case::{Case, parse_case};
use poinsot::posterior::after_answer;
use poinsot::predict::wanted_sigma;
use poinsot::simulate::{simulate_exact, simulate_trial};
use poinsot::{Question, identify_tables, write_estimate};
use poinsot_design::{DesignRequest, Designed, design_case, drawn, manoeuvre_case};
use poinsot_dynamics::Tree;
use poinsot_formats::DesignedNumberFile;
use poinsot_identify::predicted_covariance;
use poinsot_model::{Model, parse_model};
use poinsot_testkit::vehicles::ModelText;
use std::path::Path;
use tempfile::TempDir;

/// All wheels, and one of them.
const ALL: &str = r#"["a", "b", "c"]"#;
const ONE: &str = r#"["a"]"#;

/// A box with three wheels, whose spin inertias are known as `knowledge` says.
fn vehicle(knowledge: &str) -> Model {
    let text = ModelText::new("box with three wheels")
        .body(
            "box",
            40.0,
            [0.0; 3],
            [2.0, 2.6, 3.1, 0.1, -0.05, 0.2],
            "estimate = [\"inertia\"]",
        )
        .wheel("a", "box", [1.0, 0.0, 0.0], 0.002)
        .wheel("b", "box", [0.0, 1.0, 0.0], 0.0021)
        .wheel("c", "box", [0.0, 0.0, 1.0], 0.0022)
        .sensor(
            "gyro",
            "gyro",
            "noise_rad_s = 2.0e-5\nbias = { sigma_rad_s = 1.0e-4 }",
        )
        .sensor("tracker", "attitude", "noise_rad = 5.0e-5")
        .text();
    let text = text.replace("exact = true", knowledge);
    assert!(text.contains(knowledge));
    parse_model(&text, "box.toml").unwrap()
}

/// 20 s in which the design moves these wheels.
fn case(wheels: &str) -> Case {
    let stays = |wheel: &&str| !wheels.contains(&format!("{wheel:?}"));
    let rest = ["a", "b", "c"].into_iter().filter(stays).map(|wheel| {
        format!("[[wheel_motion]]\nwheel = \"{wheel}\"\ntime_s = [0.0]\nspeed_rad_s = [0.0]\n")
    });
    let rest: String = rest.collect();
    let text = format!(
        r#"
schema = "poinsot.case/2"
model = "box.toml"
duration_s = 20.0
[initial]
momentum_zero = true
[output]
rate_hz = 5
seed = 3
sensors_only = true
{rest}[[want]]
number = "box.inertia_kg_m2"
relative = 1.0e-3
[limits]
[[limits.wheel]]
speed_rad_s = 150.0
torque_N_m = 0.05
[design]
starts = 2
evaluations = 400
[[design.wheel]]
wheels = {wheels}
nodes = 6
"#
    );
    parse_case(Path::new("box_case.toml"), text).unwrap()
}

/// The segment in which a design moves these wheels, and a folder with the answer to its record.
fn first_segment(model: &Model, wheels: &str) -> (TempDir, Case) {
    let begun = design_case(&case(wheels), model.clone(), &DesignRequest::default()).unwrap();
    let flown = manoeuvre_case(&begun, Path::new("")).unwrap();
    let record = simulate_trial(&flown, model, 1).unwrap().table;
    let answer = identify_tables(model.clone(), vec![record], &Question::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write_estimate(folder.path(), &answer).unwrap();
    (folder, flown)
}

/// The design of a segment with these wheels after an answer.
fn next_segment(model: &Model, wheels: &str, answer: &Path, verify: u64) -> Designed {
    let request = DesignRequest {
        after: Some(answer.to_owned()),
        verify,
        ..DesignRequest::default()
    };
    design_case(&case(wheels), model.clone(), &request).unwrap()
}

/// How far the sigmas of a design after an answer are from those of a prediction of both records together, relative, ascending.
fn beside_both(knowledge: &str, next: &str) -> Vec<f64> {
    let model = vehicle(knowledge);
    let (folder, first) = first_segment(&model, ALL);
    let next = next_segment(&model, next, folder.path(), 0);
    let second = manoeuvre_case(&next, Path::new("")).unwrap();
    let mut at_answer = after_answer(&model, folder.path(), false).unwrap();
    at_answer.knowledge.posterior = None;
    let records = [&first, &second].map(|c| simulate_exact(c, &at_answer).unwrap().table);
    let tree = Tree::new(&at_answer);
    let bound = bind(&at_answer, &tree, &records).unwrap();
    let both = predicted_covariance(&bound.problem(&at_answer, &tree)).unwrap();
    let wants = second.wants(&at_answer).unwrap();
    let pairs = wants.iter().zip(&next.file.wants);
    let ratios = pairs.map(|(want, own)| {
        let (sigma, known) = (own.sigma.unwrap(), own.known_sigma.unwrap());
        assert!(sigma < 1.001 * known, "{own:?}");
        sigma / wanted_sigma(&both, want).unwrap()
    });
    let mut off: Vec<f64> = ratios.map(|r| (r - 1.0).abs()).collect();
    off.sort_by(f64::total_cmp);
    off
}

#[test]
fn xval_a_design_after_an_answer_predicts_what_both_records_tell() {
    let off = beside_both("exact = true", ALL);
    assert!(off.iter().all(|off| *off < 0.005), "{off:?}");
}

#[test]
fn xval_errors_of_known_numbers_are_common_to_both_records() {
    // The next segment need not move the wheels on which the answer depends. If the errors of the
    // two segments were independent, sigmas would be 29 % less; if those of the known numbers were, up to 22 % off.
    for next in [ALL, ONE] {
        let off = beside_both("source = \"cad\"", next);
        assert!(off.iter().all(|off| *off < 0.005), "{next}: {off:?}");
    }
}

#[test]
fn xval_a_partial_answer_counts_for_what_it_determines() {
    let mut model = vehicle("exact = true");
    // Rotation alone does not show the mass.
    model.bodies[0].estimate.mass = true;
    let (folder, _) = first_segment(&model, ALL);
    let after = after_answer(&model, folder.path(), false).unwrap();
    let posterior = after.knowledge.posterior.unwrap();
    assert_eq!(posterior.place("box.mass_kg"), None);
    assert_eq!(after.bodies[0].nominal.mass, 40.0);
    let next = next_segment(&model, ALL, folder.path(), 0);
    let learns = |w: &DesignedNumberFile| w.sigma.unwrap() < w.known_sigma.unwrap();
    assert!(next.file.wants.iter().all(learns));
    assert!(next.file.after.is_some());
}

#[test]
fn stat_vehicles_drawn_after_an_answer_scatter_as_it_states() {
    let model = vehicle("source = \"cad\"");
    let (folder, _) = first_segment(&model, ALL);
    let after = after_answer(&model, folder.path(), false).unwrap();
    let told = after.knowledge.posterior.clone().unwrap();
    let [x, y] = ["xx", "yy"].map(|e| told.place(&format!("box.inertia_kg_m2.{e}")).unwrap());
    let draws = 4000;
    let of = |k: usize| (0..draws).map(move |n| (n, k));
    let nominal = after.bodies[0].nominal.I_BBcm_B;
    let deviation = |(n, k): (u64, usize)| {
        let own = drawn(&after, 7, n).bodies[0].nominal.I_BBcm_B;
        own[(k, k)] - nominal[(k, k)]
    };
    let x_own: Vec<f64> = of(0).map(deviation).collect();
    let y_own: Vec<f64> = of(1).map(deviation).collect();
    let mean = |a: &[f64], b: &[f64]| {
        let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        sum / draws as f64
    };
    // Five standard deviations of a sample variance.
    let band = 5.0 * (2.0 / draws as f64).sqrt();
    let scale = (told.between(x, x) * told.between(y, y)).sqrt();
    assert!((mean(&x_own, &x_own) / told.between(x, x) - 1.0).abs() < band);
    assert!((mean(&x_own, &y_own) - told.between(x, y)).abs() < band * scale);
}

#[test]
fn stat_trial_flights_after_an_answer_agree_with_the_prediction() {
    let model = vehicle("exact = true");
    let (folder, _) = first_segment(&model, ALL);
    let found = next_segment(&model, ALL, folder.path(), 60);
    let verified = found.file.verification.unwrap();
    assert!(verified.agrees, "{verified:?}");
}

#[test]
fn exact_an_answer_of_another_vehicle_is_refused() {
    let model = vehicle("exact = true");
    let (folder, _) = first_segment(&model, ALL);
    let refused = |other: &Model| after_answer(other, folder.path(), false).unwrap_err();
    let mut renamed = model.clone();
    renamed.bodies[0].name = "bus".to_owned();
    let error = refused(&renamed);
    assert_eq!(error.list[0].code, "E0605");
    assert!(error.to_string().contains("no body \"box\""), "{error}");
    let mut more = model.clone();
    more.bodies[0].estimate.mass = true;
    let error = refused(&more);
    assert_eq!(error.list[0].code, "E0605");
    let problem = "box.mass_kg is unknown in the model and known in the answer";
    assert!(error.to_string().contains(problem), "{error}");
}

#[test]
fn exact_an_unreliable_answer_needs_to_be_accepted() {
    let model = vehicle("exact = true");
    // A turn about x alone leaves the other moments to the limits of physical bodies.
    let (folder, _) = first_segment(&model, ONE);
    let error = after_answer(&model, folder.path(), false).unwrap_err();
    assert_eq!(error.list[0].code, "E0601");
    assert!(error.to_string().contains("--accept-unreliable"), "{error}");
    assert!(after_answer(&model, folder.path(), true).is_ok());
}
