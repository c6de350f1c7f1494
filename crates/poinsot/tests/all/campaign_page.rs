//! The published campaign agrees with its recorded sums.

use poinsot::trials::{Sums, statistics_document, statistics_of};
use std::path::{Path, PathBuf};

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// Files of recorded sums in a folder, by name.
fn sums(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository(folder)).unwrap();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    files
}

#[test]
fn regress_the_page_of_the_campaign_shows_the_recorded_sums() {
    let page = std::fs::read_to_string(repository("docs/validation/campaign.md")).unwrap();
    let files = sums("fixtures/campaign");
    assert_eq!(files.len(), 5, "one file per set-up");
    let fixed = sums("fixtures/campaign/fixed_step");
    assert_eq!(fixed.len(), 1);
    for file in files.iter().chain(&fixed) {
        let sums = Sums::read(file).unwrap();
        let statistics = statistics_of(&sums);
        let table = statistics_document(&sums.setup, &statistics).to_string();
        assert!(
            page.contains(table.trim_end()),
            "{}\n{table}",
            file.display()
        );
        // A missed requirement is on the page.
        for miss in statistics.misses() {
            assert!(page.contains(&format!("missed: {miss}")), "{miss}");
        }
    }
}
