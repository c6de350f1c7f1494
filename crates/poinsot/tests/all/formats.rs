//! The formats of results: one type writes, reads and describes each, and nothing else knows their shape.

use poinsot::predict::{predict, prediction_file};
use poinsot::{IdentifyRequest, estimate_file, identify};
use poinsot_formats::{PredictionFile, parse_estimate};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn exact_results_read_back_as_they_were() {
    let examples = root().join("examples");
    for (model, telemetry) in [
        ("stsat3/model.toml", "stsat3/multiaxis/telemetry_noisy.csv"),
        (
            "ma2008/model_noisy.toml",
            "ma2008/traj1/telemetry_noisy.csv",
        ),
    ] {
        let request = IdentifyRequest::new(examples.join(model), [examples.join(telemetry)]);
        let file = estimate_file(&identify(&request).unwrap());
        let text = serde_json::to_string_pretty(&file).unwrap();
        let read = parse_estimate(Path::new("estimate.json"), text.as_bytes()).unwrap();
        assert_eq!(read, file, "{model}");
        assert_eq!(file.model_file.unwrap().sha256.len(), 64);
    }
    let found = predict(&examples.join("cases/tug_thrusters.toml"), 1.0).unwrap();
    let file = prediction_file(&found);
    let text = serde_json::to_string(&file).unwrap();
    let read: PredictionFile = serde_json::from_str(&text).unwrap();
    assert_eq!(read, file);
}

/// Every number of a prediction stands under the name that it has in an estimate.
#[test]
fn exact_predict_and_identify_use_the_same_names() {
    let examples = root().join("examples");
    let found = predict(&examples.join("cases/ma2008_traj1.toml"), 1.0).unwrap();
    let predicted = prediction_file(&found);
    let request = IdentifyRequest::new(
        examples.join("ma2008/model_noisy.toml"),
        [examples.join("ma2008/traj1/telemetry_noisy.csv")],
    );
    let identified = estimate_file(&identify(&request).unwrap());
    let value = serde_json::to_value(&predicted).unwrap();
    for (name, body) in &predicted.bodies {
        let own = &identified.bodies[name];
        assert!(own.com_m.named().map(|n| n.0) == body.com_m.named().map(|n| n.0));
        assert!(value["bodies"][name]["inertia_kg_m2"]["xy"]["sigma"].is_number());
    }
    for row in &predicted.covariance.names {
        assert!(identified.covariance.names.contains(row), "{row}");
    }
}

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// The text of every source file of the crates, without the tests in it, by its path below `crates`.
fn code() -> Vec<(String, String)> {
    let crates = root().join("crates");
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(&crates).unwrap() {
        let src = entry.unwrap().path().join("src");
        if src.is_dir() {
            sources(&src, &mut paths);
        }
    }
    assert!(paths.len() > 300);
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or("").to_owned();
        let name = path.strip_prefix(&crates).unwrap().display().to_string();
        (name, code)
    };
    paths.into_iter().map(read).collect()
}

/// A result is a type of `poinsot-formats`: no other crate builds JSON by hand or looks into it by key. What is left are
/// JSON Schemas, which have no type.
#[test]
fn unit_json_is_untyped_in_the_formats_crate_alone() {
    const SCHEMAS: [&str; 5] = [
        "poinsot-model/src/schema.rs",
        "poinsot-model/src/shape.rs",
        "poinsot-model/src/read.rs",
        "poinsot/src/schema.rs",
        "poinsot-book/src/formats.rs",
    ];
    const WORDS: [&str; 3] = ["json!", "serde_json::Value", "serde_json::{"];
    let found: Vec<String> = code()
        .into_iter()
        .filter(|(name, _)| {
            !name.starts_with("poinsot-formats") && !SCHEMAS.contains(&name.as_str())
        })
        .filter(|(_, text)| WORDS.iter().any(|word| text.contains(word)))
        .map(|(name, _)| name)
        .collect();
    assert!(found.is_empty(), "untyped JSON: {found:?}");
}

/// The order of the ten parameters is that of `InertialParameters::to_array`; who needs an element asks by name
/// (`tensor_index`), and no list of places is written by hand. Left out: the order of `y` of Ma 2008.
#[test]
fn unit_no_permutation_of_the_tensor_is_written_by_hand() {
    let found: Vec<String> = code()
        .into_iter()
        .filter(|(_, text)| {
            let text: String = text.split_whitespace().collect();
            let hand = ["[0,2,5,1,3,4]", "[0,2,5,1,4,3]", "[4,6,9,5,7,8]"];
            hand.iter().any(|list| text.contains(list))
        })
        .map(|(name, _)| name)
        .collect();
    assert!(found.is_empty(), "an order by hand: {found:?}");
}
