//! Result files that were changed or cut are refused, or read as before.

#![allow(clippy::unwrap_used, clippy::panic)]

use poinsot_formats::{
    CampaignFile, ComparisonFile, DesignFile, EstimateFile, PredictionFile, ReportData, ResultFile,
    TruthFile, ValidationFile, check_files, parse_result, result_text, sha256,
};
use std::fmt::Debug;
use std::path::Path;

fn text(path: &str) -> String {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::read_to_string(crates.join(path)).unwrap()
}

fn read<T: ResultFile>(bytes: &[u8]) -> Result<T, String> {
    parse_result(Path::new("file.json"), bytes).map_err(|e| e.to_string())
}

/// Every byte changed in one bit, and every length.
fn every_change_of<T: ResultFile + PartialEq + Debug>(text: &str) {
    let whole: T = read(text.as_bytes()).unwrap();
    let (mut refused, mut equal) = (0, 0);
    let mut count = |bytes: &[u8], what: &str| match read::<T>(bytes) {
        Err(_) => refused += 1,
        Ok(same) if same == whole => equal += 1,
        Ok(_) => panic!("{what}: another answer"),
    };
    let mut changed = text.as_bytes().to_vec();
    for k in 0..changed.len() {
        changed[k] ^= 1 << (k % 8);
        count(&changed, &format!("byte {k} changed"));
        changed[k] ^= 1 << (k % 8);
        count(&changed[..k], &format!("cut at {k}"));
    }
    println!("{}: {refused} refused, {equal} equal", T::SCHEMA);
    assert!(equal < 20, "{equal} of {}", 2 * text.len());
}

#[test]
fn exact_a_changed_or_cut_result_is_refused_or_equal() {
    every_change_of::<EstimateFile>(&text("poinsot-formats/doc/estimate.json"));
    let old: TruthFile = read(text("../data/stsat3/multiaxis/truth.json").as_bytes()).unwrap();
    every_change_of::<TruthFile>(&result_text(&old, true).unwrap());
    let document = |name: &str| text(&format!("poinsot-report/doc/{name}.json"));
    every_change_of::<ReportData>(&document("report_data"));
    every_change_of::<PredictionFile>(&document("prediction"));
    every_change_of::<ValidationFile>(&document("validation"));
    every_change_of::<ComparisonFile>(&document("comparison"));
    every_change_of::<DesignFile>(&document("design"));
    every_change_of::<CampaignFile>(&document("campaign"));
}

/// Numbers and keys changed by hand, with a good checksum.
#[test]
fn exact_an_estimate_that_contradicts_itself_is_refused() {
    let text = text("poinsot-formats/doc/estimate.json");
    let file: EstimateFile = read(text.as_bytes()).unwrap();
    let edited = |change: &dyn Fn(&mut EstimateFile)| {
        let mut file = file.clone();
        change(&mut file);
        result_text(&file, true).unwrap()
    };
    let body = text.split_once("\"sha256\": \"");
    assert!(body.is_some());
    let end = text.rfind("\"sha256\"").unwrap();
    let body = text[..end].trim_end().trim_end_matches(',');
    let twice = body.replacen("\"bodies\": {", "\"bodies\": {}, \"bodies\": {", 1);
    let sum = sha256(twice.as_bytes());
    for (k, edit) in [
        edited(&|e| e.bodies["bus"].mass_kg.value = Some(-1.0)),
        edited(&|e| e.bodies["bus"].inertia_kg_m2.xx.value = Some(1.0e308)),
        edited(&|e| e.bodies["bus"].inertia_kg_m2.xx.sigma = Some(-1.0)),
        edited(&|e| e.status = "finished".to_owned()),
        format!("{twice},\n  \"sha256\": \"{sum}\"\n}}\n"),
        format!("{body}}}"),
    ]
    .iter()
    .enumerate()
    {
        let refused = read::<EstimateFile>(edit.as_bytes());
        println!("{k}: {}", refused.as_ref().err().unwrap());
        assert!(refused.is_err(), "edit {k}");
    }
}

/// Each byte of a file beside a result, and each length.
#[test]
fn exact_a_changed_file_beside_a_result_is_refused() {
    let folder = std::env::temp_dir().join(format!("poinsot-beside-{}", std::process::id()));
    std::fs::create_dir(&folder).unwrap();
    let path = folder.join("rows.csv");
    let bytes: Vec<u8> = (0..200).collect();
    let listed = [("rows.csv".to_owned(), sha256(&bytes))]
        .into_iter()
        .collect();
    let check = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        check_files(&folder, &listed)
    };
    for k in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[k] ^= 1 << (k % 8);
        assert!(
            check(&changed)
                .unwrap_err()
                .starts_with("rows.csv beside it")
        );
        assert!(check(&bytes[..k]).is_err(), "{k}");
    }
    check(&bytes).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    check_files(&folder, &listed).unwrap();
}

/// A file of the previous version has no checksum, is read, and says so.
#[test]
fn exact_an_earlier_version_is_read_as_unchecked() {
    let text = text("poinsot-formats/doc/estimate.json");
    let end = text.rfind(",\n  \"sha256\"").unwrap();
    let old = text[..end].replacen("estimate/3", "estimate/2", 1) + "\n}\n";
    let file: EstimateFile = read(old.as_bytes()).unwrap();
    let note = "unchecked: poinsot.estimate/2 has no checksum";
    assert!(
        file.warnings.iter().any(|w| w == note),
        "{:?}",
        file.warnings
    );
    assert_eq!(file.unreliable(), [note]);
    // With a checksum it is not of the previous version.
    let forged = text.replacen("estimate/3", "estimate/2", 1);
    assert!(read::<EstimateFile>(forged.as_bytes()).is_err());
}
