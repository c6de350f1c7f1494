//! Shards on all cores of one machine.
//!
//! Each worker takes the next trials of any shard; the worker that finishes the last ones of a shard writes the shard.
//! Each worker has its own single-thread pool for the parallel parts of a fit. Trials therefore do not wait for each
//! other.

use super::faults::whole_fault;
use super::plan::{Plan, Shard};
use super::shard::{Found, ShardResult, find};
use super::trial::{Done, Prepared, at_once};
use crate::error::Error;
use crate::progress::step;
use std::collections::VecDeque;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Data shared by the trials of a cell, computed by the first trial.
type Shared = Arc<OnceLock<Result<Prepared, String>>>;

/// Numbers of damaged shards, with the reason.
pub type Damaged = Vec<(u64, String)>;

/// A shard whose trials are running.
struct Active {
    shard: Shard,
    prepared: Shared,
    done: Mutex<Vec<Option<Done>>>,
    left: AtomicUsize,
}

/// The remaining trials.
struct Queue {
    shards: VecDeque<u64>,
    current: Option<(Arc<Active>, u64)>,
}

/// Runs shards into the folder of a campaign; `watch` is called after each.
///
/// # Errors
/// Writing fails, or an experiment cannot be simulated. Finished shards are kept.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-shards-{}", std::process::id()));
/// let (missing, _) = missing_shards(&plan, &out, 0..plan.shards())?;
/// run_shards(&plan, &out, &missing, &|_| {})?;
/// assert!(missing_shards(&plan, &out, 0..plan.shards())?.0.is_empty());
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
    let total: u64 = shards.iter().map(|s| size(&plan.shard(*s))).sum();
    let total = usize::try_from(total).unwrap_or(usize::MAX);
    let queue = Mutex::new(Queue {
        shards: shards.iter().copied().collect(),
        current: None,
    });
    let failure: Mutex<Option<Error>> = Mutex::new(None);
    let count = AtomicUsize::new(0);
    let work = || {
        while locked(&failure).is_none() {
            let Some((active, trials)) = next(plan, &queue) else {
                return;
            };
            let many = (trials.end - trials.start) as usize;
            let finished = run_some(plan, &active, trials);
            step(
                "trials",
                count.fetch_add(many, Ordering::Relaxed) + many,
                total,
            );
            let taken = finished.and_then(|result| result.map_or(Ok(()), take));
            if let Err(error) = taken {
                locked(&failure).get_or_insert(error);
            }
        }
    };
    on_all_cores(&work)?;
    match failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(()),
    }
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
    let prepared = Prepared::new(plan, &shard)?;
    let done = prepared.run(plan, &shard, shard.trials.clone());
    Ok(ShardResult::new(plan, &shard, &prepared.bound(), &done))
}

/// Missing shards among these, and damaged ones with the reason.
///
/// # Errors
/// Reading fails.
///
/// ```
#[doc = include_str!("../../doc/plan.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-missing-{}", std::process::id()));
/// let (missing, damaged) = missing_shards(&plan, &out, 0..plan.shards())?;
/// assert_eq!((missing, damaged.len()), (vec![0], 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn missing_shards(
    plan: &Plan,
    out: &Path,
    shards: impl Iterator<Item = u64>,
) -> Result<(Vec<u64>, Damaged), Error> {
    let (mut missing, mut damaged) = (Vec::new(), Vec::new());
    for number in shards {
        match find(plan, out, &plan.shard(number))? {
            Found::Whole(_) => continue,
            Found::Missing => {}
            Found::Damaged(why) => damaged.push((number, why)),
        }
        missing.push(number);
    }
    Ok((missing, damaged))
}

fn size(shard: &Shard) -> u64 {
    shard.trials.end - shard.trials.start
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The next trials, and their shard.
fn next(plan: &Plan, queue: &Mutex<Queue>) -> Option<(Arc<Active>, Range<u64>)> {
    let mut queue = locked(queue);
    let queue = &mut *queue;
    loop {
        if let Some((active, at)) = &mut queue.current
            && *at < active.shard.trials.end
        {
            let first = *at;
            *at = active.shard.trials.end.min(first + at_once(plan));
            return Some((Arc::clone(active), first..*at));
        }
        let shard = plan.shard(queue.shards.pop_front()?);
        let kept = queue.current.take().filter(|(last, _)| {
            // The points of a sampling belong to one shard.
            last.shard.cell == shard.cell && plan.sampling.is_none()
        });
        let prepared = kept.map_or_else(Arc::default, |(last, _)| Arc::clone(&last.prepared));
        let n = usize::try_from(size(&shard)).unwrap_or(usize::MAX);
        let first = shard.trials.start;
        let active = Active {
            done: Mutex::new((0..n).map(|_| None).collect()),
            left: AtomicUsize::new(n),
            prepared,
            shard,
        };
        queue.current = Some((Arc::new(active), first));
    }
}

/// Runs trials; returns the shard after its last ones.
fn run_some(
    plan: &Plan,
    active: &Active,
    trials: Range<u64>,
) -> Result<Option<ShardResult>, Error> {
    let shard = &active.shard;
    let prepare = || Prepared::new(plan, shard).map_err(|e| e.to_string());
    let prepared = active.prepared.get_or_init(prepare);
    let prepared = prepared.as_ref().map_err(|why| {
        // The error already names file and remedy.
        let what = format!("cell {} cannot be simulated: {why}", shard.cell);
        whole_fault(
            "E0541",
            Path::new(&plan.name),
            what,
            "correct case, model or plan",
        )
    })?;
    let first = (trials.start - shard.trials.start) as usize;
    let done = prepared.run(plan, shard, trials);
    let many = done.len();
    for (place, one) in locked(&active.done)[first..].iter_mut().zip(done) {
        *place = Some(one);
    }
    if active.left.fetch_sub(many, Ordering::AcqRel) > many {
        return Ok(None);
    }
    let done: Vec<Done> = locked(&active.done).drain(..).flatten().collect();
    Ok(Some(ShardResult::new(
        plan,
        shard,
        &prepared.bound(),
        &done,
    )))
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
