//! Runs the committed corpus and deterministic mutations of it through every target.
//!
//! `POINSOT_FUZZ_SECONDS=60` mutates for that time per target instead, and prints the number of inputs.
#![allow(clippy::unwrap_used, clippy::panic)]

use poinsot_fuzz::{Mutator, TARGETS};
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time limit of a single small input.
const LONGEST: Duration = Duration::from_secs(10);

/// The inputs written by hand, then those that libFuzzer found.
fn corpus(name: &str) -> Vec<Vec<u8>> {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let folder = std::fs::read_dir(fuzz.join("corpus").join(name)).unwrap();
    let mut paths: Vec<_> = folder.map(|e| e.unwrap().path()).collect();
    paths.sort();
    let written = paths.iter().map(|p| std::fs::read(p).unwrap());
    written.chain(found(&fuzz, name)).collect()
}

/// The fuzzer's inputs of a target; for `identify` it has kept none.
fn found(fuzz: &Path, name: &str) -> Vec<Vec<u8>> {
    if name == "identify" {
        return Vec::new();
    }
    let path = fuzz.join("found").join(name).with_extension("tar");
    let file = std::fs::File::open(path).unwrap();
    let mut archive = tar::Archive::new(file);
    let bytes = |mut entry: tar::Entry<_>| {
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        bytes
    };
    let entries = archive.entries().unwrap();
    entries.map(|entry| bytes(entry.unwrap())).collect()
}

fn replay(name: &str, mutations: u64) {
    let target = TARGETS.iter().find(|t| t.0 == name).unwrap().1;
    let corpus = corpus(name);
    assert!(!corpus.is_empty());
    let seconds = std::env::var("POINSOT_FUZZ_SECONDS").ok();
    let until = seconds.map(|s| Instant::now() + Duration::from_secs(s.parse().unwrap()));
    let mut mutator = Mutator::new(name.len() as u64);
    let started = Instant::now();
    let mut count = 0;
    let mut slowest = (Duration::ZERO, 0);
    let mut inputs = corpus.clone().into_iter();
    while until.map_or(count < mutations + corpus.len() as u64, |end| {
        Instant::now() < end
    }) {
        let input = inputs.next().unwrap_or_else(|| mutator.input(&corpus));
        count += 1;
        let began = Instant::now();
        if std::panic::catch_unwind(|| target(&input)).is_err() {
            let path = std::env::temp_dir().join(format!("poinsot-fuzz-{name}-{count}"));
            std::fs::write(&path, &input).unwrap();
            panic!("{name}: input {count} fails, kept as {}", path.display());
        }
        let took = began.elapsed();
        slowest = slowest.max((took, count));
        if took > LONGEST {
            let path = std::env::temp_dir().join(format!("poinsot-fuzz-slow-{name}-{count}"));
            std::fs::write(&path, &input).unwrap();
            panic!(
                "{name}: input {count} takes {took:?}, kept as {}",
                path.display()
            );
        }
    }
    println!(
        "{name}: {count} inputs in {:.1} s, the slowest ({}) {:.2} s",
        started.elapsed().as_secs_f64(),
        slowest.1,
        slowest.0.as_secs_f64()
    );
}

#[test]
fn prop_csv_corpus_and_mutations() {
    replay("csv", 2000);
}

#[test]
fn prop_parquet_corpus_and_mutations() {
    replay("parquet", 2000);
}

#[test]
fn prop_model_corpus_and_mutations() {
    replay("model", 20_000);
}

#[test]
fn prop_urdf_corpus_and_mutations() {
    replay("urdf", 20_000);
}

#[test]
fn prop_identify_corpus_and_mutations() {
    replay("identify", 60);
}
