//! Thread pool of a command.

use crate::error::Error;
use std::sync::mpsc::channel;
use std::thread::{Builder, JoinHandle};

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
    let mut waiting = Vec::new();
    let mut started: Vec<JoinHandle<()>> = Vec::new();
    let mut refusal = None;
    for _ in 0..wanted {
        let (end, ended) = channel::<()>();
        match Builder::new().spawn(move || {
            let _ = ended.recv();
        }) {
            Ok(thread) => started.push(thread),
            Err(error) => refusal = Some(error),
        }
        waiting.push(end);
        if refusal.is_some() {
            break;
        }
    }
    drop(waiting);
    let count = started.len();
    for thread in started {
        let _ = thread.join();
    }
    match refusal {
        Some(error) if count == 0 => Err(Error::threads(error)),
        _ => Ok(count),
    }
}
