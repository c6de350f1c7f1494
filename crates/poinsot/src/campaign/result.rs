//! Statistics with intervals from the sums of shards.

use super::pairs::banded;
use super::plan::Plan;
use super::shard::{Found, ShardSums, find};
use super::sums::CellSums;
use crate::error::Error;
use crate::trials::{Interval, NumberSums, ParameterStatistics, Statistics, statistics_of};
use poinsot_formats::{
    BandedFile, CAMPAIGN, CampaignFile, CellFile, MethodResultFile, NumberResultFile, PairFile,
    finite,
};
use std::collections::BTreeMap;
use std::path::Path;

/// Probability outside an interval of the result.
pub const OUTSIDE: f64 = 0.05;
/// Number of missing shards listed.
const LISTED: usize = 100;
/// Number of failed trials listed.
const NAMED: usize = 10;

/// The shards of a plan, added in the order of their numbers.
pub struct Folded {
    /// One entry per cell.
    pub cells: Vec<CellSums>,
    /// Missing shards, and damaged ones with the reason.
    pub missing: Vec<(u64, String)>,
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
/// let answer = folded.result(&plan, plan.trials);
/// assert!(answer.cells[0].methods[0].numbers.contains_key("bus.inertia_kg_m2.zz"));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fold_shards(plan: &Plan, out: &Path, trials: u64) -> Result<Folded, Error> {
    let mut folded = Folded::none(plan);
    for number in 0..plan.shards_up_to(trials) {
        folded.add(plan, number, find(plan, out, &plan.shard(number))?);
    }
    Ok(folded)
}

/// Adds the sums of given shards in the order of their numbers.
///
/// # Errors
/// A shard belongs to another plan or is given twice.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// // The sums of all shards, from wherever they were run.
/// let folded = fold_sums(&plan, &[run_shard(&plan, 0)?.sums])?;
/// assert!(folded.missing.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fold_sums(plan: &Plan, shards: &[ShardSums]) -> Result<Folded, String> {
    let mut folded = Folded::none(plan);
    let mut given = BTreeMap::new();
    for sums in shards {
        sums.check(plan, &plan.shard(sums.shard))?;
        if given.insert(sums.shard, sums).is_some() {
            return Err(format!("shard {} is given twice", sums.shard));
        }
    }
    for number in 0..plan.shards() {
        let found = match given.get(&number) {
            Some(sums) => Found::Whole(Box::new((*sums).clone())),
            None => Found::Missing,
        };
        folded.add(plan, number, found);
    }
    Ok(folded)
}

impl Folded {
    fn none(plan: &Plan) -> Self {
        Self {
            cells: vec![CellSums::default(); plan.cells() as usize],
            missing: Vec::new(),
        }
    }

    /// Adds a shard, or notes why it is missing.
    fn add(&mut self, plan: &Plan, number: u64, found: Found) {
        let added = match found {
            Found::Whole(shard) => {
                let cell = &mut self.cells[plan.shard(number).cell as usize];
                cell.merge(&shard.sums, plan.sampling.is_some())
            }
            Found::Missing => Err("it is not there".to_owned()),
            Found::Damaged(why) => Err(why),
        };
        self.missing.extend(added.err().map(|why| (number, why)));
    }

    /// The statistics of every method of every cell that has trials.
    pub fn statistics(&self) -> Vec<Vec<Statistics>> {
        let cells = self.cells.iter().filter(|c| !c.methods.is_empty());
        cells
            .map(|c| c.methods.iter().map(statistics_of).collect())
            .collect()
    }

    /// The statistics of the trials below this number.
    pub fn result(&self, plan: &Plan, trials: u64) -> CampaignFile {
        let cells = self.cells.iter().enumerate();
        let cells = cells.filter(|(_, sums)| !sums.methods.is_empty());
        CampaignFile {
            schema: CAMPAIGN.to_owned(),
            poinsot: env!("CARGO_PKG_VERSION").to_owned(),
            name: plan.name.clone(),
            about: plan.file.about.clone(),
            digest: plan.digest.clone(),
            trials,
            planned: plan.trials,
            missing: self.missing.iter().take(LISTED).map(|m| m.0).collect(),
            outside: OUTSIDE,
            cells: cells
                .map(|(k, sums)| cell_file(plan, k as u64, sums))
                .collect(),
        }
    }

    /// Half-width of the widest coverage interval over all numbers, methods and cells; infinite if no trial stated an
    /// interval.
    pub fn widest_coverage(&self, outside: f64) -> f64 {
        let mut widest = f64::NAN;
        for cell in &self.cells {
            for (k, sums) in cell.methods.iter().enumerate() {
                for n in sums.numbers.iter().filter(|n| n.trials > 0) {
                    let (answered, all) = coverage(cell, k, n, sums.trials, outside);
                    // NaN means that a method states no interval.
                    widest = widest.max(answered.half()).max(all.half());
                }
            }
        }
        if widest.is_nan() {
            f64::INFINITY
        } else {
            widest
        }
    }
}

fn coverage(
    cell: &CellSums,
    method: usize,
    n: &NumberSums,
    trials: u64,
    outside: f64,
) -> (Interval, Interval) {
    let replicated = cell.replicates.get(method).and_then(|r| r.get(&n.name));
    let stated = n.trials - n.unstated;
    if stated == 0 {
        let none = Interval::unknown(f64::NAN, f64::NAN, f64::NAN);
        return (none, none);
    }
    let answered = Interval::share(n.held, stated, outside);
    let all = Interval::share(n.held, trials, outside);
    // Equal replicates have no scatter; an interval of zero width is not used.
    let wide = |own: Interval, wilson: Interval| match own.half() > 0.0 {
        true => own,
        false => wilson,
    };
    match replicated {
        Some(r) => (
            wide(r.interval(r.held, answered.value, outside), answered),
            wide(r.interval(r.held_all, all.value, outside), all),
        ),
        None => (answered, all),
    }
}

fn cell_file(plan: &Plan, cell: u64, sums: &CellSums) -> CellFile {
    let labels = plan.method_labels();
    let point = plan.point(cell).into_iter();
    let methods = labels.iter().enumerate();
    let pairs = sums.pairs.iter().zip(labels.iter().skip(1));
    CellFile {
        experiment: plan.experiment(cell).name.clone(),
        at: point.map(|(n, x)| (n.to_owned(), x)).collect(),
        methods: methods
            .map(|(k, label)| method_file(label, k, sums))
            .collect(),
        comparisons: pairs
            .map(|(pair, other)| PairFile {
                first: labels[0].to_owned(),
                other: (*other).to_owned(),
                numbers: pair
                    .numbers
                    .iter()
                    .map(|n| (n.name.clone(), n.file(OUTSIDE)))
                    .collect(),
            })
            .collect(),
    }
}

fn method_file(label: &str, k: usize, cell: &CellSums) -> MethodResultFile {
    let sums = &cell.methods[k];
    let statistics = statistics_of(sums);
    let numbers = sums.numbers.iter().filter(|n| n.trials > 0);
    let failures = statistics.failed.iter().take(NAMED).cloned();
    MethodResultFile {
        method: label.to_owned(),
        trials: sums.trials,
        failed: banded(Interval::share(statistics.failures, sums.trials, OUTSIDE)),
        doubted: banded(Interval::share(sums.doubted, sums.answers, OUTSIDE)),
        statuses: sums.statuses.iter().cloned().collect(),
        failures: failures.collect(),
        nees: statistics
            .nees
            .map(|(mean, dof)| banded(Interval::mean_square(mean, dof, OUTSIDE))),
        nees_dof: statistics.nees.map_or(0, |n| n.1),
        // Exactly zero where no answer has residuals: a kernel states none.
        chi2_per_dof: finite(statistics.chi2_per_dof).filter(|chi2| *chi2 > 0.0),
        iterations: (statistics.iterations.0, statistics.iterations.1 as u64),
        seconds_per_trial: finite(cell.seconds[k] / sums.trials as f64),
        misses: statistics.misses(),
        numbers: numbers
            .zip(&statistics.parameters)
            .map(|(n, p)| (n.name.clone(), number_file(cell, k, n, p)))
            .collect(),
    }
}

fn number_file(
    cell: &CellSums,
    method: usize,
    n: &NumberSums,
    p: &ParameterStatistics,
) -> NumberResultFile {
    let sums = &cell.methods[method];
    let rmse = Interval::mean_square(p.rmse * p.rmse, n.trials, OUTSIDE).root();
    let over = match cell.replicates.get(method).and_then(|r| r.get(&n.name)) {
        Some(r) => {
            let value = (p.rmse / p.sigma()).powi(2);
            r.interval(r.square, value, OUTSIDE).root()
        }
        None => rmse.over(p.sigma()),
    };
    let (answered, all) = coverage(cell, method, n, sums.trials, OUTSIDE);
    NumberResultFile {
        trials: n.trials,
        bound: p.bound,
        stated: finite(p.stated),
        bias: banded(Interval::mean(p.bias, p.spread, n.trials, OUTSIDE)),
        rmse: banded(rmse),
        rmse_over_bound: match p.bound {
            Some(_) => banded(over),
            None => BandedFile {
                value: None,
                low: None,
                high: None,
            },
        },
        coverage_answered: banded(answered),
        coverage_all: banded(all),
    }
}
