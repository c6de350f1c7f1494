//! The command `campaign`: many trials of many experiments, from one core to a cluster.
//!
//! A [`Plan`] has experiments, methods, varied numbers and random numbers. Its trials are divided into numbered
//! shards. A shard depends only on the plan and its number: it can run anywhere, is written atomically, and can be
//! repeated. [`fold_shards`] adds shards in the order of their numbers, so that interruptions do not change the sums.
//!
//! ```
//! use poinsot::campaign::{fold_shards, read_plan, run_shards};
//! use std::path::Path;
//!
//! let plan = read_plan(&Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/plan.toml"))?;
//! # let out = std::env::temp_dir().join(format!("poinsot-campaign-page-{}", std::process::id()));
//! let shards: Vec<u64> = (0..plan.shards()).collect();
//! run_shards(&plan, &out, &shards, &|_| {})?;
//! let folded = fold_shards(&plan, &out, plan.trials)?;
//! let answer = folded.result(&plan, plan.trials, 0.05);
//! let I_zz = &answer.cells[0].methods[0].numbers["bus.inertia_kg_m2.zz"];
//! assert_eq!(I_zz.trials, 4);
//! # std::fs::remove_dir_all(&out)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod address;
mod engine;
mod estimate;
mod experiment;
mod faults;
mod methods;
mod pairs;
mod plan;
mod result;
mod run;
mod sampling;
mod shard;
mod slurm;
mod sums;
mod trial;
mod until;

pub use engine::{missing_shards, run_shard, run_shards};
pub use estimate::campaign_cost;
pub use pairs::{PairNumberSums, PairSums};
pub use plan::{Plan, Shard, made_plan, parse_plan, read_plan};
pub use result::{Folded, fold_shards, fold_sums};
pub use run::{CampaignRequest, CampaignRun, Engine, campaign, campaign_in_memory, merge_campaign};
pub use shard::{MissingShard, ShardResult, ShardSums};
pub use slurm::slurm_scripts;
pub use sums::CellSums;
pub use until::{looks, outside_at_each};
