//! Runs the committed corpus through every target, and drawn bytes through `identify` and the on-board filter.
#![allow(clippy::unwrap_used)]

use poinsot_fuzz::{Target, csv, identify, model, onboard, parquet, results, urdf, xml};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time limit of a single small input.
const LONGEST: Duration = Duration::from_secs(10);
/// Inputs of drawn bytes, and bytes of each: enough for a vehicle and its record.
const DRAWN: u64 = 200;
const BYTES: usize = 4096;

/// The inputs written by hand, then those that libFuzzer found, with their names.
fn corpus(name: &str) -> Vec<(String, Vec<u8>)> {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let folder = std::fs::read_dir(fuzz.join("corpus").join(name)).unwrap();
    let written = folder.map(|entry| entry.unwrap().path());
    let mut inputs: Vec<_> = written
        .map(|path| (path.display().to_string(), std::fs::read(&path).unwrap()))
        .collect();
    // For `identify` the fuzzer has kept none.
    if let Ok(file) = std::fs::File::open(fuzz.join("found").join(name).with_extension("tar")) {
        for entry in tar::Archive::new(file).entries().unwrap() {
            let mut entry = entry.unwrap();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            inputs.push((entry.path().unwrap().display().to_string(), bytes));
        }
    }
    inputs
}

fn replay(target: Target, inputs: &[(String, Vec<u8>)]) {
    assert!(!inputs.is_empty());
    for (name, bytes) in inputs {
        let began = Instant::now();
        let ended = std::panic::catch_unwind(|| target(bytes));
        assert!(ended.is_ok(), "{name} fails");
        let took = began.elapsed();
        assert!(took < LONGEST, "{name} takes {took:?}");
    }
}

#[test]
fn prop_csv_corpus() {
    replay(csv, &corpus("csv"));
}

#[test]
fn prop_parquet_corpus() {
    replay(parquet, &corpus("parquet"));
}

#[test]
fn prop_model_corpus() {
    replay(model, &corpus("model"));
}

#[test]
fn prop_urdf_corpus() {
    replay(urdf, &corpus("urdf"));
}

#[test]
fn prop_results_corpus() {
    replay(results, &corpus("results"));
}

#[test]
fn prop_xml_corpus() {
    replay(xml, &corpus("xml"));
}

fn with_drawn(name: &str) -> Vec<(String, Vec<u8>)> {
    let drawn = (0..DRAWN).map(|seed| {
        let mut bytes = vec![0; BYTES];
        ChaCha8Rng::seed_from_u64(seed).fill_bytes(&mut bytes);
        (format!("drawn, seed {seed}"), bytes)
    });
    corpus(name).into_iter().chain(drawn).collect()
}

#[test]
fn prop_identify_corpus_and_drawn_problems() {
    replay(identify, &with_drawn("identify"));
}

#[test]
fn prop_onboard_corpus_and_drawn_streams() {
    replay(onboard, &with_drawn("onboard"));
}
