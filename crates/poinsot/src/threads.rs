//! Thread pool of a command, and the processor time of a thread.

use crate::error::Error;
use std::sync::Mutex;
use std::thread::Builder;
use std::time::Duration;

/// Starts the thread pool: one thread per core, or fewer if `RAYON_NUM_THREADS` or the system limits them. For program
/// start only; libraries use the existing pool.
///
/// # Errors
/// The system starts no thread at all.
///
/// ```
/// poinsot::start_threads()?;
/// # Ok::<(), poinsot::Error>(())
/// ```
pub fn start_threads() -> Result<(), Error> {
    let count = startable(thread_count())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count);
    pool.build_global().map_err(Error::threads)
}

/// Number of threads that a command starts: one per core, or fewer by `RAYON_NUM_THREADS`.
///
/// ```
/// assert!(poinsot::thread_count() > 0);
/// ```
pub fn thread_count() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let asked = std::env::var("RAYON_NUM_THREADS").ok();
    let asked = asked.and_then(|n| n.trim().parse().ok());
    let asked = asked.filter(|n| *n > 0);
    asked.map_or(cores, |n: usize| n.min(cores))
}

/// Number of these threads that can run at the same time.
fn startable(wanted: usize) -> Result<usize, Error> {
    let gate = Mutex::new(());
    let closed = gate.lock();
    std::thread::scope(|scope| {
        let mut refusal = None;
        let start = |_| Builder::new().spawn_scoped(scope, || drop(gate.lock()));
        let started = (0..wanted).map(start);
        let count = started
            .map_while(|thread| thread.map_err(|error| refusal = Some(error)).ok())
            .count();
        drop(closed);
        match refusal {
            Some(error) if count == 0 => Err(Error::threads(error)),
            _ => Ok(count),
        }
    })
}

/// Processor time of this thread.
#[cfg(unix)]
pub(crate) fn processor_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(t.tv_sec.max(0) as u64, t.tv_nsec as u32)
}

/// Wall-clock time, if processor time is not available.
#[cfg(not(unix))]
pub(crate) fn processor_time() -> Duration {
    use std::sync::OnceLock;
    use std::time::Instant;
    static ZERO: OnceLock<Instant> = OnceLock::new();
    ZERO.get_or_init(Instant::now).elapsed()
}

/// Processor time of this thread since an earlier one, s.
pub(crate) fn since(start: Duration) -> f64 {
    processor_time().saturating_sub(start).as_secs_f64()
}
