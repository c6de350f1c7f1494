//! Turns a panic into a one-line error and exit code 4.

use crate::Error;
use std::any::Any;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook};
use std::sync::{Mutex, PoisonError};

/// Texts in the message of a panic after a failed allocation.
const NO_MEMORY: [&str; 2] = ["AllocError", "capacity overflow"];

/// The last panic.
static LAST: Mutex<Option<Error>> = Mutex::new(None);

/// Runs a verb; a panic inside becomes a failure. Panics caught deeper (by the Parquet decoder) print
/// nothing.
///
/// # Errors
/// Those of the verb, or E0009 and E0006 of a panic.
///
/// ```
/// let answer: Result<(), _> = poinsot::guarded(|| panic!("out of range"));
/// assert_eq!(answer.unwrap_err().code(), "E0009");
/// ```
pub fn guarded<T>(verb: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    set_hook(Box::new(move |info| *last() = Some(panic_error(info))));
    let unknown = || Error::internal("no message");
    catch_unwind(AssertUnwindSafe(verb))
        .unwrap_or_else(|_| Err(last().take().unwrap_or_else(unknown)))
}

/// The words of a panic.
pub(crate) fn panic_text(payload: &dyn Any) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message")
}

/// The error of a panic, E0009 or E0006, for a hook where panics cannot be caught.
///
/// ```
/// std::panic::set_hook(Box::new(|info| eprintln!("{}", poinsot::panic_error(info))));
/// ```
pub fn panic_error(info: &PanicHookInfo<'_>) -> Error {
    let message = panic_text(info.payload())
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    let place = info.location().map_or(String::new(), |l| {
        // The last three path components are enough; the rest is the path on the build machine.
        let parts: Vec<&str> = l.file().rsplit(['/', '\\']).take(3).collect();
        let parts: Vec<&str> = parts.into_iter().rev().collect();
        format!(" ({}:{})", parts.join("/"), l.line())
    });
    let what = format!("{message}{place}");
    match NO_MEMORY.iter().any(|text| what.contains(text)) {
        true => Error::memory("out of memory".to_owned()),
        false => Error::internal(what),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::panic)]
    fn exact_a_panic_is_one_line_and_exit_code_4() {
        let failure = guarded::<u8>(|| panic!("two\nlines")).err();
        let failure = failure.unwrap_or_default();
        assert_eq!(failure.kind(), crate::ErrorKind::Internal);
        let message = failure.to_string();
        let line = message.rsplit_once(':').map_or("", |m| m.0);
        assert!(
            line.starts_with("E0009 internal error: two lines (poinsot/src/guard.rs"),
            "{message}"
        );
        assert!(message.ends_with(
            ": this is a bug in poinsot; please report it with the command and, if possible, the input"
        ));
        assert!(!message.contains('\n'));
    }
}
