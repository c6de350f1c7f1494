//! The published campaign agrees with its recorded sums.
//!
//! `POINSOT_CAMPAIGNS=DIR` records the sums of the finished campaigns `DIR/NAME` first.

use poinsot::campaign::{fold_shards, read_plan};
use poinsot::trials::{Sums, statistics_of};
use poinsot_formats::CampaignFile;
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

/// The sums of all shards of a campaign, recorded where `folder` has one of this name.
fn record(folder: &Path, name: &str, file: &Path) -> bool {
    let out = folder.join(name);
    if !out.exists() {
        return false;
    }
    let plan = read_plan(&repository("data/campaigns").join(format!("{name}.toml"))).unwrap();
    let result = std::fs::read_to_string(out.join("campaign.json")).unwrap();
    let result: CampaignFile = serde_json::from_str(&result).unwrap();
    let folded = fold_shards(&plan, &out, result.trials).unwrap();
    assert!(folded.missing.is_empty(), "{name}: {:?}", folded.missing);
    let [cell] = &folded.cells[..] else {
        panic!("{name}: {} cells", folded.cells.len());
    };
    assert_eq!(cell.methods.len(), 1, "{name}");
    let mut sums = cell.methods[0].clone();
    sums.setup = format!("{name}: {}", plan.file.about);
    sums.seconds = cell.seconds[0];
    sums.write(file).unwrap();
    true
}

#[test]
fn regress_the_page_of_the_campaign_shows_the_recorded_sums() {
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
        let sums = Sums::read(&file).unwrap();
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
