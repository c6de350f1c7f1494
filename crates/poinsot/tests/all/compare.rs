//! Comparison of answers of one vehicle.

use crate::shared::stsat3;
use poinsot::compare::{compare, compare_estimates};
use poinsot::{EstimateFile, IdentifyRequest, estimate_file, identify};
use poinsot_formats::ComparisonFile;
use poinsot_report::comparison_document;

/// The first or second half of the shipped slews: two nights of one satellite.
fn night(half: [f64; 2]) -> EstimateFile {
    let telemetry = stsat3().join("multiaxis/telemetry_noisy.csv");
    let mut request = IdentifyRequest::new(stsat3().join("model.toml"), [telemetry]);
    request.reading.time_s = Some(half);
    let mut file = estimate_file(&identify(&request).unwrap());
    // Each night has its own file.
    file.inputs[0].sha256 = format!("{half:?}");
    file
}

fn ask(files: &[&EstimateFile]) -> ComparisonFile {
    let named = files.iter().map(|file| ("".into(), (*file).clone()));
    compare_estimates(&named.collect::<Vec<_>>()).unwrap()
}

#[test]
fn stat_two_nights_agree_and_a_change_is_named() {
    let (first, second) = (night([0.0, 240.0]), night([240.0, 480.0]));
    let same = ask(&[&first, &second]);
    assert_eq!(same.verdict, "agree", "{:?}", same.tests);
    assert!(same.doubts.is_empty(), "{:?}", same.doubts);
    assert_eq!(same.numbers.len(), 6);
    for (name, n) in &same.numbers {
        let best = n.sigmas.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(n.pooled_sigma.unwrap() < best, "{name}");
    }
    // The moment about x changed by twenty sigmas between the nights.
    let mut changed = second.clone();
    let body = &mut changed.bodies["spacecraft"];
    let sigma = body.inertia_kg_m2.xx.sigma.unwrap();
    body.inertia_kg_m2.xx.value = body.inertia_kg_m2.xx.value.map(|v| v + 20.0 * sigma);
    let other = ask(&[&first, &changed]);
    assert_eq!(other.verdict, "differ");
    assert!(other.numbers["spacecraft.inertia_kg_m2.xx"].p < 1.0e-6);
    assert!(
        other.numbers["spacecraft.inertia_kg_m2.xx"]
            .pooled
            .is_none()
    );
    let said = comparison_document(&other).verdict;
    assert!(said.contains("inertia of spacecraft"), "{said}");
}

#[test]
fn regress_one_record_twice_is_not_two_answers() {
    let first = night([0.0, 240.0]);
    let twice = ask(&[&first, &first]);
    assert_eq!(twice.verdict, "agree");
    assert!(
        twice.doubts[0].contains("not independent"),
        "{:?}",
        twice.doubts
    );
}

#[test]
fn cli_answers_of_different_vehicles_are_refused() {
    let first = night([0.0, 240.0]);
    let mut other = first.clone();
    let body = other.bodies.swap_remove("spacecraft").unwrap();
    other.bodies.insert("bus".to_owned(), body);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, file: &EstimateFile| {
        let path = folder.path().join(name);
        std::fs::write(&path, poinsot_formats::result_text(file, true).unwrap()).unwrap();
        path
    };
    let answers = vec![write("a.json", &first), write("b.json", &other)];
    let error = compare(&answers).unwrap_err().to_string();
    assert!(error.contains("E0601") && error.contains("bus"), "{error}");
    let error = compare(&[write("a.json", &first)]).unwrap_err().to_string();
    assert!(error.contains("at least two answers"), "{error}");
}

/// The same period in another export has another hash; the dates reveal it.
#[test]
fn regress_overlapping_records_of_other_hashes_are_named() {
    let dated = |at: &str, sha256: &str| {
        let mut file = night([0.0, 240.0]);
        file.inputs[0].sha256 = sha256.to_owned();
        let epoch = file.epoch.as_mut().unwrap();
        (epoch.at, epoch.scale) = (Some(at.to_owned()), Some("UTC".to_owned()));
        file
    };
    let first = dated("2026-03-14T18:00:00", "a");
    let overlaps = ask(&[&first, &dated("2026-03-14T18:03:00.5", "b")]);
    let said = &overlaps.doubts;
    assert!(
        said.iter()
            .any(|d| d.contains("answers 1 and 2 overlaps by 59.50 s")),
        "{said:?}"
    );
    let apart = ask(&[&first, &dated("2026-03-14T18:04:01", "b")]);
    assert_eq!(apart.doubts.len(), 1, "{:?}", apart.doubts);
    // Without overlap in time the numbers reveal it: here both answers are identical.
    assert!(apart.doubts[0].contains("agree better than independent answers"));
}

/// Without dates an overlap in counts reveals it; two halves of one file do not overlap.
#[test]
fn regress_records_without_dates_are_compared_by_their_counts() {
    let (first, second) = (night([0.0, 240.0]), night([180.0, 420.0]));
    let said = ask(&[&first, &second]).doubts;
    assert!(
        said.len() == 1 && said[0].contains("has no dates; with one clock it overlaps by 60.00 s"),
        "{said:?}"
    );
    let mut halves = [night([0.0, 240.0]), night([240.0, 480.0])];
    halves
        .iter_mut()
        .for_each(|h| h.inputs[0].sha256 = "one".to_owned());
    let [first, second] = &halves;
    assert!(ask(&[first, second]).doubts.is_empty());
}

#[test]
fn cli_the_page_compares_with_earlier_answers() {
    let folder = tempfile::tempdir().unwrap();
    let telemetry = stsat3().join("multiaxis/telemetry_noisy.csv");
    let mut answers = Vec::new();
    for (name, half) in [("before", [0.0, 240.0]), ("after", [240.0, 480.0])] {
        let mut request = IdentifyRequest::new(stsat3().join("model.toml"), [&telemetry]);
        request.reading.time_s = Some(half);
        let out = folder.path().join(name);
        poinsot::write_result(&out, &identify(&request).unwrap(), &[], false, &[]).unwrap();
        answers.push(out);
    }
    let [before, after] = [&answers[0], &answers[1]];
    poinsot::write_report(after, std::slice::from_ref(before), &[]).unwrap();
    let page = std::fs::read_to_string(after.join("report.html")).unwrap();
    assert!(page.contains("id=\"comparison\"") && page.contains("spacecraft.inertia_kg_m2.xy"));
}
