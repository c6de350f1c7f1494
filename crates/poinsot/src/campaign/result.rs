//! The result of a campaign from the sums of its shards.

use super::plan::Plan;
use super::shard::{Found, MissingShard, ShardSums, find};
use super::sums::CellSums;
use crate::error::Error;
use poinsot_formats::{CAMPAIGN, CampaignFile};
use std::collections::BTreeMap;
use std::path::Path;

/// Number of missing shards listed.
const LISTED: usize = 100;

/// The shards of a plan, added in the order of their numbers.
pub struct Folded {
    /// One entry per cell.
    pub cells: Vec<CellSums>,
    /// Missing and damaged shards.
    pub missing: Vec<MissingShard>,
}

/// Adds the shards with trials below `trials` in order; the memory does not depend on their number.
///
/// # Errors
/// Reading fails, or two shards hold the same trial.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-fold-{}", std::process::id()));
/// run_shards(&plan, &out, &[0], &|_| {})?;
/// let folded = fold_shards(&plan, &out, plan.trials)?;
/// let answer = folded.result(&plan, plan.trials, 0.05);
/// assert!(answer.cells[0].methods[0].numbers.contains_key("bus.inertia_kg_m2.zz"));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fold_shards(plan: &Plan, out: &Path, trials: u64) -> Result<Folded, Error> {
    Folded::of(plan, trials, |number| find(plan, out, number))
}

/// Adds the sums of given shards in the order of their numbers.
///
/// # Errors
/// A shard belongs to another plan or is given twice.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// // The sums of all shards, from wherever they were run.
/// let folded = fold_sums(&plan, vec![run_shard(&plan, 0)?.sums])?;
/// assert!(folded.missing.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fold_sums(plan: &Plan, shards: Vec<ShardSums>) -> Result<Folded, Error> {
    let mut given = BTreeMap::new();
    for sums in shards {
        sums.check(plan, sums.shard).map_err(Error::internal)?;
        if let Some(twice) = given.insert(sums.shard, sums) {
            let what = format!("shard {} is given twice", twice.shard);
            return Err(Error::internal(what));
        }
    }
    Folded::of(plan, plan.trials, |number| {
        let missing = MissingShard {
            number,
            damage: None,
        };
        Ok(given.remove(&number).ok_or(missing))
    })
}

impl Folded {
    fn of(
        plan: &Plan,
        trials: u64,
        mut find: impl FnMut(u64) -> Result<Found, Error>,
    ) -> Result<Self, Error> {
        let mut folded = Self {
            cells: vec![CellSums::of(plan, &[]); plan.cells() as usize],
            missing: Vec::new(),
        };
        for number in 0..plan.shards_up_to(trials) {
            let cell = &mut folded.cells[plan.shard(number).cell as usize];
            match find(number)? {
                Ok(shard) => cell.merge(&shard.sums),
                Err(missing) => folded.missing.push(missing),
            }
        }
        Ok(folded)
    }

    /// The statistics of the trials below this number; `outside` is the probability outside each interval.
    pub fn result(&self, plan: &Plan, trials: u64, outside: f64) -> CampaignFile {
        let cells = (0..).zip(&self.cells);
        let cells = cells.filter(|(_, sums)| sums.methods.iter().any(|m| m.trials > 0));
        CampaignFile {
            schema: CAMPAIGN.to_owned(),
            poinsot: env!("CARGO_PKG_VERSION").to_owned(),
            name: plan.name.clone(),
            about: plan.file.about.clone(),
            digest: plan.digest.clone(),
            trials,
            planned: plan.trials,
            missing: self.missing.iter().take(LISTED).map(|m| m.number).collect(),
            outside,
            cells: cells.map(|(k, sums)| sums.file(plan, k, outside)).collect(),
        }
    }
}

/// Half-width of the widest coverage interval over all numbers, methods and cells; infinite if no trial stated an
/// interval.
pub(super) fn widest_coverage(result: &CampaignFile) -> f64 {
    let methods = result.cells.iter().flat_map(|c| &c.methods);
    let numbers = methods.flat_map(|m| m.numbers.values());
    let bands = numbers.flat_map(|n| [n.coverage_answered, n.coverage_all]);
    let stated = bands.filter(|band| band.value.is_some());
    let half = stated.map(|band| band.half().unwrap_or(f64::INFINITY));
    half.reduce(f64::max).unwrap_or(f64::INFINITY)
}
