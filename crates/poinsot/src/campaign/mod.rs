//! The command `campaign`: many trials of many experiments, from one core to a cluster.
//!
//! A [`Plan`] has experiments, methods, varied numbers and random numbers. Its trials are divided into numbered
//! shards. A shard depends only on the plan and its number: it can run anywhere, is written atomically, and can be
//! repeated. Shards are added in the order of their numbers, so that interruptions do not change the sums.
//!
//! ```
//! use poinsot::campaign::{campaign_in_memory, read_plan};
//! use std::path::Path;
//!
//! let plan = read_plan(&Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/plan.toml"))?;
//! let answer = campaign_in_memory(&plan)?.result.unwrap();
//! let I_zz = &answer.cells[0].methods[0].numbers["bus.inertia_kg_m2.zz"];
//! assert_eq!(I_zz.trials, 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod address;
mod deviates;
mod engine;
mod estimate;
mod experiment;
mod faults;
mod methods;
mod plan;
mod recount;
mod result;
mod run;
mod shard;
mod slurm;
mod sums;
mod trial;
mod until;

pub use estimate::campaign_cost;
pub use plan::{Plan, made_plan, parse_plan, read_plan};
pub use run::{CampaignRequest, CampaignRun, campaign, campaign_in_memory, merge_campaign};
pub use slurm::slurm_scripts;
#[doc(hidden)]
pub use {
    engine::{missing_shards, run_shard, run_shards},
    result::{fold_shards, fold_sums},
    run::Engine,
    shard::ShardSums,
    until::looks,
};
