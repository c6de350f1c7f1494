//! The published campaign agrees with its recorded results.
//!
//! `POINSOT_CAMPAIGNS=DIR` records the results of the finished campaigns `DIR/NAME` first.

use poinsot_formats::{CampaignFile, read_result};
use poinsot_report::statistics_document;
use std::path::{Path, PathBuf};

/// Campaigns of the page.
const PUBLISHED: [&str; 6] = [
    "ma_traj1",
    "ma_traj2",
    "stsat3_multiaxis",
    "tug_thrusters",
    "xu_target",
    "stsat3_fixed_step",
];

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// The result of a campaign, recorded where `folder` has one of this name.
fn record(folder: &Path, name: &str, file: &Path) -> bool {
    let result = folder.join(name).join("campaign.json");
    result.exists() && std::fs::copy(result, file).is_ok()
}

#[test]
fn regress_the_page_of_the_campaign_shows_the_recorded_results() {
    let made = std::env::var_os("POINSOT_CAMPAIGNS").map(PathBuf::from);
    let page = std::fs::read_to_string(repository("docs/validation/campaign.md")).unwrap();
    let file = |name: &str| repository("validation/campaign").join(format!("{name}.json"));
    if let Some(made) = &made {
        let recorded = PUBLISHED.map(|name| record(made, name, &file(name)));
        assert!(recorded.contains(&true), "{}", made.display());
    }
    let files = std::fs::read_dir(repository("validation/campaign")).unwrap();
    assert_eq!(files.count(), PUBLISHED.len());
    for name in PUBLISHED {
        let file = file(name);
        let result: CampaignFile = read_result(&file).unwrap();
        assert!(result.missing.is_empty(), "{name}: {:?}", result.missing);
        let [method] = &result.cells[0].methods[..] else {
            panic!("{name}: not one method");
        };
        let title = format!("{name}: {}", result.about);
        let table = statistics_document(&title, method).to_string();
        assert!(
            page.contains(table.trim_end()),
            "{}\n{table}",
            file.display()
        );
        // A missed requirement is on the page.
        for miss in method.find_misses() {
            assert!(page.contains(&format!("missed: {miss}")), "{miss}");
        }
    }
}
