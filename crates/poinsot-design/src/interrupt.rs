//! Interruption of a search, which then returns its best result.

use std::sync::atomic::{AtomicBool, Ordering};

static LISTENING: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Asks the running search to stop. Returns `false` if no search runs or one was already asked; the caller then ends
/// the program.
///
/// ```
/// // No search runs: the caller should end the program.
/// assert!(!poinsot_design::interrupt::request());
/// ```
pub fn request() -> bool {
    LISTENING.load(Ordering::SeqCst) && !REQUESTED.swap(true, Ordering::SeqCst)
}

/// Whether an interruption was requested.
pub(crate) fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// While it exists, interruptions are directed to the search.
pub(crate) struct Listening;

impl Listening {
    pub fn begin() -> Self {
        REQUESTED.store(false, Ordering::SeqCst);
        LISTENING.store(true, Ordering::SeqCst);
        Self
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        LISTENING.store(false, Ordering::SeqCst);
    }
}
