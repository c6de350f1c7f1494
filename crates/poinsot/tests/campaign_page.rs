//! The published campaign is what its recorded sums say.
#![allow(clippy::unwrap_used)]

use poinsot::trials::{Sums, statistics_document, statistics_of};
use std::path::{Path, PathBuf};

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

#[test]
fn regress_the_page_of_the_campaign_shows_the_recorded_sums() {
    let page = std::fs::read_to_string(repository("docs/validation/campaign.md")).unwrap();
    let mut files: Vec<PathBuf> = std::fs::read_dir(repository("fixtures/campaign"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    assert_eq!(files.len(), 5, "one file per set-up");
    for file in files {
        let sums = Sums::read(&file).unwrap();
        let statistics = statistics_of(&sums);
        let table = statistics_document(&sums.setup, &statistics).to_string();
        assert!(
            page.contains(table.trim_end()),
            "{}\n{table}",
            file.display()
        );
        // What misses its aim is said on the page.
        for miss in statistics.misses() {
            assert!(page.contains(&format!("missed: {miss}")), "{miss}");
        }
    }
}
