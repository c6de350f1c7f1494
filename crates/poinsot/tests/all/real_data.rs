//! Measurements of real bodies and satellites that are not in the repository; they run by `scripts/test data`.

use crate::throws::{Found, Object, likelihood, linear};
use poinsot_testkit::outside::outside;

use poinsot::{Identified, IdentifyRequest, Question, estimate_file, identify};
use poinsot_identify::Status;
use std::path::{Path, PathBuf};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(name)
        .join("model.toml")
}

fn ask(model: &str, files: Vec<PathBuf>, method: &str) -> Identified {
    identify(&IdentifyRequest {
        model: example(model),
        segments: vec![files],
        question: Question::by(method),
        ..IdentifyRequest::default()
    })
    .unwrap()
}

/// No inertia element, principal moment or sigma is given.
fn assert_no_inertia(identified: &Identified, body: &str) {
    let file = estimate_file(identified);
    let body = &file.bodies[body];
    for (_, n) in body.inertia_kg_m2.named() {
        assert_eq!((n.value, n.sigma, &n.source), (None, None, &None));
    }
    assert!(body.principal.is_none(), "{:?}", body.principal);
    let barycentric = body.barycentric.I_BBo_kg_m2.named();
    assert!(barycentric.iter().all(|(_, n)| n.value.is_none()));
}

/// Names, throws, and bounds of the mean and worst error, %.
fn assert_objects(found: &Found, bounds: [(&str, usize, f64, f64); 2]) {
    found.print();
    let block = found.proof_error;
    assert!(block.iter().all(|e| e.abs() < 0.9), "{block:?}");
    assert_eq!(found.objects.len(), bounds.len());
    for (object, (name, throws, mean, worst)) in found.objects.iter().zip(bounds) {
        assert_eq!((object.name.as_str(), object.throws.len()), (name, throws));
        let errors = object.errors();
        assert!(errors.0 < mean && errors.1 < worst, "{name}: {errors:?}");
        let together = object.together.error;
        assert!(
            together.iter().all(|e| e.abs() < 5.0),
            "{name}: {together:?}"
        );
    }
}

/// The first table of `data/tudelft_throw/README.md`. The known moments are from scales, ruler and CAD; Blaha et al. publish
/// a mean error of 2 %. The calibration is repeatable from throw to throw; a mistake in a filter, an axis or a lag would
/// change it.
#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_thrown_objects_within_two_percent_on_average() {
    let found = linear::evaluate(&outside("data/real/tudelft_throw")).unwrap();
    assert_objects(
        &found,
        [("config_empty", 10, 1.8, 6.2), ("config_a", 11, 2.0, 6.2)],
    );
    let J = 1.0e6 * found.J;
    assert!((J - 1.691).abs() < 0.01, "J = {J}e-6 kg m2");
    assert!(
        found
            .each_J
            .iter()
            .all(|one| (one / found.J - 1.0).abs() < 0.02)
    );
    let whole = found.the_box.together.I.trace();
    let traces = found.the_box.each.iter().map(|b| b.I.trace());
    assert!(
        traces
            .into_iter()
            .all(|one| (one / whole - 1.0).abs() < 0.015)
    );
}

/// The second table of that page: raw samples, a calibrated box.
#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_thrown_objects_by_likelihood() {
    let found = likelihood::evaluate(&outside("data/real/tudelft_throw"), false).unwrap();
    assert_objects(
        &found,
        [("config_empty", 10, 3.6, 8.2), ("config_a", 11, 1.0, 2.4)],
    );
    let held: Vec<f64> = found.objects.iter().map(Object::held).collect();
    assert!(held[0] > 0.8 && held[1] > 0.95, "{held:?}");
}

/// Its last rows: the box as assumed is worse.
#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_thrown_objects_with_an_ideal_box() {
    let found = likelihood::evaluate(&outside("data/real/tudelft_throw"), true).unwrap();
    found.print();
    let means: Vec<f64> = found.objects.iter().map(|o| o.errors().0).collect();
    assert!(means[0] > 3.4 && means[1] > 1.0, "{means:?}");
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_lomonosov_gives_no_number() {
    let rates = outside("data/real/lomonosov_flight_wheels/attitude_rates.csv");
    let wheels = outside("data/real/lomonosov_flight_wheels/wheels.csv");
    for method in ["auto", "linear"] {
        let identified = ask("lomonosov", vec![rates.clone(), wheels.clone()], method);
        let status = identified.estimate.status;
        assert!(
            matches!(status, Status::NotIdentifiable | Status::Rejected),
            "{method}: {status:?}"
        );
        assert!(!identified.passes());
        assert_no_inertia(&identified, "satellite");
        let body = &estimate_file(&identified).bodies["satellite"];
        assert!(body.mass_kg.value.is_none());
        assert!(body.com_m.named().iter().all(|(_, n)| n.value.is_none()));
        assert!(!identified.estimate.covariance_trustworthy());
    }
}

/// The table of `docs/validation/real_flight.md`: the nutation rate over the mean measured rate, beside an independent count.
#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_suchai3_nutates_as_counted() {
    for (date, counted, sigma) in [
        ("20230824", 0.13500, 0.00014),
        ("20231211", 0.13430, 0.00027),
    ] {
        let record = outside(&format!("data/real/suchai3/suchai3_{date}.csv"));
        let identified = ask("suchai3", vec![record.clone()], "auto");
        let rates = crate::coasting::rates(&record);
        let found = crate::coasting::nutation(&estimate_file(&identified), &rates, "bus");
        let k = found.unwrap() / rates.iter().sum::<nalgebra::Vector3<f64>>().y.abs()
            * rates.len() as f64;
        println!(
            "{date}: nutation over mean measured rate {k:.5}, counted {counted:.5}({sigma:.5})"
        );
        assert!((k - counted).abs() < 3.0 * sigma, "{date}: {k}");
        // What the record tells: one direction of the tensor much better than the prior.
        let told = &identified.estimate.identifiability;
        assert!(!told.open.is_empty(), "the prior alone tells the scale");
    }
}

/// A satellite at rest with wheels at rest determines nothing.
#[test]
fn regress_rest_is_not_identifiable() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rest.csv");
    let mut text =
        "time_s,q_x,q_y,q_z,q_w,omega_x,omega_y,omega_z,wheel1_rad_s,wheel2_rad_s,wheel3_rad_s\n"
            .to_owned();
    for k in 0..600 {
        text.push_str(&format!("{:.1},0,0,0,1,0,0,0,0,0,0\n", 0.1 * f64::from(k)));
    }
    std::fs::write(&path, text).unwrap();
    for method in ["auto", "linear"] {
        let identified = ask("stsat3", vec![path.clone()], method);
        assert_eq!(
            identified.estimate.status,
            Status::NotIdentifiable,
            "{method}"
        );
        assert!(!identified.passes());
        assert_no_inertia(&identified, "spacecraft");
    }
}
