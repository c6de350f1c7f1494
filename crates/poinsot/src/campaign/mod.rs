//! The command `campaign`: many trials of many experiments, from one core to a cluster.
//!
//! A [`Plan`] has experiments, methods, varied numbers and random numbers. Its trials are divided into numbered
//! shards. A shard depends only on the plan and its number: it can run anywhere, is written atomically, and can be
//! repeated. [`fold_shards`] adds shards in the order of their numbers, so that interruptions do not change the sums.
//!
//! ```no_run
//! use poinsot::campaign::{fold_shards, missing_shards, read_plan, run_shards};
//! # fn main() -> Result<(), poinsot::Error> {
//! let plan = read_plan("plan.toml".as_ref())?;
//! let (missing, _) = missing_shards(&plan, "out".as_ref(), 0..plan.shards())?;
//! run_shards(&plan, "out".as_ref(), &missing, &|_| {})?;
//! let folded = fold_shards(&plan, "out".as_ref(), plan.trials)?;
//! let mass = &folded.result(&plan, plan.trials).cells[0].methods[0].numbers["bus.mass_kg"];
//! println!("{:?}", mass.coverage_all);
//! # Ok(())
//! # }
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
mod trial;
mod until;

pub use engine::{Damaged, missing_shards, run_shard, run_shards};
pub use estimate::campaign_cost;
pub use pairs::{PairNumberSums, PairSums};
pub use plan::{Plan, Shard, made_plan, parse_plan, read_plan};
pub use result::{CellSums, Folded, OUTSIDE, fold_shards, fold_sums};
pub use run::{CampaignRequest, CampaignRun, Engine, campaign, campaign_in_memory, merge_campaign};
pub use shard::{ShardResult, ShardSums};
pub use slurm::slurm_scripts;
pub use until::{looks, outside_at_each};
