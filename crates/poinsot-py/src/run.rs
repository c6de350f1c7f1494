//! A verb beside the interpreter: other Python threads go on, Ctrl-C ends it, and progress is told.
//!
//! The verb works on a thread of its own, which knows nothing of Python. The calling thread looks at it every
//! [`POLL`], passes progress on and asks for signals. A call that is interrupted returns at once; its thread unwinds at
//! its next report of progress, of which every iteration of a fit makes one.

use crate::fault::Fault;
use poinsot::{Listener, Step, guarded};
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::Builder;
use std::time::Duration;

/// How often the calling thread looks; a tenth of the 0.2 s within which Ctrl-C acts.
const POLL: Duration = Duration::from_millis(20);
/// Stack of a verb, that of a main thread.
const STACK: usize = 8 << 20;

/// Whether this process is the child of a fork: threads of the parent's pool do not exist here.
static FORKED: AtomicBool = AtomicBool::new(false);
/// Whether the pool of threads was started.
static STARTED: OnceLock<()> = OnceLock::new();

/// Called by the interpreter in the child after a fork.
#[pyfunction]
pub fn after_fork() {
    FORKED.store(true, Ordering::Release);
}

/// What the two threads share.
#[derive(Default)]
struct Watch {
    interrupted: AtomicBool,
    last: Mutex<Step>,
}

/// Payload of the unwinding that ends an interrupted verb.
struct Interrupted;

impl Watch {
    /// Keeps the last step, or unwinds an interrupted verb.
    fn take(&self, step: Step) {
        if self.interrupted.load(Ordering::Acquire) {
            resume_unwind(Box::new(Interrupted));
        }
        if let Ok(mut last) = self.last.lock() {
            *last = step;
        }
    }
}

/// Runs a verb without the interpreter's lock; `progress(stage, done, total)` is called as it goes.
///
/// # Errors
/// Those of the verb, an exception of the callback, or that of a signal.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    verb: impl FnOnce() -> Result<T, Fault> + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let (send, mut receive) = channel();
    let theirs = Arc::clone(&watch);
    let work = move || {
        // An interrupted verb has no listener.
        let _ = send.send(watched(theirs, verb));
    };
    let started = Builder::new().stack_size(STACK).spawn(work);
    started.map_err(|e| Fault::from(poinsot::Error::threads(e)))?;
    let mut told = Step::default();
    loop {
        let (back, waited) = py.detach(move || {
            let waited = receive.recv_timeout(POLL);
            (receive, waited)
        });
        receive = back;
        match waited {
            Ok(result) => return result.map_err(PyErr::from),
            Err(RecvTimeoutError::Disconnected) => {
                let what = "a verb ended without an answer".to_owned();
                return Err(Fault::from(poinsot::Error::internal(what)).into());
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let looked = tell(progress, &watch, &mut told).and_then(|()| py.check_signals());
        if let Err(error) = looked {
            watch.interrupted.store(true, Ordering::Release);
            return Err(error);
        }
    }
}

/// Passes the last step on where it is new.
fn tell(progress: Option<&Bound<'_, PyAny>>, watch: &Watch, told: &mut Step) -> PyResult<()> {
    let Some(progress) = progress else {
        return Ok(());
    };
    let last = match watch.last.lock() {
        Ok(last) => last.clone(),
        Err(_) => return Ok(()),
    };
    if last == *told {
        return Ok(());
    }
    *told = last.clone();
    progress.call1((last.stage, last.done, last.total))?;
    Ok(())
}

/// The verb under its listener; panics become faults.
fn watched<T: Send>(
    watch: Arc<Watch>,
    verb: impl FnOnce() -> Result<T, Fault> + Send,
) -> Result<T, Fault> {
    let listened = move || {
        let dispatch = tracing::Dispatch::new(Listener(move |step| watch.take(step)));
        tracing::dispatcher::with_default(&dispatch, || {
            guarded(|| verb().map_err(|fault| fault.0)).map_err(Fault)
        })
    };
    if FORKED.load(Ordering::Acquire) {
        let pool = rayon::ThreadPoolBuilder::new().build();
        let pool = pool.map_err(poinsot::Error::threads)?;
        return pool.install(listened);
    }
    if STARTED.get().is_none() {
        // Whoever comes second finds the pool there.
        let _ = poinsot::start_threads();
        let _ = STARTED.set(());
    }
    listened()
}
