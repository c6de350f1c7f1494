//! The set-ups of the published campaign (`data/campaigns`) as studies of the tests.

use poinsot::campaign::made_plan;
use poinsot::trials::Study;
use poinsot_formats::PlanFile;
use std::path::Path;

/// A set-up at every `stride`-th sample.
pub fn study(name: &str, stride: u64) -> Study {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/campaigns");
    let text = std::fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
    let mut file: PlanFile = toml::from_str(&text).unwrap();
    file.experiment[0].every = Some(stride);
    let plan = made_plan(file, &folder).unwrap();
    Study {
        diagnose: false,
        ..plan.study(0).unwrap()
    }
}
