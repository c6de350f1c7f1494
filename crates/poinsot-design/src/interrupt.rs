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

/// Whether an interruption was requested since [`Listening::begin`].
///
/// ```
/// use poinsot_design::interrupt::{Listening, is_requested, request};
///
/// let _listening = Listening::begin();
/// assert!(!is_requested() && request() && is_requested());
/// ```
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// While it exists, interruptions are directed to the search. Only one exists at a time.
///
/// ```
/// drop(poinsot_design::interrupt::Listening::begin());
/// assert!(!poinsot_design::interrupt::request());
/// ```
pub struct Listening;

impl Listening {
    /// Directs interruptions to the caller.
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
