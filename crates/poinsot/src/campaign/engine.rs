//! Shards on all cores of one machine.
//!
//! Each worker takes the next trial of any shard; the worker that finishes the last one of a shard writes the shard.
//! Each worker has its own single-thread pool for the parallel parts of a fit. Trials therefore do not wait for each
//! other.

use super::plan::{Plan, Shard};
use super::shard::{MissingShard, ShardResult, find};
use super::trial::Prepared;
use crate::error::Error;
use crate::progress::{TRIALS, step};
use crate::trials::Row;
use poinsot_files::{Pace, Place, check_time};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A shard whose trials are running.
struct Active {
    shard: Shard,
    /// Data shared by the trials of a cell, computed by the first trial.
    prepared: Arc<OnceLock<Result<Prepared, String>>>,
    /// Finished rows by their first trial.
    done: Mutex<BTreeMap<u64, Vec<Row>>>,
}

/// Runs shards into the folder of a campaign; `watch` is called after each.
///
/// # Errors
/// Writing fails, an experiment cannot be simulated, or by the time of the first trials all of them take longer than the
/// limit (E0006). Finished shards are kept.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-shards-{}", std::process::id()));
/// run_shards(&plan, &out, &[0], &|_| {})?;
/// assert!(missing_shards(&plan, &out, 0..plan.shards())?.is_empty());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_shards(
    plan: &Plan,
    out: &Path,
    shards: &[u64],
    watch: &(dyn Fn(u64) + Sync),
) -> Result<(), Error> {
    run_each(plan, shards, &|mut result| {
        let number = result.sums.shard;
        result.write(out).map(|()| watch(number))
    })
}

/// Runs shards on all cores and passes on each finished one.
pub(super) fn run_each(
    plan: &Plan,
    shards: &[u64],
    take: &(dyn Fn(ShardResult) -> Result<(), Error> + Sync),
) -> Result<(), Error> {
    let total: usize = shards.iter().map(|s| size(&plan.shard(*s))).sum();
    let seconds = total as f64 * plan.seconds / rayon::current_num_threads() as f64;
    let what = format!("the {total} trials");
    check_time(&what, seconds)?;
    let pace = Pace::new(what);
    let pieces = Mutex::new(pieces(plan, shards));
    let failure: OnceLock<Error> = OnceLock::new();
    let count = AtomicUsize::new(0);
    step(TRIALS, 0, total);
    let work = || {
        while failure.get().is_none() {
            let Some((active, trial)) = locked(&pieces).next() else {
                return;
            };
            let finished = run_one(plan, &active, trial);
            let done = count.fetch_add(1, Ordering::Relaxed) + 1;
            step(TRIALS, done, total);
            let taken = finished.and_then(|result| result.map_or(Ok(()), take));
            let taken = taken.and_then(|()| pace.check(1, total));
            if let Err(error) = taken {
                failure.get_or_init(|| error);
            }
        }
    };
    on_all_cores(&work)?;
    failure.into_inner().map_or(Ok(()), Err)
}

/// Runs one shard in memory, on this thread.
///
/// # Errors
/// An experiment cannot be simulated.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// let shard = run_shard(&plan, 0)?;
/// assert_eq!(shard.sums.trials, (0, 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_shard(plan: &Plan, shard: u64) -> Result<ShardResult, Error> {
    let shard = plan.shard(shard);
    let rows = Prepared::new(plan, &shard)?.run_all(plan, &shard);
    Ok(ShardResult::new(plan, &shard, &rows))
}

/// Missing shards among these, and damaged ones with the reason.
///
/// # Errors
/// Reading fails.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-missing-{}", std::process::id()));
/// let missing = missing_shards(&plan, &out, 0..plan.shards())?;
/// assert_eq!((missing[0].number, &missing[0].damage), (0, &None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn missing_shards(
    plan: &Plan,
    out: &Path,
    shards: impl Iterator<Item = u64>,
) -> Result<Vec<MissingShard>, Error> {
    let found = shards.map(|number| Ok(find(plan, out, number)?.err()));
    found.filter_map(Result::transpose).collect()
}

fn size(shard: &Shard) -> usize {
    usize::try_from(shard.trials.end - shard.trials.start).unwrap_or(usize::MAX)
}

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The trials of all shards, each with its shard.
fn pieces<'a>(
    plan: &'a Plan,
    shards: &'a [u64],
) -> impl Iterator<Item = (Arc<Active>, u64)> + Send + 'a {
    let mut last: Option<Arc<Active>> = None;
    shards.iter().flat_map(move |number| {
        let shard = plan.shard(*number);
        let same = |l: &Arc<Active>| l.shard.cell == shard.cell;
        let kept = last.take().filter(same);
        let active = Arc::new(Active {
            prepared: kept.map_or_else(Arc::default, |l| Arc::clone(&l.prepared)),
            done: Mutex::default(),
            shard,
        });
        last = Some(Arc::clone(&active));
        let trials = active.shard.trials.clone();
        trials.map(move |trial| (Arc::clone(&active), trial))
    })
}

/// Runs a trial; returns the shard after its last one.
fn run_one(plan: &Plan, active: &Active, trial: u64) -> Result<Option<ShardResult>, Error> {
    let shard = &active.shard;
    let prepare = || Prepared::new(plan, shard).map_err(|e| e.to_string());
    let prepared = active.prepared.get_or_init(prepare);
    let prepared = prepared.as_ref().map_err(|why| {
        // The error already names file and remedy.
        let what = format!("cell {} cannot be simulated: {why}", shard.cell);
        let remedy = "correct case, model or plan";
        Error::one("E0541", Place::file(&plan.name), what, remedy)
    })?;
    let rows = prepared.run(plan, shard, trial);
    let mut done = locked(&active.done);
    done.insert(trial, rows);
    if done.len() < size(shard) {
        return Ok(None);
    }
    let rows: Vec<Row> = std::mem::take(&mut *done).into_values().flatten().collect();
    Ok(Some(ShardResult::new(plan, shard, &rows)))
}

/// A pool of one thread, which runs the parallel parts of a fit one after the other.
pub(super) fn one_thread() -> Result<rayon::ThreadPool, Error> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.map_err(Error::threads)
}

/// Calls `work` on one thread per core; the parallel parts of a fit stay on the thread of its trial.
fn on_all_cores(work: &(dyn Fn() + Sync)) -> Result<(), Error> {
    let threads = rayon::current_num_threads();
    let pools = (0..threads)
        .map(|_| one_thread())
        .collect::<Result<Vec<_>, _>>()?;
    std::thread::scope(|scope| {
        for pool in &pools {
            // `install` blocks, so it needs its own thread.
            scope.spawn(move || pool.install(work));
        }
    });
    Ok(())
}
